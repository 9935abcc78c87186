//! The books of the mechanical energy.
//!
//! For the ball, from any time to any other: kinetic + elastic + impact loss = what they were + wall + electrical. For the
//! cylinder: kinetic = what it was + excitation, minus the work of the wall if there is reaction.

mod change;

pub(super) use self::change::LedgerChange;

use super::Harvester;
use crate::flight::Side;

/// Sums up to the last event.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Ledger {
    /// Work of the walls on the ball, J; while the ball rests under the impulsive law, less its kinetic energy.
    pub(super) wall: f64,
    /// Work of the Maxwell force on the ball, J.
    pub(super) electrical: f64,
    /// Energy lost in contacts that have ended, J.
    pub(super) loss: f64,
    /// Time in contact under the compliant law, s, of contacts that have ended.
    pub(super) contact_time: f64,
}

/// Mechanical energies and works since the start, J.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Energies {
    /// Kinetic energy of the ball in the laboratory frame.
    pub ball: f64,
    /// Kinetic energy of the cylinder in the laboratory frame.
    pub cylinder: f64,
    /// Energy that the membranes can give back; an impact that takes no time stores none.
    pub elastic: f64,
    /// Energy lost in the membranes.
    pub impact_loss: f64,
    /// Work of excitation and external force on the cylinder.
    pub excitation: f64,
    /// Work of the Maxwell force on the ball: the integral of 1/2 U^2 dC.
    pub electrical: f64,
    /// Work of the walls, membranes included, on the ball, with the walls' own velocity.
    pub wall: f64,
}

impl Harvester {
    /// Mechanical energies and works since the start.
    ///
    /// Wall, electrical and loss are integrals and sums on their own, from which the balance of the ball can be audited. The
    /// work of the excitation follows from the cylinder's kinetic energy.
    pub fn energies(&self) -> Energies {
        let p = &self.parameters;
        let (ball, Ledger { mut wall, mut electrical, loss, .. }) = (self.kinetic(self.ball_velocity()), self.ledger);
        let mut energies = Energies { impact_loss: loss, ..Energies::default() };
        if let Some(touch) = &self.touch {
            let (law, work) = (self.law(touch.side), touch.work(self.time));
            wall += work.wall;
            electrical += work.electrical;
            energies.elastic = law.elastic(touch.at(self.time).x);
            energies.impact_loss += law.loss(touch.largest_at(self.time));
        } else if self.ball.resting.is_some() {
            wall += ball;
        }
        let cylinder = |velocity: f64| 0.5 * p.cylinder_mass * velocity * velocity;
        let gained = cylinder(self.cylinder_velocity()) - cylinder(p.cylinder_velocity);
        Energies {
            ball,
            cylinder: cylinder(self.cylinder_velocity()),
            excitation: gained + if p.reaction { wall } else { 0.0 },
            electrical,
            wall,
            ..energies
        }
    }

    /// Time in contact since the start, s, under the compliant law; impacts of the impulsive law take none.
    pub fn contact_time(&self) -> f64 {
        self.ledger.contact_time + self.touch.as_ref().map_or(0.0, |touch| self.time - touch.since)
    }

    fn kinetic(&self, velocity: f64) -> f64 {
        0.5 * self.parameters.ball_mass * velocity * velocity
    }

    /// An impact at relative `speed`, m/s: the impulse m (1 + r) `speed` at the velocity of the `wall`, m/s.
    pub(super) fn book_impact(&mut self, side: Side, wall: f64, speed: f64) {
        let r = self.parameters.restitution;
        self.ledger.wall += self.parameters.ball_mass * side.sign() * (1.0 + r) * speed * wall;
        self.ledger.loss += (1.0 - r * r) * self.kinetic(speed);
    }

    /// The ball takes on the velocity of the `wall`, m/s. This, and how much faster the ball is, change by `changes`, m/s.
    pub(super) fn book_settling(&mut self, wall: f64, changes: [f64; 2]) {
        let slip = -self.search.flight.rate;
        self.ledger.wall -= self.parameters.ball_mass * slip * wall;
        self.ledger.loss += self.kinetic(slip);
        let [wall_change, slip_change] = changes;
        self.change_by_settling([slip, slip_change], [wall, wall_change]);
    }

    /// The wall begins to carry the ball: its work is the gain of kinetic energy. Its velocity `wall`, m/s, changes by
    /// `wall_change`, m/s.
    pub(super) fn book_rest(&mut self, wall: f64, wall_change: f64) {
        self.ledger.wall -= self.kinetic(wall);
        self.tangent.ledger.wall -= self.kinetic_change([wall, wall_change]);
    }

    /// The wall, whose velocity changes by `wall_change`, m/s, lets the ball go.
    pub(super) fn book_release(&mut self, wall_change: f64) {
        self.ledger.wall += self.kinetic(self.ball.velocity);
        self.tangent.ledger.wall += self.kinetic_change([self.ball.velocity, wall_change]);
    }
}
