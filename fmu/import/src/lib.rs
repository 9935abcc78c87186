//! Importer for co-simulation FMUs of FMI 2.0: opens the archive, reads the model description, loads the library, makes instances
//! and steps them.
//!
//! ```no_run
//! use fmu_import::{Fmu, Logging};
//!
//! # fn main() -> fmu_import::Result<()> {
//! let fmu = Fmu::open("BouncingBall.fmu")?;
//! let height = [fmu.description().variable("h")?.value_reference];
//! let mut ball = fmu.instantiate("ball", Logging::default())?;
//! ball.set_by_name("e", "0.7")?;
//! ball.setup_experiment(0.0, Some(3.0), None)?;
//! ball.enter_initialization_mode()?;
//! ball.exit_initialization_mode()?;
//! let mut value = [0.0];
//! for step in 0..300 {
//!     ball.do_step(f64::from(step) * 0.01, 0.01)?;
//!     ball.get_real(&height, &mut value)?;
//! }
//! # Ok(())
//! # }
//! ```
//!
//! - [`Archive`] and [`ModelDescription`] look at an FMU without unpacking or loading anything. They do not trust it: sizes, numbers
//!   and names are bounded ([`Limits`]), and no entry leaves its folder.
//! - [`Instance`] has the functions of the standard: values by reference or by name, derivatives, states, also as bytes. A call whose
//!   status is neither OK nor Warning is an error with the FMU's messages ([`FmiError`]).
//! - A loaded library runs with all rights of the process. [`Fmu::open_isolated`] gives each instance a process of its own with limits
//!   on time and memory: a crash, an endless loop or a leak is an error of the call. The program of an [`Isolation`] calls
//!   [`isolated::serve`] for its verb [`isolated::WORKER_VERB`].
//!
//! # Limits
//! - No model exchange, no FMI 3.0, no FMUs of source code alone.
//! - Steps are synchronous: `fmi2Pending` is an error. `fmi2CancelStep` is never called.
//! - An instance stays on its thread, as FMI 2.0 wants it; several instances may run on several threads.
//! - Of a message with printf arguments, the log shows the format; only `"%s"` alone is filled in.
//! - Isolation is no sandbox: an FMU may do what its user may. On Windows and macOS its memory is not bounded.

mod access;
mod archive;
mod component;
mod description;
mod error;
mod fmu;
mod instance;
pub mod isolated;
mod library;
mod loaded;
mod logging;
mod request;
mod slave;
mod state;
mod suggest;
mod unit;
mod value;
mod xml;

#[cfg(test)]
mod fake;

pub use archive::{Archive, Limits, check_name, check_names};
pub use description::{
    BaseUnit, Causality, CoSimulation, DefaultExperiment, EnumerationItem, EnumerationType, Initial, Kind,
    ModelDescription, Unit, Variability, Variable,
};
pub use error::{FmiError, Result, ValueError};
pub use fmu::Fmu;
pub use instance::Instance;
pub use isolated::{Bounds, Isolation};
pub use library::{FUNCTIONS_3, HOST_PLATFORM, LIBRARY_EXTENSION, library_extension};
pub use logging::{LogRecord, LogSink, Logging, Status};
pub use state::FmuState;
pub use suggest::nearest as nearest_name;
pub use unit::hint as unit_hint;
pub use value::Value;
