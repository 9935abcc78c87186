//! `simulate`: the harvester alone.

use std::path::PathBuf;

use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde::Serialize;
use videg::simulate::{Column, TableOptions};

use crate::error::{error, error_of_record};
use crate::scenario::{By, Run};
use crate::{background, fmus};

/// What a run gives beside its columns.
#[derive(Serialize)]
struct Summary<'a> {
    case: &'a str,
    description: &'a str,
    until: f64,
    window: [f64; 2],
    /// Of the run.
    impacts: i32,
    /// V/s.
    average_voltage_gain: f64,
    /// W.
    average_power_eq13: f64,
    /// F.
    rest_capacitance: f64,
    warnings: &'a [String],
}

/// Runs the harvester: columns and units by name, and the summary as JSON.
#[pyfunction]
pub fn simulate<'py>(
    py: Python<'py>,
    fmu: PathBuf,
    run: Run,
    record: Vec<String>,
    by: By,
    progress: Option<Bound<'py, PyAny>>,
) -> PyResult<(Bound<'py, PyDict>, Bound<'py, PyDict>, String)> {
    let scenario = run.resolve().map_err(error)?;
    let points = by.points(scenario.until);
    let table = background::run(py, progress.as_ref(), |progress| {
        let harvester = fmus::open(&fmu).map_err(|error| error.to_string())?;
        let options = TableOptions { harvester: &harvester, scenario: &scenario, points, columns: &record };
        videg::simulate::table(&options, progress).map_err(error_of_record)
    })?;
    let summary = Summary {
        case: &scenario.name,
        description: &scenario.description,
        until: scenario.until,
        window: scenario.window,
        impacts: table.impacts,
        average_voltage_gain: table.averages.voltage_gain,
        average_power_eq13: table.averages.power,
        rest_capacitance: table.rest_capacitance,
        warnings: &table.warnings,
    };
    let summary = serde_json::to_string(&summary).map_err(error)?;
    let (columns, units) = (PyDict::new(py), PyDict::new(py));
    for Column { name, unit, values } in table.columns {
        units.set_item(&name, unit)?;
        columns.set_item(name, PyArray1::from_vec(py, values))?;
    }
    Ok((columns, units, summary))
}
