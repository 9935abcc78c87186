//! The events of the motion: what comes next, and what it does.

use super::course::{Boundary, Place};
use super::dues::Dues;
use super::phase::phase;
use super::tangent::Hit;
use super::{Ball, Harvester};
use crate::cylinder::{CylinderState, Drive};
use crate::error::ModelError;
use crate::flight::{Flight, Side};
use crate::noise;
use crate::parameters::{ContactLaw, NoiseModel};
use crate::pulse::Pulse;

/// Relative change of the wall's acceleration over the rest of a chattering sequence below which it counts as constant,
/// so that the rest is a geometric series.
const CHATTER_TOLERANCE: f64 = 1e-5;

/// Height of a bounce, in units of s/2, below which a ball may count as resting.
const CHATTER_HEIGHT: f64 = 1e-9;

/// The same two bounds for an integrator with tolerances, which cannot follow bounces so low.
const PLACED_CHATTER_TOLERANCE: f64 = 1e-3;
const PLACED_CHATTER_HEIGHT: f64 = 1e-6;

/// Events allowed within one second of simulated time. Forged states use all of them up, which a fuzzer has no time for.
const EVENT_BUDGET: u64 = if cfg!(fuzzing) { 2_000 } else { 1_000_000 };

/// What the next event is. Times in s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Event {
    Impact {
        time: f64,
        side: Side,
    },
    Release {
        time: f64,
    },
    /// The contact changes: it turns, ends or goes on.
    Touch {
        time: f64,
    },
    /// The phase noise takes its next sample.
    NoiseSample {
        time: f64,
    },
}

impl Event {
    pub(super) fn time(self) -> f64 {
        match self {
            Self::Impact { time, .. } | Self::Release { time } | Self::Touch { time } | Self::NoiseSample { time } => {
                time
            }
        }
    }
}

/// How a chattering sequence ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Tail {
    /// Endless bounces in a time so short that they are a geometric series.
    Summed,
    /// Bounces lower than rounding; what they would still gain is left out.
    Unresolved,
}

/// How far the present flight (or rest) has been searched.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Search {
    pub(super) flight: Flight,
    /// Windows before this one hold no event.
    window: u64,
    pub(super) found: Option<Event>,
    /// Relative speed, m/s, of the impact that has been found.
    pub(super) speed: f64,
    /// Time of the first impact after the release that has been found, s, infinity if none is foreseen; none before it
    /// has been looked for.
    pub(super) after_release: Option<f64>,
    /// With phase noise: the begin of the first hold interval that has not been searched, or of that in which the event is
    /// that has been found, unless it is the present one.
    pub(super) ahead: Option<Place>,
    /// With phase noise: the begin of an earlier hold interval of the block, which the present one follows from.
    pub(super) anchor: Option<Boundary>,
    /// No event will ever come.
    exhausted: bool,
}

impl Search {
    pub(super) fn new(flight: Flight) -> Self {
        Self {
            flight,
            window: 0,
            found: None,
            speed: 0.0,
            after_release: None,
            ahead: None,
            anchor: None,
            exhausted: false,
        }
    }

    /// No search at all: no event is foreseen.
    pub(super) fn none(flight: Flight) -> Self {
        Self { exhausted: true, ..Self::new(flight) }
    }

    /// The search of a flight in which all events up to `time`, s, have happened: windows that lie before are passed over.
    pub(super) fn resumed(flight: Flight, time: f64) -> Self {
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        // saturates; time does not lie before the start
        let passed = ((time - flight.start) / flight.window_length()) as u64;
        Self { window: passed.saturating_sub(1), ..Self::new(flight) }
    }
}

impl Harvester {
    /// The membrane that a ball touches where its present flight begins, and the speed at which it approaches that, m/s.
    fn touched(&self) -> Option<(Side, f64)> {
        let Flight { dz, rate, .. } = self.search.flight;
        let side = if dz > 0.0 { Side::Left } else { Side::Right };
        let is_touching = (dz.abs() - self.half_travel()).abs() <= 4.0 * f64::EPSILON * self.half_travel();
        is_touching.then_some((side, side.sign() * rate))
    }

