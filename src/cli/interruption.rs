//! Signals that end the program: it ends its children, and removes its temporary folders and the files that it has not
//! finished, and folders in which nothing is, before. `videg sweep` ends the runs that it has begun instead.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use anyhow::Context as _;
use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag::{register, register_conditional_shutdown, register_usize};

use super::message::say;
use videg_system::{atomic_file, folders, processes, temporary};

/// Signals that end the program, but for those that it was started to ignore, as `nohup` and a shell's `&` do.
#[cfg(unix)]
fn signals() -> Vec<i32> {
    use signal_hook::consts::{SIGHUP, SIGQUIT};
    [SIGINT, SIGTERM, SIGHUP, SIGQUIT].into_iter().filter(|signal| !is_ignored(*signal)).collect()
}

/// As above. Nothing there is ignored.
#[cfg(not(unix))]
fn signals() -> Vec<i32> {
    vec![SIGINT, SIGTERM]
}

#[cfg(unix)]
fn is_ignored(signal: i32) -> bool {
    let mut present = core::mem::MaybeUninit::<libc::sigaction>::zeroed();
    // SAFETY: without a new action this only writes the present one; zero bytes are a valid one, too.
    let present = unsafe {
        libc::sigaction(signal, core::ptr::null(), present.as_mut_ptr());
        present.assume_init()
    };
    present.sa_sigaction == libc::SIG_IGN
}

/// Polling interval for signals.
const POLL: Duration = Duration::from_millis(20);

/// The signal that has come, once signals are waited for.
#[derive(Default, Clone)]
pub struct Interruption {
    /// Its number; before one has come, 0.
    signal: Arc<AtomicUsize>,
    has_come: Arc<AtomicBool>,
    /// Whether the caller ends by itself.
    is_deferred: Arc<AtomicBool>,
    /// What becomes of the results.
    notice: Arc<Mutex<String>>,
}

impl Interruption {
    /// Waits for signals from here on. A second one ends the process at once, without cleaning up; so does the first where
    /// the system gives no thread to wait.
    pub fn watch(&self) -> anyhow::Result<()> {
        let watched = self.clone();
        let look = move || {
            loop {
                watched.settle();
                std::thread::sleep(POLL);
            }
        };
        if std::thread::Builder::new().name("signals".into()).spawn(look).is_err() {
            return Ok(());
        }
        self.register()
    }

    /// From here on the first signal stores its number, and the second one ends the process at once.
    fn register(&self) -> anyhow::Result<()> {
        for signal in signals() {
            let number = usize::try_from(signal).unwrap_or_default();
            register_conditional_shutdown(signal, 128 + signal, Arc::clone(&self.has_come))
                .and_then(|_| register_usize(signal, Arc::clone(&self.signal), number))
                .and_then(|_| register(signal, Arc::clone(&self.has_come)))
                .with_context(|| format!("cannot wait for signal {signal}"))?;
        }
        Ok(())
    }

    /// Whether a signal has come, for a caller that ends in order by itself from here on. Ends the process if one has come
    /// before.
    pub fn defer(&self) -> &AtomicBool {
        self.settle();
        self.is_deferred.store(true, Ordering::Relaxed);
        &self.has_come
    }

    /// The number of the signal that has come; before, 0.
    pub fn signal(&self) -> usize {
        self.signal.load(Ordering::Relaxed)
    }

    /// Sets what is told of the results if a signal ends the process from here on.
    pub fn tell(&self, notice: &str) {
        notice.clone_into(&mut self.notice.lock().unwrap_or_else(PoisonError::into_inner));
    }

    /// Ends the process if a signal has come, unless the caller ends by itself. Errors that the signal caused are not shown.
    pub fn settle(&self) {
        let Ok(signal @ 1..) = i32::try_from(self.signal()) else { return };
        if self.is_deferred.load(Ordering::Relaxed) {
            return;
        }
        let _closed = (processes::end_all(), temporary::remove_all());
        let (removed, _closed_too) = atomic_file::remove_all();
        folders::remove_empty();
        let removed = removed.iter().map(|part| format!("removed {}", part.display()));
        let notice = self.notice.lock().unwrap_or_else(PoisonError::into_inner).clone();
        let told =
            ["interrupted".to_owned()].into_iter().chain(removed).chain(Some(notice).filter(|it| !it.is_empty()));
        say(&told.collect::<Vec<_>>().join("; "));
        // As shells say it; without the destructors of libraries whose code may be running.
        signal_hook::low_level::exit(128 + signal)
    }
}
