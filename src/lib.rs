//! Vibro-impact dielectric elastomer generator: the harness around the FMUs `VibroImpactHarvester` and
//! `HarvestingCircuit`.
//!
//! - [`package`] puts the FMUs together; [`fmu_import`] loads them or any other FMU for FMI 2.0 co-simulation;
//! - [`scenario`] says what to run: a case of the paper, settings, duration;
//! - [`cosim`] couples the harvester FMU with a circuit and records what happens;
//! - [`ngspice`] runs the circuit in ngspice, to check the embedded solver;
//! - [`crosscheck`] holds both, and the closed forms of the paper, against each other;
//! - [`paper`] reproduces every table and figure of the paper;
//! - [`sweep`] runs the harvester, or any FMU, many times over its parameters;
//! - [`cli`] is the command-line tool.
//!
//! Beside it: [`videg_report`] draws figures and writes HTML reports, [`videg_system`] has temporary folders, files written
//! atomically and groups of processes.

#[cfg(doctest)]
mod book;
mod circuit_sample;
pub mod cli;
pub mod cosim;
pub mod crosscheck;
pub mod ngspice;
pub mod package;
pub mod paper;
pub mod progress;
pub mod scenario;
pub mod sweep;
pub(crate) mod threads;
