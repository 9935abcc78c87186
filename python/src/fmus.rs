//! The FMUs of the package, opened once in a process.

use std::collections::HashMap;
use std::mem;
use std::path::{Path, PathBuf};
use std::process;
use std::sync::{Mutex, PoisonError};

use fmu_import::{FmiError, Fmu};
use pyo3::prelude::*;

/// The FMUs that are open, and the process that opened them.
static OPEN: Mutex<Option<(u32, HashMap<PathBuf, Fmu>)>> = Mutex::new(None);

/// The FMU at `path`. A process that was forked opens its own: the temporary folder is that of the other.
pub fn open(path: &Path) -> Result<Fmu, FmiError> {
    let mut open = OPEN.lock().unwrap_or_else(PoisonError::into_inner);
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
    let closed = py.detach(|| OPEN.lock().unwrap_or_else(PoisonError::into_inner).take());
    if let Some((owner, fmus)) = closed
        && owner != process::id()
    {
        mem::forget(fmus);
    }
}
