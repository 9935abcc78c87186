//! The states of a contact at the nodes of a step, by collocation.

use super::law::{Law, Phase};
use super::point::{Point, Recoil};
use crate::membrane::viscosity::{Strained, Viscosity};
use crate::numerics::chebyshev::{DEGREE, GRID, NODES, Values};

/// What is integrated, at the nodes.
#[derive(Clone, Copy)]
pub(super) struct States {
    /// x, m.
    pub(super) x: Values,
    /// What the contact adds to the cylinder's position, m, and velocity, m/s, if it is a motion of its own.
    recoil: [Values; 2],
    /// The creep of a viscous film.
    pub(super) creep: Values,
}

/// What acts at the nodes, besides what follows from the states.
pub(super) struct Given<'a> {
    pub(super) law: &'a Law<'a>,
    pub(super) phase: Phase,
    /// Begin of the step, s.
    pub(super) start: f64,
    /// Time since then, s.
    pub(super) elapsed: Values,
    /// x'' without membrane, voltage and recoil, m/s^2.
    pushes: Values,
    /// Whether the recoil is a motion of its own.
    pub(super) recoils: bool,
    pub(super) viscosity: Option<&'a Viscosity>,
}

/// Forces of membrane, outwards, and voltage, inwards, on a ball that moves, N.
pub(super) struct Forces {
    pub(super) spring: Values,
    pub(super) maxwell: Values,
    /// Rate of the creep, 1/s, how fast it recovers, 1/s, and power that is lost in a viscous film, W.
    pub(super) flow: Values,
    pub(super) recovery: Values,
    pub(super) loss: Values,
}

/// One value for each node.
pub(super) fn at_nodes(f: impl FnMut(usize) -> f64) -> Values {
    core::array::from_fn(f)
}

impl States {
    pub(super) fn recoil(&self, j: usize) -> Recoil {
        Recoil { position: self.recoil[0][j], velocity: self.recoil[1][j] }
    }

    /// Largest change since `before`, and largest size, m, of a step of this `length`, s.
    fn distance(&self, before: &Self, length: f64) -> [f64; 2] {
        let ([position, velocity], [place, speed]) = (&self.recoil, &before.recoil);
        let pairs = [(&self.x, &before.x, 1.0), (position, place, 1.0), (velocity, speed, length)];
        let [mut change, mut size] = [0.0_f64; 2];
        for (values, before, unit) in pairs {
            for (value, before) in values.iter().zip(before) {
                change = change.max(unit * (value - before).abs());
                size = size.max(unit * value.abs());
            }
        }
        [change, size]
    }

    /// Largest change of the creep since `before`.
    fn change_of_creep(&self, before: &Self) -> f64 {
        self.creep.iter().zip(&before.creep).fold(0.0, |most, (value, before)| most.max((value - before).abs()))
    }

    fn is_finite(&self) -> bool {
        self.x.iter().chain(self.recoil.as_flattened()).chain(&self.creep).all(|value| value.is_finite())
    }
}

impl<'a> Given<'a> {
    /// What is given for a step of length 2 `half`, s, from `start`, s.
    pub(super) fn new(law: &'a Law<'a>, phase: Phase, start: f64, half: f64) -> Self {
        let elapsed = GRID.nodes.map(|node| half * (1.0 + node));
        let rubbing = phase.direction() * law.deceleration();
        let pushes = elapsed.map(|elapsed| law.push(start, elapsed) - rubbing);
        let (recoils, viscosity) = (law.recoils(), law.membrane.viscosity.as_ref());
        Self { law, phase, start, elapsed, pushes, recoils, viscosity }
    }

    pub(super) fn forces(&self, states: &States) -> Forces {
        let maxwell = at_nodes(|j| self.law.maxwell(self.start, self.elapsed[j], states.x[j]));
        let Some(viscosity) = self.viscosity else {
            let spring = at_nodes(|j| self.law.spring(self.phase, states.x[j]));
            let [flow, recovery, loss] = [[0.0; NODES]; 3];
            return Forces { spring, maxwell, flow, recovery, loss };
        };
        let films: [Strained; NODES] =
            core::array::from_fn(|j| self.law.membrane.strained(viscosity, states.x[j], states.creep[j]));
        Forces {
            spring: films.map(|film| film.force),
            maxwell,
            flow: films.map(|film| film.flow),
            recovery: films.map(|film| film.recovery),
            loss: films.map(|film| film.loss),
        }
    }

