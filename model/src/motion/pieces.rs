//! The way in pieces: over a suspended cylinder those of its power series, and under a recording its segments.
//!
//! A piece begins at an event or where the one before it ends, so that no step of a caller moves it. The search may be some pieces
//! ahead of the present one.

use super::cylinder::{CylinderMotion, Drive, Harmonic};
use super::events::{Piece, Prediction};
use super::flight::piece::Leg;
use super::flight::{End, Flight};
use super::mount::Load;
use super::suspended::{self, Oscillation, Series, Suspension};
use super::{Motion, Start};

/// What stays the same from piece to piece of a suspended cylinder.
struct Constants {
    load: Load,
    harmonic: Harmonic,
    /// Spring and damper over the mass that moves.
    suspension: Suspension,
    /// Length of a piece, s.
    length: f64,
    half_travel: f64,
    /// What gravity and friction add to dz'', m/s^2, by the ball's own motion.
    relative: f64,
}

impl Constants {
    fn new(motion: &Motion, drive: &Drive) -> Self {
        let load = motion.cylinder.load;
        let suspension = load.suspension.over(load.share);
        Self {
            load,
            harmonic: Harmonic::new(drive, &load),
            suspension,
            length: suspension.piece(drive.omega()),
            half_travel: motion.half_travel,
            relative: motion.mount.relative(motion.slip),
        }
    }

    /// Time, s, up to which a piece holds.
    fn end_of(&self, piece: &Piece) -> f64 {
        (piece.cylinder.time + self.length).min(piece.drive.recorded.end)
    }

    /// The terms of the cylinder's motion after `tau`, s, of a piece.
    fn terms(&self, piece: &Piece, tau: f64) -> Series {
        let Self { ref load, ref harmonic, suspension, .. } = *self;
        let Piece { cylinder: Start { time, position, velocity }, ref drive, .. } = *piece;
        let (amplitude, sine) = (harmonic.amplitude, harmonic.sine(time));
        let (omega, external) = (drive.omega(), drive.line(load, time));
        Oscillation { suspension, position, velocity, amplitude, sine, omega, external }.terms(tau)
    }

    fn leg(&self, piece: &Piece) -> Leg {
        let [dz, rate] = piece.relative;
        Leg { half_travel: self.half_travel, dz, rate, relative: self.relative }
    }
}

/// Time, s, up to which cylinder and flight go on as they are.
fn end_of(cylinder: &CylinderMotion, flight: &Flight) -> f64 {
    flight.end_of_series().min(cylinder.drive.recorded.end)
}

impl Motion {
    /// Whether the motion has pieces.
    pub(super) fn goes_in_pieces(&self) -> bool {
        self.flight.piece().is_some() || self.playback.is_some()
    }

    /// Time, s, up to which the present piece holds; infinite if there is no other.
    pub(super) fn end_of_piece(&self) -> f64 {
        end_of(&self.cylinder, &self.flight)
    }

    /// The next event, if there is one before a piece, or a window of one, begins after `until`, s; up to `limit`, s, the force is
    /// known.
    #[inline(never)]
    pub(super) fn next_event_in_pieces(&mut self, limit: Option<f64>, until: f64) -> Option<Prediction> {
        if self.flight.piece().is_some() {
            self.search_series(limit, until);
            return self.search.found;
        }
        while !self.search.has_ended() {
            let ahead = self.search.piece.map(|piece| self.motion_from(&piece));
            let (cylinder, flight) = ahead.unwrap_or((self.cylinder, self.flight));
            if flight.start > until {
                break;
            }
            let end = end_of(&cylinder, &flight);
            let is_last = limit.is_some_and(|limit| limit <= end);
            let end = limit.map_or(end, |limit| limit.min(end));
            if !self.search_windows(&cylinder, &flight, end, until) || self.search.found.is_some() {
                break;
            }
            if is_last {
                self.search.found = limit.map(|time| Prediction::NoiseSample { time });
                break;
            }
            let mut piece = self.piece_after(&cylinder, &flight, end);
            self.pass_quiet(&mut piece, limit, until);
            (self.search.piece, self.search.window) = (Some(piece), 0);
        }
        self.search.found
    }

    /// Searches the pieces of the power series of a suspended cylinder until an event is found, or the next piece begins after `until`,
    /// s.
    fn search_series(&mut self, limit: Option<f64>, until: f64) {
        if self.search.has_ended() {
            return;
        }
        let present = self.begin_of_piece();
        let constants = Constants::new(self, &present.drive);
        let (mut piece, mut is_ahead) = self.search.piece.map_or((present, false), |piece| (piece, true));
        while piece.cylinder.time <= until {
            let start = piece.cylinder.time;
            let end = constants.end_of(&piece);
            if end <= start && end < piece.drive.recorded.end {
                self.search.exhausted = true; // times have no digits for so short a piece
                break;
            }
            let is_last = limit.is_some_and(|limit| limit <= end);
            let end = limit.map_or(end, |limit| limit.min(end));
            let terms = constants.terms(&piece, end - start);
            self.search_piece(&constants.leg(&piece), &terms, (start, end));
            if self.search.found.is_some() {
                break;
            }
            if is_last {
                self.search.found = limit.map(|time| Prediction::NoiseSample { time });
                break;
            }
            (piece, is_ahead) = (self.piece_after_series(&constants, &piece, &terms, end), true);
        }
        self.search.piece = is_ahead.then_some(piece);
    }

