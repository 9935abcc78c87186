//! The dynamic state of a harvester as plain values: to be written down, and to go on from elsewhere to the last bit.

use core::f64::consts::TAU;

use super::Harvester;
use super::integrator::MAX_LAG;
use crate::accounting::budget::Budget;
use crate::accounting::ledger::{Ledger, Totals, Works};
use crate::contact::{Contact, ContactState, Creep, Ramp, Recoil};
use crate::error::ModelError;
use crate::membrane::Membrane;
use crate::membrane::table::ForceTable;
use crate::motion::cylinder::Drive;
use crate::motion::mount::Mount;
use crate::motion::pulse::{Pulse, PulseShape, Pulses, Running};
use crate::motion::side::Side;
use crate::motion::{Ball, Motion, Prediction, Search, Start};
use crate::noise::Noise;
use crate::noise::block::BLOCK;
use crate::parameters::{ContactLaw, Parameters};
use crate::recording::{Recording, Segment};
use crate::sensitivity::{Changes, Tangent};
use crate::setup::Setup;
use crate::shared::Shared;

/// Everything that a [`Harvester`] carries from one step to the next, besides its parameters, its recording and the table of its
/// membranes.
///
/// Exported by [`Harvester::snapshot`], imported by [`Harvester::restore`]. What follows from these values, such as the
/// time of the next impact, is worked out again.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Snapshot {
    /// Present time, s.
    pub time: f64,
    /// Start of the cylinder's present motion.
    pub cylinder: Start,
    /// Energy that the cylinder's damper has taken up to that start, over M, J/kg.
    pub damped: f64,
    /// External force over M at that start, m/s^2.
    pub external: f64,
    /// Its rate, m/s^3.
    pub external_rate: f64,
    /// Last event of the ball.
    pub ball: Start,
    /// The membrane on which the ball rests.
    pub resting: Option<Side>,
    /// Friction holds it between the membranes.
    pub is_stuck: bool,
    /// Sign of dz' while friction acts on a ball that slides, else 0.
    pub slip: f64,
    /// Start of the present search for events: `z_M` - `z_m` and its rate.
    pub relative: Start,
    /// Number of the phase-noise sample in force at the start of the cylinder's motion. With phase noise that start may
    /// lie hold intervals back: the begin of a block of 512, or of the interval after an event.
    pub noise_sample: u64,
    /// The Wiener process of the phase noise, sqrt(s).
    pub noise_walk: f64,
    /// Fingerprint of the recording, 0 if there is none.
    pub recording: u64,
    /// Fingerprint of the table of the membranes, 0 if there is none.
    pub table: u64,
    /// Number of the recording's segment at the start of the cylinder's motion.
    pub segment: u64,
    /// Pulses under way on the left and on the right membrane, the largest peak first.
    pub pulses: [Vec<Pulse>; 2],
    /// The present contact under the compliant law.
    pub contact: Option<ContactState>,
    /// Creep of the left and the right membrane where a ball last left them, if they are viscous.
    pub creeps: [Creep; 2],
    /// Voltages across the left and the right membrane.
    pub voltages: [Ramp; 2],
    /// Sums over all impacts so far.
    pub totals: Totals,
    /// Sums of the energy up to the last event.
    pub works: Works,
    /// What [`Harvester::sensitivities`] carry besides the changes of the pulses; none before anybody asked.
    pub changes: Option<Changes>,
    /// Number of the second in which events are being counted.
    pub second: f64,
    /// Events counted in it.
    pub second_events: u64,
}

