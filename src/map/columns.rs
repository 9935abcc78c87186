//! Numbers of a point of a map, from the rows of its samples.

use csv::StringRecord;
use videg_coupled::OVER_LIMITS;

use crate::sweep::{Sweep, Type};

/// The columns of the results that a point has a number of.
#[derive(Debug, Clone)]
pub(super) struct Columns {
    /// Names, and places in a row.
    numbers: Vec<(String, usize)>,
    /// Place of the reason of a failure.
    error: usize,
}

/// Numbers of a point.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Cell {
    /// Means over the samples that succeeded, and the most that any of them takes of a limit; empty without one.
    pub numbers: Vec<f64>,
    /// Samples that failed.
    pub failed: u64,
    /// Why the first of these did.
    pub reason: String,
}

impl Columns {
    pub(super) fn of(sweep: &Sweep) -> Self {
        let columns = sweep.columns();
        let is_number = |kind: Type| matches!(kind, Type::Real | Type::Integer);
        let numbers = columns.iter().enumerate().filter(|(_, column)| column.optional && is_number(column.kind));
        Self {
            numbers: numbers.map(|(place, column)| (column.name.clone(), place)).collect(),
            error: columns.len() - 1,
        }
    }

    pub(super) fn names(&self) -> impl Iterator<Item = &str> {
        self.numbers.iter().map(|(name, _)| name.as_str())
    }

    /// Place of a name among the numbers.
    pub(super) fn place(&self, name: &str) -> Option<usize> {
        self.names().position(|other| other == name)
    }

    /// The cell of a point from the `rows` of its samples.
    pub(super) fn cell(&self, rows: &[StringRecord]) -> Cell {
        let mut cell = Cell::default();
        let mut count = 0.0;
        for row in rows {
            let reason = row.get(self.error).unwrap_or_default();
            if !reason.is_empty() {
                if cell.failed == 0 {
                    reason.clone_into(&mut cell.reason);
                }
                cell.failed += 1;
                continue;
            }
            count += 1.0;
            cell.numbers.resize(self.numbers.len(), 0.0);
            for (sum, (name, place)) in cell.numbers.iter_mut().zip(&self.numbers) {
                let value = row.get(*place).and_then(|text| text.parse().ok()).unwrap_or(f64::NAN);
                *sum = if is_limit(name) { largest(*sum, value) } else { *sum + value };
            }
        }
        for (sum, (name, _)) in cell.numbers.iter_mut().zip(&self.numbers) {
            if !is_limit(name) {
                *sum /= count;
            }
        }
        cell
    }
}

fn is_limit(name: &str) -> bool {
    OVER_LIMITS.contains(&name)
}

/// The larger one; NaN if one is.
pub(super) fn largest(a: f64, b: f64) -> f64 {
    if a.is_nan() || a > b { a } else { b }
}
