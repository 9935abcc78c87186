//! The search for the next event.

use super::cylinder::{CylinderState, Drive};
use super::events::{Prediction, Search};
use super::flight::{End, Flight};
use super::mount::Mount;
use super::side::Side;
use super::{Ball, Motion};
use crate::noise::Noise;

/// Pieces of the series of a suspended cylinder that are searched ahead of the present time: some tenths of a second of work.
const MOST_PIECES: f64 = 1e6;

impl Motion {
    /// The membrane that a ball touches where its present flight begins, and the speed at which it approaches that, m/s.
    pub fn touched(&self) -> Option<(Side, f64)> {
        let Flight { dz, rate, .. } = self.flight;
        let side = Side::of(dz);
        let is_touching = (dz.abs() - self.half_travel).abs() <= 4.0 * f64::EPSILON * self.half_travel;
        is_touching.then_some((side, side.sign() * rate))
    }

    /// All events up to `time`, s, have happened: windows that lie before are passed over.
    pub fn resume_search(&mut self, time: f64) {
        self.search = Search::new();
        if self.ball.contact().is_none() && self.flight.piece().is_none() {
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
            // saturates; time does not lie before the start
            let passed = ((time - self.flight.start) / self.flight.window_length()) as u64;
            self.search.window = passed.saturating_sub(1);
        }
    }

    /// The future is an integrator's: a flight from where the cylinder is `here`, and no search.
    pub fn forget_search(&mut self, here: &CylinderState, motion: [f64; 2]) {
        self.new_flight(here, motion);
        self.search = Search::none();
    }

    /// The next event, if there is one before the search windows have passed `until`, s. If the caller is to get there,
    /// `follow` spares it the way.
    #[allow(clippy::inline_always)] // at each event, where what it returns stays in registers
    #[inline(always)]
    pub fn next_event(&mut self, noise: &mut Noise, until: f64, follow: bool) -> Option<Prediction> {
        self.next_impact(noise, until).or_else(|| self.search_for_event(noise, until, follow))
    }

    /// The same if it is the impact of a simple flight that has not been searched.
    #[allow(clippy::inline_always)] // at each event, where what it returns stays in registers
    #[inline(always)]
    fn next_impact(&mut self, noise: &Noise, until: f64) -> Option<Prediction> {
        let is_free =
            matches!(self.ball, Ball::Free) && self.slip == 0.0 && !self.goes_in_pieces() && noise.limit().is_none();
        let Self { flight, search, .. } = self;
        if !is_free || search.window > 0 || search.has_ended() || flight.start > until {
            return None;
        }
        let contact = flight.simple_contact()?;
        let event = Prediction::Impact { time: flight.start + contact.elapsed, side: contact.side };
        (search.window, search.found, search.speed) = (1, Some(event), contact.speed);
        Some(event)
    }

    /// The next event, whatever it is.
    #[inline(never)] // what a simple flight does stays small
    fn search_for_event(&mut self, noise: &mut Noise, until: f64, follow: bool) -> Option<Prediction> {
        let limit = noise.limit();
        if let Ball::InContact(contact) = &self.ball {
            let end = contact.end();
            let sample = limit.filter(|limit| *limit <= end);
            let change = Prediction::ContactChange { time: end };
            return Some(sample.map_or(change, |time| Prediction::NoiseSample { time }));
        }
        if self.goes_in_pieces() {
            return self.next_event_in_pieces(limit, until);
        }
        let start = self.flight.start;
        let in_blocks = noise.in_blocks();
        let limit_elapsed = match limit {
            Some(_) if in_blocks => noise.rest_after(start),
            Some(time) => time - start,
            None => f64::INFINITY,
        };
        while !self.search.has_ended() {
            if in_blocks && let Some(ahead) = self.search.ahead {
                self.search_ahead(noise, ahead, until, follow);
                break;
            }
            let begin = self.search.window as f64 * self.flight.window_length();
            if begin >= limit_elapsed && in_blocks {
                self.search.window = 0;
                self.search.ahead = Some(self.next_interval(noise));
                continue;
            }
            if begin >= limit_elapsed {
                self.search.found = limit.map(|time| Prediction::NoiseSample { time });
                break;
            }
            if start + begin > until {
                break;
            }
            self.search_window(limit_elapsed, limit.unwrap_or(f64::INFINITY));
        }
        if in_blocks && self.search.found.is_some() {
            self.search.window = 0; // whether it was found from here or ahead
        }
        self.search.found
    }

