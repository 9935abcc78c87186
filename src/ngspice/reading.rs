//! Results of ngspice, piece by piece, as the circuit at the times of a table.

use std::io::BufRead;

use super::books::Books;
use super::capacitance::CapacitanceTable;
use super::circuit::{Elements, Start};
use super::raw::RawReader;
use super::{NgspiceError, Waveforms};
use crate::circuit_sample::CircuitSample;

/// A run that is being read, point by point; what is kept is as large as the table.
#[derive(Debug)]
pub(super) struct Reading<'a> {
    elements: &'a Elements,
    table: &'a CapacitanceTable,
    books: Books,
    found: Waveforms,
}

/// How far a run has been read.
#[derive(Debug)]
pub(super) struct Mark {
    books: Books,
    rows: usize,
    points: Option<u64>,
}

impl<'a> Reading<'a> {
    /// The run of `elements` over `table`, of which nothing has been read.
    pub fn new(elements: &'a Elements, table: &'a CapacitanceTable) -> Self {
        let found = Waveforms { points: Some(0), ..Waveforms::with_capacity(table.len()) };
        Self { elements, table, books: Books::new(elements, table.initial()), found }
    }

    /// Reads the result of a piece that began at row `from`.
    ///
    /// # Errors
    /// A result that is none.
    pub fn take(&mut self, raw: impl BufRead, from: usize) -> Result<(), NgspiceError> {
        let mut reader = RawReader::new(raw)?;
        let columns = self.elements.vectors().iter().map(|name| reader.index(name)).collect::<Result<Vec<_>, _>>()?;
        let start = self.table.times()[from];
        let (mut point, mut values) = (Vec::new(), Vec::new());
        while reader.next_point(&mut point)? {
            values.clear();
            values.extend(columns.iter().map(|&column| point[column]));
            let Some(now) = Books::instant(self.elements, start + point[0], &values) else { break };
            let before = (self.books.time(), self.books.sample());
            self.books.take(&now);
            let after = (now.time, self.books.sample());
            let reached = now.time + 1e-12 * self.table.until();
            while let Some(&time) = self.table.times().get(self.found.time.len()).filter(|&&time| time <= reached) {
                self.found.push(time, interpolated(&before, &after, time));
            }
        }
        self.found.points = self.found.points.map(|points| points + reader.points());
        Ok(())
    }

    /// Whether row `to` has been reached.
    pub fn has(&self, to: usize) -> bool {
        self.found.time.len() > to
    }

    /// Last time point, s, and the voltages there.
    pub fn end(&self) -> (f64, Start) {
        (self.books.time(), self.books.end())
    }

    /// How far it has been read.
    pub fn mark(&self) -> Mark {
        Mark { books: self.books.clone(), rows: self.found.time.len(), points: self.found.points }
    }

    /// Forgets what has been read since.
    pub fn return_to(&mut self, mark: &Mark) {
        self.books.clone_from(&mark.books);
        self.found.truncate(mark.rows);
        self.found.points = mark.points;
    }

    /// The run, as far as it has been read.
    pub fn finish(self) -> Waveforms {
        self.found
    }
}

/// The sample at `time` between two others.
fn interpolated(before: &(f64, CircuitSample), after: &(f64, CircuitSample), time: f64) -> CircuitSample {
    let span = after.0 - before.0;
    let part = if span > 0.0 { ((time - before.0) / span).clamp(0.0, 1.0) } else { 1.0 };
    let (a, b) = (before.1.columns(), after.1.columns());
    CircuitSample::from_columns(std::array::from_fn(|k| a[k] + part * (b[k] - a[k])))
}