impl Harvester {
    /// The dynamic state.
    pub fn snapshot(&self) -> Snapshot {
        let Self { motion, noise, tangent, ledger, budget, .. } = self;
        // What follows from an anchor does so again, to the last bit, from nothing else.
        let state = motion.search.anchor.unwrap_or_else(|| motion.hold_state(noise.sample));
        let begin = motion.search.anchor.map(|anchor| noise.begin_of(anchor.sample));
        let start = |time: f64, position, velocity| Start { time: begin.unwrap_or(time), position, velocity };
        Snapshot {
            time: self.time,
            cylinder: start(motion.cylinder.start, state.position, state.velocity),
            damped: motion.cylinder.damped,
            external: state.external,
            external_rate: motion.cylinder.drive.external_rate,
            ball: motion.last,
            resting: motion.ball.support(),
            is_stuck: motion.ball == Ball::Stuck,
            slip: motion.slip,
            relative: start(motion.flight.start, state.dz, state.rate),
            noise_sample: state.sample,
            noise_walk: noise.walk,
            recording: motion.playback.as_ref().map_or(0, |playback| playback.recording.fingerprint()),
            table: self.membrane.table().map_or(0, ForceTable::fingerprint),
            segment: motion.cylinder.drive.recorded.number,
            pulses: self.pulses.lists(),
            contact: motion.ball.contact().map(|contact| contact.state),
            creeps: motion.resting_films.each_ref().map(|film| film.creep),
            voltages: self.voltages,
            totals: ledger.totals,
            works: ledger.works,
            changes: (!tangent.idle).then_some(tangent.changes),
            second: budget.second,
            second_events: budget.events,
        }
    }

    /// The harvester that had this state. With the parameters and the recording it had then, it goes on as if nothing had happened, to the
    /// last bit.
    ///
    /// # Errors
    /// A parameter out of bounds; another recording; values that no harvester can have had, such as NaN or an event in the
    /// future.
    pub fn restore<'a>(setup: impl Into<Setup<'a>>, snapshot: &Snapshot) -> Result<Self, ModelError> {
        let mut harvester = Self::rebuild(&setup.into(), snapshot, BLOCK as f64)?;
        let segment_end = harvester.motion.cylinder.drive.recorded.end;
        check("segment of the recording that ended at", segment_end, segment_end >= snapshot.time)?;
        harvester.motion.resume_search(snapshot.time);
        let (motion, forces, limit, ..) = harvester.parts();
        motion.plan_contact(forces, limit);
        let due = harvester.motion.next_event(&mut harvester.noise, snapshot.time, true);
        if let Some(Prediction::Impact { time, .. } | Prediction::Release { time } | Prediction::Turn { time }) =
            due.filter(|event| event.time() <= snapshot.time)
        {
            // All of them have happened; a state that says otherwise could hold any number.
            check("event before the present time", time, false)?;
        }
        harvester.advance(snapshot.time)?;
        Ok(harvester)
    }

    /// The same for a harvester whose states are set by an integrator ([`Harvester::place`]).
    ///
    /// # Errors
    /// As [`Harvester::restore`].
    pub fn restore_placed<'a>(setup: impl Into<Setup<'a>>, snapshot: &Snapshot) -> Result<Self, ModelError> {
        let mut harvester = Self::rebuild(&setup.into(), snapshot, MAX_LAG)?;
        harvester.leave_to_integrator();
        Ok(harvester)
    }

    /// `lag`: how many phase-noise samples may be due and not taken.
    fn rebuild(setup: &Setup<'_>, snapshot: &Snapshot, lag: f64) -> Result<Self, ModelError> {
        setup.validate()?;
        let p = setup.parameters;
        snapshot.validate(p, lag)?;
        if snapshot.recording != setup.recording.map_or(0, Recording::fingerprint) {
            return Err(ModelError::OtherRecording);
        }
        if snapshot.table != setup.table.map_or(0, ForceTable::fingerprint) {
            return Err(ModelError::OtherTable);
        }
        let mut noise = Noise::new(p, snapshot.noise_sample, snapshot.noise_walk);
        let mut drive = Drive::new(p, noise.phase(noise.sample), [snapshot.external, snapshot.external_rate]);
        let playback = setup.playback();
        if let Some(playback) = &playback {
            noise.pass_singly();
            drive.recorded = playback.segment(snapshot.segment);
        }
        let Segment { number, start, .. } = drive.recorded;
        check("segment of the recording", snapshot.segment as f64, number == snapshot.segment)?;
        // An integrator stops at a sample to rounding.
        let has_begun = number == 0 || start <= snapshot.cylinder.time + 2.0 * f64::EPSILON * start.abs();
        check("segment of the recording that begins at", start, has_begun)?;
        let ball = match (snapshot.contact, snapshot.resting) {
            (Some(state), _) => Ball::InContact(Contact::resumed(state)),
            (None, Some(side)) => Ball::Resting(side),
            (None, None) if snapshot.is_stuck => Ball::Stuck,
            (None, None) => Ball::Free,
        };
        let rate = if ball.is_carried() { 0.0 } else { snapshot.relative.velocity };
        let relative = Start { velocity: rate, ..snapshot.relative };
        let mut motion = Motion::new(p, snapshot.cylinder, drive, snapshot.ball, (ball, snapshot.slip), relative);
        motion.cylinder.damped = snapshot.damped;
        (motion.search, motion.playback) = (Search::none(), playback);
        motion.resting_films = snapshot.creeps.map(Into::into);
        let tangent = snapshot
            .changes
            .map_or_else(Tangent::none, |changes| Tangent { changes, ..Tangent::of_force(changes.since, p) });
        let membrane = Shared::new(Membrane::new(*setup));
        let shape = PulseShape::new(p.stiffness_exponent, p.restitution);
        let ledger = Ledger::new(p, membrane.rest_capacitance, snapshot.totals, snapshot.works);
        let running = |list: &Vec<Pulse>| list.iter().map(|pulse| Running::new(&membrane, *pulse)).collect();
        let under_way = snapshot.pulses.each_ref().map(running);
        Ok(Self {
            parameters: Shared::new(*p),
            membrane,
            time: snapshot.time,
            motion,
            noise,
            voltages: snapshot.voltages,
            pulses: Pulses { shape, under_way },
            ledger,
            budget: Budget::new(p, snapshot.second, snapshot.second_events),
            tangent,
            origin: None,
            calm_until: f64::NEG_INFINITY,
        })
    }
}