    /// A ball that starts on a membrane meets it if it approaches, and if it is pushed against it, without a speed, it rests.
    pub(super) fn begin_on_membrane(&mut self) {
        if let Some((side, speed)) = self.touched().filter(|(_, speed)| *speed > 0.0) {
            (self.search.found, self.search.speed) = (Some(Event::Impact { time: self.time, side }), speed);
        }
        let resting = self.touched().filter(|(_, speed)| *speed == 0.0);
        // Under the compliant law the search finds the instant from which on it is pressed in.
        let resting = resting.filter(|_| self.parameters.contact_law == ContactLaw::Impulsive);
        let wall = self.cylinder.at(self.time);
        if let Some((side, _)) = resting.filter(|(side, _)| self.end_of_bounces(*side, 0.0, &wall).is_some()) {
            let [_, wall_change] = self.cylinder_change(self.time);
            self.rest(side, &wall, wall_change);
        }
    }

    /// Takes cylinder and ball at `time` as the start of a new motion under `drive`.
    pub(super) fn restart(&mut self, time: f64, drive: Drive) {
        if self.touch.is_some() {
            return self.restart_touch(time, drive);
        }
        let motion = self.relative_motion_at(time);
        self.cylinder = self.cylinder.continued(time, drive);
        self.new_flight(&self.cylinder.at(time), motion);
    }

    /// Searches from where the cylinder is `here` and `z_M` - `z_m` and its rate are `motion`, m and m/s. These are handed on
    /// rather than computed from positions and velocities, so that a ball on a membrane is there to the last bit, and
    /// leaves it as fast as it should, however far the cylinder has drifted and however fast it is.
    pub(super) fn new_flight(&mut self, here: &CylinderState, motion: [f64; 2]) {
        self.search = Search::new(Flight::new(&self.cylinder, here, motion, self.half_travel()));
    }

    /// The next event, if there is one before the search windows have passed `until`, s. If the caller is to get there,
    /// `follow` spares it the way.
    pub(super) fn next_event(&mut self, until: f64, follow: bool) -> Option<Event> {
        if let Some(touch) = &self.touch {
            let end = touch.end();
            let limit = self.noise_limit().filter(|limit| *limit <= end);
            return Some(limit.map_or(Event::Touch { time: end }, |time| Event::NoiseSample { time }));
        }
        let limit = self.noise_limit();
        let start = self.search.flight.start;
        let in_blocks = self.in_blocks();
        let limit_elapsed = match limit {
            Some(_) if in_blocks => self.rest_of_hold(start),
            Some(time) => time - start,
            None => f64::INFINITY,
        };
        while self.search.found.is_none() && !self.search.exhausted {
            if let Some(place) = self.search.ahead {
                self.search_ahead(place, until, follow);
                break;
            }
            let begin = self.search.window as f64 * self.search.flight.window_length();
            if begin >= limit_elapsed && in_blocks {
                self.search.window = 0;
                self.search.ahead = Some(self.next_place());
                continue;
            }
            if begin >= limit_elapsed {
                self.search.found = limit.map(|time| Event::NoiseSample { time });
                break;
            }
            if start + begin > until {
                break;
            }
            self.search_window(limit_elapsed);
        }
        if in_blocks && self.search.found.is_some() {
            self.search.window = 0; // whether it was found from here or ahead
        }
        self.search.found
    }

    /// The time, s, up to which nothing happens and the search has nothing more to foresee. It follows from what has been
    /// found, not from the present time, so that no step of a caller changes it.
    pub(super) fn calm(&self) -> f64 {
        if self.parameters.phase_noise > 0.0 {
            return f64::NEG_INFINITY; // there is always a hold interval to enter
        }
        if let Some(touch) = &self.touch {
            return touch.end();
        }
        let Search { flight, window, found, exhausted, .. } = &self.search;
        match found {
            Some(event) => event.time(),
            None if *exhausted => f64::INFINITY,
            None => {
                let (searched, horizon) = (flight.start + *window as f64 * flight.window_length(), self.horizon());
                // Less the rounding of this difference and of the sum that the search compares with.
                searched - horizon - 4.0 * f64::EPSILON * (searched.abs() + horizon)
            }
        }
    }

