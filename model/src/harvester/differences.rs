//! First-order changes by differences, where they are not carried along in closed form: with friction, a suspension or reaction,
//! under the compliant law, with another law of the membrane than Eq. (2), and with respect to parameters of these and of a recording and to the exponent of the force law, on which
//! the shape of a pulse depends in no simple way.
//!
//! Harvesters in which the cause is moved a little are compared with this one. They must have met the same events, so that all
//! shown is smooth in between; next to an event only those on one side have. The step is reduced until two estimates agree, for
//! each number on its own.

use core::cell::Cell;
use core::f64::consts::TAU;

use super::Harvester;
use crate::accounting::ledger::Energies;
use crate::contact::Phase;
use crate::error::ModelError;
use crate::motion::cylinder::{CylinderMotion, CylinderState};
use crate::motion::side::Side;
use crate::parameters::{ContactLaw, MembraneLaw, Parameters};
use crate::sensitivity::{Direction, Sensitivities};

/// The first step, in units of what the cause typically is, and by how much each is shorter than the one before.
const STEP: f64 = 3e-2;
const SHORTER: f64 = 0.3;

/// Steps that are tried. The last is below the rounding of anything.
const STEPS: usize = 14;

/// Least acceleration that counts as typical, in units of a motion through the gap at the frequency of the excitation.
const LEAST: f64 = 1e-3;

/// Two estimates that differ by less than this, relative to them, agree.
const AGREED: f64 = 1e-11;

/// The cause of the changes, and from where on it acts.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Origin {
    /// The external force: the harvester when it was set.
    Force(Box<Harvester>),
    /// The parameters, and the external force, at the start.
    Start(Box<Beginning>),
}

/// How a harvester began.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Beginning {
    /// s.
    pub start: f64,
    /// External force, N.
    pub force: f64,
    pub direction: Direction,
}

/// What tells whether two harvesters have met the same events.
#[derive(PartialEq)]
struct Past {
    counts: [u64; 3],
    ball: Option<Side>,
    is_stuck: bool,
    slip: f64,
    contact: Option<Phase>,
    /// Whether the largest pulse of each membrane, if there is one, is past its peak.
    pulses: [Option<bool>; 2],
}

impl Direction {
    /// Whether the changes along it are carried along in closed form.
    fn is_closed(&self) -> bool {
        let p = &self.parameters;
        let mount = [p.friction, p.suspension_stiffness, p.suspension_damping];
        mount == [0.0; 3] && [p.file_scale, p.file_offset, p.stiffness_exponent] == [0.0; 3]
    }
}

impl Harvester {
    /// Whether changes are carried along in closed form: under the impulsive law and Eq. (2), without friction, suspension and
    /// reaction. With these they are taken by differences.
    pub fn has_closed_changes(&self) -> bool {
        let p = &self.parameters;
        let is_plain = p.contact_law == ContactLaw::Impulsive && !p.reaction;
        is_plain && p.friction == 0.0 && !p.is_suspended() && p.membrane_law == MembraneLaw::Power
    }

    /// Where the changes along a `direction` begin, if they are taken by differences, of this harvester before all events, under this
    /// `force`, N.
    pub(super) fn origin_along(&self, force: f64, direction: &Direction) -> Option<Origin> {
        let is_closed = self.has_closed_changes() && direction.is_closed();
        (!is_closed).then(|| Origin::Start(Box::new(Beginning { start: self.time, force, direction: *direction })))
    }

    /// The external force has just been set: changes count from here.
    pub(super) fn begin_differences(&mut self) {
        if self.has_closed_changes() {
            self.origin = None;
            return;
        }
        // A step of a caller takes no memory that is there already.
        let mut origin = match self.origin.take() {
            Some(Origin::Force(origin)) => origin,
            _ => Box::new(self.clone()),
        };
        (*origin).clone_from(self);
        self.origin = Some(Origin::Force(origin));
    }

    /// Where the changes with the external force begin, if they are taken by differences.
    pub fn origin(&self) -> Option<&Self> {
        match &self.origin {
            Some(Origin::Force(origin)) => Some(origin),
            _ => None,
        }
    }

    /// Changes with the external force begin at `origin`, an earlier state of this harvester.
    ///
    /// # Errors
    /// A time of the origin after the present one.
    pub fn set_origin(&mut self, origin: Self) -> Result<(), ModelError> {
        if origin.time > self.time {
            return Err(ModelError::Backwards { from: origin.time, to: self.time });
        }
        self.origin = (!self.has_closed_changes()).then(|| Origin::Force(Box::new(origin)));
        Ok(())
    }