/// No run has had as many events, and none will count beyond all numbers from there.
const MAX_COUNT: u64 = 1 << 53;

impl Snapshot {
    fn validate(&self, parameters: &Parameters, lag: f64) -> Result<(), ModelError> {
        let Self { time, cylinder, ball, relative, totals, works, .. } = *self;
        let periods_since = |start: f64| (time - start) * parameters.frequency;
        let finite = |name, values: &[f64]| values.iter().try_for_each(|value| check(name, *value, value.is_finite()));
        finite("time", &[time])?;
        for Start { time, position, velocity } in [cylinder, ball, relative] {
            finite("motion", &[time, position, velocity])?;
        }
        finite("motion", &[self.external, self.external_rate])?;
        // An integrator may predict one below zero.
        finite("energy of the damper", &[self.damped])?;
        for pulse in self.pulses.iter().flatten() {
            finite("change", &[pulse.change.start, pulse.change.speed, pulse.change.peak])?;
        }
        if let Some(c) = &self.changes {
            let motion = [c.since, c.displacement, c.rate];
            finite("change", &[motion, [c.last_speed, c.voltage_gain, c.energy]].concat())?;
            finite("change", &[c.loss])?;
        }
        let since = self.changes.map(|changes| changes.since);
        for start in [cylinder.time, ball.time, relative.time].into_iter().chain(since) {
            // Beyond 2^53 periods ago, time has no digits left in which to search.
            check("start of a motion", start, start <= time && periods_since(start) < 9.0e15)?;
        }
        if parameters.is_suspended() {
            // The cylinder is followed piece by piece, and the ball with it.
            let longest = Mount::new(parameters).longest_piece(TAU * parameters.frequency);
            let (start, elapsed) = (cylinder.time, time - cylinder.time);
            let is_present = relative.time == start && elapsed <= 1.001 * longest && start + longest > start;
            check("start of a motion", start, is_present)?;
        }
        let is_carried = self.resting.is_some() || self.is_stuck;
        let slips = if parameters.friction_acceleration() > 0.0 {
            !is_carried && self.slip.abs() == 1.0
        } else {
            self.slip == 0.0
        };
        check("slip", self.slip, slips || (self.slip == 0.0 && (is_carried || self.contact.is_some())))?;
        let may_stick = self.is_stuck
            && parameters.friction_acceleration() > 0.0
            && self.resting.is_none()
            && self.contact.is_none();
        check("sticking ball at", relative.position, may_stick || !self.is_stuck)?;
        finite("Wiener process", &[self.noise_walk])?;
        if parameters.is_noisy() {
            let (sample, hold) = (self.noise_sample as f64, parameters.noise_hold);
            let in_force = (sample + 1.0 + lag) * hold > time && sample * hold <= time.max(0.0) + hold;
            check("noise sample", sample, in_force)?;
        }
        for sum in [totals.last_speed, totals.voltage_gain, totals.energy, totals.rebound] {
            check_size("sum over the impacts", sum)?;
        }
        for Ramp { start, value, rate } in self.voltages {
            finite("voltage or sum of work", &[start, value, rate])?;
        }
        let Works { wall, electrical, loss, viscous, friction, contact_time, .. } = works;
        finite("voltage or sum of work", &[wall, electrical, loss, viscous, friction, contact_time])?;
        for Creep { since, value } in self.creeps {
            check("creep since", since, since.is_finite() && since <= time.max(0.0))?;
            check_creep(parameters, value)?;
        }
        finite("begin of friction", &works.slide)?;
        if let Some(ContactState { since, largest, start, credited, proposal, .. }) = self.contact {
            let is_compliant = parameters.contact_law == ContactLaw::Compliant && self.resting.is_none();
            check("contact since", since, since <= start.time && is_compliant)?;
            check("start of a contact", start.time, start.time <= time && periods_since(start.time) <= 2.0)?;
            finite("deflection", &[start.x])?;
            finite("rate of a deflection", &[start.v])?;
            check_creep(parameters, start.creep)?;
            let Recoil { position, velocity } = start.recoil;
            let may_recoil = parameters.recoil_share() > 0.0 && parameters.is_suspended();
            finite("recoil", &[position, velocity])?;
            check("recoil of a free cylinder", position, may_recoil || start.recoil == Recoil::default())?;
            check_size("largest deflection", largest)?;
            check_size("credited excess", credited)?;
            check("first step", proposal, proposal.is_finite() && proposal > 0.0)?;
        }
        finite("second", &[self.second])?;
        for count in [totals.impacts, totals.chatters, totals.releases, self.second_events] {
            check("number of events", count as f64, count <= MAX_COUNT)?;
        }
        self.pulses.iter().try_for_each(|pulses| validate_pulses(pulses, time))
    }
}

