//! Errors of the circuit: each names the thing, its value and the bound that it breaks.

use crate::parameters::names;

/// What can go wrong when a circuit is built, advanced or restored.
///
/// A circuit whose [`advance`](crate::Circuit::advance) returned an error is unchanged by that call.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A value is NaN or infinite.
    #[error("{name} = {value} {unit} is not a finite number")]
    NotFinite {
        /// Name of the quantity, as in [`names`](crate::names).
        name: &'static str,
        /// The value given.
        value: f64,
        /// SI unit of the value.
        unit: &'static str,
    },
    /// A value has to be above zero and is not.
    #[error("{name} = {value} {unit} is not above 0 {unit}")]
    NotPositive {
        /// Name of the quantity, as in [`names`](crate::names).
        name: &'static str,
        /// The value given.
        value: f64,
        /// SI unit of the value.
        unit: &'static str,
    },
    /// A value has to be zero or more and is not.
    #[error("{name} = {value} {unit} is below 0 {unit}")]
    Negative {
        /// Name of the quantity, as in [`names`](crate::names).
        name: &'static str,
        /// The value given.
        value: f64,
        /// SI unit of the value.
        unit: &'static str,
    },
    /// A parameter is NaN or out of its bounds.
    #[error("{name} = {value} {unit} is outside its bounds [{min}, {max}] {unit}")]
    Bounds {
        /// Name of the parameter, as in [`names`](crate::names).
        name: &'static str,
        /// The value given.
        value: f64,
        /// SI unit of the values.
        unit: &'static str,
        /// Smallest value allowed.
        min: f64,
        /// Largest value allowed.
        max: f64,
    },
    /// A leakage faster than any film's, but not 0, which means none.
    #[error("leakage.timeConstant = {time_constant} s is below {min} s; 0 means no leakage")]
    LeakageTooFast {
        /// The value given (s).
        time_constant: f64,
        /// Smallest value allowed but 0 (s).
        min: f64,
    },
    /// The release element would conduct all the time: the paper demands `U_in <= U_z` (Section 4.1).
    #[error("zener.voltage = {zener} V is below supply.voltage = {supply} V")]
    ZenerBelowSupply {
        /// `U_z` (V).
        zener: f64,
        /// `U_in` (V).
        supply: f64,
    },
    /// The charging and the release diode in series would conduct all the time, limited by nothing.
    #[error(
        "storage.voltage = {storage} V is below supply.voltage = {supply} V: the supply would feed the storage without bound"
    )]
    StorageBelowSupply {
        /// `U_out` (V).
        storage: f64,
        /// `U_in` (V).
        supply: f64,
    },
    /// Both membranes hang on one node, so that they cannot start at different voltages.
    #[error("right.voltage = {right} V differs from left.voltage = {left} V on the shared node")]
    VoltagesDiffer {
        /// Voltage asked for the left membrane (V).
        left: f64,
        /// Voltage asked for the right membrane (V).
        right: f64,
    },
    /// A mode flag of a state to be restored contradicts another one.
    #[error("mode of node {node} is contradictory: more than one of charging, holding and releasing is set")]
    ContradictoryMode {
        /// Index of the node: 0 left or shared, 1 right.
        node: usize,
    },
    /// A count of a state to be restored is one that no run reaches.
    #[error("{name} = {value} is above {bound}")]
    Count {
        /// What is counted.
        name: &'static str,
        /// The value given.
        value: u64,
        /// Largest value taken.
        bound: u64,
    },
    /// More switching instants in one step than a linear ramp can have.
    #[error("step of {step} s from time {time} s has more than {bound} switching instants")]
    TooManyEvents {
        /// Time at the start of the step (s).
        time: f64,
        /// Length of the step (s).
        step: f64,
        /// Largest number of switching instants in one step.
        bound: usize,
    },
    /// The integrator could not go on.
    #[error("integration stopped at time {time} s with an internal step of {step} s: {failure}")]
    Integration {
        /// Time reached (s).
        time: f64,
        /// Internal step tried there (s).
        step: f64,
        /// What failed.
        failure: Failure,
    },
}

impl Error {
    /// Names of the variables whose values the error is about.
    pub fn variables(&self) -> Vec<&'static str> {
        match self {
            Self::NotFinite { name, .. }
            | Self::NotPositive { name, .. }
            | Self::Negative { name, .. }
            | Self::Bounds { name, .. } => vec![name],
            Self::LeakageTooFast { .. } => vec![names::LEAKAGE_TIME_CONSTANT],
            Self::ZenerBelowSupply { .. } => vec![names::ZENER_VOLTAGE, names::SUPPLY_VOLTAGE],
            Self::StorageBelowSupply { .. } => vec![names::STORAGE_VOLTAGE, names::SUPPLY_VOLTAGE],
            _ => Vec::new(),
        }
    }
}

/// Why the integrator of the exponential diodes stopped.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Failure {
    /// The error estimate stays above the tolerance however short the step.
    #[error("the error estimate stays above solver.relativeTolerance")]
    ErrorEstimate,
    /// The node equations could not be solved however short the step.
    #[error("the node equations have no solution")]
    NodeEquations,
    /// `solver.maximumSteps` internal steps did not reach the end of the step.
    #[error("solver.maximumSteps = {0} internal steps did not suffice")]
    Steps(usize),
    /// Newton's method settles too rarely, and the searches in its place have used up their trial voltages.
    #[error("the node equations took more than {0} trial voltages")]
    Trials(usize),
}

/// A finite value, or an error that names it.
pub(crate) fn finite(name: &'static str, value: f64, unit: &'static str) -> Result<(), Error> {
    if value.is_finite() { Ok(()) } else { Err(Error::NotFinite { name, value, unit }) }
}

/// A finite value above zero, or an error that names it.
pub(crate) fn positive(name: &'static str, value: f64, unit: &'static str) -> Result<(), Error> {
    finite(name, value, unit)?;
    if value > 0.0 { Ok(()) } else { Err(Error::NotPositive { name, value, unit }) }
}

/// A finite value of zero or more, or an error that names it.
pub(crate) fn not_negative(name: &'static str, value: f64, unit: &'static str) -> Result<(), Error> {
    finite(name, value, unit)?;
    if value >= 0.0 { Ok(()) } else { Err(Error::Negative { name, value, unit }) }
}
