//! A worker as this process sees it: started, asked, watched and ended.

use std::collections::VecDeque;
use std::io::{self, Read};
use std::path::Path;
use std::process::{Child, ChildStderr, Command, Stdio};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use serde::Serialize;

use super::WORKER_VERB;
use super::ending::How;
use super::pipes::{Heard, Pipes};
use super::protocol::{Reply, frame, unframe};

/// How often a silent worker is looked at: what it started may hold its pipes open beyond its death.
const LOOK: Duration = Duration::from_millis(100);
/// How long a worker that has closed its pipes may take to end.
const FAREWELL: Duration = Duration::from_secs(1);
/// The end of what a worker prints is kept, bytes.
const KEPT: usize = 2048;

/// A worker. Dropping it ends it, together with what it started and did not send away.
pub(super) struct Process {
    child: Child,
    pipes: Pipes,
    /// What it sent and nobody has read yet.
    heard: Vec<u8>,
    printed: Arc<Mutex<Printed>>,
}

#[derive(Default)]
struct Printed {
    tail: VecDeque<u8>,
    is_over: bool,
}

impl Process {
    /// Starts a worker in `folder`.
    ///
    /// # Errors
    /// If the system refuses.
    pub fn start(program: &Path, folder: &Path) -> io::Result<Self> {
        let mut command = Command::new(program);
        command.arg(WORKER_VERB).current_dir(folder);
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        #[cfg(unix)]
        std::os::unix::process::CommandExt::process_group(&mut command, 0);
        let mut child = command.spawn()?;
        let missing = || io::Error::other("no pipe");
        let (requests, replies) = (child.stdin.take().ok_or_else(missing)?, child.stdout.take().ok_or_else(missing)?);
        let printed = keep_printed(child.stderr.take().ok_or_else(missing)?);
        let pipes = Pipes::new(requests, replies)?;
        Ok(Self { child, pipes, heard: Vec::new(), printed })
    }

    /// Sends a message and returns the answer, which must come within `limit`; `log` gets the records on the way. After an
    /// error the worker is gone.
    ///
    /// # Errors
    /// What happened to it.
    pub fn ask(
        &mut self,
        message: &impl Serialize,
        limit: Option<Duration>,
        mut log: impl FnMut(Reply),
    ) -> Result<Reply, How> {
        let end = limit.and_then(|limit| Instant::now().checked_add(limit));
        let bytes = frame(message).map_err(|cause| How::Refused(cause.to_string()))?;
        self.send(&bytes, end).map_err(|how| self.end(how))?;
        loop {
            match self.next(end) {
                Ok(record @ Reply::Log(_)) => log(record),
                Ok(answer) => return Ok(answer),
                Err(how) => return Err(self.end(how)),
            }
        }
    }

    fn send(&mut self, mut bytes: &[u8], end: Option<Instant>) -> Result<(), How> {
        while !bytes.is_empty() {
            match self.pipes.write(bytes, wait(end)?) {
                Ok(0) => self.look()?,
                Ok(count) => bytes = &bytes[count..],
                // It is gone, and has said why: see what it sent last.
                Err(_) => return Ok(()),
            }
        }
        Ok(())
    }

    fn next(&mut self, end: Option<Instant>) -> Result<Reply, How> {
        loop {
            let message = unframe(&mut self.heard).map_err(|cause| How::Garbled(cause.to_string()))?;
            if let Some(message) = message {
                return Ok(message);
            }
            match self.pipes.read(&mut self.heard, wait(end)?) {
                Ok(Heard::Something) => {}
                Ok(Heard::Nothing) => self.look()?,
                Ok(Heard::End) => return Err(How::Silent),
                Err(cause) => return Err(How::Refused(cause.to_string())),
            }
        }
    }

    /// Whether it lives.
    fn look(&mut self) -> Result<(), How> {
        match self.child.try_wait() {
            Ok(None) => Ok(()),
            Ok(Some(status)) => Err(How::Ended(status)),
            Err(cause) => Err(How::Refused(cause.to_string())),
        }
    }

    /// Ends it; what became of it is `how`, or its own end where that comes first.
    fn end(&mut self, how: How) -> How {
        let own = if matches!(how, How::Silent) { self.farewell() } else { None };
        self.kill();
        own.map_or(how, How::Ended)
    }

    /// The exit status of a worker that has closed its pipes, if it ends by itself.
    fn farewell(&mut self) -> Option<std::process::ExitStatus> {
        let end = Instant::now() + FAREWELL;
        while Instant::now() < end {
            match self.child.try_wait() {
                Ok(None) => std::thread::sleep(Duration::from_millis(1)),
                Ok(status) => return status,
                Err(_) => return None,
            }
        }
        None
    }

    /// Ends the worker and its group.
    fn kill(&mut self) {
        #[cfg(unix)]
        {
            let group = rustix::process::Pid::from_child(&self.child);
            let _ = rustix::process::kill_process_group(group, rustix::process::Signal::KILL);
        }
        let _ = self.child.kill();
        let _ = self.child.wait();
    }

    /// The end of what it printed.
    pub fn printed(&self) -> String {
        let end = Instant::now() + LOOK;
        loop {
            let printed = self.printed.lock().unwrap_or_else(PoisonError::into_inner);
            // Something else may hold the pipe open.
            if printed.is_over || Instant::now() > end {
                return String::from_utf8_lossy(&printed.tail.iter().copied().collect::<Vec<_>>()).into_owned();
            }
            drop(printed);
            std::thread::sleep(Duration::from_millis(1));
        }
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        self.kill();
    }
}

/// How long to wait before the next look.
fn wait(end: Option<Instant>) -> Result<Duration, How> {
    let Some(end) = end else { return Ok(LOOK) };
    let left = end.saturating_duration_since(Instant::now());
    if left.is_zero() { Err(How::TooLong) } else { Ok(left.min(LOOK)) }
}

/// Reads what a worker prints, so that it never waits for a reader, and keeps the end.
fn keep_printed(mut stderr: ChildStderr) -> Arc<Mutex<Printed>> {
    let printed = Arc::new(Mutex::new(Printed::default()));
    let shared = Arc::clone(&printed);
    std::thread::spawn(move || {
        let mut chunk = [0; 1024];
        let keep = |bytes: &[u8]| {
            let mut printed = shared.lock().unwrap_or_else(PoisonError::into_inner);
            printed.tail.extend(bytes);
            let excess = printed.tail.len().saturating_sub(KEPT);
            printed.tail.drain(..excess);
        };
        while let Ok(count @ 1..) = stderr.read(&mut chunk) {
            keep(&chunk[..count]);
        }
        shared.lock().unwrap_or_else(PoisonError::into_inner).is_over = true;
    });
    printed
}