    /// Searches one window of the flight or of the rest.
    fn search_window(&mut self, limit: f64) {
        let Search { ref flight, window, .. } = self.search;
        let end = self.noise_limit().unwrap_or(f64::INFINITY);
        let time = |elapsed: f64| (flight.start + elapsed).min(end);
        if let Some(side) = self.ball.resting {
            let release = flight.release_in_window(side, window, limit);
            self.search.found = release.map(|elapsed| Event::Release { time: time(elapsed) });
            self.search.window += 1;
            // Without a force that changes, the ball rests for ever.
            self.search.exhausted = release.is_none() && self.cylinder.drive.is_constant() && limit == f64::INFINITY;
            return;
        }
        let Some(window) = flight.skip(window) else {
            if limit == f64::INFINITY {
                self.search.exhausted = true;
            } else {
                self.search.window = u64::MAX;
            }
            return;
        };
        let contact = flight.contact_in_window(window, limit);
        self.search.window = window + 1;
        self.search.found = contact.map(|contact| Event::Impact { time: time(contact.elapsed), side: contact.side });
        self.search.speed = contact.map_or(0.0, |contact| contact.speed);
    }

    pub(super) fn process(&mut self, event: Event, dues: &mut Dues) -> Result<(), ModelError> {
        self.tangent.fresh = false;
        if let Some(place) = self.search.ahead {
            self.enter(place);
        }
        match event {
            Event::Impact { time, side } => {
                let speed = self.search.speed;
                self.spend(time)?;
                match self.parameters.contact_law {
                    ContactLaw::Impulsive => self.impact(time, side, speed, dues),
                    ContactLaw::Compliant => self.touch(time, side, speed),
                }
            }
            Event::Touch { .. } => self.follow_touch()?,
            Event::Release { time } => {
                self.spend(time)?;
                let motion = self.relative_motion_at(time);
                let [_, wall_change] = self.cylinder_change(time);
                self.tangent.motion = self.motion_change(time);
                self.ball = self.ball_at(time);
                self.book_release(wall_change);
                self.totals.releases += 1;
                self.new_flight(&self.cylinder.at(time), motion);
            }
            Event::NoiseSample { time } => self.next_noise_sample(time),
        }
        Ok(())
    }

    /// Counts an event against the budget of its second.
    pub(super) fn spend(&mut self, time: f64) -> Result<(), ModelError> {
        if !(0.0..1.0).contains(&(time - self.second)) {
            (self.second, self.second_events) = (time.floor(), 0);
        }
        self.second_events += 1;
        if self.second_events > EVENT_BUDGET {
            return Err(self.too_many_events(time));
        }
        Ok(())
    }

    pub(super) fn too_many_events(&self, time: f64) -> ModelError {
        let (travel, restitution) = (self.parameters.travel(), self.parameters.restitution);
        ModelError::TooManyEvents { time, limit: EVENT_BUDGET, travel, restitution }
    }

    /// Eqs. (10) to (13): the membrane is pressed in at relative `speed`, m/s, the ball rebounds, or comes to rest.
    pub(super) fn impact(&mut self, time: f64, side: Side, speed: f64, dues: &mut Dues) {
        let wall = self.cylinder.at(time);
        self.totals.impacts += 1;
        self.totals.last_speed = speed;
        let changes = if self.tangent.idle {
            self.owe(dues, time, side, speed);
            [0.0; 2]
        } else {
            self.credit_with_changes(speed, side, &wall)
        };
        self.book_impact(side, wall.velocity, speed);
        let rebound = self.parameters.restitution * speed;
        let dz = side.sign() * self.half_travel();
        let velocity = wall.velocity + side.sign() * rebound; // Eq. (11), with v_M subtracted from both sides
        self.ball = Ball { since: time, position: wall.position - dz, velocity, resting: None };
        self.new_flight(&wall, [dz, -side.sign() * rebound]);
        match self.end_of_bounces(side, rebound, &wall) {
            Some(Tail::Summed) => {
                self.settle_dues(dues);
                let excess = self.membrane.excess_of_chatter(rebound, self.parameters.restitution);
                self.credit(excess);
                if !self.tangent.idle {
                    self.take_over_tail(speed, excess);
                }
                self.settle(side, &wall, changes);
            }
            Some(Tail::Unresolved) => self.settle(side, &wall, changes),
            None => {}
        }
    }

