//! The way through the hold intervals of the phase noise, many in one go.
//!
//! The impulsive law lets the cylinder go its own way, so that in a block of hold intervals the states follow from that
//! at the begin of one of them, the anchor, in closed form with the sums that [`Holds`](crate::holds::Holds) have.
//! Anchors are the begin of each block and of the interval after an event, whoever asks and whenever, so that no step
//! of a caller changes a bit. Inside an interval dz stays within a bound, given by the largest acceleration, of its
//! chord; only where that may touch a membrane the interval is searched in closed form. The ends of the intervals lie
//! at multiples of the hold time; only events are rounded to what a double can tell as a time.

mod pace;

pub(super) use self::pace::{Boundary, Place};

use core::f64::consts::TAU;

use self::pace::Pace;
use super::Harvester;
use super::events::{Event, Search};
use super::phase::{Noise, phase};
use crate::cylinder::{CylinderMotion, Drive};
use crate::flight::Flight;
use crate::holds::BLOCK;
use crate::parameters::{ContactLaw, NoiseModel};

/// Number of the hold interval of length `hold`, s, that `time`, s, is in; 0 before t = 0.
pub(super) fn hold_at(hold: f64, time: f64) -> u64 {
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // saturates
    let mut sample = (time / hold) as u64;
    // The quotient is rounded, the grid is the product.
    while (sample + 1) as f64 * hold <= time {
        sample += 1;
    }
    while sample > 0 && sample as f64 * hold > time {
        sample -= 1;
    }
    sample
}

impl Harvester {
    /// Whether hold intervals are passed in one go. A contact that lasts, a Wiener process and the states of an
    /// integrator take them one by one; and so do intervals longer than a window of the search, which cost nothing.
    pub(super) fn in_blocks(&self) -> bool {
        let p = &self.parameters;
        p.phase_noise > 0.0
            && p.noise_model == NoiseModel::Held
            && p.contact_law == ContactLaw::Impulsive
            && !self.placed
            && p.noise_hold <= 1.0 / p.frequency
    }

    /// How far ahead of the present time events are foreseen, s.
    pub(super) fn horizon(&self) -> f64 {
        let period = 1.0 / self.parameters.frequency;
        if self.in_blocks() { period.min(BLOCK as f64 * self.parameters.noise_hold) } else { period }
    }

    /// Begin of hold interval `sample`, s.
    pub(super) fn hold_start(&self, sample: u64) -> f64 {
        sample as f64 * self.parameters.noise_hold
    }

    /// What remains of the present hold interval after `time`, s.
    pub(super) fn rest_of_hold(&self, time: f64) -> f64 {
        self.parameters.noise_hold - (time - self.hold_start(self.noise.sample))
    }

    fn pace(&self) -> Pace {
        let drive = &self.cylinder.drive;
        Pace {
            hold: self.parameters.noise_hold,
            resting: self.ball.resting,
            rate: drive.external_rate,
            amplitude: drive.amplitude,
            omega: TAU * drive.frequency,
            half_travel: self.half_travel(),
        }
    }

    /// The begin of the hold interval after the present one.
    pub(super) fn next_place(&mut self) -> Place {
        let (pace, sample) = (self.pace(), self.noise.sample);
        let anchor = self.search.anchor.unwrap_or_else(|| self.present_boundary());
        // Cylinder or ball may have begun their present motion inside the interval.
        let begin = self.hold_start(sample);
        if self.cylinder.start != begin || self.search.flight.start != begin {
            return Place::of_anchor(self.boundary_after_event());
        }
        self.place_at(&pace, anchor, sample + 1)
    }

    /// The state at the begin of the present motion, as if it were the begin of the present hold interval.
    pub(super) fn present_boundary(&self) -> Boundary {
        let CylinderMotion { position, velocity, drive, .. } = self.cylinder;
        let Flight { dz, rate, .. } = self.search.flight;
        Boundary { sample: self.noise.sample, position, velocity, dz, rate, external: drive.external }
    }

    fn boundary_after_event(&self) -> Boundary {
        let (cylinder, flight, sample) = (&self.cylinder, &self.search.flight, self.noise.sample + 1);
        let end = self.hold_start(sample);
        let is_resting = self.ball.resting.is_some();
        let [dz, rate] = if is_resting { [flight.dz, 0.0] } else { flight.at(self.rest_of_hold(flight.start)) };
        let Drive { external, external_rate, .. } = cylinder.drive;
        let external = external + external_rate * (end - cylinder.start);
        Boundary { sample, position: cylinder.position(end), velocity: cylinder.velocity(end), dz, rate, external }
    }

