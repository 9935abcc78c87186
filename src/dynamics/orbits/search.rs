//! Search for periodic orbits at one value of the parameter: from motions that have settled, from near returns of those that do not,
//! and from starts at random, so that unstable orbits are found, too.

use std::f64::consts::TAU;

use fastrand::Rng;
use videg_model::ModelError;

use super::flow::{Flow, Point, State};
use super::orbit::Orbit;
use super::survey::Survey;

/// How orbits are searched for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Search {
    /// Largest period, in periods of the excitation.
    pub periods: u32,
    /// Starts at random, for each period.
    pub starts: u32,
    /// Seed of these.
    pub seed: u64,
}

impl Default for Search {
    fn default() -> Self {
        Self { periods: 4, starts: 24, seed: 1 }
    }
}

/// A phase at which nothing happens in the orbits of simple numbers.
const PHASE: f64 = 0.237_1;
/// Periods until a motion has settled, and periods that it is then looked at.
const TRANSIENT: u32 = 200;
const TAKEN: u32 = 200;
/// Distance, in units of the scale, within which a motion comes back.
const RETURNS: f64 = 1e-4;
/// Motions that are let settle.
const SETTLED: u32 = 6;
/// Near returns that are tried for each period.
const NEAR: usize = 4;

impl Search {
    /// The orbits where the parameter has this `value`: by period, number of impacts and their order.
    ///
    /// # Errors
    /// Parameters out of their bounds.
    pub fn at(&self, flow: Flow<'_>, value: f64) -> Result<Vec<Orbit>, ModelError> {
        flow.problem().at(value).validate()?;
        let mut rng = Rng::with_seed(self.seed);
        let mut found = Vec::new();
        let mut add = |guess: &Point, period: u32| {
            if let Some(orbit) = Orbit::find(flow, guess, period)
                && !found.iter().any(|other: &Orbit| other.is_same(&orbit, flow))
            {
                found.push(orbit);
            }
        };
        let at = |state: State| Point { value, phase: PHASE, state };
        let starts: Vec<State> = (0..SETTLED).map(|_| random_state(flow, value, &mut rng)).collect();
        for start in starts {
            // A motion that cannot be followed, for its many events, leads nowhere.
            let Ok(states) = Self::settle(flow, at(start)) else { continue };
            for (state, period) in self.returns(flow, value, &states) {
                add(&in_flight(flow, at(state), period), period);
            }
        }
        for period in 1..=self.periods {
            for _ in 0..self.starts {
                add(&at(random_state(flow, value, &mut rng)), period);
            }
        }
        found.retain(|orbit| orbit.period <= self.periods);
        found.sort_by(|a, b| key(a).partial_cmp(&key(b)).unwrap_or(std::cmp::Ordering::Equal));
        Ok(found)
    }

    /// States once a period, when the motion from `start` has settled.
    fn settle(flow: Flow<'_>, start: Point) -> Result<Vec<State>, ModelError> {
        let mut point = start;
        let mut states = Vec::new();
        for k in 0..TRANSIENT + TAKEN {
            point.state = flow.after(&point, 1.0, |_| {})?;
            if k >= TRANSIENT {
                states.push(point.state.clone());
            }
        }
        Ok(states)
    }

    /// States that come back, and after how many periods: of a motion that has settled the last one, of another those that come
    /// nearest.
    fn returns(&self, flow: Flow<'_>, value: f64, states: &[State]) -> Vec<(State, u32)> {
        let scale = flow.scale(value);
        let apart = |k: usize, period: u32| {
            let other = states.get(k + period as usize)?;
            Some((other - &states[k]).component_div(&scale).norm())
        };
        let last = states.len().saturating_sub(1);
        let settled = (1..=self.periods).find(|period| {
            last.checked_sub(*period as usize).and_then(|k| apart(k, *period)).is_some_and(|apart| apart < RETURNS)
        });
        if let Some(period) = settled {
            return states.last().map(|state| (state.clone(), period)).into_iter().collect();
        }
        let nearest = |period: u32| {
            let mut all: Vec<_> = (0..states.len()).filter_map(|k| apart(k, period).map(|apart| (apart, k))).collect();
            all.sort_by(|a, b| a.0.total_cmp(&b.0));
            all.into_iter().take(NEAR).map(move |(_, k)| (states[k].clone(), period))
        };
        (1..=self.periods).flat_map(nearest).collect()
    }
}

/// The motion through `point` in the middle of its longest flight: Newton's method cannot begin where the ball rests.
fn in_flight(flow: Flow<'_>, point: Point, period: u32) -> Point {
    match Survey::along(flow, &point, period) {
        Ok(Some(Survey { middle: (elapsed, state), .. })) => {
            Point { phase: (point.phase + elapsed) % 1.0, state, ..point }
        }
        _ => point,
    }
}

/// A state somewhere between the membranes, as fast as the excitation and the travel make typical.
fn random_state(flow: Flow<'_>, value: f64, rng: &mut Rng) -> State {
    let (p, scale) = (flow.problem().at(value), flow.scale(value));
    let omega = TAU * p.frequency;
    let swing = p.harmonic_acceleration() / (omega * omega);
    let mut about = |size: f64| size * (2.0 * rng.f64() - 1.0);
    let (length, rate) = (scale[0], 2.0 * (scale[1] + omega * swing));
    flow.state_of([about(0.99 * length), about(rate)], [about(2.0 * swing), about(2.0 * omega * swing)])
}

/// Order of orbits in lists.
fn key(orbit: &Orbit) -> (u32, usize, String, f64) {
    let [left, right] = orbit.pattern.counts();
    let first = orbit.flashes.first().map_or(f64::NAN, |flash| flash[0]);
    (orbit.period, left + right, orbit.pattern.letters().to_owned(), first)
}
