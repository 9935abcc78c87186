//! The motion of cylinder and ball from event to event, exactly under the impulsive law.

mod ball;
mod chatter;
mod contacts;
pub mod cylinder;
mod events;
pub mod flight;
mod intervals;
pub mod pulse;
mod search;
pub mod side;

pub use self::ball::{Ball, Start};
pub use self::chatter::{Accuracy, Tail};
pub use self::contacts::Forces;
pub use self::events::{Prediction, Search};

use self::cylinder::{CylinderMotion, CylinderState, Drive};
use self::flight::Flight;
use self::side::Side;
use crate::contact::{Contact, Phase, Recoil};
use crate::paper::impact;
use crate::parameters::{OutsideGap, Parameters};

/// Where cylinder and ball are, how they go on, and what has been found of the way ahead.
#[derive(Debug, PartialEq)]
pub struct Motion {
    pub half_travel: f64,
    restitution: f64,
    /// Share of the relative motion in a contact that the cylinder makes.
    recoil_share: f64,
    accuracy: Accuracy,
    pub cylinder: CylinderMotion,
    /// The ball at its last event: from there a free one goes straight on.
    pub last: Start,
    pub ball: Ball,
    /// The free motion of the ball relative to the cylinder.
    pub flight: Flight,
    pub search: Search,
}

impl Clone for Motion {
    fn clone(&self) -> Self {
        Self { ball: self.ball.clone(), ..*self }
    }

    fn clone_from(&mut self, source: &Self) {
        let Self { half_travel, restitution, recoil_share, accuracy, cylinder, last, ref ball, flight, search } =
            *source;
        self.ball.clone_from(ball);
        (self.half_travel, self.restitution, self.recoil_share) = (half_travel, restitution, recoil_share);
        (self.accuracy, self.cylinder, self.last, self.flight, self.search) =
            (accuracy, cylinder, last, flight, search);
    }
}

impl Motion {
    /// The motion in which the ball is at `last` and the flight started with this dz, m, and rate, m/s, at `start`, s.
    pub fn new(p: &Parameters, cylinder: CylinderMotion, last: Start, ball: Ball, relative: Start) -> Self {
        let half_travel = p.travel() / 2.0;
        let motion = [relative.position, relative.velocity];
        let flight = Flight::new(&cylinder, &cylinder.at(relative.time), motion, half_travel);
        let (restitution, recoil_share) = (p.restitution, p.recoil_share());
        let search = Search::new();
        Self { half_travel, restitution, recoil_share, accuracy: Accuracy::Exact, cylinder, last, ball, flight, search }
    }

    /// From now on an integrator places the states: its future is not searched.
    pub fn leave_to_integrator(&mut self) {
        self.accuracy = Accuracy::Integrated;
    }

    /// The membrane on which the ball rests, or which holds it at a deflection under the compliant law.
    pub fn resting(&self) -> Option<Side> {
        match &self.ball {
            Ball::Free => None,
            Ball::Resting(side) => Some(*side),
            Ball::InContact(contact) => (contact.state.phase == Phase::Held).then_some(contact.state.side),
        }
    }

    fn recoil(&self, time: f64) -> Recoil {
        self.ball.contact().map_or(Recoil::default(), |contact| self.recoil_of(contact, time))
    }

    fn recoil_of(&self, contact: &Contact, time: f64) -> Recoil {
        let point = crate::contact::Point { time, ..contact.at(time) };
        Recoil::new(self.recoil_share, &self.flight, contact.state.side, &point)
    }

    pub fn cylinder_position_at(&self, time: f64) -> f64 {
        self.cylinder.at(time).position + self.recoil(time).position
    }

    pub fn cylinder_velocity_at(&self, time: f64) -> f64 {
        self.cylinder.at(time).velocity + self.recoil(time).velocity
    }

