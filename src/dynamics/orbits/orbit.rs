//! A periodic orbit: found by Newton's method on the return map, and what it is like.

use nalgebra::{DMatrix, DVector};
use videg_model::{Impact, ModelError};

use super::cycle::Cycle;
use super::flow::{Change, Flow, Point, State};
use super::multipliers::Multipliers;
use super::pattern::{Pattern, leading};

/// Most steps of Newton's method.
const STEPS: u32 = 20;
/// Longest step, in units of the state's scale.
const LONGEST: f64 = 0.3;
/// A step, in these units, below which the method has found an orbit.
const SMALL: f64 = 1e-9;
/// A singular value of the return map less the identity below which an orbit is one of a continuum.
const SINGULAR: f64 = 1e-6;
/// Distance, in units of the scale, below which two states are one.
const SAME: f64 = 1e-6;

/// A periodic orbit.
#[derive(Debug, Clone)]
pub struct Orbit {
    /// The state in the middle of the longest flight, where the return map is smooth.
    pub point: Point,
    /// Periods of the excitation in one round.
    pub period: u32,
    /// Impacts of a round; their times are in periods since the excitation had the phase `excitation.phase`.
    pub impacts: Vec<Impact>,
    /// Their order.
    pub pattern: Pattern,
    /// Floquet multipliers.
    pub multipliers: Multipliers,
    /// Smallest relative speed of an impact, m/s; infinite without one. Of those by which the ball comes to rest the first counts.
    pub least_speed: f64,
    /// Smallest distance, m, from a membrane at which the ball turns without meeting it; infinite if it turns nowhere.
    pub least_gap: f64,
    /// `<U>`, V/s.
    pub voltage_gain: f64,
    /// dz, m, and its rate, m/s, at the beginning of each period.
    pub flashes: Vec<[f64; 2]>,
    /// The return map at the point.
    pub(super) change: Change,
    /// Periods from where it was found to the point.
    pub(super) elapsed: f64,
}

impl Orbit {
    /// The orbit that Newton's method finds from `guess`, and that comes back after `period` periods or a part of them. None if it
    /// finds none, or one of a continuum.
    pub fn find(flow: Flow<'_>, guess: &Point, period: u32) -> Option<Self> {
        let scale = flow.scale(guess.value);
        let mut point = guess.clone();
        let mut before = f64::INFINITY;
        for _ in 0..STEPS {
            let change = flow.change(&point, f64::from(period)).ok()?;
            let defect = &change.end - &point.state;
            let mut step = scaled(&less_identity(&change), &scale).lu().solve(&-defect.component_div(&scale))?;
            let length = step.norm();
            if !length.is_finite() {
                return None;
            }
            if length > LONGEST {
                step *= LONGEST / length;
            }
            point.state = inside(flow, &point, step.component_mul(&scale))?;
            // Rounding is all that is left once steps do not shrink any more.
            if length < SMALL && length >= 0.5 * before || length < 1e-15 {
                return Self::measured(flow, &point, period).filter(|orbit| orbit.is_isolated(flow));
            }
            before = length;
        }
        None
    }

    /// The orbit through `point`, which comes back after `period` periods.
    pub(super) fn measured(flow: Flow<'_>, point: &Point, period: u32) -> Option<Self> {
        let period = shortest(flow, point, period).ok()?;
        let found = Cycle::along(flow, point, period).ok()??;
        let (elapsed, state) = found.middle;
        let point = Point { value: point.value, phase: (point.phase + elapsed) % 1.0, state };
        // Once more from there: times of impacts count from the new beginning.
        let cycle = Cycle::along(flow, &point, period).ok()??;
        let change = flow.change(&point, f64::from(period)).ok()?;
        let multipliers = Multipliers::of(&change.by_state)?;
        let least_speed = leading(&cycle.impacts).iter().map(|impact| impact.speed).fold(f64::INFINITY, f64::min);
        let flashes = (0..period).map(|k| {
            let elapsed = f64::from(k) + (1.0 - point.phase) % 1.0;
            flow.after(&point, elapsed, |_| {}).map(|state| [state[0], state[1]])
        });
        let flashes = flashes.collect::<Result<_, _>>().ok()?;
        Some(Self {
            period,
            pattern: Pattern::of(&cycle.impacts),
            impacts: cycle.impacts,
            multipliers,
            least_speed,
            least_gap: cycle.least_gap,
            voltage_gain: cycle.voltage_gain,
            flashes,
            change,
            elapsed,
            point,
        })
    }

    /// Whether it is none of a continuum of orbits.
    fn is_isolated(&self, flow: Flow<'_>) -> bool {
        let matrix = scaled(&less_identity(&self.change), &flow.scale(self.point.value));
        matrix.singular_values().min() > SINGULAR
    }

    /// Whether neighbouring motions approach it, or at least do not leave it.
    pub fn is_stable(&self) -> bool {
        self.multipliers.unstable() == 0
    }

    /// Name: numbers of impacts on the left and on the right membrane, and the periods if they are several.
    pub fn name(&self) -> String {
        match self.period {
            1 => self.pattern.to_string(),
            periods => format!("{}, {periods} periods", self.pattern),
        }
    }

    /// Whether this is the same motion as the other, perhaps some periods later.
    pub fn is_same(&self, other: &Self, flow: Flow<'_>) -> bool {
        if (self.period, &self.pattern) != (other.period, &other.pattern) {
            return false;
        }
        let scale = flow.scale(self.point.value)[1];
        let (ours, theirs) = (leading(&self.impacts), leading(&other.impacts));
        let round = f64::from(self.period);
        let near = |a: &Impact, b: &Impact, shift: f64| {
            let apart = (a.time + shift - b.time).rem_euclid(round);
            apart.min(round - apart) < SAME && (a.speed - b.speed).abs() < SAME * scale && a.side == b.side
        };
        (0..self.period).any(|shift| {
            let shift = f64::from(shift);
            ours.iter().all(|a| theirs.iter().any(|b| near(a, b, shift)))
        })
    }
}

/// The derivative of the return map less the identity.
pub(super) fn less_identity(change: &Change) -> DMatrix<f64> {
    let size = change.by_state.nrows();
    &change.by_state - DMatrix::identity(size, size)
}

/// A derivative in units of the `scale`.
pub(super) fn scaled(matrix: &DMatrix<f64>, scale: &DVector<f64>) -> DMatrix<f64> {
    DMatrix::from_fn(matrix.nrows(), matrix.ncols(), |row, column| matrix[(row, column)] * scale[column] / scale[row])
}

/// The state of `point` moved by `step`, or by a part of it that leaves the ball between the membranes. None if no part does.
pub(super) fn inside(flow: Flow<'_>, point: &Point, mut step: State) -> Option<State> {
    let half = flow.problem().at(point.value).travel() / 2.0;
    for _ in 0..8 {
        let moved = &point.state + &step;
        if moved[0].abs() < half {
            return Some(moved);
        }
        step *= 0.5;
    }
    None
}

/// The smallest part of `period` after which the motion has come back.
fn shortest(flow: Flow<'_>, point: &Point, period: u32) -> Result<u32, ModelError> {
    let scale = flow.scale(point.value);
    for part in (1..period).filter(|part| period.is_multiple_of(*part)) {
        let end = flow.after(point, f64::from(part), |_| {})?;
        if (end - &point.state).component_div(&scale).norm() < SAME {
            return Ok(part);
        }
    }
    Ok(period)
}
