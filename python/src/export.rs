//! `export` and `netlist`: C(t) for other programs.

use std::path::PathBuf;

use pyo3::prelude::*;
use videg::export::{Format, Options};

use crate::error::error;
use crate::scenario::{By, Run, item};
use crate::{background, fmus};

/// Writes the file at `path`; what was written, as JSON.
#[pyfunction]
#[allow(clippy::too_many_arguments)] // the package names them
pub fn export(
    py: Python<'_>,
    fmu: PathBuf,
    run: Run,
    path: PathBuf,
    format: String,
    by: By,
    columns: Vec<String>,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<String> {
    let format: Format = item("format", &format)?;
    let scenario = run.resolve().map_err(error)?;
    let points = by.points(scenario.until);
    let exported = background::run(py, progress.as_ref(), |progress| {
        let harvester = fmus::open(&fmu).map_err(|error| error.to_string())?;
        let (scenario, columns, path) = (&scenario, &columns[..], &path);
        let options = Options { harvester: &harvester, scenario, format, points, columns, path };
        videg::export::run(&options, progress).map_err(|error| error.to_string())
    })?;
    serde_json::to_string(&exported).map_err(error)
}
