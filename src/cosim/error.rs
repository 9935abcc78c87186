//! Errors of a co-simulation.

use std::path::PathBuf;

use thiserror::Error;

use crate::ngspice::NgspiceError;

/// Error of the master or of one of its subsystems.
#[derive(Debug, Error)]
pub enum CosimError {
    /// An FMU refused something.
    #[error(transparent)]
    Fmi(#[from] fmu_import::FmiError),
    /// The embedded circuit refused something.
    #[error("circuit \"{label}\": {cause}")]
    Circuit {
        /// The circuit.
        label: String,
        /// Its error.
        cause: videg_circuit::Error,
    },
    /// ngspice refused something.
    #[error("circuit \"{label}\" in ngspice: {cause}")]
    Ngspice {
        /// The circuit.
        label: String,
        /// Its error.
        cause: Box<NgspiceError>,
    },
    /// A circuit cannot go back to an earlier state, which an adaptive step takes.
    #[error(
        "--adaptive takes circuits that can go back to an earlier state; \"{label}\" cannot (ngspice never can; allowed: embedded, fmu)"
    )]
    NoRollback {
        /// The circuit.
        label: String,
    },
    /// An FMU was to go back to a state and none is saved.
    #[error("{instance}: no earlier state is saved to go back to")]
    NothingSaved {
        /// The instance.
        instance: String,
    },
    /// The options of the master contradict each other or are out of bounds.
    #[error("--adaptive {tolerance}: {bound}")]
    Tolerance {
        /// The tolerance given.
        tolerance: f64,
        /// What is allowed.
        bound: String,
    },
    /// An FMU refused a setting.
    #[error("{place}: {cause}")]
    Refused {
        /// Where the setting was said.
        place: String,
        /// Its error.
        cause: Box<fmu_import::FmiError>,
    },
    /// Neither the harvester nor the circuit has a variable of this name.
    #[error("{place}: neither the harvester nor the circuit has such a variable; {hint}")]
    UnknownVariable {
        /// Where the setting was said.
        place: String,
        /// The nearest name, or where to find all.
        hint: String,
    },
    /// A circuit cannot be put into a netlist.
    #[error(transparent)]
    Netlist(#[from] NgspiceError),
    /// An error about variables that the user set.
    #[error("{cause} ({places})")]
    Located {
        /// The error.
        cause: Box<CosimError>,
        /// Where the variables were set.
        places: String,
    },
    /// The observer of the run stopped it.
    #[error("stopped at {time} s")]
    Stopped {
        /// The time reached, s.
        time: f64,
    },
    /// A setting has a value that the embedded circuit cannot take.
    #[error("{place}: {name} = {value}: {bound}")]
    Setting {
        /// Where the setting was said.
        place: String,
        /// Name of the variable.
        name: String,
        /// Value given.
        value: String,
        /// What is allowed.
        bound: String,
    },
    /// A file could not be written.
    #[error("cannot write {}: {cause}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// What the system said.
        cause: std::io::Error,
    },
}

impl From<CosimError> for NgspiceError {
    fn from(error: CosimError) -> Self {
        match error {
            CosimError::Ngspice { cause, .. } => *cause,
            other => Self::Harvester(Box::new(other)),
        }
    }
}
