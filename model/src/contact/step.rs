//! One internal step of a contact: x and x' as series in time, by collocation.

use super::law::{Law, Phase};
use super::point::Point;
use crate::numerics::chebyshev::{DEGREE, GRID, NODES, Series, Values};

/// Error of the velocity that a step may make, relative to the velocity.
const TOLERANCE: f64 = 1e-13;

/// The velocity that counts is at least this fraction of what the forces alone would change: where they balance, nothing
/// is gained by resolving their rounding.
const FLOOR: f64 = 1e-2;

/// Work on the ball since the start of a step, J.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Work {
    /// Of the wall, with its own velocity.
    pub(crate) wall: f64,
    /// Of the Maxwell force, along x.
    pub(crate) electrical: f64,
}

/// The motion between two times.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Step {
    start: f64,
    pub(super) length: f64,
    pub(super) deflection: Series,
    pub(super) rate: Series,
    /// While held: the push, m/s^2, that the membrane balances.
    pub(super) push: Series,
    wall: Series,
    electrical: Series,
    /// Length to try next.
    pub(super) proposal: f64,
}

/// A step that is too long.
pub(super) struct TooLong {
    /// Length to try instead.
    pub(super) proposal: f64,
}

impl Step {
    /// The step of `length`, s, from `from`.
    pub(super) fn new(law: &Law<'_>, phase: Phase, from: &Point, length: f64) -> Result<Self, TooLong> {
        let half = 0.5 * length;
        let elapsed = GRID.nodes.map(|node| half * (1.0 + node));
        let rubbing = phase.direction() * law.deceleration();
        let pushes = elapsed.map(|elapsed| law.push(from.time, elapsed) - rubbing);
        let at_nodes = |f: &dyn Fn(usize) -> f64| -> Values { core::array::from_fn(f) };
        let (x, deflection, rate, push) = if phase.is_at_rest() {
            let push = at_nodes(&|j| pushes[j] + law.maxwell(from.time, elapsed[j], from.x) / law.mass());
            ([from.x; NODES], Series::constant(from.x), Series::default(), GRID.fit(&push))
        } else {
            let x = collocate(law, phase, from, half, &pushes).ok_or(TooLong { proposal: 0.3 * length })?;
            let acceleration =
                GRID.fit(&at_nodes(&|j| acceleration(law, phase, from.time, elapsed[j], x[j], pushes[j])));
            let rate = acceleration.integral(half, from.v);
            (x, rate.integral(half, from.x), rate, acceleration)
        };
        let v = GRID.nodes.map(|node| rate.value(node));
        let maxwell = at_nodes(&|j| law.maxwell(from.time, elapsed[j], x[j]));
        let spring = at_nodes(&|j| law.spring(phase, x[j]));
        // What the wall, membrane included, does to the ball in the ball's direction of z.
        let force = at_nodes(&|j| match phase {
            Phase::Held | Phase::Stuck => law.mass() * pushes[j],
            _ => spring[j] - maxwell[j] + law.friction(phase),
        });
        let wall_velocity = at_nodes(&|j| {
            let time = from.time + elapsed[j];
            law.cylinder.at(time).velocity + law.recoil(time, x[j], v[j]).velocity
        });
        let largest = |values: &Values| values.iter().fold(0.0_f64, |max, value| max.max(value.abs()));
        let forces = law.push_size(from.time, length) + (largest(&spring) + largest(&maxwell)) / law.mass();
        let scale = largest(&v) + FLOOR * length * forces;
        let error = length * push.tail() / DEGREE as f64 / scale.max(f64::MIN_POSITIVE);
        if !error.is_finite() {
            return Err(TooLong { proposal: 0.3 * length }); // forces overflow
        }
        let proposal =
            length * (0.9 * (TOLERANCE / error.max(f64::MIN_POSITIVE)).powf(1.0 / DEGREE as f64)).clamp(0.2, 4.0);
        if error > TOLERANCE {
            return Err(TooLong { proposal });
        }
        let sign = law.side.sign();
        let wall = GRID.fit(&at_nodes(&|j| sign * force[j] * wall_velocity[j])).integral(half, 0.0);
        let electrical = GRID.fit(&at_nodes(&|j| maxwell[j] * v[j])).integral(half, 0.0);
        Ok(Self { start: from.time, length, deflection, rate, push, wall, electrical, proposal })
    }

    pub(super) fn end(&self) -> f64 {
        self.start + self.length
    }

    /// Place in [-1, 1] of `time`, s.
    fn place(&self, time: f64) -> f64 {
        (2.0 * (time - self.start) / self.length - 1.0).clamp(-1.0, 1.0)
    }

    /// Time, s, of a place in [-1, 1].
    pub(super) fn time(&self, place: f64) -> f64 {
        self.start + 0.5 * self.length * (1.0 + place)
    }

    pub(super) fn at(&self, time: f64) -> Point {
        let place = self.place(time);
        Point { time, x: self.deflection.value(place), v: self.rate.value(place) }
    }

    pub(super) fn work(&self, time: f64) -> Work {
        let place = self.place(time);
        Work { wall: self.wall.value(place), electrical: self.electrical.value(place) }
    }
}

/// x'' of a moving ball, m/s^2.
fn acceleration(law: &Law<'_>, phase: Phase, time: f64, elapsed: f64, x: f64, push: f64) -> f64 {
    push - (law.spring(phase, x) - law.maxwell(time, elapsed, x)) / law.mass()
}

/// x at the nodes: Picard's iteration, which gains a factor (omega h)^2 / (2k)^2 in its k-th round.
fn collocate(law: &Law<'_>, phase: Phase, from: &Point, half: f64, pushes: &Values) -> Option<Values> {
    const MAX_ROUNDS: u32 = 16;
    let elapsed = GRID.nodes.map(|node| half * (1.0 + node));
    let straight = elapsed.map(|elapsed| from.x + from.v * elapsed);
    let mut x = straight;
    for _ in 0..MAX_ROUNDS {
        let a: Values = core::array::from_fn(|j| acceleration(law, phase, from.time, elapsed[j], x[j], pushes[j]));
        let mut change: f64 = 0.0;
        let mut size: f64 = 0.0;
        for (j, row) in GRID.double_integral.iter().enumerate() {
            let integral: f64 = row.iter().zip(&a).map(|(weight, a)| weight * a).sum();
            let next = straight[j] + half * half * integral;
            change = change.max((next - x[j]).abs());
            size = size.max(next.abs());
            x[j] = next;
        }
        // Overflowing forces can cancel to NaN, which no maximum shows.
        if !x.iter().all(|x| x.is_finite()) {
            return None;
        }
        if change <= 4.0 * f64::EPSILON * size {
            return Some(x);
        }
    }
    None
}
