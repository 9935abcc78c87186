//! Results read back, a point at a time: memory does not grow with the number of points.

use std::io;
use std::path::Path;

use csv::StringRecord;

use super::document::Kept;
use super::order::is_quantity;

/// Which columns hold what.
pub(super) struct Layout {
    /// Number of varied variables, whose columns follow the first three.
    axes: usize,
    /// Columns of numbers that a run gives.
    quantities: Vec<usize>,
}

/// The samples of a point.
#[derive(Debug, Default, Clone, PartialEq)]
pub(super) struct Samples {
    pub point: u64,
    /// Values of the varied variables, as they stand there.
    pub given: Vec<String>,
    /// Runs that succeeded.
    pub succeeded: u64,
    /// Runs that failed.
    pub failed: u64,
    /// By quantity, of the runs that succeeded.
    pub values: Vec<Vec<f64>>,
}

impl Layout {
    pub fn new(kept: &Kept) -> Self {
        let quantities = kept.columns.iter().enumerate().filter(|(_, column)| is_quantity(column));
        Self { axes: kept.vary.len(), quantities: quantities.map(|(index, _)| index).collect() }
    }

    /// Columns of the quantities.
    pub fn quantities(&self) -> &[usize] {
        &self.quantities
    }

    fn begin(&self, row: &StringRecord, point: u64) -> Samples {
        let given = row.iter().skip(3).take(self.axes).map(str::to_owned).collect();
        Samples { point, given, values: vec![Vec::new(); self.quantities.len()], ..Samples::default() }
    }

    fn add(&self, samples: &mut Samples, row: &StringRecord) -> io::Result<()> {
        if row.iter().next_back().is_some_and(|reason| !reason.is_empty()) {
            samples.failed += 1;
            return Ok(());
        }
        samples.succeeded += 1;
        for (&column, values) in self.quantities.iter().zip(&mut samples.values) {
            values.push(number(row, column)?);
        }
        Ok(())
    }
}

/// A cell that is a number.
fn number<T: std::str::FromStr>(row: &StringRecord, column: usize) -> io::Result<T> {
    let cell = row.get(column).unwrap_or_default();
    cell.parse().map_err(|_| io::Error::other(format!("{cell:?} in column {column} is no number")))
}

/// Hands the samples of each point of the results at `csv` to `take`, in order.
pub(super) fn each(csv: &Path, layout: &Layout, mut take: impl FnMut(Samples) -> io::Result<()>) -> io::Result<()> {
    let (mut reader, mut row, mut samples) = (csv::Reader::from_path(csv)?, StringRecord::new(), None::<Samples>);
    while reader.read_record(&mut row)? {
        let point = number(&row, 1)?;
        if let Some(complete) = samples.take_if(|samples| samples.point != point) {
            take(complete)?;
        }
        layout.add(samples.get_or_insert_with(|| layout.begin(&row, point)), &row)?;
    }
    samples.map_or(Ok(()), take)
}
