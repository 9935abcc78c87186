//! First-order changes of the ledger under the impulsive law. A value and its change go as a pair.

use super::{Tangent, Tangential, bounded};
use crate::accounting::ledger::Energies;

/// Change of 1/2 m v^2.
pub(super) fn kinetic([mass, mass_change]: [f64; 2], [velocity, change]: [f64; 2]) -> f64 {
    velocity * (mass * change + 0.5 * mass_change * velocity)
}

impl Tangent {
    /// The ball's mass and its change.
    pub(super) fn ball_mass(&self, ball_mass: f64) -> [f64; 2] {
        [ball_mass, self.of(|change| change.of.ball_mass)]
    }

    /// A `slip` against the wall ends, m/s.
    pub fn settle(&mut self, ball_mass: f64, slip: [f64; 2]) {
        self.changes.loss += bounded(kinetic(self.ball_mass(ball_mass), slip));
    }
}

impl Tangential<'_> {
    /// Change of the work of gravity on the ball up to `time`, s.
    fn gravity_change(&self, time: f64) -> f64 {
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
        let speed = [p.ball_velocity, tangent.of(|change| change.of.ball_velocity)];
        let ball_at_start = tangent.of(|change| kinetic([p.ball_mass, change.of.ball_mass], speed));
        Energies {
            ball,
            cylinder,
            gravity,
            impact_loss: tangent.changes.loss,
            excitation: cylinder - at_start,
            // What the balance of the ball leaves.
            wall: (ball - ball_at_start) + tangent.changes.loss - gravity,
            ..Energies::default()
        }
    }
}
