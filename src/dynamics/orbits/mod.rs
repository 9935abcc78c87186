//! Periodic orbits: found by Newton's method on the return map with the exact first-order changes of the model, their Floquet
//! multipliers, and their branches over a parameter by pseudo-arclength continuation.
//!
//! The section is stroboscopic: a round is a whole number of periods of the excitation, so the map has the dimension of the state
//! for any order of impacts, and resting needs no map of its own. Its phase is the middle of the orbit's longest flight, where the map
//! is smooth: at an impact the state jumps, and a section at a fixed phase would fail for orbits with an impact there.

mod arc;
mod branch;
mod cycle;
mod flow;
mod marks;
mod multipliers;
mod orbit;
mod pattern;
mod search;

pub use branch::{Branch, End};
pub use flow::{Change, Flow, Point, State};
pub use marks::{Bifurcation, Mark};
pub use multipliers::Multipliers;
pub use orbit::Orbit;
pub use pattern::Pattern;
pub use search::Search;

use nalgebra::DVector;

use self::arc::Arc;
use super::{DynamicsError, Problem};
use crate::progress::Progress;
use crate::threads;

/// Values of the parameter at which orbits are searched for.
const STATIONS: usize = 9;
/// Most branches.
const MOST: usize = 64;
/// How far beyond a grazing impact, in units of the range, orbits with another order of impacts are looked for.
const BEYOND: [f64; 4] = [1e-5, -1e-5, 1e-3, -1e-3];

/// Orbits of the problem at its own parameters, by period, number of impacts and their order.
///
/// # Errors
/// A problem whose orbits cannot be found by this method, or with parameters out of their bounds; stopped by the observer.
pub fn orbits(problem: &Problem, search: &Search, observer: &dyn Progress) -> Result<Vec<Orbit>, DynamicsError> {
    let alone = Problem { varied: None, ..problem.clone() };
    alone.check_orbits()?;
    search.at_on_all_cores(Flow::new(&alone), f64::NAN, observer)
}

/// Branches of orbits over the parameter that varies, in the order in which they are found. If the observer stops the search, the
/// branches that are complete.
///
/// # Errors
/// As [`orbits`]; nothing varies.
pub fn branches(problem: &Problem, search: &Search, observer: &dyn Progress) -> Result<Vec<Branch>, DynamicsError> {
    problem.check_orbits()?;
    let Some(varied) = &problem.varied else {
        return Err(DynamicsError::NoRange { name: String::new() });
    };
    let (flow, range) = (Flow::new(problem), varied.range());
    let stations: Vec<f64> = (0..STATIONS).map(|k| station(range, k)).collect();
    let found = threads::map(&stations, observer, |value| {
        // Where a value is out of bounds there are none.
        Ok::<_, DynamicsError>(if observer.is_stopped() {
            Vec::new()
        } else {
            search.at(flow, *value).unwrap_or_default()
        })
    })?;
    let mut followed = Followed { flow, range, search, branches: Vec::new() };
    let mut found: Vec<Orbit> = found.into_iter().flatten().collect();
    // Simple ones first, should there be too many to follow all.
    found.sort_by_key(|orbit| (orbit.period, orbit.impacts.len()));
    for orbit in found {
        followed.add(orbit, None, observer);
    }
    Ok(followed.branches)
}

fn station([from, to]: [f64; 2], index: usize) -> f64 {
    from + (to - from) * index as f64 / (STATIONS - 1) as f64
}

struct Followed<'a> {
    flow: Flow<'a>,
    range: [f64; 2],
    search: &'a Search,
    branches: Vec<Branch>,
}

impl Followed<'_> {
    /// Follows `orbit`, unless that was done, and the branches that begin on the way.
    fn add(&mut self, orbit: Orbit, direction: Option<DVector<f64>>, observer: &dyn Progress) {
        let mut waiting = vec![(orbit, direction)];
        while let Some((orbit, direction)) = waiting.pop() {
            let is_known = |orbit: &Orbit| self.branches.iter().any(|branch| branch.has(self.flow, orbit));
            if self.branches.len() >= MOST || observer.is_stopped() || is_known(&orbit) {
                continue;
            }
            let is_stopped = || observer.is_stopped();
            let branch = Branch::through(self.flow, self.range, &orbit, direction.as_ref(), &is_stopped);
            let Some(branch) = branch.filter(|_| !observer.is_stopped()) else { continue };
            if branch.orbits.get(branch.orbits.len() / 2).is_some_and(is_known) {
                continue;
            }
            waiting.extend(self.starts(&branch));
            self.branches.push(branch);
        }
    }

    /// Where other branches begin at this one.
    fn starts(&self, branch: &Branch) -> Vec<(Orbit, Option<DVector<f64>>)> {
        let Some(period) = branch.orbits.first().map(|orbit| orbit.period) else { return Vec::new() };
        let arc = Arc::new(self.flow, self.range, period);
        let mut starts = Vec::new();
        for mark in &branch.marks {
            if mark.kind == Bifurcation::Grazing {
                let point = &mark.orbit.point;
                starts.extend(BEYOND.iter().filter_map(|step| {
                    let value = point.value + step * (self.range[1] - self.range[0]);
                    let guess = Point { value, ..point.clone() };
                    let orbit = Orbit::find(self.flow, &guess, mark.orbit.period)?;
                    (orbit.pattern != mark.orbit.pattern).then_some((orbit, None))
                }));
            } else if mark.kind != Bifurcation::PeriodDoubling || 2 * mark.orbit.period <= self.search.periods {
                starts.extend(mark.starts(&arc).into_iter().map(|(orbit, direction)| (orbit, Some(direction))));
            }
        }
        starts
    }
}
