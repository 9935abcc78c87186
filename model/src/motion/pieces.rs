//! The way over a suspended cylinder, piece by piece of its power series.
//!
//! A piece begins at an event or where the one before it ends, so that no step of a caller moves it. The search may be some pieces
//! ahead of the present one.

use super::cylinder::CylinderMotion;
use super::events::{Piece, Prediction};
use super::flight::{End, Flight};
use super::suspended::{self, Series};
use super::{Motion, Start};

impl Motion {
    /// Time, s, up to which the present piece holds, if the cylinder is suspended.
    pub(super) fn end_of_piece(&self) -> Option<f64> {
        self.flight.piece().map(|length| self.flight.start + length)
    }

    /// The next event, if there is one before a piece begins after `until`, s; up to `limit`, s, the force is known.
    #[inline(never)]
    pub(super) fn next_event_in_pieces(&mut self, limit: Option<f64>, until: f64) -> Option<Prediction> {
        let mut ahead = self.search.piece.map(|piece| (piece, self.motion_from(&piece)));
        while !self.search.has_ended() {
            let (cylinder, flight) = ahead.as_ref().map_or((&self.cylinder, &self.flight), |(_, (c, f))| (c, f));
            if flight.start > until {
                break;
            }
            let Some(length) = flight.piece() else { break };
            let end = flight.start + length;
            if end <= flight.start {
                self.search.exhausted = true; // times have no digits for so short a piece
                break;
            }
            let is_last = limit.is_some_and(|limit| limit <= end);
            let end = limit.map_or(end, |limit| limit.min(end));
            let length = end - flight.start;
            let terms = cylinder.oscillation().terms(length);
            let time = |elapsed: f64| (flight.start + elapsed).min(end);
            let mut speed = 0.0;
            let found = if self.ball.is_carried() {
                let departure = flight.departure_in_piece_of(&terms, length, (self.ball.support(), &self.mount));
                departure.map(|elapsed| Prediction::Release { time: time(elapsed) })
            } else {
                match flight.end_in_piece_of(&terms, length, self.slip) {
                    Some(End::Contact(there)) => {
                        speed = there.speed;
                        Some(Prediction::Impact { time: time(there.elapsed), side: there.side })
                    }
                    Some(End::Turn { elapsed }) => Some(Prediction::Turn { time: time(elapsed) }),
                    None => None,
                }
            };
            (self.search.found, self.search.speed) =
                (found.or(limit.filter(|_| is_last).map(|time| Prediction::NoiseSample { time })), speed);
            if self.search.found.is_none() {
                let piece = self.piece_after(cylinder, flight, &terms, end);
                ahead = Some((piece, self.motion_from(&piece)));
            }
        }
        self.search.piece = ahead.map(|(piece, _)| piece);
        self.search.found
    }

    /// The piece that begins at `time`, s, where the one with these terms ends.
    fn piece_after(&self, cylinder: &CylinderMotion, flight: &Flight, terms: &Series, time: f64) -> Piece {
        let length = time - flight.start;
        let by_cylinder = suspended::change(terms, length);
        let [position, velocity] = cylinder.after(length, by_cylinder);
        let relative = if self.ball.is_carried() { [flight.dz, 0.0] } else { flight.after(length, by_cylinder) };
        let damping = cylinder.load.suspension.damping;
        let damped = cylinder.damped + suspended::damped_energy(damping, terms, length);
        Piece { cylinder: Start { time, position, velocity }, relative, damped }
    }

    /// Cylinder and flight from the begin of a piece on.
    fn motion_from(
        &self,
        Piece { cylinder: Start { time, position, velocity }, relative, damped }: &Piece,
    ) -> (CylinderMotion, Flight) {
        let mut cylinder = CylinderMotion::new(*time, *position, *velocity, self.drive_at(*time), self.cylinder.load);
        cylinder.damped = *damped;
        let here = cylinder.at(*time);
        (cylinder, Flight::new(&cylinder, &here, *relative, self.half_travel, self.mount.relative(self.slip)))
    }

    /// Enters the piece ahead in which the event is that has been found.
    pub(super) fn enter_predicted_piece(&mut self) {
        if let Some(piece) = self.search.piece.take() {
            (self.cylinder, self.flight) = self.motion_from(&piece);
        }
    }

    /// Enters the piece of `time`, s, up to which nothing happens any more.
    pub fn enter_piece_of(&mut self, time: f64) {
        while self.ball.contact().is_none()
            && self.end_of_piece().is_some_and(|end| end > self.flight.start && end <= time)
        {
            let end = self.end_of_piece().unwrap_or(time);
            let terms = self.cylinder.oscillation().terms(end - self.flight.start);
            let piece = self.piece_after(&self.cylinder, &self.flight, &terms, end);
            let has_caught_up = self.search.piece.is_some_and(|ahead| ahead.cylinder.time <= piece.cylinder.time);
            if has_caught_up {
                self.search.piece = None;
            }
            (self.cylinder, self.flight) = self.motion_from(&piece);
        }
    }
}
