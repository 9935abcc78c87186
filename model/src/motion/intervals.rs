//! The way through the hold intervals of the phase noise, many in one go.
//!
//! The impulsive law lets the cylinder go its own way, so that in a block of hold intervals the states follow from that
//! at the begin of one of them, the anchor, in closed form with the sums of the block. Anchors are the begin of each block
//! and of the interval after an event, whoever asks and whenever, so that no step of a caller changes a bit. The ends of
//! the intervals lie at multiples of the hold time; only events are rounded to what a double can tell as a time.

use core::f64::consts::TAU;

use super::Motion;
use super::cylinder::{CylinderMotion, CylinderState, Drive};
use super::events::{Prediction, Search};
use super::flight::Flight;
use super::mount::Load;
use crate::noise::Noise;
use crate::noise::block::BLOCK;
use crate::noise::intervals::{Anchored, Conditions, HoldState};

impl Motion {
    fn conditions(&self, noise: &Noise) -> Conditions {
        let drive = &self.cylinder.drive;
        Conditions {
            hold: noise.hold(),
            resting: self.ball.support().map(super::side::Side::sign),
            rate: drive.external_rate,
            incline: self.mount.incline,
            amplitude: drive.amplitude,
            omega: TAU * drive.frequency,
            half_travel: self.half_travel,
        }
    }

    /// The begin of the hold interval after the present one.
    pub(super) fn next_interval(&self, noise: &mut Noise) -> Anchored {
        let anchor = self.search.anchor.unwrap_or_else(|| self.hold_state(noise.sample));
        // Cylinder or ball may have begun their present motion inside the interval.
        let begin = noise.begin_of(noise.sample);
        if self.cylinder.start != begin || self.flight.start != begin {
            return Anchored::at_anchor(self.after_event(noise));
        }
        self.follow(noise, anchor, noise.sample + 1)
    }

    /// The state at the begin of the present motion, as if it were the begin of the present hold interval.
    pub fn hold_state(&self, sample: u64) -> HoldState {
        let CylinderMotion { position, velocity, drive, .. } = self.cylinder;
        let Flight { dz, rate, .. } = self.flight;
        HoldState { sample, position, velocity, dz, rate, external: drive.external }
    }

    /// The begin of the interval after an event.
    fn after_event(&self, noise: &Noise) -> HoldState {
        let (cylinder, flight, sample) = (&self.cylinder, &self.flight, noise.sample + 1);
        let end = noise.begin_of(sample);
        let is_resting = self.ball.support().is_some();
        let [dz, rate] = if is_resting { [flight.dz, 0.0] } else { flight.at(noise.rest_after(flight.start)) };
        let CylinderState { position, velocity, .. } = cylinder.at(end);
        HoldState { sample, position, velocity, dz, rate, external: self.drive_at(end).external }
    }

    /// The begin of hold interval `sample` on the way that leads from `anchor`, which does not lie behind it.
    fn follow(&self, noise: &mut Noise, mut anchor: HoldState, sample: u64) -> Anchored {
        let (conditions, size) = (self.conditions(noise), BLOCK as u64);
        while anchor.sample / size < sample / size {
            anchor = conditions.at(&anchor, noise.block(anchor.sample), BLOCK);
        }
        let place = crate::noise::block::place_in_block(sample);
        Anchored { anchor, here: conditions.at(&anchor, noise.block(sample), place) }
    }

    fn cylinder_from(&self, noise: &Noise, state: &HoldState, phase: f64) -> CylinderMotion {
        let drive = Drive { phase, external: state.external, ..self.cylinder.drive };
        CylinderMotion::new(noise.begin_of(state.sample), state.position, state.velocity, drive, Load::NONE)
    }

    fn flight_from(&self, state: &HoldState, cylinder: &CylinderMotion) -> Flight {
        Flight::new(cylinder, &cylinder.at_start(), [state.dz, state.rate], self.half_travel, self.mount.incline)
    }

