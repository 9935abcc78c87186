//! The energy-harvesting circuit of Fig. 8(a): supply `U_in`, charging diode, membrane capacitances `C(t)`,
//! release element and load: a Zener or switch at `U_z` and a resistor `R`, or a storage at `U_out`. It knows no mechanics;
//! its input is two capacitances.
//!
//! - [`Circuit`] advances over linear ramps of the capacitances: exactly with ideal diodes, with error control with
//!   exponential ones.
//! - [`Ledger`] says where the energy and the charge went, and checks itself.
//! - [`formulas`] holds the closed forms of one cycle.
//! - [`names`] and [`Parameters`] are the place for names, units, defaults and bounds.
#![forbid(unsafe_code)]

mod circuit;
mod devices;
mod error;
mod exponential;
pub mod formulas;
mod ideal;
mod leakage;
mod leaking;
mod ledger;
mod network;
mod node_equations;
mod parameters;
mod quadrature;
mod release;
mod roots;
mod sample;
mod settings;
mod state;

pub use circuit::Circuit;
pub use error::{Error, Failure};
pub use ledger::Ledger;
pub use parameters::{DiodeParameters, Diodes, Parameters, Release, Solver, Topology, names};
pub use sample::CircuitSample;
pub use settings::{Choice, Quantity, Settings};
pub use state::State;
