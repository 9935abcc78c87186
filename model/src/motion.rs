//! The motion of cylinder and ball from event to event, exactly under the impulsive law.

mod ball;
mod chatter;
mod contacts;
pub mod cylinder;
mod events;
pub mod flight;
mod glide;
mod intervals;
pub mod mount;
mod pieces;
pub mod pulse;
mod rest;
mod search;
pub mod side;
pub mod suspended;

pub use self::ball::{Ball, Start};
pub use self::chatter::{Accuracy, Tail};
pub use self::contacts::Forces;
pub use self::events::{Prediction, Search};

use self::cylinder::{CylinderMotion, CylinderState, Drive};
use self::flight::Flight;
use self::mount::{Load, Mount};
pub use self::rest::Resting;
use self::side::Side;
use crate::contact::{Contact, Recoil};
use crate::paper::impact;
use crate::parameters::{OutsideGap, Parameters};
use crate::recording::{Playback, Segment};

/// Where cylinder and ball are, how they go on, and what has been found of the way ahead.
#[derive(Debug, PartialEq)]
pub struct Motion {
    pub half_travel: f64,
    restitution: f64,
    /// Share of the relative motion in a contact that the cylinder makes.
    recoil_share: f64,
    accuracy: Accuracy,
    pub mount: Mount,
    pub cylinder: CylinderMotion,
    /// The ball at its last event: from there a free one has a constant acceleration.
    pub last: Start,
    pub ball: Ball,
    /// Sign of dz' while friction acts on a ball that slides, else 0.
    pub slip: f64,
    /// The free motion of the ball relative to the cylinder.
    pub flight: Flight,
    pub search: Search,
    /// The recording that excites the cylinder, of which a segment is in the drive.
    pub playback: Option<Playback>,
    /// Membranes that are viscous since a ball last left them.
    pub resting_films: [Resting; 2],
}

impl Clone for Motion {
    fn clone(&self) -> Self {
        Self {
            ball: self.ball.clone(),
            playback: self.playback.clone(),
            resting_films: self.resting_films.clone(),
            ..*self
        }
    }

    fn clone_from(&mut self, source: &Self) {
        let Self {
            half_travel,
            restitution,
            recoil_share,
            accuracy,
            mount,
            cylinder,
            last,
            ref ball,
            slip,
            flight,
            search,
            ref playback,
            ref resting_films,
        } = *source;
        self.ball.clone_from(ball);
        self.playback.clone_from(playback);
        (self.half_travel, self.restitution, self.recoil_share) = (half_travel, restitution, recoil_share);
        (self.accuracy, self.mount, self.cylinder, self.last) = (accuracy, mount, cylinder, last);
        self.resting_films.clone_from(resting_films);
        (self.slip, self.flight, self.search) = (slip, flight, search);
    }
}

impl Motion {
    /// The motion in which the ball is at `last`, and slides with this sign of dz', and the flight started with this dz, m, and
    /// rate, m/s, at `start`, s. The cylinder is at `cylinder` under `drive`.
    pub fn new(
        p: &Parameters,
        cylinder: Start,
        drive: Drive,
        last: Start,
        (ball, slip): (Ball, f64),
        relative: Start,
    ) -> Self {
        let (half_travel, mount) = (p.travel() / 2.0, Mount::new(p));
        let load = Self::load_of(&mount, &ball, slip);
        let cylinder = CylinderMotion::new(cylinder.time, cylinder.position, cylinder.velocity, drive, load);
        let motion = [relative.position, relative.velocity];
        let here = cylinder.at(relative.time);
        let flight = Flight::new(&cylinder, &here, motion, half_travel, mount.relative(slip));
        let (restitution, recoil_share, accuracy) = (p.restitution, p.recoil_share(), Accuracy::Exact);
        let (search, playback, resting_films) = (Search::new(), None, Default::default());
        Self {
            half_travel,
            restitution,
            recoil_share,
            accuracy,
            mount,
            cylinder,
            last,
            ball,
            slip,
            flight,
            search,
            playback,
            resting_films,
        }
    }

    /// What this `ball` does to the cylinder, under the compliant law besides the force of the contact.
    fn load_of(mount: &Mount, ball: &Ball, slip: f64) -> Load {
        if ball.is_carried() { mount.carrying() } else { mount.sliding(slip) }
    }

