//! ngspice.

pub mod live;