fn validate_pulses(pulses: &[Pulse], time: f64) -> Result<(), ModelError> {
    check("number of pulses", pulses.len() as f64, pulses.len() <= Pulses::CAPACITY)?;
    for pulse in pulses {
        check("start of a pulse", pulse.start, pulse.start.is_finite() && pulse.start <= time)?;
        check_size("speed of a pulse", pulse.speed)?;
        check_size("peak of a pulse", pulse.peak)?;
    }
    let ascent = pulses.windows(2).find(|pair| pair[0].peak < pair[1].peak);
    check("order of the pulses", ascent.map_or(0.0, |pair| pair[1].peak), ascent.is_none())
}

/// That a film has given way as far as one can.
fn check_creep(parameters: &Parameters, value: f64) -> Result<(), ModelError> {
    /// A film as long as that has no thickness left.
    const LARGEST: f64 = 30.0;
    let largest = if parameters.is_viscous() { LARGEST } else { 0.0 };
    check("creep of a film", value, value.abs() <= largest)
}

/// That a value that is never negative is finite, too.
fn check_size(name: &'static str, value: f64) -> Result<(), ModelError> {
    check(name, value, value.is_finite() && value >= 0.0)
}

fn check(name: &'static str, value: f64, is_possible: bool) -> Result<(), ModelError> {
    if is_possible { Ok(()) } else { Err(ModelError::Snapshot { name, value }) }
}
