//! Results of ngspice, piece by piece, as the circuit at the times of a table.

use std::io::BufRead;

use videg_circuit::CircuitSample;

use super::capacitance::CapacitanceTable;
use super::elements::{Elements, Start};
use super::ledger::TrapezoidalLedger;
use super::raw::RawReader;
use super::{NgspiceError, Waveforms};

/// Reads a run point by point and keeps the rows of the table.
pub(super) struct ResultReader<'a> {
    elements: &'a Elements,
    table: &'a CapacitanceTable,
    position: Position,
    found: Waveforms,
}

/// How far a run has been read.
#[derive(Clone, Copy)]
pub(super) struct Position {
    ledger: TrapezoidalLedger,
    rows: usize,
    points: u64,
}

impl<'a> ResultReader<'a> {
    /// The run of `elements` over `table`, of which nothing has been read.
    pub fn new(elements: &'a Elements, table: &'a CapacitanceTable) -> Self {
        let ledger = TrapezoidalLedger::new(elements, table.initial());
        let position = Position { ledger, rows: 0, points: 0 };
        Self { elements, table, position, found: Waveforms::with_capacity(table.len()) }
    }

    /// Reads the result of a piece that began at row `from`.
    pub fn read(&mut self, raw: impl BufRead, from: usize) -> Result<(), NgspiceError> {
        let mut reader = RawReader::new(raw)?;
        let columns = reader.indices(self.elements.vectors())?;
        let start = self.table.times()[from];
        let (mut point, mut values) = (Vec::new(), Vec::new());
        let Position { ledger, rows, points } = &mut self.position;
        while reader.next_point(&mut point)? {
            values.clear();
            values.extend(columns.iter().map(|&column| point[column]));
            let before = (ledger.time(), ledger.sample());
            ledger.add(start + point[0], &values);
            let after = (ledger.time(), ledger.sample());
            let reached = after.0 + 1e-12 * self.table.until();
            while let Some(&time) = self.table.times().get(*rows).filter(|&&time| time <= reached) {
                self.found.push(time, interpolated(&before, &after, time));
                *rows += 1;
            }
        }
        *points += reader.points();
        Ok(())
    }

    /// Whether row `to` has been reached.
    pub fn has(&self, to: usize) -> bool {
        self.position.rows > to
    }

    /// Last time point, s, and the voltages there.
    pub fn end(&self) -> (f64, Start) {
        (self.position.ledger.time(), self.position.ledger.end())
    }

    /// How far the run has been read.
    pub fn position(&self) -> Position {
        self.position
    }

    /// Forgets what has been read since `position`.
    pub fn return_to(&mut self, position: &Position) {
        self.found.truncate(position.rows);
        self.position = *position;
    }

    /// The run, as far as it has been read.
    pub fn finish(self) -> Waveforms {
        Waveforms { points: Some(self.position.points), ..self.found }
    }
}

/// The sample at `time` between two others.
fn interpolated(before: &(f64, CircuitSample), after: &(f64, CircuitSample), time: f64) -> CircuitSample {
    let span = after.0 - before.0;
    let part = if span > 0.0 { ((time - before.0) / span).clamp(0.0, 1.0) } else { 1.0 };
    let (a, b) = (before.1.columns(), after.1.columns());
    CircuitSample::from_columns(std::array::from_fn(|k| a[k] + part * (b[k] - a[k])))
}