    /// [`Harvester::sensitivities`] by differences from this origin; zero where none are found.
    pub(super) fn differences(&self, origin: &Origin) -> Sensitivities {
        match origin {
            Origin::Force(origin) => self.slopes(self.typical_force(), |distance| self.pushed(origin, distance)),
            Origin::Start(beginning) => {
                let Beginning { start, force, direction } = **beginning;
                let p = &self.parameters;
                let changes = Parameters::TABLE.iter().map(|quantity| {
                    let (value, change) = ((quantity.get)(p), (quantity.get)(&direction.parameters));
                    (p.typical(quantity.unit, value), change.abs())
                });
                let typical = changes
                    .chain([(self.typical_force(), direction.force.abs())])
                    .filter(|(_, change)| *change > 0.0)
                    .map(|(typical, change)| typical / change)
                    .fold(f64::INFINITY, f64::min);
                self.slopes(typical, |distance| self.begun(start, force, &direction, distance))
            }
        }
    }

    /// Changes per unit of continuous state number `state` in [`Harvester::states`], one of the motion, or of the external force, at the present time,
    /// by differences. None in a contact that lasts.
    pub fn differences_at_point(&self, state: Option<usize>) -> Option<Sensitivities> {
        if self.motion.ball.contact().is_some() {
            return None;
        }
        let p = &self.parameters;
        let typical = match state {
            None => self.typical_force(),
            Some(0 | 2) => p.typical("m", 0.0),
            Some(_) => p.typical("m/s", 0.0),
        };
        Some(self.slopes(typical, |distance| {
            let mut copy = self.clone();
            match state {
                None => copy.push_by(distance),
                Some(state) => copy.displace(state, distance),
            }
            Some(copy)
        }))
    }

    /// This harvester with the external force larger by `distance`, N, since `origin`.
    fn pushed(&self, origin: &Self, distance: f64) -> Option<Self> {
        let mut copy = origin.clone();
        copy.push_by(distance);
        copy.take_voltages_of(self)?;
        copy.advance(self.time).ok()?;
        // A force set since then acts from now on.
        let [of_self, of_copy] = [self, &copy].map(Self::external_force);
        if of_self[0] + distance != of_copy[0] || of_self[1] != of_copy[1] {
            copy.push(of_self[0] + distance, of_self[1]);
        }
        Some(copy)
    }

    /// This harvester if it had begun `distance` farther along `direction`.
    fn begun(&self, start: f64, force: f64, direction: &Direction, distance: f64) -> Option<Self> {
        let mut moved = *self.parameters;
        for quantity in Parameters::TABLE {
            let change = (quantity.get)(&direction.parameters);
            (quantity.set)(&mut moved, (quantity.get)(&self.parameters) + distance * change);
        }
        let recording = self.motion.playback.as_ref().map(|playback| &playback.recording);
        let setup = moved.with_recording(recording).with_table(self.membrane.table());
        let mut copy = Self::new(setup, start).ok()?;
        copy.push(force + distance * direction.force, 0.0);
        copy.take_voltages_of(self)?;
        copy.advance(self.time).ok()?;
        Some(copy)
    }

    /// Takes on the voltages that `other` has, from where it has them on.
    fn take_voltages_of(&mut self, other: &Self) -> Option<()> {
        let since = other.voltages.iter().map(|ramp| ramp.start).fold(self.time, f64::max).min(other.time);
        self.advance(since).ok()?;
        self.set_voltages(other.voltages.map(|ramp| ramp.at(since)), other.voltages.map(|ramp| ramp.rate)).ok()
    }

    /// External force, N, and its rate, N/s, at the present time.
    fn external_force(&self) -> [f64; 2] {
        let drive = self.motion.drive_at(self.time);
        [drive.external, drive.external_rate].map(|value| value * self.parameters.cylinder_mass)
    }

    fn push_by(&mut self, distance: f64) {
        let [force, rate] = self.external_force();
        self.push(force + distance, rate);
    }

    /// Moves continuous state number `state`, one of the motion, by `distance`, m or m/s. A ball that the cylinder carries goes with it.
    fn displace(&mut self, state: usize, distance: f64) {
        let mut change = [0.0; 4];
        change[state] = distance;
        let [dz, rate] = self.motion.relative_at(self.time);
        if self.motion.ball.is_carried() {
            (change[2], change[3]) = (change[0], change[1]);
        }
        let [position, velocity, ball_position, ball_velocity, _] = self.states();
        let here = self.motion.cylinder.at(self.time);
        let moved = CylinderState { position: position + change[0], velocity: velocity + change[1], ..here };
        let motion = &mut self.motion;
        motion.cylinder = CylinderMotion::from_state(&moved, motion.drive_at(self.time), motion.cylinder.load);
        motion.last.time = self.time;
        (motion.last.position, motion.last.velocity) = (ball_position + change[2], ball_velocity + change[3]);
        let is_searched = !motion.is_left_to_integrator();
        let here = motion.cylinder.at(self.time);
        motion.new_flight(&here, [dz + (change[0] - change[2]), rate + (change[1] - change[3])]);
        if is_searched {
            self.look_ahead();
        } else {
            self.forget_search();
        }
    }