    /// `z_M` - `z_m`, m, and its rate, m/s.
    pub fn relative_at(&self, time: f64) -> [f64; 2] {
        match &self.ball {
            Ball::Free => self.flight.at(time - self.flight.start),
            Ball::Resting(side) => [side.sign() * self.half_travel, 0.0],
            Ball::InContact(contact) => {
                let (sign, point) = (contact.state.side.sign(), contact.at(time));
                [sign * (self.half_travel + point.x), sign * point.v]
            }
        }
    }

    pub fn ball_position_at(&self, time: f64) -> f64 {
        match &self.ball {
            Ball::Free => self.last.position + self.last.velocity * (time - self.last.time),
            Ball::Resting(side) => self.cylinder.at(time).position - side.sign() * self.half_travel,
            Ball::InContact(_) => {
                let [dz, _] = self.relative_at(time);
                self.cylinder_position_at(time) - dz
            }
        }
    }

    pub fn ball_velocity_at(&self, time: f64) -> f64 {
        match &self.ball {
            Ball::Free => self.last.velocity,
            Ball::Resting(_) => self.cylinder.at(time).velocity,
            Ball::InContact(contact) => {
                self.cylinder_velocity_at(time) - contact.state.side.sign() * contact.at(time).v
            }
        }
    }

    /// The drive as it is at `time`, s, for a motion that starts there.
    pub fn drive_at(&self, time: f64) -> Drive {
        let drive = self.cylinder.drive;
        Drive { external: drive.external + drive.external_rate * (time - self.cylinder.start), ..drive }
    }

    /// Takes cylinder and ball at `time`, s, as the start of a new motion under `drive`; not in a contact.
    pub fn restart(&mut self, time: f64, drive: Drive) {
        let motion = self.relative_at(time);
        self.cylinder = self.cylinder.continued(time, drive);
        self.new_flight(&self.cylinder.at(time), motion);
    }

    /// Searches from where the cylinder is `here` and `z_M` - `z_m` and its rate are `motion`, m and m/s. These are handed on
    /// rather than computed from positions and velocities, so that a ball on a membrane is there to the last bit, and
    /// leaves it as fast as it should, however far the cylinder has drifted and however fast it is.
    pub fn new_flight(&mut self, here: &CylinderState, motion: [f64; 2]) {
        self.flight = Flight::new(&self.cylinder, here, motion, self.half_travel);
        self.search = Search::new();
    }

    /// The ball leaves the `wall` at `side` after an impact at relative `speed`, m/s: Eq. (11). Returns the relative speed, m/s.
    pub fn rebound(&mut self, side: Side, speed: f64, wall: &CylinderState) -> f64 {
        let rebound = impact::rebound(self.restitution, speed);
        let dz = side.sign() * self.half_travel;
        let velocity = impact::velocity_after(wall.velocity, side.sign(), rebound);
        self.last = Start { time: wall.time, position: wall.position - dz, velocity };
        self.ball = Ball::Free;
        self.new_flight(wall, [dz, -side.sign() * rebound]);
        rebound
    }

    /// From now on the ball rests on the membrane at `side`, on this `wall`.
    pub fn rest(&mut self, side: Side, wall: &CylinderState) {
        self.ball = Ball::Resting(side);
        self.new_flight(wall, [side.sign() * self.half_travel, 0.0]);
    }

    /// The wall lets the ball go at `time`, s. Where the flight begins is for the caller to say.
    pub fn release(&mut self, time: f64) {
        let (position, velocity) = (self.ball_position_at(time), self.ball_velocity_at(time));
        self.last = Start { time, position, velocity };
        self.ball = Ball::Free;
    }
}

impl Parameters {
    /// The membrane on which a ball that starts beyond it is placed.
    pub(crate) fn projected_side(&self) -> Option<Side> {
        let dz = self.cylinder_position - self.ball_position;
        let is_projected = self.outside_gap == OutsideGap::Project && dz.abs() >= self.travel() / 2.0;
        is_projected.then_some(Side::of(dz))
    }
}
