//! Bifurcations on a branch: where a multiplier leaves the unit circle.

use nalgebra::{DMatrix, DVector};

use super::arc::Arc;
use super::flow::Change;
use super::multipliers::Multipliers;
use super::orbit::{Orbit, scaled};

/// Turns of the search for a zero.
const TURNS: u32 = 80;
/// Length of the interval, in units of the arc, that it ends with.
const SHORT: f64 = 1e-14;
/// Excess of a modulus over 1 below which rounding decides its sign.
const ROUNDING: f64 = 1e-6;
/// First steps onto a branch that begins at a bifurcation.
const FIRST: [f64; 3] = [1e-3, 3e-3, 1e-2];

/// What happens at a mark.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Bifurcation {
    /// The branch turns back: a multiplier is +1.
    Fold,
    /// Another branch crosses: a multiplier is +1, and the branch goes on.
    BranchPoint,
    /// An orbit of twice the period begins: a multiplier is -1.
    PeriodDoubling,
    /// A pair of multipliers crosses the unit circle.
    NeimarkSacker,
    /// The ball touches a membrane without speed.
    Grazing,
}

impl Bifurcation {
    /// In words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Fold => "fold",
            Self::BranchPoint => "branch point",
            Self::PeriodDoubling => "period doubling",
            Self::NeimarkSacker => "Neimark-Sacker",
            Self::Grazing => "grazing",
        }
    }
}

/// A bifurcation on a branch.
#[derive(Debug, Clone)]
pub struct Mark {
    /// What happens.
    pub kind: Bifurcation,
    /// The orbit there.
    pub orbit: Orbit,
}

impl Mark {
    pub(super) fn grazing(orbit: Orbit) -> Self {
        Self { kind: Bifurcation::Grazing, orbit }
    }

    /// The branches that begin here: an orbit of each close to the mark, and the direction from it, of state and parameter.
    pub(super) fn starts(&self, branch_of: &Arc<'_>) -> Vec<(Orbit, DVector<f64>)> {
        let (sign, period, ways): (_, _, &[f64]) = match self.kind {
            Bifurcation::PeriodDoubling => (1.0, 2 * self.orbit.period, &[1.0]),
            Bifurcation::BranchPoint => (-1.0, self.orbit.period, &[1.0, -1.0]),
            _ => return Vec::new(),
        };
        let flow = branch_of.flow;
        let arc = Arc::new(flow, branch_of.range, period);
        let derivative = scaled(&self.orbit.change.by_state, &flow.scale(self.orbit.point.value));
        let Some(direction) = null_vector(&(derivative + sign * identity(&self.orbit.change))) else {
            return Vec::new();
        };
        let start = |way: &f64| {
            let normal = arc.of_state(&(&direction * *way));
            FIRST.iter().find_map(|step| {
                let guess = arc.along(&self.orbit.point, &normal, *step);
                let (point, change) = arc.correct(&guess, &normal)?;
                let tangent = arc.tangent(&change, &normal)?;
                let orbit = Orbit::measured(flow, &point, period)?;
                let is_other = orbit.period == period;
                let carried = arc.carried(&point, &tangent, orbit.elapsed)?;
                is_other.then_some((orbit, carried))
            })
        };
        ways.iter().filter_map(start).collect()
    }
}

fn identity(change: &Change) -> DMatrix<f64> {
    DMatrix::identity(change.by_state.nrows(), change.by_state.nrows())
}

/// The direction that a nearly singular matrix leaves no length.
fn null_vector(matrix: &DMatrix<f64>) -> Option<DVector<f64>> {
    let svd = matrix.clone().try_svd(false, true, f64::EPSILON, 10_000)?;
    let rows = svd.v_t?;
    Some(rows.row(svd.singular_values.imin()).transpose())
}

/// A function of the return map and of the parameter's part in the tangent.
type Test = fn(&Change, f64) -> f64;

