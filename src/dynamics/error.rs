//! Errors of a look at the dynamics.

use videg_model::ModelError;
use videg_report::ReportError;

use crate::sweep::SweepError;

/// Why the dynamics of a case could not be looked at.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the message of each variant names its fields")]
pub enum DynamicsError {
    #[error(transparent)]
    Model(#[from] ModelError),
    #[error(transparent)]
    Sweep(#[from] SweepError),
    #[error(transparent)]
    Report(#[from] ReportError),
    /// Something that is set is no parameter of the model.
    #[error("{name}: the dynamics are those of constant parameters of the model, and this is none of them")]
    NoParameter { name: String },
    /// A file cannot be read.
    #[error("{name} = {file:?}: {reason}")]
    File { name: &'static str, file: String, reason: String },
    #[error(
        "excitation.fileRepeat = false: dynamics needs an excitation that repeats; with true the recording begins again \
         where it ends"
    )]
    RecordedOnce,
    #[error(
        "the recording begins at {first} s with excitation.fileOffset; dynamics needs it from 0 s on at the latest"
    )]
    RecordedLate { first: f64 },
    #[error(
        "the recording of {duration} s has {periods} periods of excitation.frequency = {frequency} Hz; dynamics needs a whole \
         number of them, or excitation.amplitude and excitation.acceleration = 0"
    )]
    Incommensurate { duration: f64, periods: f64, frequency: f64 },
    #[error("excitation.file: periodic orbits are followed under a harmonic excitation alone")]
    Recording,
    /// What varies has no numbers between its ends.
    #[error(
        "--vary {name}: dynamics follows one real parameter over a range, name=from:to:count with a count of at least 2"
    )]
    NoRange { name: String },
    #[error("--vary {name}: {count} values; at most {most} are followed")]
    TooMany { name: String, count: u64, most: u64 },
    /// The excitation does not repeat.
    #[error("{name} = {value}: dynamics needs an excitation that repeats; with noise no motion comes back")]
    NotPeriodic { name: &'static str, value: f64 },
    #[error("--vary {name}: an orbit does not depend on where a motion starts")]
    InitialState { name: &'static str },
    /// The film remembers more than the section shows.
    #[error(
        "{name} = {value}: the deflection that a viscous film keeps is part of its state, which orbits do not follow; 0 is a film \
         without"
    )]
    Viscous { name: &'static str, value: f64 },
    /// The observer wants no more.
    #[error("stopped")]
    Stopped,
}
