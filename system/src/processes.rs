//! Child processes, each with its process group. A signal that ends the command-line tool ends them (`end_all`). If this process is
//! killed, workers notice the end of their stdin, and Cargo and ngspice run to their own end. Windows has no such groups: there a
//! child is ended alone, and not by signals.

use std::collections::BTreeSet;
use std::io;
use std::process::{Child, Command, ExitStatus};
use std::sync::{Mutex, MutexGuard, PoisonError, RwLock};
use std::time::{Duration, Instant};

/// Held for reading while a child is started, for writing when all are ended.
static STARTING: RwLock<()> = RwLock::new(());
/// Process ids of children that are not reaped.
static RUNNING: Mutex<BTreeSet<u32>> = Mutex::new(BTreeSet::new());

fn running() -> MutexGuard<'static, BTreeSet<u32>> {
    RUNNING.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Polling interval for the end of a child.
const LOOK: Duration = Duration::from_millis(5);

/// A child in a process group of its own. Dropping it ends the group.
#[derive(Debug)]
pub struct ProcessGroup {
    /// For its pipes.
    pub child: Child,
    /// Whether it is reaped or about to be.
    is_over: bool,
}

impl ProcessGroup {
    /// Starts a child.
    ///
    /// # Errors
    /// If the system refuses.
    pub fn start(command: &mut Command) -> io::Result<Self> {
        #[cfg(unix)]
        std::os::unix::process::CommandExt::process_group(command, 0);
        let _open = STARTING.read().unwrap_or_else(PoisonError::into_inner);
        let child = command.spawn()?;
        running().insert(child.id());
        Ok(Self { child, is_over: false })
    }

    /// Whether the child has ended. This does not reap it: its process id, and that of its group, stays its own.
    ///
    /// # Errors
    /// If the system does not tell.
    #[cfg(unix)]
    pub fn has_ended(&mut self) -> io::Result<bool> {
        use rustix::process::{Pid, WaitId, WaitIdOptions, waitid};
        if self.is_over {
            return Ok(true);
        }
        let options = WaitIdOptions::EXITED | WaitIdOptions::NOHANG | WaitIdOptions::NOWAIT;
        match waitid(WaitId::Pid(Pid::from_child(&self.child)), options) {
            Ok(status) => Ok(status.is_some()),
            Err(rustix::io::Errno::INTR) => Ok(false),
            Err(cause) => Err(cause.into()),
        }
    }

    /// Whether the child has ended.
    ///
    /// # Errors
    /// If the system does not tell.
    #[cfg(not(unix))]
    pub fn has_ended(&mut self) -> io::Result<bool> {
        self.child.try_wait().map(|status| status.is_some())
    }

    /// Waits until the child has ended, or the time is up; whether it has ended.
    ///
    /// # Errors
    /// If the system does not tell.
    pub fn wait(&mut self, limit: Option<Duration>) -> io::Result<bool> {
        let start = Instant::now();
        while !self.has_ended()? {
            if limit.is_some_and(|limit| start.elapsed() >= limit) {
                return Ok(false);
            }
            std::thread::sleep(LOOK);
        }
        Ok(true)
    }

    /// Ends the group, once: the id of a reaped child may be given to another process. Returns the status of the child, which may
    /// have ended by itself.
    ///
    /// # Errors
    /// If the system does not tell.
    pub fn end(&mut self) -> io::Result<ExitStatus> {
        if !self.is_over {
            self.is_over = true;
            end_group(self.child.id());
            let _ = self.child.kill();
            running().remove(&self.child.id());
        }
        self.child.wait()
    }
}

impl Drop for ProcessGroup {
    fn drop(&mut self) {
        let _ = self.end();
    }
}

/// Ends the children of this process, which is about to end. While the returned value lives, no others can be started.
pub fn end_all() -> impl Sized {
    let closed = STARTING.write().unwrap_or_else(PoisonError::into_inner);
    let running = running();
    running.iter().for_each(|&child| end_group(child));
    (closed, running)
}

#[cfg(unix)]
fn end_group(child: u32) {
    if let Some(group) = i32::try_from(child).ok().and_then(rustix::process::Pid::from_raw) {
        // It may have ended by itself.
        let _ = rustix::process::kill_process_group(group, rustix::process::Signal::KILL);
    }
}

#[cfg(not(unix))]
fn end_group(_: u32) {}
