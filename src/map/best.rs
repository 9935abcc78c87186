//! The best points of a map.

use super::columns::Cell;
use super::error::MapError;
use super::plan::Plan;
use super::search::{Spot, climb};
use crate::progress::Progress;
use crate::sweep::{DrivenImpacts, Engine};
use crate::threads::{Sharing, in_order};
use videg_circuit::Topology;

/// Tops of the grid from which the search begins.
const STARTS: usize = 3;
/// Places that are worked out ahead of the first one that is not done.
const AHEAD: u64 = 64;

/// A point of a map.
#[derive(Debug, Clone, PartialEq)]
pub struct Point {
    /// Values of both axes.
    pub at: [f64; 2],
    /// Value of what is mapped.
    pub value: f64,
    /// All numbers.
    pub cell: Cell,
}

/// What closed forms say of a quick release, over all impacts at the best point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClosedForms {
    /// The best voltage of release, V.
    pub release_voltage: f64,
    /// Net gain there, W.
    pub release_power: f64,
    /// Largest net gain of any circuit that charges to `U_in`, W.
    pub largest_power: f64,
}

/// Where places are worked out.
pub(super) struct Search<'a> {
    pub plan: &'a Plan,
    pub engine: &'a Engine,
    pub jobs: usize,
    pub observer: &'a dyn Progress,
}

impl Plan {
    /// What the search makes largest: the quantity, where it is a number and, if asked for, no limit is exceeded.
    fn score(&self, cell: &Cell, is_bounded: bool) -> f64 {
        let value = self.number(cell, &self.of);
        let counts = value.is_finite() && (!is_bounded || self.over_limits(cell) <= 1.0);
        if counts { value } else { f64::NEG_INFINITY }
    }

    fn point(&self, spot: &Spot<Cell>) -> Point {
        let at = [0, 1].map(|j| self.axes[j].value(spot.at[j]));
        Point { at, value: self.number(&spot.what, &self.of), cell: spot.what.clone() }
    }

    /// Tops of the grid, the best first: cells that none of their neighbours surpasses. `is_bounded`: within the limits of the film.
    fn tops(&self, cells: &[Cell], is_bounded: bool) -> Vec<Spot<Cell>> {
        let [columns, rows] = [self.axes[0].count, self.axes[1].count];
        let scores: Vec<f64> = cells.iter().map(|cell| self.score(cell, is_bounded)).collect();
        let is_top = |index: &usize| {
            let (i, j) = (index % columns, index / columns);
            let near = |k: usize, last: usize| k.saturating_sub(1)..=(k + 1).min(last - 1);
            near(j, rows)
                .flat_map(|j| near(i, columns).map(move |i| j * columns + i))
                .all(|k| scores[k] <= scores[*index])
        };
        let counts = |index: &usize| scores[*index] > f64::NEG_INFINITY;
        let mut tops: Vec<usize> = (0..cells.len()).filter(counts).filter(is_top).collect();
        tops.sort_by(|a, b| scores[*b].total_cmp(&scores[*a]));
        let spot = |index: usize| Spot {
            at: [(index % columns) as f64, (index / columns) as f64],
            score: scores[index],
            what: cells[index].clone(),
        };
        tops.into_iter().take(STARTS).map(spot).collect()
    }
}

impl Search<'_> {
    /// The best point of the grid, and the best one that the search finds from its tops on; none if no cell counts.
    pub(super) fn best(&self, cells: &[Cell], is_bounded: bool) -> Result<Option<[Point; 2]>, MapError> {
        let plan = self.plan;
        let tops = plan.tops(cells, is_bounded);
        let Some(grid) = tops.first().map(|top| plan.point(top)) else { return Ok(None) };
        let last = [0, 1].map(|j| plan.axes[j].last());
        let mut best: Option<Spot<Cell>> = None;
        for top in tops {
            let found = climb(top, last, |places| self.evaluate(places, is_bounded))?;
            if best.as_ref().is_none_or(|best| found.score > best.score) {
                best = Some(found);
            }
        }
        Ok(best.map(|best| [grid, plan.point(&best)]))
    }

    fn evaluate(&self, places: &[[f64; 2]], is_bounded: bool) -> Result<Vec<Spot<Cell>>, MapError> {
        let Self { plan, engine, jobs, observer } = *self;
        let work = |number: u64| {
            let at = usize::try_from(number).ok().and_then(|index| places.get(index)).copied().unwrap_or_default();
            let what = plan.cell_at(engine, [0, 1].map(|j| plan.axes[j].value(at[j])))?;
            Ok::<_, MapError>(Spot { at, score: plan.score(&what, is_bounded), what })
        };
        let is_stopped = || observer.is_stopped();
        let sharing = Sharing { threads: jobs, ahead: AHEAD, is_stopped: &is_stopped };
        let mut spots = Vec::new();
        in_order(0..places.len() as u64, sharing, work, |found| {
            spots.extend(found);
            Ok(())
        })?;
        if spots.len() < places.len() { Err(MapError::Stopped) } else { Ok(spots) }
    }

    /// Closed forms of the impacts of all samples at a point; none under the compliant law, and of an engine without a circuit.
    pub(super) fn closed_forms(&self, [x, y]: [f64; 2]) -> Option<ClosedForms> {
        let Engine::System(system) = self.engine else { return None };
        let sweep = &self.plan.sweep;
        let mut all: Option<DrivenImpacts> = None;
        for sample in 0..sweep.samples() {
            // A sample that failed has left the point, too.
            let Ok(driven) = system.impacts_at(sweep, &[y, x], sample) else { continue };
            let driven = driven?;
            match &mut all {
                Some(DrivenImpacts { impacts, .. }) => {
                    impacts.ratios.extend(driven.impacts.ratios);
                    impacts.time += driven.impacts.time;
                }
                None => all = Some(driven),
            }
        }
        let DrivenImpacts { impacts, topology } = all?;
        let idle = if topology == Topology::SharedNode { 1.0 } else { 0.0 };
        let release_voltage = impacts.best_voltage(idle);
        Some(ClosedForms {
            release_voltage,
            release_power: impacts.quick_release(release_voltage, idle),
            largest_power: impacts.largest_gain(idle),
        })
    }
}
