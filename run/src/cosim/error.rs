//! Errors of a co-simulation.

use std::path::PathBuf;

use thiserror::Error;

use crate::ngspice::NgspiceError;

/// Error of the master or of one of its subsystems.
#[derive(Debug, Error)]
#[allow(missing_docs, reason = "the message of each variant names its fields")]
pub enum CosimError {
    #[error(transparent)]
    Fmi(#[from] fmu_import::FmiError),
    #[error("circuit \"{label}\": {cause}")]
    Circuit { label: String, cause: videg_circuit::Error },
    #[error("circuit \"{label}\" in ngspice: {cause}")]
    Ngspice { label: String, cause: Box<NgspiceError> },
    /// A circuit cannot go back to an earlier state, which an adaptive step takes.
    #[error(
        "--adaptive takes circuits that can go back to an earlier state; \"{label}\" cannot (ngspice never can; allowed: embedded, fmu)"
    )]
    NoRollback { label: String },
    #[error("{option} {name}: {reason}")]
    Element { option: String, name: String, reason: String },
    #[error("{place}: {reason}")]
    Mapping { place: String, reason: String },
    #[error("circuit \"{label}\": {variable} = {value}; allowed are finite numbers")]
    NotFinite { label: String, variable: String, value: f64 },
    #[error(transparent)]
    File(#[from] Box<crate::scenario::ScenarioError>),
    #[error("{names}: with --netlist the netlist has the values of the circuit")]
    CircuitSettings { names: String },
    #[error("{instance}: no earlier state is saved to go back to")]
    NothingSaved { instance: String },
    #[error("--adaptive {tolerance}: {bound}")]
    Tolerance { tolerance: f64, bound: String },
    #[error("{place}: {cause}")]
    Refused { place: String, cause: Box<fmu_import::FmiError> },
    #[error("{place}: neither the harvester nor the circuit has such a variable; {hint}")]
    UnknownVariable { place: String, hint: String },
    #[error(transparent)]
    Netlist(#[from] NgspiceError),
    /// An error about variables that the user set.
    #[error("{cause} ({places})")]
    Located { cause: Box<CosimError>, places: String },
    #[error("stopped at {time} s")]
    Stopped { time: f64 },
    #[error(
        "--sample {sample} s: must lie above 0 s and not above {until} s, the end of the run; step: each communication point"
    )]
    Sample { sample: f64, until: f64 },
    #[error("{place}: {name} = {value}: {bound}")]
    Setting { place: String, name: String, value: String, bound: String },
    #[error("cannot write {}: {cause}", path.display())]
    Write { path: PathBuf, cause: std::io::Error },
}

impl From<CosimError> for NgspiceError {
    fn from(error: CosimError) -> Self {
        match error {
            CosimError::Ngspice { cause, .. } => *cause,
            other => Self::Harvester(Box::new(other)),
        }
    }
}