    /// A force, N, of the size of those that act.
    fn typical_force(&self) -> f64 {
        let p = &self.parameters;
        let [force, _] = self.external_force();
        let sum = p.harmonic_acceleration() + p.incline().abs() + p.friction_acceleration();
        (p.cylinder_mass * sum).max(force.abs()).max(p.typical("N", 0.0))
    }

    fn past(&self) -> Past {
        let (totals, motion) = (self.totals(), &self.motion);
        Past {
            // Of a chattering sequence, more or fewer bounces may be resolved one by one.
            counts: [if totals.chatters == 0 { totals.impacts } else { 0 }, totals.chatters, totals.releases],
            ball: motion.ball.support(),
            is_stuck: self.is_stuck(),
            slip: motion.slip,
            contact: motion.ball.contact().map(|contact| contact.state.phase),
            pulses: self.pulses.under_way.each_ref().map(|pulses| {
                let largest = pulses.first()?;
                Some(largest.peak_time(&self.pulses.shape) <= self.time)
            }),
        }
    }

    /// Slopes of what is shown by `at`, which moves the cause by a distance, at zero; `typical`: a large distance.
    fn slopes(&self, typical: f64, at: impl Fn(f64) -> Option<Self>) -> Sensitivities {
        let (here, past) = (self.shown(), self.past());
        let change = |distance: f64| {
            let moved = at(distance).filter(|moved| moved.past() == past)?;
            let mut change = moved.shown().with(&here, |moved, here| moved - here);
            // What is predicted for one of them only has no change.
            for (number, predicted) in [
                (&mut change.next_impact, Self::next_impact as fn(&Self) -> Option<f64>),
                (&mut change.next_knot, Self::next_knot),
            ] {
                if predicted(self).is_none() || predicted(&moved).is_none() {
                    *number = 0.0;
                }
            }
            if moved.totals().impacts != self.totals().impacts {
                change.last_speed = f64::NAN; // that of another bounce
            }
            Some(change)
        };
        let (mut best, mut before): (Option<[Sensitivities; 2]>, Option<Sensitivities>) = (None, None);
        let mut h = STEP * typical;
        for _ in 0..STEPS {
            let estimate = slope(h, &change);
            if let (Some(now), Some(before)) = (&estimate, &before) {
                // Two may agree by chance where rounding counts.
                let spread = now.with(before, |now, before| (now - before).abs());
                let rounding = |value: f64| f64::EPSILON * value.abs() / h;
                let error = spread.with(&here, |spread, here| spread + rounding(here));
                let (old, old_error) = best.map_or((*now, error), |[value, error]| (value, error));
                // Far below, rounding may be the same at each step: a shorter one must be much better.
                let is_better = error.with(&old_error, |new, old| f64::from(new <= 0.1 * old || old.is_nan()));
                let value = is_better
                    .with(now, |better, now| if better > 0.0 { now } else { f64::NAN })
                    .with(&old, |new, old| if new.is_nan() { old } else { new });
                let error = is_better
                    .with(&error, |better, error| if better > 0.0 { error } else { f64::NAN })
                    .with(&old_error, |new, old| if new.is_nan() { old } else { new });
                best = Some([value, error]);
                let agree = Cell::new(true);
                let bound = now.with(&here, |now, here| AGREED * now.abs() + rounding(here));
                spread.with(&bound, |spread, bound| {
                    agree.set(agree.get() && spread <= bound);
                    0.0
                });
                if agree.get() {
                    break;
                }
            }
            before = estimate.or(before);
            h *= SHORTER;
        }
        let value = best.map(|[value, _]| value).or(before).unwrap_or_default();
        value.with(&value, |value, _| if value.is_finite() { value } else { 0.0 })
    }

    /// What sensitivities are the changes of.
    fn shown(&self) -> Sensitivities {
        let deflection = Side::BOTH.map(|side| self.deflection(side).value);
        let of_membrane = |value: &dyn Fn(f64) -> f64| deflection.map(value);
        let (membrane, totals) = (self.membrane(), self.totals());
        Sensitivities {
            cylinder: [self.cylinder_position(), self.cylinder_velocity(), self.cylinder_acceleration()],
            ball: [self.ball_position(), self.ball_velocity(), self.ball_acceleration()],
            relative_displacement: self.relative_displacement(),
            deflection,
            area_ratio: of_membrane(&|x| membrane.area_ratio(x)),
            stretch: of_membrane(&|x| membrane.stretch(x)),
            field_per_volt: of_membrane(&|x| membrane.field(x, 1.0)),
            capacitance: of_membrane(&|x| membrane.capacitance(x)),
            last_speed: totals.last_speed,
            rebound: self.effective_restitution(),
            voltage_gain: totals.voltage_gain,
            energy: totals.energy,
            energies: self.energies(),
            contact_time: self.contact_time(),
            mount_force: self.mount_force(),
            damping_power: self.damping_power(),
            next_impact: self.next_impact().unwrap_or(0.0),
            next_knot: self.next_knot().unwrap_or(0.0),
        }
    }
}