    /// x'' that free bodies would have, m/s^2, on a mount that acts against the recoil.
    fn push(&self, states: &States, j: usize) -> f64 {
        if self.recoils { self.pushes[j] + self.law.yielding(&states.recoil(j)) } else { self.pushes[j] }
    }

    /// What the wall, membrane included, does to the ball, N, outwards.
    pub(super) fn force(&self, states: &States, forces: &Forces, j: usize) -> f64 {
        if self.phase.is_at_rest() {
            self.law.mass() * self.push(states, j)
        } else {
            forces.spring[j] - forces.maxwell[j] + self.law.friction(self.phase)
        }
    }

    /// x'' of a ball that moves, m/s^2; of one at rest, what the membrane balances.
    pub(super) fn acceleration(&self, states: &States, forces: &Forces, j: usize) -> f64 {
        let spring = if self.phase.is_at_rest() { 0.0 } else { forces.spring[j] };
        self.push(states, j) - (spring - forces.maxwell[j]) / self.law.mass()
    }

    /// Acceleration of the recoil, m/s^2.
    pub(super) fn recoil_acceleration(&self, states: &States, forces: &Forces, j: usize) -> f64 {
        self.law.recoil_acceleration(&states.recoil(j), self.force(states, forces, j))
    }

    /// The states at the nodes of a step of length 2 `half`, s: Picard's iteration, which gains a factor (omega h)^2 / (2k)^2 in its
    /// k-th round. The creep may be much faster than the step is long: it is found by Newton's method with the rate of the first node.
    pub(super) fn collocate(&self, from: &Point, half: f64) -> Option<States> {
        const MAX_ROUNDS: u32 = 16;
        let rate = if self.phase.is_at_rest() { 0.0 } else { from.v };
        let mut states = States {
            x: self.elapsed.map(|elapsed| from.x + rate * elapsed),
            recoil: [
                self.elapsed.map(|elapsed| from.recoil.position + from.recoil.velocity * elapsed),
                [from.recoil.velocity; NODES],
            ],
            creep: [from.creep; NODES],
        };
        let moves = !self.phase.is_at_rest();
        if !moves && !self.recoils && self.viscosity.is_none() {
            return Some(states);
        }
        let straight = states;
        let mut implicit = None;
        for _ in 0..MAX_ROUNDS {
            let (forces, mut next) = (self.forces(&states), straight);
            if moves {
                let acceleration = at_nodes(|j| self.acceleration(&states, &forces, j));
                add_integral(&mut next.x, &GRID.double_integral, half * half, &acceleration);
            }
            if self.recoils {
                let acceleration = at_nodes(|j| self.recoil_acceleration(&states, &forces, j));
                let [position, velocity] = &mut next.recoil;
                add_integral(position, &GRID.double_integral, half * half, &acceleration);
                add_integral(velocity, &GRID.integral, half, &acceleration);
            }
            if self.viscosity.is_some() {
                let solver = implicit.get_or_insert_with(|| GRID.relaxing(half * forces.recovery[DEGREE]));
                add_integral(&mut next.creep, &GRID.integral, half, &forces.flow);
                let missing = at_nodes(|j| next.creep[j] - states.creep[j]);
                next.creep = states.creep;
                add_integral(&mut next.creep, solver, 1.0, &missing);
            }
            let (change, creep) = (next.distance(&states, 2.0 * half), next.change_of_creep(&states));
            let strained = if self.viscosity.is_some() { self.strain(&next) } else { 0.0 };
            states = next;
            // Overflowing forces can cancel to NaN, which no maximum shows. The force of a film is none beyond its limit.
            let deepest = self.law.membrane.deepest();
            if !states.is_finite() || states.x.iter().any(|x| *x >= deepest) {
                return None;
            }
            if change[0] <= 4.0 * f64::EPSILON * change[1] && creep <= 16.0 * f64::EPSILON * strained {
                return Some(states);
            }
        }
        None
    }

    /// Size of the logarithmic strains of a viscous film.
    pub(super) fn strain(&self, states: &States) -> f64 {
        let deepest = states.x.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        states.creep.iter().fold(self.law.membrane.strain(deepest), |most, creep| most.max(creep.abs()))
    }
}

/// Adds the integral of a function with these values by the `matrix` for [-1, 1], `scale` times as long.
fn add_integral(sums: &mut Values, matrix: &[Values; NODES], scale: f64, values: &Values) {
    for (sum, row) in sums.iter_mut().zip(matrix) {
        let integral: f64 = row.iter().zip(values).map(|(weight, value)| weight * value).sum();
        *sum += scale * integral;
    }
}
