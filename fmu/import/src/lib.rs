//! Importer for FMI 2.0 co-simulation FMUs.
//!
//! An FMU is foreign input twice over: an archive and an XML file, which are read with bounds and without trust
//! ([`Archive`], [`ModelDescription`]), and a shared library, which can only be trusted ([`Fmu`], [`Instance`]) or run in
//! a process of its own ([`isolated`]). Looking at an FMU ([`Archive::description`]) neither unpacks nor loads anything.
//!
//! ```no_run
//! use fmu_import::{Fmu, Logging};
//!
//! # fn main() -> Result<(), fmu_import::FmiError> {
//! let fmu = Fmu::open("target/fmu/VibroImpactHarvester.fmu")?;
//! let capacitance = [fmu.description().variable("left.capacitance")?.value_reference];
//! let mut harvester = fmu.instantiate("harvester", Logging::default())?;
//! harvester.set_by_name("contact.law", "compliant")?;
//! harvester.setup_experiment(0.0, Some(100.0), None)?;
//! harvester.enter_initialization_mode()?;
//! harvester.exit_initialization_mode()?;
//! let mut value = [0.0];
//! for step in 0..1000 {
//!     harvester.do_step(f64::from(step) * 0.1, 0.1)?;
//!     harvester.get_real(&capacitance, &mut value)?;
//! }
//! harvester.terminate()?;
//! # Ok(())
//! # }
//! ```

mod access;
mod archive;
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
mod value;
mod xml;

#[cfg(test)]
mod fake;

pub use archive::{Archive, Limits};
pub use description::{
    BaseUnit, Causality, CoSimulation, DefaultExperiment, EnumerationItem, EnumerationType, Initial, Kind,
    ModelDescription, Unit, Variability, Variable,
};
pub use error::{FmiError, Result, ValueError};
pub use fmu::Fmu;
pub use instance::Instance;
pub use isolated::{Bounds, Isolation};
pub use library::{HOST_PLATFORM, LIBRARY_EXTENSION, library_extension};
pub use logging::{LogRecord, LogSink, Logging, Status};
pub use state::FmuState;
pub use suggest::nearest as nearest_name;
pub use value::Value;