    /// The begin of hold interval `sample` on the way that leads from `anchor`, which does not lie behind it.
    fn place_at(&mut self, pace: &Pace, mut anchor: Boundary, sample: u64) -> Place {
        let size = BLOCK as u64;
        while anchor.sample / size < sample / size {
            anchor = pace.at(&anchor, self.holds.block(anchor.sample), BLOCK);
        }
        #[allow(clippy::cast_possible_truncation)] // less than BLOCK
        let here = pace.at(&anchor, self.holds.block(sample), (sample % size) as usize);
        Place { anchor, here }
    }

    fn motion_from(&self, boundary: &Boundary) -> CylinderMotion {
        let noise = Noise { sample: boundary.sample, ..self.noise };
        self.motion_under(boundary, phase(&self.parameters, &noise))
    }

    fn motion_under(&self, boundary: &Boundary, phase: f64) -> CylinderMotion {
        let drive = Drive { phase, external: boundary.external, ..self.cylinder.drive };
        CylinderMotion::new(self.hold_start(boundary.sample), boundary.position, boundary.velocity, drive)
    }

    fn flight_from(&self, boundary: &Boundary, cylinder: &CylinderMotion) -> Flight {
        Flight::new(cylinder, &cylinder.at(cylinder.start), [boundary.dz, boundary.rate], self.half_travel())
    }

    /// The cylinder's motion when the event comes that is foreseen.
    pub(super) fn foreseen_motion(&self) -> CylinderMotion {
        self.search.ahead.map_or(self.cylinder, |place| self.motion_from(&place.here))
    }

    /// The hold interval with this begin becomes the present one.
    pub(super) fn enter(&mut self, place: Place) {
        let Place { anchor, here } = place;
        let xi = self.holds.block(here.sample).sample(here.place()); // at hand: phase() would make it once more
        self.cylinder = self.motion_under(&here, self.parameters.phase + self.parameters.phase_noise * xi);
        self.noise.sample = here.sample;
        self.search.flight = self.flight_from(&here, &self.cylinder);
        self.search.anchor = (anchor.sample < here.sample).then_some(anchor);
        self.forget_the_way();
    }

    /// An event that is foreseen in the present hold interval is not ahead of it.
    fn forget_the_way(&mut self) {
        let Search { found, ahead, .. } = &mut self.search;
        *ahead = ahead.filter(|ahead| found.is_none() || ahead.here.sample != self.noise.sample);
    }

    /// Enters the hold interval of `time`, s, up to which nothing happens any more.
    pub(super) fn follow_noise(&mut self, time: f64) {
        if !self.in_blocks() || self.noise_limit().is_none_or(|limit| time < limit) {
            return;
        }
        let (pace, target) = (self.pace(), hold_at(self.parameters.noise_hold, time));
        let next = self.next_place();
        let place = self.place_at(&pace, next.anchor, target);
        self.enter(place);
    }

    /// Searches the hold intervals ahead for an event, block by block, until one begins after `until`, s. If the caller
    /// is to get there, `follow` spares it the way.
    pub(super) fn search_ahead(&mut self, mut place: Place, until: f64, follow: bool) {
        let (pace, mut reached) = (self.pace(), None);
        while self.search.found.is_none() && self.hold_start(place.here.sample) <= until {
            reached = Some(place);
            let (anchor, mut first) = (place.anchor, place.here.place());
            while let Some(doubtful) = pace.doubtful(&anchor, self.holds.block(anchor.sample), first) {
                let here = pace.at(&anchor, self.holds.block(anchor.sample), doubtful);
                self.search.found = self.look_closely(&here);
                if self.search.found.is_some() {
                    place.here = here;
                    break;
                }
                first = doubtful + 1;
            }
            if self.search.found.is_none() {
                place = Place::of_anchor(pace.at(&anchor, self.holds.block(anchor.sample), BLOCK));
            }
        }
        self.search.ahead = Some(place);
        match reached.filter(|_| follow) {
            Some(reached) => self.enter(reached),
            None => self.forget_the_way(),
        }
    }

    /// The event in the hold interval with this begin, in closed form.
    fn look_closely(&mut self, boundary: &Boundary) -> Option<Event> {
        let (hold, end) = (self.parameters.noise_hold, self.hold_start(boundary.sample + 1));
        let cylinder = self.motion_from(boundary);
        let flight = self.flight_from(boundary, &cylinder);
        let time = |elapsed: f64| (flight.start + elapsed).min(end);
        if let Some(side) = self.ball.resting {
            let release = flight.release_in_window(side, 0, hold);
            return release.map(|elapsed| Event::Release { time: time(elapsed) });
        }
        let contact = flight.contact_in_window(0, hold);
        self.search.speed = contact.map_or(0.0, |contact| contact.speed);
        contact.map(|contact| Event::Impact { time: time(contact.elapsed), side: contact.side })
    }
}

#[cfg(test)]
mod tests;
