//! The outputs of a circuit; they are the same for every solver.

use crate::{Circuit, Ledger};

/// Outputs of a circuit at one communication point.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct CircuitSample {
    /// Voltages of the membranes, left and right, V.
    pub voltage: [f64; 2],
    /// Voltage across the load, V.
    pub load_voltage: f64,
    /// Current through the load, A.
    pub load_current: f64,
    /// Current from the supply, A.
    pub supply_current: f64,
    /// Energies and charges so far.
    pub ledger: Ledger,
}

impl CircuitSample {
    /// Names of [`CircuitSample::columns`], as the FMU `HarvestingCircuit` has them.
    pub const NAMES: [&'static str; 14] = [
        "left.voltage",
        "right.voltage",
        "load.voltage",
        "load.current",
        "supply.current",
        "supply.energy",
        "load.energy",
        "zener.energy",
        "diode.energy",
        "stored.energy",
        "mechanical.energy",
        "supply.charge",
        "load.charge",
        "leakage.energy",
    ];

    /// The values as a row of a time series.
    pub fn columns(&self) -> [f64; Self::NAMES.len()] {
        let mut sample = *self;
        sample.places().map(|place| *place)
    }

    /// The sample of which these are the [`columns`](Self::columns).
    pub fn from_columns(row: [f64; Self::NAMES.len()]) -> Self {
        let mut sample = Self::default();
        sample.places().into_iter().zip(row).for_each(|(place, value)| *place = value);
        sample
    }

    /// Where the values are that have these [`NAMES`](Self::NAMES).
    fn places(&mut self) -> [&mut f64; Self::NAMES.len()] {
        let Self { voltage: [left, right], load_voltage: u, load_current: i, supply_current: i_in, ledger } = self;
        let Ledger { supply, load, zener, diode, leakage, stored, mechanical, supply_charge: q_in, load_charge: q_out } =
            ledger;
        [left, right, u, i, i_in, supply, load, zener, diode, stored, mechanical, q_in, q_out, leakage]
    }
}

impl From<&Circuit> for CircuitSample {
    fn from(circuit: &Circuit) -> Self {
        Self {
            voltage: circuit.voltage(),
            load_voltage: circuit.load_voltage(),
            load_current: circuit.load_current(),
            supply_current: circuit.supply_current(),
            ledger: circuit.ledger(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_of_numbers_makes_the_sample_that_made_it() {
        let mut row = [0.0; CircuitSample::NAMES.len()];
        row.iter_mut().enumerate().for_each(|(k, value)| *value = k as f64);
        let sample = CircuitSample::from_columns(row);
        assert_eq!(sample.columns(), row);
        let CircuitSample { voltage, load_current, ledger, .. } = sample;
        assert_eq!([voltage[1], load_current, ledger.stored, ledger.leakage], [1.0, 3.0, 9.0, 13.0]);
    }
}
