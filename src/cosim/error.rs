//! What can go wrong in a co-simulation.

use std::path::PathBuf;

use thiserror::Error;

/// Error of the master or of one of its subsystems.
#[derive(Debug, Error)]
pub enum CosimError {
    /// An FMU refused something.
    #[error(transparent)]
    Fmi(#[from] crate::fmi::FmiError),
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
        cause: Box<crate::ngspice::NgspiceError>,
    },
    /// A setting names no variable of the embedded circuit, or has a value that it cannot take.
    #[error("{name} = {value}: {bound}")]
    Setting {
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
