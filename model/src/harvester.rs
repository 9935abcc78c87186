//! The vibro-impact harvester: its parts, and how they act together from event to event.

mod differences;
mod events;
mod inputs;
mod integrator;
// Thousands of hold intervals of safe code, too many for Miri.
#[cfg(test)]
#[cfg(not(miri))]
mod noise_tests;
mod outputs;
mod predicted;
mod snapshot;

pub use self::events::{Event, Impact, Peak};
pub use self::snapshot::Snapshot;

use self::differences::Origin;
use self::events::Show;
use crate::accounting::batch::Batch;
use crate::accounting::budget::Budget;
use crate::accounting::ledger::{Ledger, Totals, Works};
use crate::contact::Ramp;
use crate::error::ModelError;
use crate::membrane::Membrane;
use crate::motion::cylinder::Drive;
use crate::motion::pulse::{PulseShape, Pulses};
use crate::motion::{Ball, Forces, Motion, Start};
use crate::noise::Noise;
use crate::parameters::Parameters;
use crate::sensitivity::{Direction, Tangent, Tangential};
use crate::setup::Setup;
use crate::shared::Shared;

/// The harvester: state at one time, moved forward by [`Harvester::advance`].
#[derive(Debug, PartialEq)]
pub struct Harvester {
    parameters: Shared<Parameters>,
    membrane: Shared<Membrane>,
    time: f64,
    motion: Motion,
    noise: Noise,
    /// Voltages across the membranes, V, for the Maxwell force.
    voltages: [Ramp; 2],
    pulses: Pulses,
    ledger: Ledger,
    budget: Budget,
    tangent: Tangent,
    /// From where changes are taken by differences.
    origin: Option<Origin>,
    /// Up to here, s, nothing happens and nothing more is to be predicted: on the way only the time changes.
    calm_until: f64,
}

impl Clone for Harvester {
    fn clone(&self) -> Self {
        let Self { time, voltages, ledger, budget, calm_until, .. } = *self;
        Self {
            parameters: self.parameters.clone(),
            membrane: self.membrane.clone(),
            time,
            motion: self.motion.clone(),
            noise: self.noise.clone(),
            voltages,
            pulses: self.pulses.clone(),
            ledger,
            budget,
            tangent: self.tangent.clone(),
            origin: self.origin.clone(),
            calm_until,
        }
    }

    /// Masters that try steps save a harvester and take it back at each of them: this takes no memory that is there already, and
    /// moves what it copies once.
    fn clone_from(&mut self, source: &Self) {
        self.motion.clone_from(&source.motion);
        self.noise.clone_from(&source.noise);
        self.pulses.clone_from(&source.pulses);
        match (&mut self.origin, &source.origin) {
            (Some(Origin::Force(origin)), Some(Origin::Force(other))) => origin.clone_from(other),
            (origin, other) => origin.clone_from(other),
        }
        self.parameters.clone_from(&source.parameters);
        self.membrane.clone_from(&source.membrane);
        self.tangent.clone_from(&source.tangent);
        let Self { time, voltages, ledger, budget, calm_until, .. } = *source;
        (self.time, self.voltages, self.calm_until) = (time, voltages, calm_until);
        (self.ledger, self.budget) = (ledger, budget);
    }
}

