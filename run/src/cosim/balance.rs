//! Energy balance of harvester and first circuit over a run.

use serde::Serialize;
use videg_circuit::Ledger;

/// Variables with the energies of the harvester, J: kinetic energies of ball and cylinder, elastic energy of the membranes,
/// energy lost in them so far, work of excitation and external force on the cylinder so far, work of the walls on the ball
/// so far, energy lost by friction and work of gravity on the ball so far, energy in the suspension, energy lost in its damper so
/// far, energy lost in viscous films so far.
pub(super) const ENERGIES: [&str; 11] = [
    "energy.kinetic",
    "energy.cylinderKinetic",
    "energy.elastic",
    "energy.impactLoss",
    "energy.excitation",
    "energy.wall",
    "energy.friction",
    "energy.gravity",
    "energy.suspension",
    "energy.damping",
    "energy.viscous",
];

/// The energy balance of the system over the run, J. Field names are the keys of `--json`.
///
/// It closes only with `contact.electrostaticFeedback`: without it the circuit takes energy that the mechanics does not lose.
/// With `contact.reaction`, excitation = change of the cylinder's kinetic energy + suspension + damping + wall; without it the
/// walls give the ball energy that the cylinder does not lose.
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
    /// Change of the elastic energy of the membranes.
    pub elastic: f64,
    /// Lost in the membranes.
    pub impact_loss: f64,
    /// Lost in viscous films.
    pub viscous: f64,
    /// Lost by friction between ball and cylinder.
    pub friction: f64,
    /// Work of gravity on the ball.
    pub gravity: f64,
    /// Change of the energy in the cylinder's suspension.
    pub suspension: f64,
    /// Lost in its damper.
    pub damping: f64,
    /// Energy into load, Zener, diodes and the field of the membranes, minus that from the supply.
    pub converted: f64,
    /// wall + gravity - kinetic - elastic - impact loss - viscous - friction - converted.
    pub residual: f64,
    /// The residual over the sum of impact loss, viscous loss, friction and supply.
    pub relative_residual: f64,
}

impl EnergyBalance {
    /// The balance between `start` and `end`, values of [`ENERGIES`], with the `ledger` of a circuit.
    pub(super) fn new(start: [f64; ENERGIES.len()], end: [f64; ENERGIES.len()], ledger: &Ledger) -> Self {
        let mut change = end;
        change.iter_mut().zip(start).for_each(|(energy, start)| *energy -= start);
        let [
            kinetic,
            cylinder_kinetic,
            elastic,
            impact_loss,
            excitation,
            wall,
            friction,
            gravity,
            suspension,
            damping,
            viscous,
        ] = change;
        // A circuit FMU of a user may not tell where the energy went.
        let converted = Some(ledger.converted()).filter(|energy| !energy.is_nan()).unwrap_or(ledger.mechanical);
        let residual = wall + gravity - (kinetic + elastic + impact_loss + viscous + friction + converted);
        let supply = if ledger.supply.is_nan() { converted } else { ledger.supply };
        let through = impact_loss.abs() + viscous + friction + supply.abs();
        let relative_residual = if through > 0.0 { residual.abs() / through } else { 0.0 };
        Self {
            excitation,
            wall,
            kinetic,
            cylinder_kinetic,
            elastic,
            impact_loss,
            viscous,
            friction,
            gravity,
            suspension,
            damping,
            converted,
            residual,
            relative_residual,
        }
    }
}