    /// Credits an impact on this `wall`, and carries the changes that somebody asks for over it. Returns the
    /// changes of the wall's velocity and of how much faster the ball is, m/s.
    fn credit_with_changes(&mut self, speed: f64, side: Side, wall: &CylinderState) -> [f64; 2] {
        let peak = self.membrane.deflection(speed);
        let [excess, excess_slope] = self.membrane.capacitance_excess_and_slope(peak);
        let change = self.change_of(&Hit { side, speed, peak, excess_slope, wall: *wall });
        self.pulses[side.index()].push(&self.shape, Pulse { start: wall.time, speed, peak, change: change.pulse });
        self.credit(excess);
        self.take_over(&change, excess);
        change.wall
    }

    /// Ends a chattering sequence on this `wall`. Its velocity, and how much faster the ball is, change by `changes`, m/s.
    fn settle(&mut self, side: Side, wall: &CylinderState, changes: [f64; 2]) {
        self.totals.chatters += 1;
        self.book_settling(wall.velocity, changes);
        self.rest(side, wall, changes[0]);
    }

    /// From now on the ball rests on the membrane at `side`, on this `wall`, whose velocity changes by `wall_change`, m/s.
    fn rest(&mut self, side: Side, wall: &CylinderState, wall_change: f64) {
        self.book_rest(wall.velocity, wall_change);
        self.ball.resting = Some(side);
        self.new_flight(wall, [side.sign() * self.half_travel(), 0.0]);
    }

    /// Adds impacts whose `C_3` / `C_2` - 1 sum to `excess`: Eqs. (12) and (13).
    pub(super) fn credit(&mut self, excess: f64) {
        let bias = self.parameters.bias_voltage;
        self.totals.voltage_gain += bias * excess;
        self.totals.energy += 0.5 * bias * bias * self.membrane.rest_capacitance() * excess;
    }

    /// Whether a ball that leaves the `wall` at `side` with relative speed `rebound`, m/s, comes to rest there, because that
    /// pushes and the next bounce is lower than rounding, or at least very low, with all that
    /// follow so short that the push is constant meanwhile.
    fn end_of_bounces(&self, side: Side, rebound: f64, wall: &CylinderState) -> Option<Tail> {
        let CylinderState { time, jerk, .. } = *wall;
        let push = side.sign() * wall.acceleration;
        if push <= 0.0 {
            return (push == 0.0 && rebound == 0.0 && side.sign() * jerk > 0.0).then_some(Tail::Unresolved);
        }
        let (highest, tolerance) = if self.placed {
            (PLACED_CHATTER_HEIGHT, PLACED_CHATTER_TOLERANCE)
        } else {
            (CHATTER_HEIGHT, CHATTER_TOLERANCE)
        };
        let (highest, unresolved) = (highest * self.half_travel(), 4.0 * self.search.flight.rounding(0.0));
        if rebound * rebound > 2.0 * push * highest.max(unresolved) {
            return None;
        }
        // Flights of 2 v / a, 2 v r / a, ...: their sum.
        let duration = 2.0 * rebound / (push * (1.0 - self.parameters.restitution));
        let curvature = self.cylinder.drive.amplitude * self.cylinder.drive.omega().powi(2);
        let change = duration * (jerk.abs() + 0.5 * duration * curvature);
        let noise_limit = self.noise_limit().unwrap_or(f64::INFINITY);
        let height = rebound * rebound / (2.0 * push);
        if height <= highest && change <= tolerance * push && time + duration <= noise_limit {
            return Some(Tail::Summed);
        }
        (height <= unresolved).then_some(Tail::Unresolved)
    }

    pub(super) fn next_noise_sample(&mut self, time: f64) {
        let p = &self.parameters;
        if p.noise_model == NoiseModel::Wiener {
            self.noise.walk += p.noise_hold.sqrt() * noise::normal(p.seed, self.noise.sample);
        }
        self.noise.sample += 1;
        let drive = Drive { phase: phase(p, &self.noise), ..self.cylinder.drive };
        let external = drive.external + drive.external_rate * (time - self.cylinder.start);
        self.restart(time, Drive { external, ..drive });
    }

    /// End of the present hold interval of the phase noise, s; none without noise.
    pub(super) fn noise_limit(&self) -> Option<f64> {
        let p = &self.parameters;
        (p.phase_noise > 0.0).then(|| (self.noise.sample + 1) as f64 * p.noise_hold)
    }
}
