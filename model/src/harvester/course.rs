//! The way through the hold intervals of the phase noise, many in one go.
//!
//! The impulsive law lets the cylinder go its own way, so that a hold interval adds to velocity, position and dz what
//! [`Holds`](crate::holds::Holds) know of it. The state at the begin of an interval follows from that at the begin of the
//! one before by the same sums whoever asks and whenever, so that no step of a caller changes a bit. Inside an interval dz
//! stays within a bound, given by the largest acceleration, of its chord; only where that may touch a membrane the interval
//! is searched in closed form. The ends of the intervals lie at multiples of the hold time; only events are rounded to
//! what a double can tell as a time.

use core::f64::consts::TAU;

use super::events::Event;
use super::{Harvester, Noise, Search, phase};
use crate::cylinder::{CylinderMotion, Drive};
use crate::flight::{Flight, Side};
use crate::holds::{BLOCK, Block};
use crate::parameters::{ContactLaw, NoiseModel};

/// State at the begin of a hold interval.
///
/// Position and dz stand side by side: compilers pack neighbours into one vector, and the velocity, which both wait for, must
/// not wait for them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Boundary {
    /// Number of the interval.
    pub(super) sample: u64,
    /// `z_M`, m.
    position: f64,
    /// `z_M` - `z_m`, m.
    dz: f64,
    /// `z_M'`, m/s.
    velocity: f64,
    /// External force over M, m/s^2.
    external: f64,
}

/// What is the same in all hold intervals up to the next event.
#[derive(Clone, Copy)]
struct Pace {
    hold: f64,
    /// `z_m'` of a free ball, m/s.
    ball: f64,
    resting: Option<Side>,
    /// Rate of the external force over M, m/s^3.
    rate: f64,
    /// A / M, m/s^2.
    amplitude: f64,
    omega: f64,
    half_travel: f64,
}

impl Pace {
    /// What an external force over M, m/s^2, at the begin of an interval adds to velocity, m/s, and position, m.
    #[inline]
    fn by(&self, external: f64) -> [f64; 2] {
        let (hold, change) = (self.hold, self.rate * self.hold);
        [hold * (external + change / 2.0), hold * hold * (external / 2.0 + change / 6.0)]
    }

    /// The begin of the next interval, in which the forces change the velocity by this much, and the position besides.
    #[inline]
    fn after(&self, from: &Boundary, velocity: f64, position: f64) -> Boundary {
        let glide = self.hold * from.velocity;
        let dz = if self.resting.is_some() { 0.0 } else { (glide - self.hold * self.ball) + position };
        Boundary {
            sample: from.sample + 1,
            position: from.position + (glide + position),
            velocity: from.velocity + velocity,
            dz: from.dz + dz,
            external: from.external + self.hold * self.rate,
        }
    }

    /// The begin of the interval after that with this begin, which has this place in `block`.
    fn step(&self, from: &Boundary, (block, place): (&Block, usize)) -> Boundary {
        let [velocity, position] = self.by(from.external);
        self.after(from, block.velocity[place] + velocity, block.position[place] + position)
    }

    /// Goes on from `from`, in `block`, to the begin of interval `target` or of the next block.
    fn walk(&self, mut from: Boundary, (block, place): (&Block, usize), target: u64) -> Boundary {
        let mut external = self.by(from.external);
        for (velocity, position) in block.velocity[place..].iter().zip(&block.position[place..]) {
            if from.sample == target {
                break;
            }
            from = self.after(&from, velocity + external[0], position + external[1]);
            if self.rate != 0.0 {
                external = self.by(from.external);
            }
        }
        from
    }

    /// Goes on from `from`, in `block`, to the begin of the first interval in which something might happen, or of the next
    /// block.
    fn pass(&self, mut from: Boundary, (block, place): (&Block, usize)) -> Boundary {
        let (near, doubt) = (self.near(&from), self.doubt());
        if self.resting.is_none() && from.dz.abs() >= near {
            return from;
        }
        let mut external = self.by(from.external);
        for (velocity, position) in block.velocity[place..].iter().zip(&block.position[place..]) {
            let next = self.after(&from, velocity + external[0], position + external[1]);
            let doubtful = match self.resting {
                Some(side) => side.sign() * (velocity + external[0]) <= doubt,
                None => next.dz.abs() >= near,
            };
            if doubtful {
                break;
            }
            from = next;
            if self.rate != 0.0 {
                external = self.by(from.external);
            }
        }
        from
    }

    /// |dz|, m, at both ends of an interval up to which the ball meets no membrane in between; for one block.
    fn near(&self, from: &Boundary) -> f64 {
        let [begin, end] = [0.0, BLOCK as f64].map(|n| (from.external + n * self.hold * self.rate).abs());
        let bulge = 0.125 * self.hold * self.hold * (self.amplitude + begin.max(end));
        let swing = self.amplitude / (self.omega * self.omega);
        self.half_travel * (1.0 - 1e-12) - 1.001 * bulge - 64.0 * f64::EPSILON * swing
    }

