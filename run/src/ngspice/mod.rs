//! The harvesting circuit in ngspice: an independent witness for the embedded solver.
//!
//! ```no_run
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # let harvester: &mut videg_run::cosim::HarvesterFmu = todo!();
//! use videg_run::ngspice::{CapacitanceTable, Elements, Ngspice, Run, Waveforms};
//!
//! let table = CapacitanceTable::from_harvester(harvester, 10.0, 1e-4, &())?;    // C(t), linear between its rows
//! let parameters = videg_circuit::Parameters::default();
//! let embedded = Waveforms::embedded(&parameters, &table)?;
//! let elements = Elements::new(&parameters, table.growth())?;
//! let ngspice = Ngspice::find(None)?.simulate(&elements, &table, &Run::new(table.until(), table.growth()))?;
//! assert!((ngspice.ledger().load / embedded.ledger().load - 1.0).abs() < 1e-3);
//! # Ok(())
//! # }
//! ```
//!
//! - [`CapacitanceTable`] is C(t), the same for both solvers;
//! - [`Elements`] is the circuit, rendered from the templates in `ngspice_netlists`, with C(t) from a table or from a
//!   program that has loaded ngspice. Only numbers, names of files and other templates can be put into a template, so that no text
//!   of a user gets into such a netlist;
//! - [`Ngspice`] finds the program and runs it; [`RawReader`] reads the result, which is summed up point by point;
//! - [`UserNetlist`] is a circuit of the user;
//! - [`live`] runs ngspice's shared library step by step, as the partner of a co-simulation;
//! - [`CapacitorTest`] compares ngspice's own capacitor with closed forms;
//! - [`Waveforms`] is the result of either solver.

mod capacitance;
mod capacitor;
mod elements;
mod error;
mod ledger;
pub mod live;
mod netlist_cards;
mod raw;
mod result;
mod run;
mod runner;
mod template;
mod user_netlist;
mod waveforms;

pub use capacitance::CapacitanceTable;
pub(crate) use capacitance::PICO;
pub use capacitance::write_rows;
pub use capacitor::{CapacitorTest, Deviation};
pub use elements::{Elements, Role};
pub use error::{Complaints, NgspiceError};
pub use netlist_cards::NetlistError;
pub use raw::{RawError, RawReader};
pub use run::CapacitanceSource;
pub use run::Run;
pub use runner::{Ngspice, SolverRun};
pub use template::{NETLIST_FILE, Netlist, RAW_FILE, TABLE_FILE};
pub use user_netlist::UserNetlist;
pub use waveforms::Waveforms;
