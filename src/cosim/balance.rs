//! Where the energy of the whole system went: harvester and first circuit, over the whole run.

use serde::Serialize;
use videg_circuit::Ledger;

/// Energies of the harvester, J, from its outputs `energy.*`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct MechanicalEnergies {
    /// Kinetic energy of the ball.
    pub kinetic: f64,
    /// Kinetic energy of the cylinder.
    pub cylinder_kinetic: f64,
    /// What the membranes can give back.
    pub elastic: f64,
    /// Lost in the membranes so far.
    pub impact_loss: f64,
    /// Work of excitation and external force on the cylinder so far.
    pub excitation: f64,
    /// Work of the walls on the ball so far.
    pub wall: f64,
}

impl MechanicalEnergies {
    /// Names of the variables, in the order of the fields.
    pub const NAMES: [&'static str; 6] = [
        "energy.kinetic",
        "energy.cylinderKinetic",
        "energy.elastic",
        "energy.impactLoss",
        "energy.excitation",
        "energy.wall",
    ];

    /// From the values of the variables.
    pub(super) fn new(values: [f64; Self::NAMES.len()]) -> Self {
        let [kinetic, cylinder_kinetic, elastic, impact_loss, excitation, wall] = values;
        Self { kinetic, cylinder_kinetic, elastic, impact_loss, excitation, wall }
    }
}

/// The energy balance of the system over the whole run. Field names are the keys of `--json`; J.
///
/// It closes only with `contact.electrostaticFeedback`: otherwise the circuit takes from the mechanics what nobody gives.
/// With `contact.reaction` the walls hand on what the excitation gave, excitation = change of the cylinder's kinetic energy
/// + wall; without it they give the ball energy that the cylinder does not lose.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct EnergyBalance {
    /// Work of excitation and external force on the cylinder.
    pub excitation: f64,
    /// Work of the walls on the ball.
    pub wall: f64,
    /// Change of the kinetic energy of the ball.
    pub kinetic: f64,
    /// Change of the kinetic energy of the cylinder.
    pub cylinder_kinetic: f64,
    /// Change of what the membranes can give back mechanically.
    pub elastic: f64,
    /// Lost in the membranes.
    pub impact_loss: f64,
    /// Into load, Zener, diodes and the field of the membranes, less what the supply gave.
    pub converted: f64,
    /// What the walls gave and is nowhere: wall - kinetic - elastic - impact loss - converted.
    pub residual: f64,
    /// The same over the energy that went through: lost in the membranes, and from the supply.
    pub relative_residual: f64,
}

impl EnergyBalance {
    /// The balance between `start` and `end` with a circuit that books `ledger`.
    pub(super) fn new(start: &MechanicalEnergies, end: &MechanicalEnergies, ledger: &Ledger) -> Self {
        let change = |energy: fn(&MechanicalEnergies) -> f64| energy(end) - energy(start);
        let excitation = change(|e| e.excitation);
        let wall = change(|e| e.wall);
        let kinetic = change(|e| e.kinetic);
        let cylinder_kinetic = change(|e| e.cylinder_kinetic);
        let elastic = change(|e| e.elastic);
        let impact_loss = change(|e| e.impact_loss);
        let converted = ledger.converted();
        let residual = wall - (kinetic + elastic + impact_loss + converted);
        let through = impact_loss.abs() + ledger.supply.abs();
        let relative_residual = if through > 0.0 { residual.abs() / through } else { 0.0 };
        Self {
            excitation,
            wall,
            kinetic,
            cylinder_kinetic,
            elastic,
            impact_loss,
            converted,
            residual,
            relative_residual,
        }
    }
}
