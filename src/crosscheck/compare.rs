//! Other circuits on the same C(t): the paper's, an ideal switch, and a storage, which gains.

use serde::Serialize;
use videg_circuit::{Release, Settings, formulas};

use super::peaks::node_capacitances;
use super::{Agreement, Case, Check, Claim, Solver, Values};
use crate::cosim::{CircuitSummary, Energies};

/// A circuit by the embedded solver and by ngspice.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Compared {
    /// What the circuit is.
    pub label: String,
    /// The circuit.
    #[serde(skip)]
    pub settings: Settings,
    /// The embedded solver, with ngspice's diodes.
    pub embedded: CircuitSummary,
    /// ngspice in batch.
    pub ngspice: CircuitSummary,
    /// Sum of `(C_3 U_in - C_2 U_r) (U_r - U_in)`, less what it takes to fill the membranes to `U_r` once, J.
    pub closed_form: f64,
    /// Scale of deviations of energies, J.
    #[serde(skip)]
    scale: f64,
}

impl Compared {
    /// A circuit with what the solvers found.
    pub fn new(
        label: String,
        case: &Case,
        settings: &Settings,
        embedded: CircuitSummary,
        ngspice: CircuitSummary,
    ) -> Self {
        let (supply, release) = (settings.circuit.supply_voltage, settings.circuit.release_voltage());
        let gain = case.impacts.iter().map(|impact| {
            let [c2, c3] = node_capacitances(case, settings.circuit.topology, impact);
            formulas::release_net_gain(supply, release, c2, c3)
        });
        let fill = supply * case.rest.iter().sum::<f64>() * (release - supply);
        let gain: f64 = gain.sum();
        let closed_form = if gain > 0.0 { gain - fill } else { 0.0 };
        let scale = case.energy_scale(settings, ngspice.energy.supply, ngspice.energy.load);
        Self { label, settings: *settings, embedded, ngspice, closed_form, scale }
    }
}

/// Tolerances as for the circuit asked for: the same diodes in two programs, and the claims.
const SOLVERS: f64 = 3e-4;
const CLAIM: f64 = 0.02;

/// Load energy and surplus of a circuit by both solvers, and the surplus of a storage against its closed form.
pub fn comparison_checks(circuit: &Compared) -> [Check; 2] {
    [load(circuit), surplus(circuit)]
}

fn row(circuit: &Compared, quantity: &str, value: fn(&Energies) -> f64) -> Check {
    let (a, b) = (value(&circuit.embedded.energy), value(&circuit.ngspice.energy));
    let deviation = if a == b { 0.0 } else { (a - b).abs() / circuit.scale };
    let between = format!("{} and {}", Solver::Exponential.name(), Solver::Batch.name());
    Check {
        name: format!("{}: {quantity}", circuit.label),
        unit: "J",
        analytic: None,
        values: Values { embedded_exponential: Some(a), ngspice_batch: Some(b), ..Values::default() },
        agreement: Some(Agreement::new(between, deviation, SOLVERS)),
        claim: None,
    }
}

fn load(circuit: &Compared) -> Check {
    row(circuit, "load energy", |energy| energy.load)
}

fn surplus(circuit: &Compared) -> Check {
    let mut check = row(circuit, "surplus", |energy| energy.surplus);
    if circuit.settings.circuit.release == Release::Storage && circuit.closed_form > 0.0 {
        check.analytic = Some(circuit.closed_form);
        let deviation = circuit.ngspice.energy.surplus / circuit.closed_form - 1.0;
        check.claim = Some(Claim::new(
            "a storage gains (C3 U_in - C2 U_out)(U_out - U_in) less its first filling",
            deviation,
            CLAIM,
        ));
    }
    check
}
