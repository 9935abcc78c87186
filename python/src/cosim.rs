//! `cosim`: harvester and circuit.

use std::path::PathBuf;

use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde::Serialize;
use videg::cosim::{
    CircuitSolver, CircuitSummary, Cosimulation, Coupling, CouplingSummary, EnergyBalance, LabelledCircuit,
    MechanicsSummary, Method, Options, Sample, SeriesColumns, SeriesFormat, SeriesOptions, SeriesRecorder,
};
use videg::coupled::Powers;

use videg::sweep::system_description;

use crate::error::{error, error_of_record};
use crate::scenario::{Run, item};
use crate::{background, fmus};

/// What a run gives beside its columns; the keys are those of `videg cosim --json`.
#[derive(Serialize)]
struct Summary<'a> {
    case: &'a str,
    description: &'a str,
    until: f64,
    step: f64,
    window: [f64; 2],
    #[serde(flatten)]
    mechanics: MechanicsSummary,
    circuit: &'a str,
    #[serde(flatten)]
    powers: &'a Powers,
    #[serde(flatten)]
    energies: &'a CircuitSummary,
    coupling: CouplingSummary,
    #[serde(skip_serializing_if = "Option::is_none")]
    balance: Option<EnergyBalance>,
    comparison: &'a [LabelledCircuit],
    warnings: &'a [String],
}

/// Runs harvester and circuit: columns and units by name, and the summary as JSON. Without the FMU of the circuit the embedded solver is used.
#[pyfunction]
#[allow(clippy::too_many_arguments)] // the package names them
pub fn cosim<'py>(
    py: Python<'py>,
    harvester: PathBuf,
    circuit: Option<PathBuf>,
    run: Run,
    record: Vec<String>,
    sample: Option<f64>,
    coupling: (String, Option<f64>),
    progress: Option<Bound<'py, PyAny>>,
) -> PyResult<(Bound<'py, PyDict>, Bound<'py, PyDict>, String)> {
    let scenario = run.resolve().map_err(error)?;
    let method: Method = item("master", &coupling.0)?;
    let coupling = Coupling { method, tolerance: coupling.1 };
    let sample = sample.map_or(Sample::Overview, Sample::Every);
    let series = SeriesOptions { format: SeriesFormat::default(), sample, columns: record };
    let (results, columns) = background::run(py, progress.as_ref(), |progress| {
        let run = || -> Result<_, Box<dyn std::error::Error>> {
            let harvester = fmus::open(&harvester)?;
            let circuit = circuit.as_deref().map(fmus::open).transpose()?;
            let solver = circuit.as_ref().map_or(CircuitSolver::Embedded, CircuitSolver::Fmu);
            let options = Options { harvester: &harvester, scenario: &scenario, solver, coupling };
            let cosimulation = Cosimulation::new(&options)?;
            let mut recorder = SeriesRecorder::in_memory(&series, &scenario, Some(&[]))?;
            let results = cosimulation.run(&mut recorder, progress)?;
            Ok((results, recorder.into_columns()))
        };
        run().map_err(error_of_record)
    })?;
    let Some((first, comparison)) = results.circuits.split_first() else {
        return Err(error("a co-simulation without a circuit"));
    };
    let summary = Summary {
        case: &scenario.name,
        description: &scenario.description,
        until: scenario.until,
        step: scenario.step,
        window: scenario.window,
        mechanics: results.mechanics,
        circuit: &first.label,
        powers: &first.powers,
        energies: &first.summary,
        coupling: results.coupling,
        balance: results.balance,
        comparison,
        warnings: &results.warnings,
    };
    let summary = serde_json::to_string(&summary).map_err(error)?;
    let SeriesColumns { names, values } = columns;
    let (columns, units) = (PyDict::new(py), PyDict::new(py));
    let description = system_description().map_err(error)?;
    for (name, values) in names.into_iter().zip(values) {
        let unit = description.variable(&name).ok().and_then(|variable| variable.unit());
        units.set_item(&name, if name == "time" { "s" } else { unit.unwrap_or("1") })?;
        columns.set_item(name, PyArray1::from_vec(py, values))?;
    }
    Ok((columns, units, summary))
}