    /// The cylinder's motion when the event comes that is predicted.
    pub fn predicted_cylinder(&self, noise: &Noise) -> CylinderMotion {
        let ahead = self.search.ahead;
        let in_interval = ahead.map(|Anchored { here, .. }| self.cylinder_from(noise, &here, noise.phase(here.sample)));
        in_interval.or_else(|| self.cylinder_of_predicted_piece()).unwrap_or(self.cylinder)
    }

    /// Enters the hold interval ahead in which the event is that has been found.
    pub fn enter_predicted(&mut self, noise: &mut Noise) {
        self.enter_predicted_piece();
        if let Some(ahead) = self.search.ahead {
            self.enter(noise, ahead);
        }
    }

    /// The hold interval with this begin becomes the present one.
    fn enter(&mut self, noise: &mut Noise, Anchored { anchor, here }: Anchored) {
        let phase = noise.phase_in_block(here.sample);
        self.cylinder = self.cylinder_from(noise, &here, phase);
        noise.sample = here.sample;
        self.flight = self.flight_from(&here, &self.cylinder);
        self.search.anchor = (anchor.sample < here.sample).then_some(anchor);
        self.forget_the_way(noise.sample);
    }

    /// An event that is predicted in the present hold interval is not ahead of it.
    fn forget_the_way(&mut self, present: u64) {
        let Search { found, ahead, .. } = &mut self.search;
        *ahead = ahead.filter(|ahead| found.is_none() || ahead.here.sample != present);
    }

    /// Enters the hold interval of `time`, s, up to which nothing happens any more.
    pub fn enter_interval_of(&mut self, noise: &mut Noise, time: f64) {
        self.enter_piece_of(time);
        if !noise.in_blocks() || noise.limit().is_none_or(|limit| time < limit) {
            return;
        }
        let (target, next) = (noise.sample_at(time), self.next_interval(noise));
        let reached = self.follow(noise, next.anchor, target);
        self.enter(noise, reached);
    }

    /// Searches the hold intervals ahead for an event, block by block, until one begins after `until`, s. If the caller
    /// is to get there, `follow` spares it the way.
    pub(super) fn search_ahead(&mut self, noise: &mut Noise, mut ahead: Anchored, until: f64, follow: bool) {
        let (conditions, mut reached) = (self.conditions(noise), None);
        while self.search.found.is_none() && noise.begin_of(ahead.here.sample) <= until {
            reached = Some(ahead);
            let (anchor, mut first) = (ahead.anchor, ahead.here.place());
            while let Some(doubtful) = conditions.doubtful(&anchor, noise.block(anchor.sample), first) {
                let here = conditions.at(&anchor, noise.block(anchor.sample), doubtful);
                self.search_interval(noise, &here);
                if self.search.found.is_some() {
                    ahead.here = here;
                    break;
                }
                first = doubtful + 1;
            }
            if self.search.found.is_none() {
                ahead = Anchored::at_anchor(conditions.at(&anchor, noise.block(anchor.sample), BLOCK));
            }
        }
        self.search.ahead = Some(ahead);
        match reached.filter(|_| follow) {
            Some(reached) => self.enter(noise, reached),
            None => self.forget_the_way(noise.sample),
        }
    }

    /// Searches the hold interval with this begin in closed form.
    fn search_interval(&mut self, noise: &Noise, state: &HoldState) {
        let (hold, end) = (noise.hold(), noise.begin_of(state.sample + 1));
        let cylinder = self.cylinder_from(noise, state, noise.phase(state.sample));
        let flight = self.flight_from(state, &cylinder);
        let time = |elapsed: f64| (flight.start + elapsed).min(end);
        if let Some(side) = self.ball.support() {
            let release = flight.departure_in_window(Some(side), &self.mount, 0, hold);
            self.search.found = release.map(|elapsed| Prediction::Release { time: time(elapsed) });
            return;
        }
        let crossing = flight.contact_in_window(0, hold);
        self.search.speed = crossing.map_or(0.0, |there| there.speed);
        self.search.found = crossing.map(|there| Prediction::Impact { time: time(there.elapsed), side: there.side });
    }
}