/// Functions that are zero at the bifurcations.
const TESTS: [(Bifurcation, Test); 4] = [
    (Bifurcation::Fold, |_, turn| turn),
    (Bifurcation::BranchPoint, |change, _| (&change.by_state - identity(change)).determinant()),
    (Bifurcation::PeriodDoubling, |change, _| (&change.by_state + identity(change)).determinant()),
    (Bifurcation::NeimarkSacker, |change, _| Multipliers::of(&change.by_state).map_or(-1.0, |it| it.pair_excess())),
];

/// A distance of a multiplier from +1 within which the curve may meet another one between two points.
const NEAR: f64 = 0.2;

/// Whether two neighbouring orbits, each with its tangent, can lie on one smooth curve: it turns back only where a multiplier is +1.
pub(super) fn is_smooth(
    (here, tangent): (&Orbit, &DVector<f64>),
    (next, next_tangent): (&Orbit, &DVector<f64>),
) -> bool {
    let turns = tangent[tangent.len() - 1] * next_tangent[next_tangent.len() - 1] < 0.0;
    let singular = |orbit: &Orbit| (&orbit.change.by_state - identity(&orbit.change)).determinant();
    let near = |orbit: &Orbit| orbit.multipliers.0.iter().any(|value| (value.re - 1.0).hypot(value.im) < NEAR);
    !turns || singular(here) * singular(next) < 0.0 || near(here) || near(next)
}

/// The bifurcations between an orbit and the one a `step` further on, each with its tangent, in order.
pub(super) fn between(
    arc: &Arc<'_>,
    (here, tangent): (&Orbit, &DVector<f64>),
    (next, next_tangent): (&Orbit, &DVector<f64>),
    step: f64,
) -> Vec<Mark> {
    let turn = |tangent: &DVector<f64>| tangent[tangent.len() - 1];
    let mut found: Vec<(f64, Mark)> = Vec::new();
    let mut turns_back = false;
    for (kind, test) in TESTS {
        let ends = [test(&here.change, turn(tangent)), test(&next.change, turn(next_tangent))];
        let is_crossed = ends[0] * ends[1] < 0.0;
        let is_real = match kind {
            Bifurcation::NeimarkSacker => ends.iter().all(|end| end.abs() > ROUNDING && *end > -1.0),
            // At a fold this is zero, too.
            Bifurcation::BranchPoint => !turns_back,
            _ => true,
        };
        if !(is_crossed && is_real) {
            continue;
        }
        turns_back |= kind == Bifurcation::Fold;
        let at = |s: f64| {
            let (point, change) = arc.correct(&arc.along(&here.point, tangent, s), tangent)?;
            let there = arc.tangent(&change, tangent)?;
            let value = test(&change, turn(&there));
            Some((value, point))
        };
        let (place, point) = zero(at, (0.0, ends[0]), (step, ends[1]));
        let orbit = point.and_then(|point| Orbit::measured(arc.flow, &point, arc.period));
        // At the very bifurcation the orbit may not be told from one of a continuum: a neighbour stands for it.
        let orbit = orbit.unwrap_or_else(|| here.clone());
        found.push((place, Mark { kind, orbit }));
    }
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    found.into_iter().map(|(_, mark)| mark).collect()
}

/// Zero of a function between two places of opposite sign by false position (Illinois), and the last point looked at.
fn zero<P>(
    at: impl Fn(f64) -> Option<(f64, P)>,
    (mut a, mut fa): (f64, f64),
    (mut b, mut fb): (f64, f64),
) -> (f64, Option<P>) {
    let mut last = None;
    let mut side = 0.0;
    for _ in 0..TURNS {
        if (b - a).abs() < SHORT {
            break;
        }
        let place = (a * fb - b * fa) / (fb - fa);
        let Some((value, point)) = at(place) else { break };
        last = Some((place, point));
        if value == 0.0 {
            break;
        }
        if value * fb > 0.0 {
            (b, fb) = (place, value);
            if side < 0.0 {
                fa *= 0.5;
            }
            side = -1.0;
        } else {
            (a, fa) = (place, value);
            if side > 0.0 {
                fb *= 0.5;
            }
            side = 1.0;
        }
    }
    last.map_or((0.5 * (a + b), None), |(place, point)| (place, Some(point)))
}
