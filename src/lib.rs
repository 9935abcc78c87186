//! Vibro-impact dielectric elastomer generator: the harness around the FMUs `VibroImpactHarvester` and
//! `HarvestingCircuit`.
//!
//! A program couples harvester and circuit like this:
//!
//! ```
//! use fmu_import::Fmu;
//! use videg::scenario::{Request, Setting};
//! use videg::{cosim, package};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let fmus = package::build_all(&package::Options::default())?;
//! let harvester = Fmu::open(&fmus[0])?;
//! let settings = vec![Setting::new("load.resistance", "1e10")];
//! let request = Request { case: Some("fig14".to_owned()), settings, until: Some(2.0), ..Request::default() };
//! let results = cosim::run(&cosim::Options::new(&harvester, &request.resolve()?), &())?;
//! for circuit in &results.circuits {
//!     println!("{}: {:.3} mJ", circuit.label, 1e3 * circuit.summary.energy.surplus);
//! }
//! # assert!(results.mechanics.impacts > 0 && results.circuits.len() == 4);
//! # Ok(())
//! # }
//! ```
//!
//! - [`package`] puts the FMUs together; [`fmu_import`] loads them or any other FMU for FMI 2.0 co-simulation;
//! - [`scenario`] describes a run: a published case, settings, duration;
//! - [`cosim`] couples the harvester FMU with a circuit; [`simulate`] runs the harvester alone;
//! - [`coupled`] does both at once in one process, for many runs;
//! - [`export`] writes C(t) for other programs;
//! - [`ngspice`] runs the circuit in ngspice, to check the embedded solver;
//! - [`crosscheck`] compares both with each other and with the closed forms of the paper;
//! - [`paper`] reproduces the tables and figures of the paper;
//! - [`dynamics`] finds what the motion of a case is like for long: bifurcations, periodic orbits, basins;
//! - [`sweep`] runs the harvester, or any FMU, many times over its parameters;
//! - [`map`] maps the net power, or another result, over two variables, with its best point and the limits of the film;
//! - [`cli`] is the command-line tool.
//!
//! Beside it: [`videg_report`] draws figures and writes HTML reports, [`videg_input`] reads files that a user gives, [`videg_system`] has
//! temporary folders, files written atomically and groups of processes.

#![allow(
    clippy::missing_errors_doc,
    reason = "the messages of the error types say it; a section says what is beyond them"
)]

mod artefact;
#[cfg(doctest)]
mod book;
pub mod cli;
pub mod crosscheck;
mod differences;
pub mod dynamics;
pub mod explorer;
pub mod export;
pub mod map;
pub mod package;
pub mod paper;
pub mod statistics;
pub mod sweep;
pub(crate) mod threads;

pub use videg_coupled as coupled;
pub use videg_run::{cosim, ngspice, progress, scenario, simulate};
