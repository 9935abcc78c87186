//! One internal step of a contact: its states as series in time.

use super::collocation::{Forces, Given, at_nodes};
use super::law::{Law, Phase};
use super::point::{Point, Recoil};
use crate::numerics::chebyshev::{DEGREE, GRID, Series, Values};

/// Error of the velocity that a step may make, relative to the velocity.
const TOLERANCE: f64 = 1e-13;

/// The velocity that counts is at least this fraction of what the forces alone would change: where they balance, nothing
/// is gained by resolving their rounding.
const FLOOR: f64 = 1e-2;

/// Works since the start of a step, J.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Work {
    /// Of the wall, with its own velocity.
    pub(crate) wall: f64,
    /// Of the Maxwell force, along x.
    pub(crate) electrical: f64,
    /// Taken by the mount's damper because of the contact.
    pub(crate) damping: f64,
    /// Lost in the viscous film.
    pub(crate) viscous: f64,
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
    /// What the contact adds to the position, m, and velocity, m/s, of a suspended cylinder.
    recoil: [Series; 2],
    /// The creep of a viscous film, and while a ball is at rest on it, its force over the mass, m/s^2.
    creep: Series,
    pub(super) relaxing: Option<Series>,
    wall: Series,
    electrical: Series,
    damping: Series,
    viscous: Series,
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
        let given = Given::new(law, phase, from.time, half);
        let states = given.collocate(from, half).ok_or(TooLong { proposal: 0.3 * length })?;
        let forces = given.forces(&states);
        let push = GRID.fit(&at_nodes(|j| given.acceleration(&states, &forces, j)));
        let rate = if phase.is_at_rest() { Series::default() } else { push.integral(half, from.v) };
        let deflection = rate.integral(half, from.x);
        let recoil = if given.recoils {
            let acceleration = GRID.fit(&at_nodes(|j| given.recoil_acceleration(&states, &forces, j)));
            let velocity = acceleration.integral(half, from.recoil.velocity);
            [velocity.integral(half, from.recoil.position), velocity]
        } else {
            [Series::default(); 2]
        };
        let is_viscous = given.viscosity.is_some();
        let flow = if is_viscous { GRID.fit(&forces.flow) } else { Series::default() };
        let creep = if is_viscous { GRID.fit(&states.creep) } else { Series::default() };
        let v = GRID.nodes.map(|node| rate.value(node));
        let recoils = at_nodes(|j| {
            let point = Point {
                time: from.time + given.elapsed[j],
                x: states.x[j],
                v: v[j],
                recoil: states.recoil(j),
                creep: 0.0,
            };
            law.recoil(&point).velocity
        });
        let wall_velocity = at_nodes(|j| law.cylinder.at(from.time + given.elapsed[j]).velocity + recoils[j]);
        let largest = |values: &Values| values.iter().fold(0.0_f64, |max, value| max.max(value.abs()));
        let Forces { spring, maxwell, .. } = &forces;
        let rounding = law.membrane.magnified_rounding(largest(&states.x));
        let yielding =
            if given.recoils { largest(&at_nodes(|j| law.size_of_yielding(&states.recoil(j)))) } else { 0.0 };
        let pushed = law.push_size(from.time, length) + yielding;
        let size = pushed + (rounding * largest(spring) + largest(maxwell)) / law.mass();
        let scale = largest(&v) + FLOOR * length * size;
        let mut error = length * push.tail() / DEGREE as f64 / scale.max(f64::MIN_POSITIVE);
        if is_viscous {
            // What flows in faster than the film relaxes is gone again.
            let lasting = length / (1.0 + length * forces.recovery[DEGREE]);
            let strain = given.strain(&states).max(f64::MIN_POSITIVE);
            error = error.max(lasting * flow.tail() / DEGREE as f64 / strain);
        }
        if !error.is_finite() {
            return Err(TooLong { proposal: 0.3 * length }); // forces overflow
        }
        let proposal =
            length * (0.9 * (TOLERANCE / error.max(f64::MIN_POSITIVE)).powf(1.0 / DEGREE as f64)).clamp(0.2, 4.0);
        if error > TOLERANCE {
            return Err(TooLong { proposal });
        }
        let sign = law.side.sign();
        let integral = |values: Values| GRID.fit(&values).integral(half, 0.0);
        let wall = integral(at_nodes(|j| sign * given.force(&states, &forces, j) * wall_velocity[j]));
        let electrical = integral(at_nodes(|j| maxwell[j] * v[j]));
        let damping = if given.recoils {
            integral(at_nodes(|j| law.damping_power(recoils[j], wall_velocity[j])))
        } else {
            Series::default()
        };
        let viscous = if is_viscous { integral(forces.loss) } else { Series::default() };
        let at_rest = is_viscous && phase.is_at_rest();
        let relaxing = at_rest.then(|| GRID.fit(&spring.map(|force| force / law.mass())));
        let start = from.time;
        Ok(Self {
            start,
            length,
            deflection,
            rate,
            push,
            recoil,
            creep,
            relaxing,
            wall,
            electrical,
            damping,
            viscous,
            proposal,
        })
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
        let [position, velocity] = self.recoil.map(|series| series.value(place));
        let recoil = Recoil { position, velocity };
        let [x, v, creep] = [&self.deflection, &self.rate, &self.creep].map(|series| series.value(place));
        Point { time, x, v, recoil, creep }
    }

    pub(super) fn work(&self, time: f64) -> Work {
        let place = self.place(time);
        let [wall, electrical, damping, viscous] =
            [&self.wall, &self.electrical, &self.damping, &self.viscous].map(|series| series.value(place));
        Work { wall, electrical, damping, viscous }
    }
}
