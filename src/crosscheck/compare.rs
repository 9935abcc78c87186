//! Other circuits on the same C(t): the paper's, an ideal switch, and a storage, which gains.

use serde::Serialize;
use videg_circuit::{Release, Settings, formulas};

use super::check::{Agreement, Claim, QuantityCheck, SAME_DIODES, Values};
use super::mechanics::MechanicalRun;
use super::solver::Solver;
use crate::cosim::{CircuitSummary, Energies};

/// A circuit by the embedded solver and by ngspice.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ComparedCircuit {
    /// Name of the circuit.
    pub label: String,
    /// The circuit.
    #[serde(skip)]
    pub settings: Settings,
    /// The embedded solver, with ngspice's diodes.
    pub embedded: CircuitSummary,
    /// ngspice in batch.
    pub ngspice: CircuitSummary,
    /// Sum of `(C_3 U_in - C_2 U_r) (U_r - U_in)`, less the energy to fill the membranes to `U_r` once, J.
    pub closed_form: f64,
    /// Scale of deviations of energies, J.
    #[serde(skip)]
    scale: f64,
}

impl ComparedCircuit {
    /// A circuit with the results of the solvers.
    pub fn new(
        label: String,
        mechanics: &MechanicalRun,
        settings: &Settings,
        embedded: CircuitSummary,
        ngspice: CircuitSummary,
    ) -> Self {
        let (supply, release) = (settings.circuit.supply_voltage, settings.circuit.release_voltage());
        let gain =
            mechanics.sum(settings.circuit.topology, |c2, c3| formulas::release_net_gain(supply, release, c2, c3));
        let fill = supply * mechanics.rest.iter().sum::<f64>() * (release - supply);
        let closed_form = if gain > 0.0 { gain - fill } else { 0.0 };
        let scale = mechanics.energy_scale(settings, ngspice.energy.supply, ngspice.energy.load);
        Self { label, settings: *settings, embedded, ngspice, closed_form, scale }
    }

    /// Load energy and surplus by both solvers, and the surplus of a storage against its closed form.
    pub fn checks(&self) -> [QuantityCheck; 2] {
        let load = self.check("load energy", |energy| energy.load);
        let mut surplus = self.check("surplus", |energy| energy.surplus);
        if self.settings.circuit.release == Release::Storage && self.closed_form > 0.0 {
            let says = "a storage gains (C3 U_in - C2 U_out)(U_out - U_in) less its first filling";
            let deviation = self.ngspice.energy.surplus / self.closed_form - 1.0;
            surplus.analytic = Some(self.closed_form);
            surplus.claim = Some(Claim::new(says, deviation, Claim::TOLERANCE));
        }
        [load, surplus]
    }

    fn check(&self, quantity: &str, value: fn(&Energies) -> f64) -> QuantityCheck {
        let (a, b) = (value(&self.embedded.energy), value(&self.ngspice.energy));
        let deviation = if a == b { 0.0 } else { (a - b).abs() / self.scale };
        let values = Values::by([(Solver::Exponential, a), (Solver::Batch, b)]);
        QuantityCheck {
            agreement: Some(Agreement::between(Solver::Exponential, Solver::Batch, deviation, SAME_DIODES)),
            ..QuantityCheck::new(format!("{}: {quantity}", self.label), "J", values)
        }
    }
}