    /// Searches a piece over a free cylinder that ends at `end`, s, window by window; false if it is not searched to its end because
    /// a window begins after `until`, s, or nothing will ever happen.
    fn search_windows(&mut self, cylinder: &CylinderMotion, flight: &Flight, end: f64, until: f64) -> bool {
        let length = end - flight.start;
        while self.search.found.is_none() {
            let begin = self.search.window as f64 * flight.window_length();
            if begin >= length {
                return true;
            }
            if flight.start + begin > until || self.search.exhausted {
                return false;
            }
            let Self { mount, ball, slip, search, .. } = self;
            Self::search_window_of((mount, ball, slip, search), &cylinder.drive, flight, length, end);
        }
        true
    }

    /// Searches a piece over a suspended cylinder with these terms, from `start` to `end`, s.
    fn search_piece(&mut self, leg: &Leg, terms: &Series, (start, end): (f64, f64)) {
        let length = end - start;
        if length == 0.0 {
            return; // an event has come at its end
        }
        let time = |elapsed: f64| (start + elapsed).min(end);
        self.search.found = if self.ball.is_carried() {
            let departure = leg.departure(terms, length, (self.ball.support(), &self.mount));
            departure.map(|elapsed| self.mount.release(start, elapsed, end))
        } else {
            match leg.end(terms, length, self.slip) {
                Some(End::Contact(there)) => {
                    self.search.speed = there.speed;
                    Some(Prediction::Impact { time: time(there.elapsed), side: there.side })
                }
                Some(End::Turn { elapsed }) => Some(Prediction::Turn { time: time(elapsed) }),
                None => None,
            }
        };
    }

    /// The begin of the present piece of a suspended cylinder.
    fn begin_of_piece(&self) -> Piece {
        let CylinderMotion { start: time, position, velocity, damped, drive, .. } = self.cylinder;
        let relative = [self.flight.dz, self.flight.rate];
        Piece { cylinder: Start { time, position, velocity }, relative, damped, drive }
    }

    /// The piece that begins at `time`, s, where this one ends, with these terms.
    fn piece_after_series(&self, constants: &Constants, piece: &Piece, terms: &Series, time: f64) -> Piece {
        let Piece { cylinder: Start { time: start, position, velocity }, relative: [dz, rate], damped, drive } = *piece;
        let length = time - start;
        let [farther, faster] = suspended::change(terms, length);
        let by_ball = constants.relative * length;
        let moved = [dz + (length * (rate + 0.5 * by_ball) + farther), rate + (by_ball + faster)];
        Piece {
            cylinder: Start { time, position: position + (velocity * length + farther), velocity: velocity + faster },
            relative: if self.ball.is_carried() { [dz, 0.0] } else { moved },
            damped: damped + suspended::damped_energy(constants.load.suspension.damping, terms, length),
            drive: self.drive_from(&drive, start, time),
        }
    }

    /// The piece that begins at `time`, s, where the one of this free cylinder and flight ends.
    fn piece_after(&self, cylinder: &CylinderMotion, flight: &Flight, time: f64) -> Piece {
        if let Some(mut piece) = Self::begun_piece(cylinder, flight) {
            self.pass(&mut piece);
            return piece;
        }
        let here = cylinder.at(time);
        let relative = if self.ball.is_carried() { [flight.dz, 0.0] } else { flight.at(time - flight.start) };
        Piece {
            cylinder: Start { time, position: here.position, velocity: here.velocity },
            relative,
            damped: cylinder.damped,
            drive: self.drive_after(cylinder, time),
        }
    }

    /// Cylinder and flight from the begin of a piece on.
    fn motion_from(&self, piece: &Piece) -> (CylinderMotion, Flight) {
        let Piece { cylinder: Start { time, position, velocity }, relative, damped, drive } = *piece;
        let mut cylinder = CylinderMotion::new(time, position, velocity, drive, self.cylinder.load);
        cylinder.damped = damped;
        let here = cylinder.at_start();
        (cylinder, Flight::new(&cylinder, &here, relative, self.half_travel, self.mount.relative(self.slip)))
    }

    /// The cylinder's motion in the piece ahead in which the event is that has been found.
    pub(super) fn cylinder_of_predicted_piece(&self) -> Option<CylinderMotion> {
        self.search.piece.map(|piece| self.motion_from(&piece).0)
    }

    /// Enters the piece ahead in which the event is that has been found.
    pub(super) fn enter_predicted_piece(&mut self) {
        if let Some(piece) = self.search.piece.take() {
            (self.cylinder, self.flight) = self.motion_from(&piece);
        }
    }

    /// Enters the piece of `time`, s, up to which nothing happens any more.
    pub fn enter_piece_of(&mut self, time: f64) {
        while self.ball.contact().is_none() && self.has_piece_after(time) {
            let piece = self.piece_to(time);
            let has_caught_up = self.search.piece.is_some_and(|ahead| ahead.cylinder.time <= piece.cylinder.time);
            if has_caught_up {
                self.search.piece = None;
            }
            (self.cylinder, self.flight) = self.motion_from(&piece);
        }
    }

    /// The piece after the present one, or over a free cylinder that of `time`, s.
    fn piece_to(&self, time: f64) -> Piece {
        let end = self.end_of_piece();
        if self.flight.piece().is_some() {
            let present = self.begin_of_piece();
            let constants = Constants::new(self, &present.drive);
            let terms = constants.terms(&present, end - present.cylinder.time);
            return self.piece_after_series(&constants, &present, &terms, end);
        }
        let mut piece = self.piece_after(&self.cylinder, &self.flight, end);
        self.pass_to(&mut piece, time);
        piece
    }

    /// Whether the present piece ends by `time`, s, and another one follows.
    fn has_piece_after(&self, time: f64) -> bool {
        let end = self.end_of_piece();
        end <= time && (end > self.flight.start || end == self.cylinder.drive.recorded.end)
    }
}
