//! First-order changes of the books under the impulsive law. A value and its change go as a pair.

use super::{Energies, Harvester};
use crate::harvester::tangent::{Hit, bounded};

/// Changes of the sums in [`Ledger`](super::Ledger) that impacts and rests add to, J.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(in crate::harvester) struct LedgerChange {
    pub(in crate::harvester) wall: f64,
    pub(in crate::harvester) loss: f64,
}

/// Change of 1/2 m v^2.
fn kinetic([mass, mass_change]: [f64; 2], [velocity, change]: [f64; 2]) -> f64 {
    velocity * (mass * change + 0.5 * mass_change * velocity)
}

impl Harvester {
    /// Change of the kinetic energy of the ball at this velocity, m/s.
    pub(super) fn kinetic_change(&self, velocity: [f64; 2]) -> f64 {
        kinetic([self.parameters.ball_mass, self.tangent.ball_mass()], velocity)
    }

    /// Change of m v V: the work of a wall at velocity V, m/s, that gives the ball this velocity, m/s.
    fn work_change(&self, [velocity, change]: [f64; 2], [wall, wall_change]: [f64; 2]) -> f64 {
        let (mass, heavier) = (self.parameters.ball_mass, self.tangent.ball_mass());
        mass * (change * wall + velocity * wall_change) + heavier * velocity * wall
    }

    /// Changes of what an impact adds when its speed and the wall's velocity change by so much, m/s.
    pub(in crate::harvester) fn ledger_change(&self, hit: &Hit, speed_change: f64, wall_change: f64) -> LedgerChange {
        let (r, dr) = (self.parameters.restitution, self.tangent.restitution());
        let (speed, wall) = ([hit.speed, speed_change], [hit.wall.velocity, wall_change]);
        let jump = hit.side.sign() * (1.0 + r);
        let jump_change = jump * speed_change + hit.side.sign() * dr * hit.speed;
        LedgerChange {
            wall: bounded(self.work_change([jump * hit.speed, jump_change], wall)),
            loss: bounded((1.0 - r * r) * self.kinetic_change(speed) - 2.0 * r * dr * self.kinetic(hit.speed)),
        }
    }

    /// Changes of what the end of a `slip` against the `wall` adds, m/s.
    pub(super) fn change_by_settling(&mut self, slip: [f64; 2], wall: [f64; 2]) {
        self.tangent.ledger.wall -= bounded(self.work_change(slip, wall));
        self.tangent.ledger.loss += bounded(self.kinetic_change(slip));
    }

    /// Changes of [`Harvester::energies`]. Under the impulsive law membranes store nothing and the Maxwell force
    /// does no work.
    pub(in crate::harvester) fn energies_change(&self) -> Energies {
        let (p, LedgerChange { wall, loss }) = (&self.parameters, self.tangent.ledger);
        let [[_, ball_change], [_, cylinder_change]] = [self.ball_change(self.time), self.cylinder_change(self.time)];
        let ball = self.kinetic_change([self.ball_velocity(), ball_change]);
        let mass = [p.cylinder_mass, self.tangent.cylinder_mass()];
        let cylinder = kinetic(mass, [self.cylinder_velocity(), cylinder_change]);
        let at_start = kinetic(mass, [p.cylinder_velocity, self.tangent.initial_velocity()]);
        Energies {
            ball,
            cylinder,
            impact_loss: loss,
            excitation: cylinder - at_start,
            wall: wall + if self.ball.resting.is_some() { ball } else { 0.0 },
            ..Energies::default()
        }
    }
}
