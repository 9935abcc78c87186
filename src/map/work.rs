//! The work of a map: its grid, its best points.

use super::best::{ClosedForms, Point, Search};
use super::columns::Cell;
use super::error::MapError;
use super::plan::Plan;
use crate::progress::Progress;
use crate::sweep::{self, Options, Report};

/// A map, worked out.
#[derive(Debug, Clone)]
pub struct Map {
    /// Points of the grid, row by row from the lowest.
    pub cells: Vec<Cell>,
    /// The best point of the grid.
    pub grid_best: Point,
    /// The best point that was found.
    pub best: Point,
    /// The best one within the limits of the film; none if the grid has no point within them.
    pub admissible: Option<Point>,
    /// Closed forms at the best point, under the impulsive law.
    pub closed_forms: Option<ClosedForms>,
}

/// Outcome of a map.
#[derive(Debug)]
pub struct Outcome {
    /// Of the sweep over the grid.
    pub report: Report,
    /// The map; none if the sweep was a shard, or was stopped.
    pub map: Option<Map>,
}

/// Works the map of `plan` out; `options` are those of the sweep over its grid, [`Plan::sweep`].
///
/// # Errors
/// As [`sweep::run`]; runs that all fail; a quantity that is nowhere a number; a search that the observer stops.
pub fn run(plan: &Plan, options: &Options<'_>, observer: &dyn Progress) -> Result<Outcome, MapError> {
    let report = sweep::run(options, observer)?;
    let results = report.files.first().filter(|_| report.is_complete() && options.shard.is_none());
    let map = results.map(|path| {
        let cells = plan.read(path)?;
        let search = Search { plan, engine: options.engine, jobs: options.jobs, observer };
        Map::new(plan, &search, cells)
    });
    Ok(Outcome { map: map.transpose()?, report })
}

impl Map {
    fn new(plan: &Plan, search: &Search<'_>, cells: Vec<Cell>) -> Result<Self, MapError> {
        if let Some(first) = cells.first().filter(|_| cells.iter().all(|cell| cell.numbers.is_empty())) {
            return Err(MapError::AllFailed { runs: plan.sweep.runs(), reason: first.reason.clone() });
        }
        let Some([grid_best, best]) = search.best(&cells, false)? else {
            return Err(MapError::NoNumber { name: plan.of.clone() });
        };
        let admissible = if plan.over_limits(&best.cell) <= 1.0 {
            Some(best.clone())
        } else {
            search.best(&cells, true)?.map(|[_, best]| best)
        };
        let closed_forms = search.closed_forms(best.at);
        Ok(Self { cells, grid_best, best, admissible, closed_forms })
    }
}
