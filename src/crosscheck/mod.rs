//! Crosscheck: the closed forms of the paper, the embedded solver and ngspice, on one C(t).
//!
//! [`run`] gives a [`Crosscheck`]:
//! - [`MechanicalRun`] is a run of the mechanics: one [`CapacitanceTable`](crate::ngspice::CapacitanceTable) for every
//!   solver, and the impacts;
//! - the circuit runs in each [`Solver`];
//! - a [`QuantityCheck`] says separately whether the solvers [agree](Agreement) and whether a [claim](Claim) holds. A
//!   refuted claim is a finding, no failure;
//! - a [`Stop`] is a run of ngspice that ended too early: its results until then are valid;
//! - [`ReleaseSweep`] follows the net gain over load and voltage of release.
//!
//! [`files`] writes data and figures, [`export`] a folder that needs ngspice only.

mod capacitor;
mod check;
mod claims;
mod compare;
mod conclude;
mod error;
pub mod export;
pub(crate) mod figures;
pub mod files;
mod mechanics;
mod pulses;
mod run;
mod solver;
mod solvers;
mod stop;
mod sweep;

pub use check::{Agreement, Claim, QuantityCheck, Values};
pub use compare::ComparedCircuit;
pub use error::FileError;
pub use mechanics::MechanicalRun;
pub use pulses::Pulses;
pub use run::{Crosscheck, Options, run};
pub use solver::Solver;
pub use stop::{Repeat, Stop};
pub use sweep::{ReleaseSweep, SweepCurve, SweepPoint};
