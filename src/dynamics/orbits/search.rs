//! Search for periodic orbits at one value of the parameter: from motions that have settled, from near returns of those that do not,
//! and from starts at random, so that unstable orbits are found, too.

use std::f64::consts::TAU;

use fastrand::Rng;
use videg_model::ModelError;

use super::cycle::Cycle;
use super::flow::{Flow, Point, State};
use super::orbit::Orbit;
use crate::dynamics::DynamicsError;
use crate::progress::Progress;
use crate::threads;

/// How orbits are searched for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Search {
    /// Largest period, in periods of the excitation.
    pub periods: u32,
    /// Starts at random for orbits of one period; for longer ones fewer.
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
/// Motions from starts at random that are let settle.
const SETTLED: usize = 6;
/// Near returns that are tried for each period.
const NEAR: usize = 4;

/// One attempt of a search.
#[derive(Debug, Clone, Copy)]
enum Attempt {
    /// From where the motion from the start of the case has settled.
    Own,
    /// The same of a start at random.
    Settled,
    /// From a state at random, for an orbit of this period.
    Random(u32),
}

impl Search {
    /// The orbits where the parameter has this `value`: by period, number of impacts and their order.
    ///
    /// # Errors
    /// Parameters out of their bounds.
    pub fn at(&self, flow: Flow<'_>, value: f64) -> Result<Vec<Orbit>, ModelError> {
        flow.problem().at(value).validate()?;
        let attempts = self.attempts().into_iter().enumerate();
        Ok(self.merged(flow, attempts.map(|(number, attempt)| self.found(flow, value, number, attempt)).collect()))
    }

    /// The same on all cores.
    ///
    /// # Errors
    /// Parameters out of their bounds; stopped by the observer.
    pub fn at_on_all_cores(
        &self,
        flow: Flow<'_>,
        value: f64,
        observer: &dyn Progress,
    ) -> Result<Vec<Orbit>, DynamicsError> {
        flow.problem().at(value).validate()?;
        let attempts: Vec<_> = self.attempts().into_iter().enumerate().collect();
        let found = threads::map(&attempts, observer, |(number, attempt)| {
            if observer.is_stopped() {
                Err(DynamicsError::Stopped)
            } else {
                Ok(self.found(flow, value, *number, *attempt))
            }
        })?;
        Ok(self.merged(flow, found))
    }

    /// Long periods take more work, so that they get fewer starts.
    fn attempts(&self) -> Vec<Attempt> {
        let random = (1..=self.periods)
            .flat_map(|period| std::iter::repeat_n(Attempt::Random(period), self.starts.div_ceil(period) as usize));
        std::iter::once(Attempt::Own).chain([Attempt::Settled; SETTLED]).chain(random).collect()
    }

    /// What an attempt of this `number` finds.
    fn found(&self, flow: Flow<'_>, value: f64, number: usize, attempt: Attempt) -> Vec<Orbit> {
        let mut rng = Rng::with_seed(self.seed.wrapping_mul(0x9e37_79b9_7f4a_7c15).wrapping_add(number as u64));
        let at = |phase: f64, state: State| Point { value, phase, state };
        let start = match attempt {
            Attempt::Random(period) => {
                let guess = at(PHASE, random_state(flow, value, &mut rng));
                return Orbit::find(flow, &guess, period).into_iter().collect();
            }
            Attempt::Own => at(0.0, own_state(flow, value)),
            Attempt::Settled => at(PHASE, random_state(flow, value, &mut rng)),
        };
        let phase = start.phase;
        // A motion that cannot be followed, for its many events, leads nowhere.
        let states = Self::settle(flow, start).unwrap_or_default();
        let returns = self.returns(flow, value, &states).into_iter();
        returns
            .filter_map(|(state, period)| Orbit::find(flow, &in_flight(flow, at(phase, state), period), period))
            .collect()
    }

    /// Each orbit once, in order.
    fn merged(&self, flow: Flow<'_>, found: Vec<Vec<Orbit>>) -> Vec<Orbit> {
        let mut orbits: Vec<Orbit> = Vec::new();
        for orbit in found.into_iter().flatten().filter(|orbit| orbit.period <= self.periods) {
            if !orbits.iter().any(|other| other.is_same(&orbit, flow)) {
                orbits.push(orbit);
            }
        }
        orbits.sort_by(|a, b| key(a).partial_cmp(&key(b)).unwrap_or(std::cmp::Ordering::Equal));
        orbits
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
    match Cycle::along(flow, &point, period) {
        Ok(Some(Cycle { middle: (elapsed, state), .. })) => {
            Point { phase: (point.phase + elapsed) % 1.0, state, ..point }
        }
        _ => point,
    }
}

/// The state at the start of the case; a ball beyond a membrane is put on it.
fn own_state(flow: Flow<'_>, value: f64) -> State {
    let p = flow.problem().at(value);
    let half = p.travel() / 2.0;
    let displacement = (p.cylinder_position - p.ball_position).clamp(-half, half);
    let cylinder = [p.cylinder_position, p.cylinder_velocity];
    flow.state_of([displacement, p.cylinder_velocity - p.ball_velocity], cylinder)
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
