//! The dynamics of a case: what its motion is like for long, and how that changes over a parameter.
//!
//! [`Motion`] takes the motion once a period, [`Diagram`] does so over a parameter, [`Basins`] over the starts, [`exponent`] says how
//! fast neighbours part, and [`orbits`] finds periodic orbits and follows them. [`pictures`] and [`sheets`] show them.

mod basins;
mod branch_lines;
mod diagram;
mod error;
mod excitation;
mod lyapunov;
mod motion;
pub mod orbits;
pub mod pictures;
mod problem;
mod resolve;
pub mod sheets;

pub use basins::{Attractor, Basins};
pub use diagram::{Diagram, Periods, WAYS};
pub use error::DynamicsError;
pub use excitation::Files;
pub use lyapunov::exponent;
pub use motion::{Flash, Motion, periods};
pub use problem::{Problem, Varied};
