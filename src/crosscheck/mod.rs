//! Crosscheck: what the paper and its closed forms say, the embedded solver and ngspice, on one C(t).
//!
//! - [`Case`] is a run of the mechanics: one [`CapacitanceTable`](crate::ngspice::CapacitanceTable) that every solver
//!   gets, and the impacts;
//! - [`Bench`] runs a circuit in one [`Solver`];
//! - [`checks`] holds the solvers against each other and against the closed forms: a [`Check`] says separately whether
//!   the solvers [agree](Agreement) and whether a [claim](Claim) holds. A refuted claim is a finding, no failure;
//! - [`Stop`] is a run of ngspice that ended too early: what was found until then stands, and [`common`] and [`limited`] say how
//!   far that is;
//! - [`conclusion`] says it in words;
//! - [`Sweep`] follows the net gain over load and voltage of release;
//! - [`export`] writes it all for somebody who has ngspice and nothing else.

mod bench;
mod case;
mod check;
mod claims;
mod compare;
mod conclude;
pub mod export;
mod peaks;
mod stop;
mod sweep;

pub(crate) use bench::Task;
pub use bench::{Bench, Progress, Solver};
pub use case::{Case, Impact};
pub use check::{Agreement, Check, Claim, Values};
pub use claims::{Findings, checks, pulse_checks};
pub use compare::{Compared, comparison_checks};
pub use conclude::conclusion;
pub use peaks::Pulses;
pub use stop::{Repeat, Stop, common, limited};
pub use sweep::{Curve, Point, Sweep};
