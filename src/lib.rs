//! Vibro-impact dielectric elastomer generator: the harness around the FMUs `VibroImpactHarvester` and
//! `HarvestingCircuit`.
//!
//! - [`package`] puts the FMUs together, [`fmi`] loads them or any other FMU for FMI 2.0 co-simulation;
//! - [`scenario`] says what to run: a case of the paper, settings, duration;
//! - [`cosim`] couples the harvester FMU with a circuit and records what happens;
//! - [`ngspice`] runs the circuit in ngspice, to check the embedded solver;
//! - [`crosscheck`] holds both, and the closed forms of the paper, against each other;
//! - [`paper`] reproduces every table and figure of the paper;
//! - [`report`] draws figures and writes the HTML report;
//! - [`sweep`] runs the harvester, or any FMU, many times over its parameters;
//! - [`temporary`] makes folders that are gone when the process ends;
//! - [`whole`] writes files that appear whole or not at all;
//! - [`cli`] is the command-line tool.
//!
//! Without the feature `tool`, which is on by default, there are [`fmi`], [`scenario`], [`cosim`], [`ngspice`] and
//! [`sweep`] alone.

#[cfg(doctest)]
mod book;
pub(crate) mod children;
mod circuit_sample;
#[cfg(feature = "tool")]
pub mod cli;
pub mod cosim;
#[cfg(feature = "tool")]
pub mod crosscheck;
pub mod fmi;
pub(crate) mod input;
pub mod ngspice;
#[cfg(feature = "tool")]
pub mod package;
#[cfg(feature = "tool")]
pub mod paper;
#[cfg(feature = "tool")]
pub mod report;
pub mod scenario;
pub mod sweep;
pub mod temporary;
pub(crate) mod threads;
pub mod whole;
