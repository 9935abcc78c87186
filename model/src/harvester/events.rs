//! What events do to the parts, and what a caller is shown of them.

use super::Harvester;
use crate::accounting::batch::Batch;
use crate::contact::Ending;
use crate::error::ModelError;
use crate::motion::cylinder::{CylinderState, Drive};
use crate::motion::flight::Flight;
use crate::motion::pulse::{Pulse, PulseChange, Running};
use crate::motion::side::Side;
use crate::motion::{Ball, Prediction, Start, Tail};
use crate::parameters::ContactLaw;
use crate::sensitivity::Hit;

/// One impact, as [`Harvester::advance_with`] shows it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Impact {
    /// Time, s.
    pub time: f64,
    /// The membrane.
    pub side: Side,
    /// Relative speed before the impact, m/s.
    pub speed: f64,
    /// The ball comes to rest on the membrane.
    pub rests: bool,
}

/// A largest deflection, as [`Harvester::advance_with`] shows it: under the impulsive law with the impact that it follows,
/// under the compliant law when it is reached.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Peak {
    /// When the membrane is there, s.
    pub time: f64,
    /// The membrane.
    pub side: Side,
    /// Its deflection, m.
    pub deflection: f64,
    /// Voltage across it when this is shown, V.
    pub voltage: f64,
}

/// What looks at the events of a run; only for it largest deflections are worked out.
pub(super) type Show<'a> = dyn FnMut(&Event) + 'a;

/// What [`Harvester::advance_with`] shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Event {
    /// An impact; under the compliant law the begin of a contact.
    Impact(Impact),
    /// A largest deflection.
    Peak(Peak),
}

impl Harvester {
    /// Does what events up to `time`, s, do, but for the gains of the impacts in `batch`.
    pub(super) fn pass_events(
        &mut self,
        time: f64,
        batch: &mut Batch,
        mut show: Option<&mut Show<'_>>,
    ) -> Result<(), ModelError> {
        while let Some(event) = self.motion.next_event(&mut self.noise, time, true).filter(|event| event.time() <= time)
        {
            let Some(show) = show.as_deref_mut() else {
                self.process(event, batch)?;
                continue;
            };
            let turn = self.turn_at(event);
            self.process(event, batch)?;
            let impact = self.impact_of(event);
            let peak = turn.or_else(|| impact.and_then(|impact| self.peak_after(impact)));
            impact.map(Event::Impact).iter().chain(&peak.map(Event::Peak)).for_each(show);
        }
        Ok(())
    }

    fn process(&mut self, event: Prediction, batch: &mut Batch) -> Result<(), ModelError> {
        self.tangent.fresh = false;
        self.motion.enter_predicted(&mut self.noise);
        self.settle_friction(event.time());
        match event {
            Prediction::Impact { time, side } => {
                let speed = self.motion.search.speed;
                self.budget.spend(time)?;
                match self.parameters.contact_law {
                    ContactLaw::Impulsive => {
                        self.membrane.check_impact(time, speed)?;
                        self.impact(time, side, speed, batch);
                    }
                    ContactLaw::Compliant => {
                        let (motion, forces, limit, ledger, _) = self.parts();
                        ledger.count_impact(speed);
                        motion.begin_contact(forces, limit, ledger, (time, side, speed));
                    }
                }
            }
            Prediction::ContactChange { .. } => {
                let (motion, forces, limit, ledger, budget) = self.parts();
                motion.follow_contact(forces, limit, (ledger, budget))?;
            }
            Prediction::Release { time } => {
                self.budget.spend(time)?;
                let relative = self.motion.relative_at(time);
                let changes = self.tangential();
                [self.tangent.changes.displacement, self.tangent.changes.rate] = changes.motion_change(time);
                self.release(time);
                self.motion.new_flight(&self.motion.cylinder.at(time), relative);
            }
            Prediction::Turn { time } => {
                self.budget.spend(time)?;
                let [dz, _] = self.motion.relative_at(time);
                self.turn(time, dz);
            }
            Prediction::NoiseSample { time } => self.next_noise_sample(time),
        }
        Ok(())
    }

