//! First-order changes of the ledger under the impulsive law. A value and its change go as a pair.

use super::{Tangent, Tangential, bounded};
use crate::accounting::ledger::Energies;

/// Change of 1/2 m v^2.
pub(super) fn kinetic([mass, mass_change]: [f64; 2], [velocity, change]: [f64; 2]) -> f64 {
    velocity * (mass * change + 0.5 * mass_change * velocity)
}

/// Change of m v V: the work of a wall at velocity V, m/s, that gives the ball this velocity, m/s.
pub(super) fn work([mass, heavier]: [f64; 2], [velocity, change]: [f64; 2], [wall, wall_change]: [f64; 2]) -> f64 {
    mass * (change * wall + velocity * wall_change) + heavier * velocity * wall
}

impl Tangent {
    /// The ball's mass and its change.
    pub(super) fn ball_mass(&self, ball_mass: f64) -> [f64; 2] {
        [ball_mass, self.of(|change| change.of.ball_mass)]
    }

    /// The wall begins to carry the ball at this velocity, m/s, when the work of gravity on it changes by `gravity`, J.
    pub fn rest(&mut self, ball_mass: f64, wall: [f64; 2], gravity: f64) {
        self.changes.wall -= kinetic(self.ball_mass(ball_mass), wall) - gravity;
    }

    /// The wall lets the ball go at this velocity, m/s, likewise.
    pub fn release(&mut self, ball_mass: f64, velocity: [f64; 2], gravity: f64) {
        self.changes.wall += kinetic(self.ball_mass(ball_mass), velocity) - gravity;
    }

    /// A `slip` against the `wall` ends, m/s.
    pub fn settle(&mut self, ball_mass: f64, slip: [f64; 2], wall: [f64; 2]) {
        let mass = self.ball_mass(ball_mass);
        self.changes.wall -= bounded(work(mass, slip, wall));
        self.changes.loss += bounded(kinetic(mass, slip));
    }
}

impl Tangential<'_> {
    /// Change of the work of gravity on the ball up to `time`, s.
    pub fn gravity_change(&self, time: f64) -> f64 {
        let (p, tangent, incline) = (self.parameters, self.tangent, self.motion.mount.incline);
        let [mass, heavier] = tangent.ball_mass(p.ball_mass);
        let way = self.motion.ball_position_at(time) - p.initial_ball_position();
        let [position, _] = self.ball_change(time);
        let way_change = position - tangent.of(|change| change.start);
        -(mass * incline * way_change + (mass * tangent.incline() + heavier * incline) * way)
    }

    /// Changes of the energies at `time`, s. Under the impulsive law membranes store nothing and the Maxwell force does no
    /// work.
    pub fn energies_change(&self, time: f64) -> Energies {
        let (p, tangent, motion) = (self.parameters, self.tangent, self.motion);
        let [[_, ball_change], [_, cylinder_change]] = [self.ball_change(time), self.cylinder_change(time)];
        let ball = kinetic(tangent.ball_mass(p.ball_mass), [motion.ball_velocity_at(time), ball_change]);
        let mass = [p.cylinder_mass, tangent.of(|change| change.of.cylinder_mass)];
        let cylinder = kinetic(mass, [motion.cylinder_velocity_at(time), cylinder_change]);
        let at_start = kinetic(mass, [p.cylinder_velocity, tangent.of(|change| change.of.cylinder_velocity)]);
        let gravity = self.gravity_change(time);
        Energies {
            ball,
            cylinder,
            gravity,
            impact_loss: tangent.changes.loss,
            excitation: cylinder - at_start,
            wall: tangent.changes.wall + if motion.ball.support().is_some() { ball - gravity } else { 0.0 },
            ..Energies::default()
        }
    }
}
