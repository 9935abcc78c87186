#![doc = include_str!("../README.md")]
//!
//! # Reference
//! A model implements [`Slave`], describes its variables in one table of [`Variable`]s, and names itself in [`export_fmu!`]. The table is
//! the only place where a variable is described: Get and Set, the checks of values, start values, the GUID and `modelDescription.xml` all
//! follow from it. With the feature `model-description`, `model_description::<Lag>(Standard::Fmi2)` gives the text of
//! `modelDescription.xml`, and `Standard::Fmi3` that of FMI 3.0. The shared library of an FMU never needs the feature.
//!
//! ## What FMI 3.0 adds
//! - [`Slave::do_step_to_event`] stops a step at the events of the model ([`ModelInfo::stops_at_events`]): co-simulation has event
//!   mode and early return then. Importers may read continuous outputs within any step (`intermediateUpdate`).
//! - Clocks ([`Variable::output_clock`], [`Variable::input_clock`]) and variables that belong to them
//!   ([`Declaration::clocked_by`]); FMI 2.0 sees neither.
//! - Types: [`IntegerWidth`], single precision. Adjoint derivatives, from the same rows as directional ones. Terminals
//!   ([`ModelInfo::terminals`]).
//!
//! ## What the exporter sees to
//! - Call order: one table says which [`Function`] is legal in which [`CallState`].
//! - Calls that the standard forbids, but importers make and no harm comes of, work and return `fmi2OK`; the category
//!   `logTolerated` tells of them. `fmi2Warning` is the model's, for what a host should stop and look at.
//! - A Set is all or nothing: type, causality, variability, bounds and finiteness of every value are checked before
//!   the first is written. A refused value is an error that names variable, value and bound.
//! - Any `fmi2Error` leaves the instance in the error state, from which only restoring an FMU state or
//!   `fmi2Reset` leads back, as the standard has it. `fmi3Error` terminates it.
//! - FMU states are clones of the model, together with call state and time; the state saved or restored last is cloned
//!   when the instance is about to change or another state is saved. The importer holds tokens, not pointers; a token
//!   that is foreign, stale or freed twice is refused. A state belongs to the instance that gave it; serialise it to
//!   carry it to another.
//! - Calls from inside a callback are refused. Calls from a second thread, which FMI 2.0 forbids, are usually refused;
//!   nothing guarantees it, and two that begin together are undefined behaviour.
//! - Panics become `fmi2Error` ([`ffi`] says what that means for stderr).
//! - Messages go to the importer's logger only. Events, tolerated calls, warnings and discarded steps are reported while logging is on
//!   for their category; errors and fatal errors always, since `loggingOn` is about debug logging.
//!
//! ## Not offered
//! Asynchronous steps. Their functions exist, as importers demand, and return `fmi2Error`. So does
//! `fmi2GetDirectionalDerivative` unless the model offers it. Of FMI 3.0: arrays and structural parameters, binary variables, clocks
//! whose interval changes, setting values within a step, dependencies of single elements, scheduled execution.
#![allow(non_upper_case_globals)] // The constants of the ABI, in patterns, are spelled as in the standard.

mod access;
mod added;
mod call_state;
mod check;
#[cfg(feature = "model-description")]
#[doc(hidden)]
pub mod describe;
mod error;
pub mod ffi;
mod fingerprint;
pub mod fmi3;
mod fnv;
mod guid;
mod info;
mod instance;
mod logger;
mod macros;
#[cfg(feature = "model-description")]
mod model_description;
mod panics;
mod parameters;
#[cfg(feature = "model-description")]
mod references;
mod resource;
mod serialize;
mod slave;
mod standard;
#[cfg(feature = "model-description")]
mod units;
mod variable;

pub use call_state::{CallState, Function, Interface, Legality};
pub use check::TableError;
pub use error::{Severity, SlaveError};
pub use fmu_abi as abi;
#[cfg(feature = "derive")]
pub use fmu_derive::{Choice, Variables};
pub use guid::Guid;
pub use info::{DefaultExperiment, ModelInfo, Terminal};
pub use logger::{LogCategory, Logger};
#[cfg(feature = "model-description")]
pub use model_description::{DescriptionError, model_description, terminals_and_icons};
#[cfg(feature = "model-description")]
pub use references::changed_references;
pub use serialize::{StateError, StateReader, StateWriter};
pub use slave::{EventOutcome, Experiment, Slave, Stop};
pub use standard::Standard;
pub use variable::{
    BooleanSpec, Causality, Choice, ClockInterval, ClockSpec, Declaration, EnumerationSpec, EnumerationType,
    GetDerivative, Getter, Initial, IntegerSpec, IntegerWidth, Kind, PartialDerivative, ReadOnly, RealSpec,
    SetDerivative, Settable, Setter, StringSpec, Variability, Variable, concat, value_reference,
};
