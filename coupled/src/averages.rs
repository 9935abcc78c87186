//! Averages over a window: of the mechanics, and of the circuit.

use serde::Serialize;
use videg_circuit::Ledger;
use videg_model::Totals;

/// Running sums of the harvester at one time.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Gains {
    /// Sum of `U_DE4` - `U_in` so far, V.
    pub voltage: f64,
    /// Sum of W, Eq. (13), so far, J.
    pub energy: f64,
    /// Impacts so far.
    pub impacts: i32,
}

/// Averages of the sums over a window.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Averages {
    /// `<U>`, Eq. (15), V/s.
    pub voltage_gain: f64,
    /// P, Eq. (14), W.
    pub power: f64,
    /// Impacts within the window.
    pub impacts: i32,
}

impl From<&Totals> for Gains {
    fn from(totals: &Totals) -> Self {
        let impacts = i32::try_from(totals.impacts).unwrap_or(i32::MAX);
        Self { voltage: totals.voltage_gain, energy: totals.energy, impacts }
    }
}

impl Averages {
    /// Averages over `window`, s, of a run from 0 s on, from the sums at its edges. An impact at the start of the run lies in
    /// a window that begins there.
    pub fn over([from, to]: [f64; 2], before: &Gains, after: &Gains) -> Self {
        let before = if from > 0.0 { *before } else { Gains::default() };
        Self {
            voltage_gain: (after.voltage - before.voltage) / (to - from),
            power: (after.energy - before.energy) / (to - from),
            impacts: after.impacts - before.impacts,
        }
    }
}

/// Mean powers of a circuit over the averaging window, W.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Powers {
    /// What a user gains: load - supply + the change of what the membranes store.
    pub net_power: f64,
    /// Into the load.
    pub load_power: f64,
    /// From the supply.
    pub supply_power: f64,
}

impl Powers {
    /// The powers over `window`, s, from the ledgers at its edges.
    pub fn over([from, to]: [f64; 2], before: &Ledger, after: &Ledger) -> Self {
        Self::of(&after.flows_since(before, to - from))
    }

    /// The powers of mean `flows`.
    pub fn of(flows: &Ledger) -> Self {
        let Ledger { load, supply, stored, .. } = *flows;
        Self { net_power: load - supply + stored, load_power: load, supply_power: supply }
    }
}
