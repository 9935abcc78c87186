//! What can go wrong: the errors that a model returns, and the errors of the C interface around it.

use crate::call_state::CallState;
use fmu_abi::{fmi2Discard, fmi2Error, fmi2Fatal, fmi2Status};

/// How far an error of a slave reaches.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Severity {
    /// The step was not taken, or only in part; the master may restore a state and try a smaller one.
    /// Meaningful for [`Slave::do_step`](crate::Slave::do_step) alone; elsewhere it counts as [`Severity::Error`].
    Discard,
    /// This instance cannot go on; restoring a state or a reset helps.
    Error,
    /// This instance is beyond repair; it can only be freed.
    Fatal,
}

/// An error that a slave returns from one of its functions. The message goes to the logger of the importer:
/// name the thing, its value and the bound.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{message}")]
pub struct SlaveError {
    severity: Severity,
    message: String,
    last_successful_time: Option<f64>,
    wants_to_terminate: bool,
}

impl SlaveError {
    /// The instance cannot go on ([`Severity::Error`]).
    pub fn error(message: impl Into<String>) -> Self {
        Self::new(Severity::Error, message.into())
    }

    /// The instance is beyond repair ([`Severity::Fatal`]).
    pub fn fatal(message: impl Into<String>) -> Self {
        Self::new(Severity::Fatal, message.into())
    }

    /// The step succeeded only up to `last_successful_time`, s ([`Severity::Discard`]).
    pub fn discard(last_successful_time: f64, message: impl Into<String>) -> Self {
        Self { last_successful_time: Some(last_successful_time), ..Self::new(Severity::Discard, message.into()) }
    }

    /// The slave wants the simulation to end at `time`, s: a discarded step whose `fmi2Terminated` is true.
    pub fn terminate(time: f64, message: impl Into<String>) -> Self {
        Self { wants_to_terminate: true, ..Self::discard(time, message) }
    }

    const fn new(severity: Severity, message: String) -> Self {
        Self { severity, message, last_successful_time: None, wants_to_terminate: false }
    }

    /// How far the error reaches.
    pub const fn severity(&self) -> Severity {
        self.severity
    }

    /// The time that a discarded step reached, s.
    pub const fn last_successful_time(&self) -> Option<f64> {
        self.last_successful_time
    }

    /// Whether the slave asks to end the simulation.
    pub const fn wants_to_terminate(&self) -> bool {
        self.wants_to_terminate
    }
}

/// Why a call of the C interface is refused. Every message names what, where, found and allowed.
#[derive(Debug, thiserror::Error)]
pub(crate) enum CallError {
    #[error("illegal in state {state}; legal in: {legal}")]
    IllegalState { state: CallState, legal: String },
    #[error("argument {0} is NULL")]
    NullArgument(&'static str),
    #[error("argument {argument} is not an array of {count} values: {reason}")]
    BadArray { argument: &'static str, count: usize, reason: &'static str },
    #[error("no variable has value reference {reference}; allowed: 0 to {last}")]
    UnknownReference { reference: u32, last: usize },
    #[error("variable {name} (value reference {reference}) is of type {actual}, not {wanted}")]
    WrongType { name: &'static str, reference: u32, actual: &'static str, wanted: &'static str },
    #[error("variable {name} ({variability} {causality}) cannot be set in state {state}")]
    NotSettable { name: &'static str, causality: &'static str, variability: &'static str, state: CallState },
    #[error("variable {name} = {value}: {bound}")]
    BadValue { name: &'static str, value: String, bound: String },
    #[error("{argument} = {value}: {bound}")]
    BadArgument { argument: &'static str, value: String, bound: String },
    #[error("currentCommunicationPoint = {found} s, but the slave is at {expected} s (tolerance {tolerance:e} s)")]
    WrongTime { found: f64, expected: f64, tolerance: f64 },
    #[error("the step from {from} s to {to} s ends behind the stop time {stop} s (tolerance {tolerance:e} s)")]
    BehindStopTime { from: f64, to: f64, stop: f64, tolerance: f64 },
    #[error("{0:#x} is no FMU state of this instance: never given out, already freed, or of another instance")]
    UnknownFmuState(usize),
    #[error("the serialised state is refused: {0}")]
    BadSerializedState(#[from] crate::serialize::StateError),
    #[error(
        "variable {name} ({type_name}, {variability} {causality}) is no {role} of directional derivatives in state {state}"
    )]
    NoDerivative {
        name: &'static str,
        type_name: &'static str,
        causality: &'static str,
        variability: &'static str,
        role: &'static str,
        state: CallState,
    },
    #[error(
        "variable {name} ({type_name}) was not among the requiredIntermediateVariables of this instance: it cannot be read within a step"
    )]
    NotIntermediate { name: &'static str, type_name: &'static str },
    #[error("not supported by this FMU: {0}")]
    Unsupported(&'static str),
    #[error("status {0} is not available here")]
    NoStatus(i32),
    #[error("{0}")]
    Slave(SlaveError),
    #[error("internal error, the model panicked: {0}")]
    Panic(String),
}

impl CallError {
    /// The status that the C function returns.
    pub(crate) fn status(&self) -> fmi2Status {
        match self {
            Self::NoStatus(_) => fmi2Discard,
            Self::Slave(e) => match e.severity {
                Severity::Discard => fmi2Discard,
                Severity::Error => fmi2Error,
                Severity::Fatal => fmi2Fatal,
            },
            _ => fmi2Error,
        }
    }
}

impl From<SlaveError> for CallError {
    /// Only a step can be discarded; from any other function of the slave a discard is an error.
    fn from(mut e: SlaveError) -> Self {
        if e.severity == Severity::Discard {
            e.severity = Severity::Error;
        }
        Self::Slave(e)
    }
}
