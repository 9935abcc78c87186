//! The way in pieces: over a suspended cylinder those of its power series, and under a recording its segments.
//!
//! A piece begins at an event or where the one before it ends, so that no step of a caller moves it. The search may be some pieces
//! ahead of the present one.

use super::cylinder::CylinderMotion;
use super::events::{Piece, Prediction};
use super::flight::{End, Flight};
use super::suspended::{self, Series};
use super::{Motion, Start};

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
        while !self.search.has_ended() {
            if self.search.piece.is_some_and(|piece| piece.cylinder.time > until) {
                break;
            }
            let ahead = self.search.piece.map(|piece| self.motion_from(&piece));
            let (cylinder, flight) = ahead.unwrap_or((self.cylinder, self.flight));
            if flight.start > until {
                break;
            }
            if flight.end_of_series() <= flight.start {
                self.search.exhausted = true; // times have no digits for so short a piece
                break;
            }
            let end = end_of(&cylinder, &flight);
            let is_last = limit.is_some_and(|limit| limit <= end);
            let end = limit.map_or(end, |limit| limit.min(end));
            let terms = flight.piece().map(|_| cylinder.oscillation().terms(end - flight.start));
            if let Some(terms) = &terms {
                self.search_series(&flight, terms, end);
            } else if !self.search_windows(&cylinder, &flight, end, until) {
                break;
            }
            if self.search.found.is_some() {
                break;
            }
            if is_last {
                self.search.found = limit.map(|time| Prediction::NoiseSample { time });
                break;
            }
            let mut piece = self.piece_after(&cylinder, &flight, terms.as_ref(), end);
            if terms.is_none() {
                self.pass_quiet(&mut piece, limit, until);
            }
            (self.search.piece, self.search.window) = (Some(piece), 0);
        }
        self.search.found
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

    /// Searches a piece over a suspended cylinder with these terms, which ends at `end`, s.
    fn search_series(&mut self, flight: &Flight, terms: &Series, end: f64) {
        let length = end - flight.start;
        if length == 0.0 {
            return; // an event has come at its end
        }
        let time = |elapsed: f64| (flight.start + elapsed).min(end);
        self.search.found = if self.ball.is_carried() {
            let departure = flight.departure_in_piece_of(terms, length, (self.ball.support(), &self.mount));
            departure.map(|elapsed| self.mount.release(flight.start, elapsed, end))
        } else {
            match flight.end_in_piece_of(terms, length, self.slip) {
                Some(End::Contact(there)) => {
                    self.search.speed = there.speed;
                    Some(Prediction::Impact { time: time(there.elapsed), side: there.side })
                }
                Some(End::Turn { elapsed }) => Some(Prediction::Turn { time: time(elapsed) }),
                None => None,
            }
        };
    }

    /// The piece that begins at `time`, s, where the one of this cylinder and flight ends, which has these terms if it is
    /// suspended.
    fn piece_after(&self, cylinder: &CylinderMotion, flight: &Flight, terms: Option<&Series>, time: f64) -> Piece {
        if let Some(mut piece) = Self::begun_piece(cylinder, flight).filter(|_| terms.is_none()) {
            self.pass(&mut piece);
            return piece;
        }
        let length = time - flight.start;
        let ([position, velocity], relative, damped) = if let Some(terms) = terms {
            let by_cylinder = suspended::change(terms, length);
            let damping = cylinder.load.suspension.damping;
            let damped = cylinder.damped + suspended::damped_energy(damping, terms, length);
            (cylinder.after(length, by_cylinder), flight.after(length, by_cylinder), damped)
        } else {
            let here = cylinder.at(time);
            ([here.position, here.velocity], flight.at(length), cylinder.damped)
        };
        let relative = if self.ball.is_carried() { [flight.dz, 0.0] } else { relative };
        Piece {
            cylinder: Start { time, position, velocity },
            relative,
            damped,
            drive: self.drive_after(cylinder, time),
        }
    }

    /// Cylinder and flight from the begin of a piece on.
    fn motion_from(&self, piece: &Piece) -> (CylinderMotion, Flight) {
        let Piece { cylinder: Start { time, position, velocity }, relative, damped, drive } = *piece;
        let mut cylinder = CylinderMotion::new(time, position, velocity, drive, self.cylinder.load);
        cylinder.damped = damped;
        let here = cylinder.at(time);
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
            let end = self.end_of_piece();
            let terms = self.flight.piece().map(|_| self.cylinder.oscillation().terms(end - self.flight.start));
            let mut piece = self.piece_after(&self.cylinder, &self.flight, terms.as_ref(), end);
            if terms.is_none() {
                self.pass_to(&mut piece, time);
            }
            let has_caught_up = self.search.piece.is_some_and(|ahead| ahead.cylinder.time <= piece.cylinder.time);
            if has_caught_up {
                self.search.piece = None;
            }
            (self.cylinder, self.flight) = self.motion_from(&piece);
        }
    }

    /// Whether the present piece ends by `time`, s, and another one follows.
    fn has_piece_after(&self, time: f64) -> bool {
        let end = self.end_of_piece();
        end <= time && (end > self.flight.start || end == self.cylinder.drive.recorded.end)
    }
}
