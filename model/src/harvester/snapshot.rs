//! The dynamic state of a harvester as plain values: to be written down, and to go on from elsewhere to the last bit.

use super::energy::{Ledger, LedgerChange};
use super::events::{Event, Search};
use super::phase::{Noise, phase};
use super::tangent::Tangent;
use super::{Ball, Harvester, Totals};
use crate::compliant::{ContactSnapshot, Ramp, Touch};
use crate::cylinder::{CylinderMotion, Drive};
use crate::error::ModelError;
use crate::flight::{Flight, Side};
use crate::holds::{BLOCK, Holds};
use crate::membrane::Membrane;
use crate::parameters::{ContactLaw, Parameters};
use crate::pulse::{Pulse, PulseChange, PulseShape, Pulses};

/// Phase-noise samples that an integrator may be behind: it may pause at an event before the event is handled.
pub(super) const MAX_LAG: f64 = 1e6;

/// Everything that a [`Harvester`] carries from one step to the next, besides its parameters.
///
/// Exported by [`Harvester::snapshot`], imported by [`Harvester::restore`]. What follows from these values, such as the
/// time of the next impact, is worked out again.
#[derive(Debug, Clone, PartialEq)]
pub struct Snapshot {
    /// Present time, s.
    pub time: f64,
    /// Start of the cylinder's present motion, s; `z_M`, m, and `z_M'`, m/s, there.
    pub cylinder: [f64; 3],
    /// External force over M at that start, m/s^2, and its rate, m/s^3.
    pub external: [f64; 2],
    /// Last event of the ball, s; `z_m`, m, and `z_m'`, m/s, there.
    pub ball: [f64; 3],
    /// The membrane on which the ball rests.
    pub resting: Option<Side>,
    /// Start of the present search for events, s; `z_M` - `z_m`, m, and its rate, m/s, there.
    pub flight: [f64; 3],
    /// Number of the phase-noise sample in force at the start of the cylinder's motion. With phase noise that start may
    /// lie hold intervals back: the begin of a block of 256, or of the interval after an event.
    pub noise_sample: u64,
    /// The Wiener process of the phase noise, sqrt(s).
    pub noise_walk: f64,
    /// Pulses under way on the left and on the right membrane, the largest peak first.
    pub pulses: [Vec<Pulse>; 2],
    /// The present contact under the compliant law.
    pub contact: Option<ContactSnapshot>,
    /// Voltages across the left and the right membrane: time, s, value then, V, and rate, V/s.
    pub voltages: [[f64; 3]; 2],
    /// Sums over all impacts so far.
    pub totals: Totals,
    /// Work of the walls (at rest less the ball's kinetic energy) and of the Maxwell force, energy lost, J, and time in
    /// contact, s, up to the last event.
    pub ledger: [f64; 4],
    /// What [`Harvester::sensitivities`] carry besides the changes of the pulses: the time from which they count, s; changes
    /// of `z_M` - `z_m`, m, and its rate, m/s, at the ball's last event; changes of last speed, m/s, voltage gain, V, and energy,
    /// J; changes of the work of the walls and of the energy lost, J, as the ledger has them. None before anybody asked.
    pub changes: Option<[f64; 8]>,
    /// Number of the second in which events are being counted.
    pub second: f64,
    /// Events counted in it.
    pub second_events: u64,
}

impl Harvester {
    /// The dynamic state.
    pub fn snapshot(&self) -> Snapshot {
        let Self { cylinder, ball, noise, tangent, ledger, .. } = self;
        let ([displacement, rate], [last_speed, voltage_gain, energy]) = (tangent.motion, tangent.totals);
        let LedgerChange { wall, loss } = tangent.ledger;
        // What follows from an anchor does so again, to the last bit, from nothing else.
        let anchor = self.search.anchor.unwrap_or_else(|| self.present_boundary());
        let is_behind = self.search.anchor.is_some();
        let start = if is_behind { self.hold_start(anchor.sample) } else { cylinder.start };
        let flight_start = if is_behind { start } else { self.search.flight.start };
        Snapshot {
            time: self.time,
            cylinder: [start, anchor.position, anchor.velocity],
            external: [anchor.external, cylinder.drive.external_rate],
            ball: [ball.since, ball.position, ball.velocity],
            resting: ball.resting,
            flight: [flight_start, anchor.dz, anchor.rate],
            noise_sample: anchor.sample,
            noise_walk: noise.walk,
            pulses: self.pulses.clone().map(Pulses::into_inner),
            contact: self.touch.as_ref().map(Touch::snapshot),
            voltages: self.voltages.map(|ramp| [ramp.start, ramp.value, ramp.rate]),
            totals: self.totals,
            ledger: [ledger.wall, ledger.electrical, ledger.loss, ledger.contact_time],
            changes: (!tangent.idle).then_some([
                tangent.since,
                displacement,
                rate,
                last_speed,
                voltage_gain,
                energy,
                wall,
                loss,
            ]),
            second: self.second,
            second_events: self.second_events,
        }
    }