    /// The time, s, up to which nothing happens and the search has nothing more to predict. It follows from what has been
    /// found, not from the present time, so that no step of a caller changes it.
    pub fn calm_until(&self, noise: &Noise) -> f64 {
        if noise.limit().is_some() {
            return f64::NEG_INFINITY; // there is always a hold interval to enter
        }
        if let Ball::InContact(contact) = &self.ball {
            return contact.end();
        }
        let Search { window, found, exhausted, piece, .. } = &self.search;
        let calm = match found {
            Some(event) => event.time(),
            None if *exhausted => f64::INFINITY,
            None => {
                let front = piece.as_ref().map_or(self.flight.start, |piece| piece.cylinder.time);
                self.before_horizon_of(front + *window as f64 * self.flight.window_length())
            }
        };
        calm.min(self.end_of_piece()) // there the next piece is to be entered
    }

    /// How far ahead events are predicted, s, without noise: an excitation period, but on a suspension of which a piece is far shorter
    /// no more than [`MOST_PIECES`], lest the first step takes a minute.
    pub fn horizon(&self) -> f64 {
        let pieces = self.flight.piece().map_or(f64::INFINITY, |piece| MOST_PIECES * piece);
        self.flight.window_length().min(pieces)
    }

    /// The last time, s, from which the search need not go farther than `searched`, s.
    fn before_horizon_of(&self, searched: f64) -> f64 {
        let horizon = self.horizon();
        // Less the rounding of this difference and of the sum that the search compares with.
        searched - horizon - 4.0 * f64::EPSILON * (searched.abs() + horizon)
    }

    /// Searches one window of the flight or of the rest; both limits mean the end of the hold interval, s since the start and s.
    fn search_window(&mut self, limit: f64, end: f64) {
        let Self { mount, cylinder, ball, slip, flight, search, .. } = self;
        Self::search_window_of((mount, ball, slip, search), &cylinder.drive, flight, limit, end);
    }

    /// The same of any flight or rest of this ball, under this `drive`.
    #[allow(clippy::inline_always)] // at each event, and not inlined otherwise
    #[inline(always)]
    pub(super) fn search_window_of(
        (mount, ball, slip, search): (&Mount, &Ball, &f64, &mut Search),
        drive: &Drive,
        flight: &Flight,
        limit: f64,
        end: f64,
    ) {
        let time = |elapsed: f64| (flight.start + elapsed).min(end);
        if ball.is_carried() {
            let release = flight.departure_in_window(ball.support(), mount, search.window, limit);
            search.found = release.map(|elapsed| mount.release(flight.start, elapsed, end));
            search.window += 1;
            // Without a force that changes, the ball rests for ever.
            search.exhausted = release.is_none() && drive.is_constant() && limit == f64::INFINITY;
            return;
        }
        let next = if *slip == 0.0 { flight.skip(search.window) } else { Some(search.window) };
        let Some(window) = next else {
            if limit == f64::INFINITY {
                search.exhausted = true;
            } else {
                search.window = u64::MAX;
            }
            return;
        };
        search.window = window + 1;
        let contact = if *slip == 0.0 {
            flight.contact_in_window(window, limit)
        } else {
            match flight.end_in_window(window, limit, *slip) {
                Some(End::Contact(crossing)) => Some(crossing),
                Some(End::Turn { elapsed }) => {
                    search.found = Some(Prediction::Turn { time: time(elapsed) });
                    None
                }
                None => None,
            }
        };
        if let Some(there) = contact {
            search.found = Some(Prediction::Impact { time: time(there.elapsed), side: there.side });
            search.speed = there.speed;
        }
    }

    /// The next impact that has been found, and its relative speed, m/s.
    pub fn found_impact(&self) -> Option<(f64, Side, f64)> {
        let Search { found: Some(Prediction::Impact { time, side }), speed, .. } = self.search else { return None };
        Some((time, side, speed))
    }

    /// When the ball next sets out against friction, released or turned, s.
    pub fn found_start(&self) -> Option<f64> {
        match self.search.found {
            Some(Prediction::Release { time } | Prediction::Turn { time }) => Some(time),
            _ => None,
        }
    }

    /// The release that has been found, s.
    pub fn found_release(&self) -> Option<f64> {
        let Some(Prediction::Release { time }) = self.search.found else { return None };
        Some(time)
    }
}