impl Sensitivities {
    /// Each number of this and that of `other`, taken together.
    fn with(&self, other: &Self, of: impl Fn(f64, f64) -> f64) -> Self {
        let pair = |a: [f64; 2], b: [f64; 2]| [of(a[0], b[0]), of(a[1], b[1])];
        let triple = |a: [f64; 3], b: [f64; 3]| [of(a[0], b[0]), of(a[1], b[1]), of(a[2], b[2])];
        let (e, f) = (&self.energies, &other.energies);
        Self {
            cylinder: triple(self.cylinder, other.cylinder),
            ball: triple(self.ball, other.ball),
            relative_displacement: of(self.relative_displacement, other.relative_displacement),
            deflection: pair(self.deflection, other.deflection),
            area_ratio: pair(self.area_ratio, other.area_ratio),
            stretch: pair(self.stretch, other.stretch),
            field_per_volt: pair(self.field_per_volt, other.field_per_volt),
            capacitance: pair(self.capacitance, other.capacitance),
            last_speed: of(self.last_speed, other.last_speed),
            rebound: of(self.rebound, other.rebound),
            voltage_gain: of(self.voltage_gain, other.voltage_gain),
            energy: of(self.energy, other.energy),
            energies: Energies {
                ball: of(e.ball, f.ball),
                cylinder: of(e.cylinder, f.cylinder),
                elastic: of(e.elastic, f.elastic),
                impact_loss: of(e.impact_loss, f.impact_loss),
                viscous: of(e.viscous, f.viscous),
                friction: of(e.friction, f.friction),
                gravity: of(e.gravity, f.gravity),
                suspension: of(e.suspension, f.suspension),
                damping: of(e.damping, f.damping),
                excitation: of(e.excitation, f.excitation),
                electrical: of(e.electrical, f.electrical),
                wall: of(e.wall, f.wall),
            },
            contact_time: of(self.contact_time, other.contact_time),
            mount_force: of(self.mount_force, other.mount_force),
            damping_power: of(self.damping_power, other.damping_power),
            next_impact: of(self.next_impact, other.next_impact),
            next_knot: of(self.next_knot, other.next_knot),
        }
    }
}

impl Parameters {
    /// What a parameter in this `unit` typically is, from its `value`.
    fn typical(&self, unit: &str, value: f64) -> f64 {
        let omega = TAU * self.frequency;
        // A recording or the external force may be all that drives.
        let acceleration = self.harmonic_acceleration().max(LEAST * self.travel() * omega * omega);
        let typical = match unit {
            "m" => self.travel(),
            "m/s" => self.travel() * self.frequency,
            "m/s2" => acceleration,
            "N" => self.cylinder_mass * acceleration,
            "N/m" => self.cylinder_mass * omega * omega,
            "N.s/m" => self.cylinder_mass * omega,
            "s" => 1.0 / self.frequency,
            _ => 1.0,
        };
        if value == 0.0 { typical } else { value.abs() }
    }
}

/// The slope at zero from changes at multiples of `h` on both sides, or on one, where the other has met other events.
fn slope(h: f64, change: &impl Fn(f64) -> Option<Sensitivities>) -> Option<Sensitivities> {
    let sum = |list: &[(f64, Sensitivities)]| {
        list.iter().fold(Sensitivities::default(), |sum, (weight, change)| {
            sum.with(change, |sum, change| sum + weight * change / h)
        })
    };
    let [ahead, behind] = [change(h), change(-h)];
    if let (Some(ahead), Some(behind)) = (&ahead, &behind)
        && let (Some(far), Some(back)) = (change(2.0 * h), change(-2.0 * h))
    {
        return Some(sum(&[(2.0 / 3.0, *ahead), (-2.0 / 3.0, *behind), (-1.0 / 12.0, far), (1.0 / 12.0, back)]));
    }
    let one_sided = |first: Option<Sensitivities>, sign: f64| {
        let [second, third, fourth] = [2.0, 3.0, 4.0].map(|n| change(sign * n * h));
        let terms = [(4.0, first?), (-3.0, second?), (4.0 / 3.0, third?), (-0.25, fourth?)];
        Some(sum(&terms.map(|(weight, change)| (sign * weight, change))))
    };
    one_sided(ahead, 1.0).or_else(|| one_sided(behind, -1.0))
}
