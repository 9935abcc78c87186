//! The energy that an element of a circuit takes.

use serde::Serialize;

use crate::ngspice::Role;

/// An element of a netlist after a run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ElementEnergy {
    /// Its name in the netlist.
    pub name: String,
    /// What it is for; none for a membrane.
    #[serde(skip)]
    pub role: Option<Role>,
    /// Energy that it took, J.
    pub energy: f64,
}