    /// A ball that starts on a membrane meets it if it approaches, and if it is pushed against it, without a speed, it rests.
    /// Friction may hold one without relative velocity anywhere.
    pub(super) fn begin(&mut self) {
        self.begin_on_membrane();
        let Flight { dz, rate, .. } = self.motion.flight;
        if self.motion.mount.friction > 0.0 && rate == 0.0 && self.motion.ball == Ball::Free {
            self.turn(self.time, dz);
        }
    }

    fn begin_on_membrane(&mut self) {
        let Some((side, speed)) = self.motion.touched() else { return };
        if speed > 0.0 {
            let search = &mut self.motion.search;
            (search.found, search.speed) = (Some(Prediction::Impact { time: self.time, side }), speed);
        }
        // Under the compliant law the search finds the instant from which on it is pressed in.
        let mut wall = self.motion.cylinder.at(self.time);
        let may_rest = speed == 0.0 && self.parameters.contact_law == ContactLaw::Impulsive;
        if may_rest && self.end_of_bounces(side, 0.0, &wall).is_some() {
            self.motion.rest(side, 0.0, &mut wall);
            self.carry(&wall);
        }
    }

    /// Eqs. (10) to (13): the membrane is pressed in at relative `speed`, m/s, the ball rebounds, or comes to rest.
    pub(super) fn impact(&mut self, time: f64, side: Side, speed: f64, batch: &mut Batch) {
        let mut wall = self.motion.cylinder.at(time);
        let before = wall.velocity;
        self.ledger.count_impact(speed);
        let changes = if self.tangent.idle {
            // A pulse that takes its own way is worked out once, if at all.
            if batch.push(time, side, speed) || !self.membrane.is_power() {
                batch.settle(&self.membrane, &mut self.pulses, &mut self.ledger);
            }
            0.0
        } else {
            self.credit_with_changes(speed, side, &wall)
        };
        let rebound = self.motion.rebound(side, speed, &mut wall);
        self.ledger.impact(side.sign(), [before, wall.velocity], speed);
        match self.end_of_bounces(side, rebound, &wall) {
            Some(Tail::Summed { slower }) => {
                batch.settle(&self.membrane, &mut self.pulses, &mut self.ledger);
                let restitution = self.parameters.restitution * slower;
                let excess = self.membrane.excess_of_chatter(rebound * slower, restitution);
                self.ledger.credit(excess);
                if !self.tangent.idle {
                    self.tangent.pass_tail(&self.parameters, &self.membrane, speed, excess);
                }
                self.settle(side, &mut wall, changes);
            }
            Some(Tail::Unresolved) => self.settle(side, &mut wall, changes),
            None => {}
        }
    }

    #[inline]
    fn end_of_bounces(&self, side: Side, rebound: f64, wall: &CylinderState) -> Option<Tail> {
        self.motion.end_of_bounces(side, rebound, wall, self.noise.limit().unwrap_or(f64::INFINITY))
    }

    /// Adds the gains of an impact on this `wall`, and carries the changes that somebody asks for over it. Returns the
    /// change of how much faster than the wall the ball is, m/s.
    fn credit_with_changes(&mut self, speed: f64, side: Side, wall: &CylinderState) -> f64 {
        let peak = self.membrane.deflection(speed);
        let [excess, excess_slope] = self.membrane.capacitance_excess_and_slope(peak);
        let change = self.tangential().change_of(&Hit { side, speed, peak, excess_slope, wall: *wall });
        self.pulses.push(&self.membrane, side, Pulse { start: wall.time, speed, peak, change: change.pulse });
        self.ledger.credit(excess);
        self.tangent.pass_impact(&self.parameters, &self.membrane, &change, excess);
        change.slip
    }

    /// Ends a chattering sequence on this `wall`. How much faster the ball is changes by `slip_change`, m/s.
    fn settle(&mut self, side: Side, wall: &mut CylinderState, slip_change: f64) {
        let slip = -self.motion.flight.rate;
        self.tangent.settle(self.parameters.ball_mass, [slip, slip_change]);
        let before = wall.velocity;
        self.motion.rest(side, slip, wall);
        self.ledger.settle([before, wall.velocity], slip);
        self.carry(wall);
    }

