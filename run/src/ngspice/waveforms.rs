//! Results: the circuit at the times of a table, from ngspice or from the embedded solver.

use videg_circuit::{Circuit, CircuitSample, Ledger, Parameters};

use super::NgspiceError;
use super::capacitance::CapacitanceTable;

/// A circuit over a run.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Waveforms {
    /// Times, s: those of the table.
    pub time: Vec<f64>,
    /// The circuit at these times.
    pub samples: Vec<CircuitSample>,
    /// Internal time points, if the solver tells.
    pub points: Option<u64>,
}

impl Waveforms {
    /// Highest voltage across a membrane, V.
    pub fn highest_voltage(&self) -> f64 {
        self.samples.iter().flat_map(|sample| sample.voltage).fold(0.0, f64::max)
    }

    /// The embedded solver on `table`.
    ///
    /// # Errors
    /// What the solver says.
    pub fn embedded(parameters: &Parameters, table: &CapacitanceTable) -> Result<Self, NgspiceError> {
        let mut circuit = Circuit::new(*parameters, table.initial())?;
        let mut found = Self::with_capacity(table.len());
        let mut now = 0.0;
        for (time, capacitance) in table.rows() {
            circuit.advance(time - now, capacitance)?;
            now = time;
            found.push(time, CircuitSample::from(&circuit));
        }
        Ok(found)
    }

    pub(super) fn with_capacity(rows: usize) -> Self {
        Self { time: Vec::with_capacity(rows), samples: Vec::with_capacity(rows), points: None }
    }

    /// Appends a row: the circuit at `time`, s.
    pub fn push(&mut self, time: f64, sample: CircuitSample) {
        self.time.push(time);
        self.samples.push(sample);
    }

    /// Drops all rows but the last.
    pub fn keep_last(&mut self) {
        // In place of a drain, which would keep the memory.
        self.time = self.time.split_off(self.time.len().saturating_sub(1));
        self.samples = self.samples.split_off(self.samples.len().saturating_sub(1));
    }

    /// The first `rows` rows.
    pub fn truncate(&mut self, rows: usize) {
        self.time.truncate(rows);
        self.samples.truncate(rows);
    }

    /// The circuit at the end.
    pub fn last(&self) -> CircuitSample {
        self.samples.last().copied().unwrap_or_default()
    }

    /// The ledger at the end.
    pub fn ledger(&self) -> Ledger {
        self.last().ledger
    }

    /// Root of the mean square of the difference of the voltages from those of `other`, left and right, V; `None` if
    /// the two are not of the same times.
    pub fn voltage_difference(&self, other: &Self) -> Option<[f64; 2]> {
        if self.time != other.time || self.time.len() < 2 {
            return None;
        }
        let difference = |index: usize, j: usize| self.samples[index].voltage[j] - other.samples[index].voltage[j];
        let mean_square = |j: usize| {
            let pieces = self.time.windows(2).enumerate();
            let sum: f64 = pieces
                .map(|(index, ends)| {
                    // Of a difference that is linear in between.
                    let (a, b) = (difference(index, j), difference(index + 1, j));
                    (ends[1] - ends[0]) * (a * a + a * b + b * b) / 3.0
                })
                .sum();
            sum / (self.time[self.time.len() - 1] - self.time[0])
        };
        Some([0, 1].map(|j| mean_square(j).sqrt()))
    }
}
