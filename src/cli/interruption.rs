//! Signals that end the program: it ends its children and removes its temporary folders before. `videg sweep` goes on to the
//! end of its runs instead.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::Duration;

use anyhow::Context as _;
use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag::{register, register_conditional_shutdown, register_usize};

use crate::{children, temporary};

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

/// From here on, the first signal sets `flag` and puts its number into `number`. The second one ends the process at once.
pub fn note(flag: &Arc<AtomicBool>, number: &Arc<AtomicUsize>) -> anyhow::Result<()> {
    for signal in signals() {
        let value = usize::try_from(signal).unwrap_or_default();
        register_conditional_shutdown(signal, 128 + signal, Arc::clone(flag))
            .and_then(|_| register_usize(signal, Arc::clone(number), value))
            .and_then(|_| register(signal, Arc::clone(flag)))
            .with_context(|| format!("cannot wait for signal {signal}"))?;
    }
    Ok(())
}

/// How often it is looked whether a signal has come.
const LOOK: Duration = Duration::from_millis(20);

/// The signal that has come.
pub struct Interruption(Arc<AtomicUsize>);

impl Interruption {
    /// Waits for signals from here on. A second one ends the process at once, whatever that leaves; so does the first where
    /// the system gives no thread to wait.
    pub fn watch() -> anyhow::Result<Self> {
        let (number, again) = (Arc::new(AtomicUsize::new(0)), Arc::new(AtomicBool::new(false)));
        let this = Self(Arc::clone(&number));
        let seen = Arc::clone(&number);
        let look = move || {
            loop {
                Self::end_if_interrupted(&seen);
                std::thread::sleep(LOOK);
            }
        };
        if std::thread::Builder::new().name("signals".into()).spawn(look).is_err() {
            return Ok(this);
        }
        note(&again, &number)?;
        Ok(this)
    }

    /// Ends the process if a signal has come: what failed for that reason is nothing to tell.
    pub fn settle(&self) {
        Self::end_if_interrupted(&self.0);
    }

    fn end_if_interrupted(number: &AtomicUsize) {
        let Ok(signal @ 1..) = i32::try_from(number.load(Ordering::Relaxed)) else { return };
        let _closed = (children::end_all(), temporary::remove_all());
        // As shells say it; without the destructors of libraries whose code may be running.
        signal_hook::low_level::exit(128 + signal)
    }
}
