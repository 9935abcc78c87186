//! Long runs: they go on in a thread of their own without the interpreter's lock, while the thread that asked for them looks for
//! signals, so that Ctrl-C ends them, and tells how far they are.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Condvar, Mutex, PoisonError};
use std::thread;
use std::time::Duration;

use pyo3::prelude::*;
use videg::progress::{Progress, Running};

use crate::error::error;

/// Polling interval for signals, and of the progress.
const POLL: Duration = Duration::from_millis(50);

/// How far a run is, and whether it is to stop.
#[derive(Default)]
struct Shared {
    stop: AtomicBool,
    done: AtomicU64,
    total: AtomicU64,
}

impl Progress for Shared {
    fn advance(&self, done: u64, total: u64, _running: &[Running]) {
        self.done.store(done, Ordering::Relaxed);
        self.total.store(total, Ordering::Relaxed);
    }

    fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
}

/// The result of `work`. `told` is called with the parts done and all parts, now and then.
///
/// # Errors
/// That of `work`; `KeyboardInterrupt` after Ctrl-C; whatever a handler of signals or `told` raises, which ends the work.
pub fn run<T: Send, E: std::fmt::Display + Send>(
    py: Python<'_>,
    told: Option<&Bound<'_, PyAny>>,
    work: impl FnOnce(&dyn Progress) -> Result<T, E> + Send,
) -> PyResult<T> {
    let (shared, result, finished) = (Shared::default(), Mutex::new(None), Condvar::new());
    let (shared, result, finished) = (&shared, &result, &finished);
    thread::scope(|scope| {
        let body = move || {
            let outcome = catch_unwind(AssertUnwindSafe(|| work(shared)));
            *result.lock().unwrap_or_else(PoisonError::into_inner) = Some(outcome);
            finished.notify_all();
        };
        thread::Builder::new().name("videg".to_owned()).spawn_scoped(scope, body).map_err(error)?;
        let mut raised = None;
        let outcome = loop {
            let outcome = py.detach(|| {
                let waiting = result.lock().unwrap_or_else(PoisonError::into_inner);
                let (mut now, _) = finished
                    .wait_timeout_while(waiting, POLL, |result| result.is_none())
                    .unwrap_or_else(PoisonError::into_inner);
                now.take()
            });
            if let Some(outcome) = outcome {
                break outcome;
            }
            if raised.is_none() {
                raised = py.check_signals().and_then(|()| tell(told, shared)).err();
                shared.stop.store(raised.is_some(), Ordering::Relaxed);
            }
        };
        match (raised, outcome) {
            (Some(raised), _) => Err(raised),
            (None, Ok(result)) => {
                let result = result.map_err(error)?;
                tell(told, shared)?;
                Ok(result)
            }
            (None, Err(_)) => Err(error("internal error: the run has panicked; the message is on stderr")),
        }
    })
}

fn tell(told: Option<&Bound<'_, PyAny>>, shared: &Shared) -> PyResult<()> {
    let Some(told) = told else { return Ok(()) };
    told.call1((shared.done.load(Ordering::Relaxed), shared.total.load(Ordering::Relaxed))).map(|_| ())
}
