//! The FMUs of the package, opened once in a process.

use std::collections::HashMap;
use std::io;
use std::mem;
use std::path::{Path, PathBuf};
use std::process;
use std::sync::{Mutex, MutexGuard, TryLockError};
use std::thread;
use std::time::{Duration, Instant};

use fmu_import::{FmiError, Fmu};
use pyo3::prelude::*;

/// The FMUs that are open, and the process that opened them.
static OPEN: Mutex<Option<Open>> = Mutex::new(None);

type Open = (u32, HashMap<PathBuf, Fmu>);

/// Longest time for which an FMU is opened, or a forked process waits for a thread that it has not.
const LONGEST: Duration = Duration::from_secs(30);

fn lock() -> io::Result<MutexGuard<'static, Option<Open>>> {
    let began = Instant::now();
    loop {
        match OPEN.try_lock() {
            Ok(open) => return Ok(open),
            Err(TryLockError::Poisoned(poisoned)) => return Ok(poisoned.into_inner()),
            Err(TryLockError::WouldBlock) if began.elapsed() > LONGEST => {
                let reason =
                    "another thread has been opening an FMU for too long; was this process forked from it meanwhile?";
                return Err(io::Error::other(reason));
            }
            Err(TryLockError::WouldBlock) => thread::sleep(Duration::from_millis(1)),
        }
    }
}

/// The FMU at `path`. A process that was forked opens its own: the temporary folder is that of the other.
pub fn open(path: &Path) -> Result<Fmu, FmiError> {
    let mut open = lock().map_err(|cause| FmiError::Io { action: "open", path: path.to_owned(), cause })?;
    if open.as_ref().is_some_and(|(owner, _)| *owner != process::id()) {
        mem::forget(open.take());
    }
    let (_, fmus) = open.get_or_insert_with(|| (process::id(), HashMap::new()));
    if let Some(fmu) = fmus.get(path) {
        return Ok(fmu.clone());
    }
    let fmu = Fmu::open(path)?;
    fmus.insert(path.to_owned(), fmu.clone());
    Ok(fmu)
}

/// Closes the FMUs, at the end of the process.
#[pyfunction]
pub fn close(py: Python<'_>) {
    // At the end of a process nobody is waited for.
    let closed = py.detach(|| OPEN.try_lock().ok()?.take());
    if let Some((owner, fmus)) = closed
        && owner != process::id()
    {
        mem::forget(fmus);
    }
}