    /// The ball begins to rest on this `wall`.
    fn carry(&mut self, wall: &CylinderState) {
        self.ledger.carry(self.motion.ball_position_at(wall.time), wall.velocity);
    }

    /// A ball without relative velocity at `time`, s, not pressed on a membrane, goes on with this dz, m.
    pub(super) fn turn(&mut self, time: f64, dz: f64) {
        self.motion.turn(time, dz);
        if self.motion.ball.is_carried() {
            self.ledger.carry(self.motion.last.position, self.motion.last.velocity);
        }
    }

    /// The work of friction up to `time`, s, before something changes there.
    pub(super) fn settle_friction(&mut self, time: f64) {
        if self.motion.mount.friction > 0.0 {
            self.ledger.slide(self.motion.slip, self.motion.slide_at(time));
        }
    }

    /// The wall lets the ball go at `time`, s.
    pub(super) fn release(&mut self, time: f64) {
        if self.motion.ball.support().is_some() {
            self.ledger.totals.releases += 1;
        }
        self.motion.release(time, self.motion.departure(time));
        let Start { position, velocity, .. } = self.motion.last;
        self.ledger.release(position, velocity);
    }

    pub(super) fn next_noise_sample(&mut self, time: f64) {
        self.noise.take_next();
        let phase = self.noise.phase(self.noise.sample);
        self.restart(time, Drive { phase, ..self.motion.drive_at(time) });
    }

    /// Cylinder and ball go on from `time`, s, under another drive.
    pub(super) fn restart(&mut self, time: f64, drive: Drive) {
        self.settle_friction(time);
        if self.motion.ball.contact().is_some() {
            let (motion, forces, limit, ledger, _) = self.parts();
            motion.restart_contact(forces, limit, ledger, (time, drive));
        } else {
            self.motion.restart(time, drive);
        }
    }

    /// The last impact, of a harvester whose present time is that of this impact: one that is just made, if its ball started on
    /// a membrane and approached it, or whose [`Harvester::handle_events`] has just counted one.
    pub fn present_impact(&self) -> Option<Impact> {
        let (totals, side) = (self.totals(), Side::of(self.relative_displacement()));
        let (time, speed, rests) = (self.time, totals.last_speed, self.resting().is_some());
        (totals.impacts > 0).then_some(Impact { time, side, speed, rests })
    }

    /// The impact that the `event`, just processed, was.
    fn impact_of(&self, event: Prediction) -> Option<Impact> {
        let Prediction::Impact { time, side } = event else { return None };
        let rests = self.motion.ball.support().is_some();
        Some(Impact { time, side, speed: self.ledger.totals.last_speed, rests })
    }

    /// The largest deflection that follows from an impact under the impulsive law.
    fn peak_after(&self, Impact { time, side, speed, .. }: Impact) -> Option<Peak> {
        if self.parameters.contact_law == ContactLaw::Compliant {
            return None;
        }
        let deflection = self.membrane.deflection(speed);
        let pulse = Pulse { start: time, speed, peak: deflection, change: PulseChange::default() };
        let voltage = self.voltages[side.index()].at(time);
        let shape = &self.pulses.shape;
        let time = if self.membrane.is_power() {
            shape.peak_time(&pulse)
        } else {
            let mut running = self.pulses.under_way[side.index()].iter();
            let running = running.find(|running| running.pulse.start == time && running.pulse.speed == speed);
            running.map_or_else(|| Running::new(&self.membrane, pulse).peak_time(shape), |it| it.peak_time(shape))
        };
        Some(Peak { time, side, deflection, voltage })
    }

    /// The largest deflection at which the contact turns, if that is the `event`.
    fn turn_at(&self, event: Prediction) -> Option<Peak> {
        let Prediction::ContactChange { time } = event else { return None };
        let contact = self.motion.ball.contact().filter(|contact| contact.ending() == Ending::Turn)?;
        let side = contact.state.side;
        let voltage = self.voltages[side.index()].at(time);
        Some(Peak { time, side, deflection: contact.largest_at(time), voltage })
    }
}