    /// From now on an integrator places the states: its future is not searched.
    pub fn leave_to_integrator(&mut self) {
        self.accuracy = Accuracy::Integrated;
    }

    /// Whether an integrator places the states.
    pub fn is_left_to_integrator(&self) -> bool {
        self.accuracy == Accuracy::Integrated
    }

    /// The membrane on which the ball rests, or which holds it at a deflection under the compliant law.
    pub fn resting(&self) -> Option<Side> {
        match &self.ball {
            Ball::Free | Ball::Stuck => None,
            Ball::Resting(side) => Some(*side),
            Ball::InContact(contact) => (contact.state.phase.is_at_rest()).then_some(contact.state.side),
        }
    }

    /// What the contact adds to the cylinder's motion.
    pub fn recoil(&self, time: f64) -> Recoil {
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
            Ball::Free => {
                let tau = time - self.flight.start;
                match self.flight.piece() {
                    None => self.flight.at(tau),
                    Some(_) => self.flight.after(tau, self.cylinder.oscillation().change(tau)),
                }
            }
            Ball::Stuck => [self.flight.dz, 0.0],
            Ball::Resting(side) => [side.sign() * self.half_travel, 0.0],
            Ball::InContact(contact) => {
                let (sign, point) = (contact.state.side.sign(), contact.at(time));
                [sign * (self.half_travel + point.x), sign * point.v]
            }
        }
    }

    pub fn ball_position_at(&self, time: f64) -> f64 {
        match &self.ball {
            Ball::Free => {
                let Start { time: since, position, velocity } = self.last;
                let elapsed = time - since;
                position + (velocity + 0.5 * self.ball_acceleration() * elapsed) * elapsed
            }
            Ball::Stuck | Ball::Resting(_) | Ball::InContact(_) => {
                let [dz, _] = self.relative_at(time);
                self.cylinder_position_at(time) - dz
            }
        }
    }

    pub fn ball_velocity_at(&self, time: f64) -> f64 {
        match &self.ball {
            Ball::Free => self.last.velocity + self.ball_acceleration() * (time - self.last.time),
            Ball::Stuck | Ball::Resting(_) => self.cylinder.at(time).velocity,
            Ball::InContact(contact) => {
                self.cylinder_velocity_at(time) - contact.state.side.sign() * contact.at(time).v
            }
        }
    }

    /// `z_M` and dz, m, at `time`, s.
    pub fn slide_at(&self, time: f64) -> [f64; 2] {
        [self.cylinder_position_at(time), self.relative_at(time)[0]]
    }

    /// `z_m''`, m/s^2, of a free ball.
    pub fn ball_acceleration(&self) -> f64 {
        0.0 - self.mount.relative(self.slip)
    }

    /// The drive as it is at `time`, s, for a motion that starts there.
    pub fn drive_at(&self, time: f64) -> Drive {
        self.cylinder.drive_at(time)
    }

    /// The same where a piece ends.
    fn drive_after(&self, cylinder: &CylinderMotion, time: f64) -> Drive {
        self.drive_from(&cylinder.drive, cylinder.start, time)
    }

    /// The `drive` of a motion from `start`, s, as it is at `time`, s, where a piece ends: the recording may go on with its next segment
    /// there.
    fn drive_from(&self, drive: &Drive, start: f64, time: f64) -> Drive {
        let next = self.playback.as_ref().filter(|_| drive.recorded.end <= time);
        Drive {
            external: drive.external + drive.external_rate * (time - start),
            recorded: next.map_or(drive.recorded, |playback| playback.segment(drive.recorded.number + 1)),
            ..*drive
        }
    }

    /// The segment of the recording at `time`, s.
    pub fn recorded_at(&self, time: f64) -> Segment {
        self.playback.as_ref().map_or(Segment::NONE, |playback| playback.segment_at(time))
    }

    /// Takes cylinder and ball at `time`, s, as the start of a new motion under `drive`; not in a contact.
    pub fn restart(&mut self, time: f64, drive: Drive) {
        let motion = self.relative_at(time);
        self.cylinder = self.cylinder.continued(time, drive);
        self.new_flight(&self.cylinder.at_start(), motion);
    }

    /// Searches from where the cylinder is `here` and `z_M` - `z_m` and its rate are `motion`, m and m/s. These are handed on
    /// rather than computed from positions and velocities, so that a ball on a membrane is there to the last bit, and
    /// leaves it as fast as it should, however far the cylinder has drifted and however fast it is.
    pub fn new_flight(&mut self, here: &CylinderState, motion: [f64; 2]) {
        self.flight = Flight::new(&self.cylinder, here, motion, self.half_travel, self.mount.relative(self.slip));
        self.search.begin();
    }

    /// The ball slides with this sign of dz', or the cylinder carries it, from `here` on, which becomes the cylinder with what the
    /// ball then does to it.
    #[inline]
    fn change_ball(&mut self, ball: Ball, slip: f64, here: &mut CylinderState) {
        (self.ball, self.slip) = (ball, slip);
        // Else the cylinder goes on as before.
        if self.mount.ratio > 0.0 || self.mount.is_suspended() {
            *here = self.change_load(*here);
        }
    }

    #[inline(never)] // what a free cylinder does stays small
    fn change_load(&mut self, here: CylinderState) -> CylinderState {
        let load = Self::load_of(&self.mount, &self.ball, self.slip);
        self.cylinder = self.cylinder.loaded(&here, load);
        self.cylinder.at_start()
    }

    /// dz'', m/s^2, of a ball without friction where the cylinder is `here`, if the ball does not act on it.
    fn free_acceleration(&self, here: &CylinderState) -> f64 {
        self.cylinder.unloaded(here.acceleration) + self.mount.incline
    }

    /// The ball leaves the `wall` at `side` after an impact at relative `speed`, m/s: Eq. (11). Returns the relative speed, m/s;
    /// the wall becomes that after the impact.
    pub fn rebound(&mut self, side: Side, speed: f64, wall: &mut CylinderState) -> f64 {
        let (sign, rebound) = (side.sign(), impact::rebound(self.restitution, speed));
        wall.velocity = impact::wall_after(wall.velocity, self.mount.taken, sign * (speed + rebound));
        let slip = if self.mount.friction > 0.0 { -sign } else { 0.0 };
        self.change_ball(Ball::Free, slip, wall);
        let dz = sign * self.half_travel;
        let velocity = impact::velocity_after(wall.velocity, sign, rebound);
        self.last = Start { time: wall.time, position: wall.position - dz, velocity };
        self.new_flight(wall, [dz, -sign * rebound]);
        rebound
    }

    /// From now on the ball rests on the membrane at `side`, on this `wall`, which it was `slip`, m/s, faster than; the wall
    /// becomes that after it.
    pub fn rest(&mut self, side: Side, slip: f64, wall: &mut CylinderState) {
        wall.velocity = impact::wall_after(wall.velocity, self.mount.taken, -slip);
        self.change_ball(Ball::Resting(side), 0.0, wall);
        self.new_flight(wall, [side.sign() * self.half_travel, 0.0]);
    }

    /// The wall lets the ball go at `time`, s, to slide with this sign of dz'. Where the flight begins is for the caller to
    /// say.
    pub fn release(&mut self, time: f64, slip: f64) {
        let (position, velocity) = (self.ball_position_at(time), self.ball_velocity_at(time));
        self.last = Start { time, position, velocity };
        self.change_ball(Ball::Free, slip, &mut self.cylinder.at(time));
    }

    /// A ball without relative velocity at `time`, s, not pressed on a membrane, goes on with this dz, m: friction holds it, or it
    /// slides.
    pub fn turn(&mut self, time: f64, dz: f64) {
        let mut here = self.cylinder.at(time);
        let slip = self.mount.start_of_slip(self.free_acceleration(&here), self.cylinder.size_at(&here));
        // A ball that turns where it has just set out stays.
        let has_gone = time > self.flight.start || self.flight.rate != 0.0 || self.accuracy == Accuracy::Integrated;
        let slip = if has_gone || self.slip == 0.0 { slip } else { 0.0 };
        let ball = if slip == 0.0 { Ball::Stuck } else { Ball::Free };
        self.change_ball(ball, slip, &mut here);
        self.last = Start { time, position: here.position - dz, velocity: here.velocity };
        self.new_flight(&here, [dz, 0.0]);
    }

    /// The sign of dz' with which a ball that the cylinder carries sets out at `time`, s.
    pub fn departure(&self, time: f64) -> f64 {
        if self.mount.friction == 0.0 {
            return 0.0;
        }
        match &self.ball {
            Ball::Resting(side) => -side.sign(),
            _ => self.free_acceleration(&self.cylinder.at(time)).signum(),
        }
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
