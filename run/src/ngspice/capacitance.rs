//! C(t) as a table, linear between its rows: what the embedded solver and ngspice both get, so that both solve the same
//! problem.

use std::io::Write;

use super::NgspiceError;

pub use videg_spice::PICO;

/// Capacitances of both membranes at rising times from 0 s on, linear in between.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct CapacitanceTable {
    time: Vec<f64>,
    left: Vec<f64>,
    right: Vec<f64>,
}

impl CapacitanceTable {
    /// Most rows that a table may have: 48 MB in memory, about 100 MB as text.
    pub const MAX_ROWS: usize = 2_000_000;

    /// A table from its columns: times in s, capacitances in F.
    ///
    /// # Errors
    /// Columns of different lengths; fewer than two rows or more than [`Self::MAX_ROWS`]; a first time that is not 0;
    /// times that do not rise; a capacitance that is not finite and above 0.
    pub fn new(time: &[f64], left: &[f64], right: &[f64]) -> Result<Self, NgspiceError> {
        let fail = |row, reason| Err(NgspiceError::Table { row, reason });
        if time.len() != left.len() || time.len() != right.len() {
            let lengths =
                format!("{} times, {} left, {} right: the numbers must be equal", time.len(), left.len(), right.len());
            return fail(0, lengths);
        }
        let mut table = Self::default();
        for ((&time, &left), &right) in time.iter().zip(left).zip(right) {
            table.push(time, [left, right])?;
        }
        if table.len() < 2 { fail(table.len(), "there must be two rows at least".to_owned()) } else { Ok(table) }
    }

    /// Appends a row.
    pub fn push(&mut self, time: f64, [left, right]: [f64; 2]) -> Result<(), NgspiceError> {
        let row = self.len();
        let fail = |reason| Err(NgspiceError::Table { row, reason });
        let in_order = self.time.last().map_or(time == 0.0, |&last| time > last && time.is_finite());
        if !in_order {
            return fail(format!("time = {time} s: must start at 0 s and rise"));
        }
        for (name, value) in [("left", left), ("right", right)] {
            if !(value > 0.0 && value.is_finite()) {
                return fail(format!("{name} capacitance = {value} F: must be finite and above 0"));
            }
        }
        if row == Self::MAX_ROWS {
            return fail(format!("there must be {} rows at most", Self::MAX_ROWS));
        }
        self.time.push(time);
        self.left.push(left);
        self.right.push(right);
        Ok(())
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.time.len()
    }

    /// Never true of a table that [`Self::new`] or [`Self::from_harvester`] made.
    pub fn is_empty(&self) -> bool {
        self.time.is_empty()
    }

    /// Times, s.
    pub fn times(&self) -> &[f64] {
        &self.time
    }

    /// Capacitances of the left membrane, F.
    pub fn left(&self) -> &[f64] {
        &self.left
    }

    /// Capacitances of the right membrane, F.
    pub fn right(&self) -> &[f64] {
        &self.right
    }

    /// Time and capacitances (left, right), F, of each row.
    pub fn rows(&self) -> impl Iterator<Item = (f64, [f64; 2])> {
        self.time.iter().zip(&self.left).zip(&self.right).map(|((&time, &left), &right)| (time, [left, right]))
    }

    /// Capacitances (left, right) at 0 s, F.
    pub fn initial(&self) -> [f64; 2] {
        [&self.left, &self.right].map(|column| column.first().copied().unwrap_or_default())
    }

    /// Largest ratio of a capacitance to that at 0 s, at least 1: the bound of the rise in voltage.
    pub fn growth(&self) -> f64 {
        let [left, right] = self.initial();
        self.rows().map(|(_, c)| (c[0] / left).max(c[1] / right)).fold(1.0, f64::max)
    }

    /// Capacitance of the left membrane at `time`, s, as ngspice reads it: in pF; F.
    pub fn left_at(&self, time: f64) -> f64 {
        let end = self.time.partition_point(|&row| row < time).clamp(1, self.len() - 1);
        let [a, b] = [end - 1, end];
        let part = ((time - self.time[a]) / (self.time[b] - self.time[a])).clamp(0.0, 1.0);
        (self.left[a] / PICO + part * (self.left[b] - self.left[a]) / PICO) * PICO
    }

    /// Last time, s.
    pub fn until(&self) -> f64 {
        self.time.last().copied().unwrap_or_default()
    }

    /// The rows from `from` to `to`, both included, as a table that begins at 0 s.
    ///
    /// # Panics
    /// If `from` is behind `to`, or `to` beyond the last row.
    #[must_use]
    pub fn part(&self, from: usize, to: usize) -> Self {
        let cut = |column: &[f64]| column[from..=to].to_vec();
        let time = self.time[from..=to].iter().map(|time| time - self.time[from]).collect();
        Self { time, left: cut(&self.left), right: cut(&self.right) }
    }

    /// Last rows of pieces of at least `length`, s, but for the last one, which may be half as long.
    pub(super) fn pieces(&self, length: f64) -> Vec<usize> {
        let (mut ends, mut earliest, until) = (Vec::new(), length, self.until());
        for (row, &time) in self.time.iter().enumerate() {
            if time >= earliest && until - time >= 0.5 * length {
                ends.push(row);
                earliest = time + length;
            }
        }
        ends.push(self.len().saturating_sub(1));
        ends
    }

    /// Writes the table as ngspice reads it.
    pub(super) fn write(&self, out: impl Write) -> std::io::Result<()> {
        write_rows(self.rows(), out)
    }
}

/// Writes time, s, and capacitances (left, right), F, as ngspice's `filesource` reads them: time in s, left and right in pF. A last
/// row beyond the end keeps the capacitances where the last step of ngspice may overshoot.
pub fn write_rows(rows: impl Iterator<Item = (f64, [f64; 2])>, mut out: impl Write) -> std::io::Result<()> {
    let mut last = None;
    let mut write =
        |(time, [left, right]): (f64, [f64; 2])| writeln!(out, "{time:e} {:e} {:e}", left / PICO, right / PICO);
    for row in rows {
        write(row)?;
        last = Some(row);
    }
    if let Some((time, capacitance)) = last {
        write((time + 1.0, capacitance))?;
    }
    out.flush()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_follow_each_other_and_end_with_the_table() {
        let time: Vec<f64> = (0..=24).map(f64::from).collect();
        let table = CapacitanceTable::new(&time, &[1e-12; 25], &[1e-12; 25]).unwrap();
        assert_eq!(table.pieces(10.0), [10, 24]);
        assert_eq!(table.pieces(8.0), [8, 16, 24]);
        assert_eq!(table.pieces(24.0), [24]);
        assert_eq!(table.pieces(100.0), [24]);
        let part = table.part(8, 16);
        assert_eq!((part.times()[0], part.until(), part.len()), (0.0, 8.0, 9));
    }
}