    /// The harvester that had this state. With the parameters it had then, it goes on as if nothing had happened, to the
    /// last bit.
    ///
    /// # Errors
    /// A parameter out of bounds; values that no harvester can have had, such as NaN or an event in the future.
    pub fn restore(parameters: &Parameters, snapshot: &Snapshot) -> Result<Self, ModelError> {
        let mut harvester = Self::rebuild(parameters, snapshot, BLOCK as f64)?;
        harvester.placed = false;
        harvester.search = if harvester.touch.is_some() {
            Search::new(harvester.search.flight)
        } else {
            Search::resumed(harvester.search.flight, snapshot.time)
        };
        harvester.plan_touch();
        let due = harvester.next_event(snapshot.time, true).filter(|event| event.time() <= snapshot.time);
        if let Some(Event::Impact { time, .. } | Event::Release { time }) = due {
            // All of them have happened; a state that says otherwise could hold any number.
            check("event before the present time", time, false)?;
        }
        harvester.advance(snapshot.time)?;
        Ok(harvester)
    }

    /// The same for a harvester whose states are placed by an integrator ([`Harvester::place`]).
    ///
    /// # Errors
    /// As [`Harvester::restore`].
    pub fn restore_placed(parameters: &Parameters, snapshot: &Snapshot) -> Result<Self, ModelError> {
        Self::rebuild(parameters, snapshot, MAX_LAG)
    }

    /// `lag`: how many phase-noise samples may be due and not taken.
    fn rebuild(parameters: &Parameters, snapshot: &Snapshot, lag: f64) -> Result<Self, ModelError> {
        parameters.validate()?;
        snapshot.validate(parameters, lag)?;
        let p = *parameters;
        let noise = Noise { sample: snapshot.noise_sample, walk: snapshot.noise_walk };
        let [external, external_rate] = snapshot.external;
        let drive = Drive {
            amplitude: p.amplitude / p.cylinder_mass,
            frequency: p.frequency,
            phase: phase(&p, &noise),
            external,
            external_rate,
        };
        let [start, position, velocity] = snapshot.cylinder;
        let cylinder = CylinderMotion::new(start, position, velocity, drive);
        let [since, position, velocity] = snapshot.ball;
        let ball = Ball { since, position, velocity, resting: snapshot.resting };
        let tangent = snapshot.changes.map_or_else(Tangent::none, |changes| {
            let [since, displacement, rate, last_speed, voltage_gain, energy, wall, loss] = changes;
            let mut tangent = Tangent::of_force(since, p.cylinder_mass);
            tangent.motion = [displacement, rate];
            tangent.totals = [last_speed, voltage_gain, energy];
            tangent.ledger = LedgerChange { wall, loss };
            tangent
        });
        let [wall, electrical, loss, contact_time] = snapshot.ledger;
        let [start, dz, rate] = snapshot.flight;
        let rate = if ball.resting.is_some() { 0.0 } else { rate };
        let flight = Flight::new(&cylinder, &cylinder.at(start), [dz, rate], p.travel() / 2.0);
        Ok(Self {
            parameters: p,
            membrane: Membrane::new(&p),
            shape: PulseShape::new(p.stiffness_exponent, p.restitution),
            time: snapshot.time,
            cylinder,
            ball,
            noise,
            holds: Holds::new(&p),
            search: Search::none(flight),
            pulses: snapshot.pulses.clone().map(Pulses::from_inner),
            touch: snapshot.contact.as_ref().map(Touch::restored),
            voltages: snapshot.voltages.map(|[start, value, rate]| Ramp { start, value, rate }),
            totals: snapshot.totals,
            ledger: Ledger { wall, electrical, loss, contact_time },
            tangent,
            placed: true,
            calm_until: f64::NEG_INFINITY,
            second: snapshot.second,
            second_events: snapshot.second_events,
        })
    }
}