impl Harvester {
    /// The harvester at `start`, s, in its initial state, from parameters and, if there is one, the recording that excites it
    /// ([`Parameters::with_recording`]). A ball that starts on a membrane and approaches it has met it:
    /// [`Harvester::present_impact`].
    ///
    /// # Errors
    /// A parameter out of bounds ([`Parameters::validate`]); a recording that does not fit ([`Setup::validate`]); a start time beyond 1e9 s before or after zero, or, with
    /// phase noise, beyond 2^52 hold intervals.
    pub fn new<'a>(setup: impl Into<Setup<'a>>, start: f64) -> Result<Self, ModelError> {
        let mut harvester = Self::before_events(&setup.into(), start)?;
        harvester.begin();
        harvester.advance(start)?;
        Ok(harvester)
    }

    /// The harvester at `start`, s, under the external `force`, N, whose [`Harvester::sensitivities`] are those to first
    /// order along `direction`.
    ///
    /// # Errors
    /// As [`Harvester::new`]; a force that is not finite or beyond 1e18 N.
    pub fn along<'a>(
        setup: impl Into<Setup<'a>>,
        start: f64,
        force: f64,
        direction: &Direction,
    ) -> Result<Self, ModelError> {
        inputs::check_force([force, 0.0])?;
        let setup = setup.into();
        let mut harvester = Self::before_events(&setup, start)?;
        let xi = harvester.noise.xi(harvester.noise.sample);
        harvester.origin = harvester.origin_along(force, direction);
        if harvester.origin.is_none() {
            harvester.tangent = Tangent::along(setup.parameters, start, force, direction, xi);
        }
        harvester.begin();
        harvester.advance(start)?;
        harvester.push(force, 0.0);
        Ok(harvester)
    }

    /// The harvester at `start`, s; what happens there is still ahead.
    fn before_events(setup: &Setup<'_>, start: f64) -> Result<Self, ModelError> {
        setup.validate()?;
        let (p, playback) = (setup.parameters, setup.playback());
        let mut noise = Noise::at_start(p, start)?;
        let mut drive = Drive::new(p, noise.phase(noise.sample), [0.0; 2]);
        if let Some(playback) = &playback {
            noise.pass_singly();
            drive.recorded = playback.segment_at(start);
        }
        let cylinder = Start { time: start, position: p.cylinder_position, velocity: p.cylinder_velocity };
        let half = p.travel() / 2.0;
        let position = p.initial_ball_position();
        let last = Start { time: start, position, velocity: p.ball_velocity };
        let projected = p.projected_side().map(|side| side.sign() * half);
        let displacement = projected.unwrap_or(p.cylinder_position - position);
        let relative = Start { time: start, position: displacement, velocity: p.cylinder_velocity - p.ball_velocity };
        let slip = if p.friction_acceleration() > 0.0 { relative.velocity.signum() } else { 0.0 };
        let mut motion = Motion::new(p, cylinder, drive, last, (Ball::Free, slip), relative);
        motion.playback = playback;
        let works = Works { slide: [p.cylinder_position, displacement], ..Works::default() };
        let membrane = Membrane::new(*setup);
        let shape = PulseShape::new(p.stiffness_exponent, p.restitution);
        let ledger = Ledger::new(p, membrane.rest_capacitance, Totals::default(), works);
        Ok(Self {
            parameters: Shared::new(*p),
            membrane: Shared::new(membrane),
            time: start,
            motion,
            noise,
            voltages: [Ramp { start, value: p.bias_voltage, rate: 0.0 }; 2],
            pulses: Pulses { shape, under_way: Default::default() },
            ledger,
            budget: Budget::new(p, 0.0, 0),
            tangent: Tangent::none(),
            origin: None,
            calm_until: f64::NEG_INFINITY,
        })
    }

    /// Moves on to `time`, s, through every event up to and including it. How a run is split into calls changes nothing.
    ///
    /// # Errors
    /// A time that is not finite or lies in the past; more events than can be resolved.
    #[inline]
    pub fn advance(&mut self, time: f64) -> Result<(), ModelError> {
        self.advance_shown(time, None)
    }

    /// Moves on as [`Harvester::advance`] does, and shows each impact and each largest deflection to `show`; not that of
    /// the start, [`Harvester::present_impact`].
    ///
    /// # Errors
    /// As [`Harvester::advance`].
    #[inline]
    pub fn advance_with(&mut self, time: f64, mut show: impl FnMut(&Event)) -> Result<(), ModelError> {
        self.advance_shown(time, Some(&mut show))
    }

    /// Moves on as [`Harvester::advance_with`] does, but no further than to the first knot of the capacitances behind the present
    /// time, [`Harvester::next_knot`]; impacts are such knots. Whether it stopped at one.
    ///
    /// # Errors
    /// As [`Harvester::advance`].
    pub fn advance_to_knot(&mut self, time: f64, mut show: impl FnMut(&Event)) -> Result<bool, ModelError> {
        let is_calm = self.time <= time && time < self.calm_until;
        if is_calm && self.pulses.next_knots(self.time).all(|knot| knot.time > time) {
            self.time = time;
            return Ok(false);
        }
        loop {
            let impacts = self.totals().impacts;
            let (end, is_knot) = self.smooth_until(time);
            self.advance_shown(end, Some(&mut show))?;
            if is_knot || self.totals().impacts > impacts {
                return Ok(true);
            }
            if end >= time {
                return Ok(false);
            }
        }
    }

    #[inline]
    fn advance_shown(&mut self, time: f64, show: Option<&mut Show<'_>>) -> Result<(), ModelError> {
        if self.time <= time && time < self.calm_until {
            self.time = time;
            return Ok(());
        }
        self.advance_through_events(time, show)
    }

    fn advance_through_events(&mut self, time: f64, show: Option<&mut Show<'_>>) -> Result<(), ModelError> {
        inputs::finite("time", time)?;
        if time < self.time {
            return Err(ModelError::Backwards { from: self.time, to: time });
        }
        self.go_to(time, show)?;
        self.look_ahead();
        Ok(())
    }

    /// Moves on to `time`, s; what comes after it is not known yet.
    fn go_to(&mut self, time: f64, show: Option<&mut Show<'_>>) -> Result<(), ModelError> {
        self.calm_until = f64::NEG_INFINITY; // until it is known anew; an error on the way leaves nothing predicted
        let mut batch = Batch::EMPTY;
        let passed = self.pass_events(time, &mut batch, show);
        batch.settle(&self.membrane, &mut self.pulses, &mut self.ledger);
        passed?;
        self.motion.enter_interval_of(&mut self.noise, time);
        self.time = time;
        Ok(())
    }

    /// Makes the next impact known, beyond a release, too; what is found does not depend on the steps.
    fn look_ahead(&mut self) {
        self.search_from(self.time);
        self.look_beyond_release();
        self.calm_until = self.motion.calm_until(&self.noise);
    }

    /// Searches for the next event as far ahead of `time`, s, as events are predicted.
    #[inline(never)]
    fn search_from(&mut self, time: f64) {
        let horizon = self.horizon();
        self.motion.next_event(&mut self.noise, time + horizon, false);
    }

    /// How far ahead events are predicted, s.
    fn horizon(&self) -> f64 {
        self.noise.horizon(self.motion.horizon())
    }

    fn forces(&self) -> Forces<'_> {
        Forces { parameters: &self.parameters, membrane: &self.membrane, voltages: &self.voltages }
    }

    /// The parts that take part in a contact, and the end of the present hold interval, s.
    fn parts(&mut self) -> (&mut Motion, Forces<'_>, Option<f64>, &mut Ledger, &mut Budget) {
        let Self { parameters, membrane, voltages, motion, noise, ledger, budget, .. } = self;
        (motion, Forces { parameters, membrane, voltages }, noise.limit(), ledger, budget)
    }

    fn tangential(&self) -> Tangential<'_> {
        let Self { parameters, membrane, motion, noise, tangent, .. } = self;
        Tangential { parameters, membrane, motion, noise, tangent }
    }
}