    /// Change of velocity in an interval, m/s, above which the acceleration has its sign all the time.
    fn doubt(&self) -> f64 {
        1.001 * self.hold * self.hold * (self.amplitude * self.omega + self.rate.abs())
    }
}

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
    /// Whether hold intervals are passed in one go. A contact that lasts, a Wiener process and the states of an integrator
    /// take them one by one; and so do intervals longer than a window of the search, which cost nothing.
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
            ball: self.ball.velocity,
            resting: self.ball.resting,
            rate: drive.external_rate,
            amplitude: drive.amplitude,
            omega: TAU * drive.frequency,
            half_travel: self.half_travel(),
        }
    }

    /// The begin of the hold interval after the present one.
    pub(super) fn next_boundary(&mut self) -> Boundary {
        let (pace, cylinder, flight, sample) = (self.pace(), self.cylinder, self.search.flight, self.noise.sample);
        let (begin, end) = (self.hold_start(sample), self.hold_start(sample + 1));
        let here = Boundary {
            sample,
            position: cylinder.position,
            velocity: cylinder.velocity,
            dz: flight.dz,
            external: cylinder.drive.external,
        };
        let mut next = pace.step(&here, self.holds.block(sample));
        // Cylinder or ball may have begun their present motion inside the interval.
        if cylinder.start != begin {
            let external = here.external + pace.rate * (end - cylinder.start);
            let (position, velocity) = (cylinder.position(end), cylinder.velocity(end));
            next = Boundary { position, velocity, external, ..next };
        }
        if flight.start != begin && pace.resting.is_none() {
            next.dz = flight.derivative(0, self.rest_of_hold(flight.start));
        }
        next
    }

    fn motion_from(&self, boundary: &Boundary) -> CylinderMotion {
        let noise = Noise { sample: boundary.sample, ..self.noise };
        let drive =
            Drive { phase: phase(&self.parameters, &noise), external: boundary.external, ..self.cylinder.drive };
        CylinderMotion::new(self.hold_start(boundary.sample), boundary.position, boundary.velocity, drive)
    }

    fn flight_from(&self, boundary: &Boundary, cylinder: &CylinderMotion) -> Flight {
        let velocity = if self.ball.resting.is_some() { boundary.velocity } else { self.ball.velocity };
        Flight::new(cylinder, &cylinder.at(cylinder.start), boundary.dz, velocity, self.half_travel())
    }

    /// The cylinder's motion when the event comes that is foreseen.
    pub(super) fn foreseen_motion(&self) -> CylinderMotion {
        self.search.ahead.map_or(self.cylinder, |boundary| self.motion_from(&boundary))
    }

    /// The hold interval with this begin becomes the present one.
    pub(super) fn enter(&mut self, boundary: Boundary) {
        self.cylinder = self.motion_from(&boundary);
        self.noise.sample = boundary.sample;
        self.search.flight = self.flight_from(&boundary, &self.cylinder);
        self.forget_the_way();
    }

    /// An event that is foreseen in the present hold interval is not ahead of it.
    fn forget_the_way(&mut self) {
        let Search { found, ahead, .. } = &mut self.search;
        *ahead = ahead.filter(|ahead| found.is_none() || ahead.sample != self.noise.sample);
    }

    /// Enters the hold interval of `time`, s, up to which nothing happens any more.
    pub(super) fn follow_noise(&mut self, time: f64) {
        if !self.in_blocks() || self.noise_limit().is_none_or(|limit| time < limit) {
            return;
        }
        let (pace, target) = (self.pace(), hold_at(self.parameters.noise_hold, time));
        let mut boundary = self.next_boundary();
        while boundary.sample < target {
            boundary = pace.walk(boundary, self.holds.block(boundary.sample), target);
        }
        self.enter(boundary);
    }

    /// Searches the hold intervals ahead for an event, block by block, until one begins after `until`, s. If the caller is
    /// to get there, `follow` spares it the way.
    pub(super) fn search_ahead(&mut self, mut boundary: Boundary, until: f64, follow: bool) {
        let (pace, mut reached) = (self.pace(), None);
        while self.search.found.is_none() && self.hold_start(boundary.sample) <= until {
            reached = Some(boundary);
            let block_end = (boundary.sample / BLOCK as u64 + 1) * BLOCK as u64;
            while boundary.sample < block_end {
                boundary = pace.pass(boundary, self.holds.block(boundary.sample));
                if boundary.sample == block_end {
                    break;
                }
                self.search.found = self.look_closely(&boundary);
                if self.search.found.is_some() {
                    break;
                }
                boundary = pace.step(&boundary, self.holds.block(boundary.sample));
            }
        }
        self.search.ahead = Some(boundary);
        match reached.filter(|_| follow) {
            Some(reached) => self.enter(reached),
            None => self.forget_the_way(),
        }
    }

    /// The event in the hold interval with this begin, in closed form.
    fn look_closely(&self, boundary: &Boundary) -> Option<Event> {
        let (hold, end) = (self.parameters.noise_hold, self.hold_start(boundary.sample + 1));
        let cylinder = self.motion_from(boundary);
        let flight = self.flight_from(boundary, &cylinder);
        let time = |elapsed: f64| (flight.start + elapsed).min(end);
        if let Some(side) = self.ball.resting {
            let release = flight.release_in_window(side, 0, hold);
            return release.map(|elapsed| Event::Release { time: time(elapsed) });
        }
        let contact = flight.contact_in_window(0, hold);
        contact.map(|contact| Event::Impact { time: time(contact.elapsed), side: contact.side })
    }
}

#[cfg(test)]
mod tests;