/// No run has had as many events, and none will count beyond all numbers from there.
const MAX_COUNT: u64 = 1 << 53;

impl Snapshot {
    fn validate(&self, parameters: &Parameters, lag: f64) -> Result<(), ModelError> {
        let Self { time, totals, .. } = *self;
        check("time", time, time.is_finite())?;
        for value in self.cylinder.into_iter().chain(self.external).chain(self.ball).chain(self.flight) {
            check("motion", value, value.is_finite())?;
        }
        let changes = self.pulses.iter().flatten().flat_map(|pulse| {
            let PulseChange { start, speed, peak } = pulse.change;
            [start, speed, peak]
        });
        for change in changes.chain(self.changes.into_iter().flatten()) {
            check("change", change, change.is_finite())?;
        }
        let since = self.changes.map(|[since, ..]| since);
        for start in [self.cylinder[0], self.ball[0], self.flight[0]].into_iter().chain(since) {
            // Beyond 2^53 periods ago, time has no digits left in which to search.
            check("start of a motion", start, start <= time && (time - start) * parameters.frequency < 9.0e15)?;
        }
        check("Wiener process", self.noise_walk, self.noise_walk.is_finite())?;
        if parameters.phase_noise > 0.0 {
            let (sample, hold) = (self.noise_sample as f64, parameters.noise_hold);
            let in_force = (sample + 1.0 + lag) * hold > time && sample * hold <= time.max(0.0) + hold;
            check("noise sample", sample, in_force)?;
        }
        for sum in [totals.last_speed, totals.voltage_gain, totals.energy] {
            check("sum over the impacts", sum, sum.is_finite() && sum >= 0.0)?;
        }
        for value in self.voltages.into_iter().flatten().chain(self.ledger) {
            check("voltage or sum of work", value, value.is_finite())?;
        }
        self.contact.iter().try_for_each(|contact| validate_contact(contact, parameters, time))?;
        check("second", self.second, self.second.is_finite())?;
        for count in [totals.impacts, totals.chatters, totals.releases, self.second_events] {
            check("number of events", count as f64, count <= MAX_COUNT)?;
        }
        self.pulses.iter().try_for_each(|pulses| validate_pulses(pulses, time))
    }
}

fn validate_contact(contact: &ContactSnapshot, parameters: &Parameters, time: f64) -> Result<(), ModelError> {
    let ContactSnapshot { since, largest, start: [start, x, v], credited, proposal, .. } = *contact;
    check("contact since", since, since <= start && parameters.contact_law == ContactLaw::Compliant)?;
    check("start of a contact", start, start <= time && (time - start) * parameters.frequency <= 2.0)?;
    check("deflection", x, x.is_finite())?;
    check("rate of a deflection", v, v.is_finite())?;
    check("largest deflection", largest, largest.is_finite() && largest >= 0.0)?;
    check("credited excess", credited, credited.is_finite() && credited >= 0.0)?;
    check("first step", proposal, proposal.is_finite() && proposal > 0.0)
}

fn validate_pulses(pulses: &[Pulse], time: f64) -> Result<(), ModelError> {
    check("number of pulses", pulses.len() as f64, pulses.len() <= Pulses::CAPACITY)?;
    for pulse in pulses {
        check("start of a pulse", pulse.start, pulse.start.is_finite() && pulse.start <= time)?;
        check("speed of a pulse", pulse.speed, pulse.speed.is_finite() && pulse.speed >= 0.0)?;
        check("peak of a pulse", pulse.peak, pulse.peak.is_finite() && pulse.peak >= 0.0)?;
    }
    let ascent = pulses.windows(2).find(|pair| pair[0].peak < pair[1].peak);
    check("order of the pulses", ascent.map_or(0.0, |pair| pair[1].peak), ascent.is_none())
}

fn check(name: &'static str, value: f64, holds: bool) -> Result<(), ModelError> {
    if holds { Ok(()) } else { Err(ModelError::Snapshot { name, value }) }
}
