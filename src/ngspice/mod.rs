//! The harvesting circuit in ngspice: an independent witness for the embedded solver.
//!
//! ```no_run
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # let harvester: &mut videg::cosim::HarvesterFmu = todo!();
//! use videg::ngspice::{CapacitanceTable, Elements, Ngspice, Run, Waveforms};
//!
//! let table = CapacitanceTable::from_harvester(harvester, 10.0, 1e-4)?;    // C(t), linear between its rows
//! let parameters = videg_circuit::Parameters::default();
//! let embedded = Waveforms::embedded(&parameters, &table)?;
//! let elements = Elements::new(&parameters, table.growth())?;
//! let ngspice = Ngspice::find(None)?.simulate(&elements, &table, &Run::new(table.until(), table.growth()))?;
//! assert!((ngspice.ledger().load / embedded.ledger().load - 1.0).abs() < 1e-3);
//! # Ok(())
//! # }
//! ```
//!
//! - [`CapacitanceTable`] is what both solvers get;
//! - [`Elements`] is the circuit; [`Elements::netlist`] renders it from the templates in `ngspice_netlists`, with C(t)
//!   from a table or from a program that has loaded ngspice ([`CapacitanceSource`]). Numbers are the only thing that
//!   can be put into a template, so that no text of a user ever gets into a netlist;
//! - [`Ngspice`] finds the program and runs a [`Netlist`];
//! - [`RawReader`] reads the result, [`Books`] sums up energies and charges point by point, also those of a program that
//!   gets the points from the library;
//! - [`live`] runs ngspice's shared library step by step, as the partner of a co-simulation;
//! - [`Check`] holds ngspice's own capacitor against closed forms;
//! - [`Waveforms`] is what comes out, of either solver.

mod analytic;
mod books;
mod capacitance;
mod circuit;
mod drain;
mod error;
pub mod live;
mod raw;
mod reading;
mod run;
mod runner;
mod template;
mod waveforms;

pub use analytic::{Check, Deviation};
pub use books::{Books, Instant};
pub use capacitance::{CapacitanceTable, PICO};
pub use circuit::{Branch, Elements, Start};
pub use error::{NgspiceError, Said};
pub use raw::{RawError, RawReader};
pub use run::{CapacitanceSource, Run};
pub use runner::{Finished, Ngspice, Outcome};
pub use template::{FileName, Netlist};
pub use waveforms::Waveforms;
