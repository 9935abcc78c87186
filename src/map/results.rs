//! Results of the runs of a map: those of the grid, and new ones in between.

use std::path::Path;

use csv::{Reader, ReaderBuilder, StringRecord};

use super::columns::Cell;
use super::error::MapError;
use super::plan::Plan;
use crate::sweep::Engine;

impl Plan {
    /// Cells of the grid, row by row from the lowest, from the results at `path`.
    pub(super) fn read(&self, path: &Path) -> Result<Vec<Cell>, MapError> {
        let unreadable = |cause| MapError::Results { path: path.to_owned(), cause };
        let mut reader = Reader::from_path(path).map_err(unreadable)?;
        let samples = usize::try_from(self.sweep.samples()).unwrap_or(usize::MAX);
        let (mut cells, mut rows) = (Vec::new(), Vec::new());
        for row in reader.records() {
            rows.push(row.map_err(unreadable)?);
            if rows.len() == samples {
                cells.push(self.columns.cell(&rows));
                rows.clear();
            }
        }
        Ok(cells)
    }

    /// The cell at these values of both axes, from new runs.
    pub(super) fn cell_at(&self, engine: &Engine, [x, y]: [f64; 2]) -> Result<Cell, MapError> {
        let row = |sample| {
            let line = self.sweep.line_at(engine, &[y, x], sample)?;
            let mut row = StringRecord::new();
            let mut reader = ReaderBuilder::new().has_headers(false).from_reader(&line[..]);
            let place = || format!("{} = {x}, {} = {y}", self.axes[0].name, self.axes[1].name);
            reader.read_record(&mut row).map_err(|cause| MapError::Line { place: place(), cause })?;
            Ok(row)
        };
        let rows = (0..self.sweep.samples()).map(row).collect::<Result<Vec<_>, MapError>>()?;
        Ok(self.columns.cell(&rows))
    }
}
