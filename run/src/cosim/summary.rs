//! Results of a run. Field names are the keys of `--json`; units are SI.

use super::CircuitSample;
use crate::ngspice::Waveforms;
use serde::Serialize;

/// The mechanics: impacts and their gains by the paper's equations.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct MechanicsSummary {
    /// Impacts of the run.
    pub impacts: i32,
    /// Events computed in the run.
    pub events: i32,
    /// `<U>`, Eq. (15), over the averaging window, V/s.
    pub average_voltage_gain: f64,
    /// P, Eq. (14), over the averaging window, W.
    pub average_power_eq13: f64,
    /// Sum of `U_DE4` - `U_in` over the run, V.
    #[serde(skip)]
    pub voltage_gain: f64,
    /// Sum of W, Eq. (13), over the run, J.
    #[serde(skip)]
    pub energy_eq13: f64,
}

/// Energies and charges of a circuit over the run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CircuitSummary {
    /// Energies, J.
    pub energy: Energies,
    /// Charges, C.
    pub charge: Charges,
}

/// Energies over the run, J.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Energies {
    /// Drawn from the supply.
    pub supply: f64,
    /// Given to the load.
    pub load: f64,
    /// Burnt in the Zener diodes.
    pub zener: f64,
    /// Burnt in the charging diodes.
    pub diode: f64,
    /// Burnt by leakage through the films.
    pub leakage: f64,
    /// Change of the energy stored in the membranes.
    pub stored: f64,
    /// Energy from the mechanics: load + zener + diode + leakage + stored - supply.
    pub converted: f64,
    /// The same, summed independently as the work -1/2 U^2 dC.
    pub mechanical: f64,
    /// Net gain: load - supply.
    pub surplus: f64,
    /// Sum of W, Eq. (13).
    pub eq13: f64,
}

/// Charges over the run, C.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Charges {
    /// Drawn from the supply.
    pub supply: f64,
    /// Through the load.
    pub load: f64,
}

impl CircuitSummary {
    /// Sums up a circuit from its last sample; `energy_eq13` is the harvester's sum of W, J.
    pub fn new(sample: &CircuitSample, energy_eq13: f64) -> Self {
        let ledger = &sample.ledger;
        Self {
            energy: Energies {
                supply: ledger.supply,
                load: ledger.load,
                zener: ledger.zener,
                diode: ledger.diode,
                leakage: ledger.leakage,
                stored: ledger.stored,
                converted: ledger.converted(),
                mechanical: ledger.mechanical,
                surplus: ledger.surplus(),
                eq13: energy_eq13,
            },
            charge: Charges { supply: ledger.supply_charge, load: ledger.load_charge },
        }
    }
}

impl Waveforms {
    /// The run summed up as that of any other circuit; `energy_eq13` is the harvester's sum of W, J.
    pub fn summary(&self, energy_eq13: f64) -> CircuitSummary {
        CircuitSummary::new(&self.last(), energy_eq13)
    }
}
