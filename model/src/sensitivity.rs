//! First-order changes of the motion: what [`Sensitivities`] are made of.
//!
//! They are carried along with the motion, in closed form. Between events the change of the cylinder is a polynomial in time
//! and that of a free ball is linear; phase-noise samples come at fixed times and leave both alone. An impact comes
//! earlier or later by the change of the gap over the relative speed, and deflection, rebound and everything summed over
//! the impacts change with the relative speed that it then has. A ball at rest moves with the wall. A release comes
//! where the acceleration of both is the same, zero, so that its time does not matter to first order, or at a jump of it,
//! whose time is known.

mod drive;
mod impact;
mod ledger;
mod membrane;
mod pulse;

pub use self::impact::{Hit, grazes};

use self::membrane::MembraneChange;
use self::pulse::ShapeChange;
use crate::accounting::ledger::Energies;
use crate::membrane::Membrane;
use crate::motion::Motion;
use crate::motion::cylinder::DriveChange;
use crate::motion::pulse::PulseShape;
use crate::motion::side::Side;
use crate::noise::Noise;
use crate::parameters::{ExcitationKind, Parameters};
use crate::shared::Shared;

/// Bound of the changes of the ball in SI units. Chaotic motion magnifies changes at each impact; beyond this they say
/// nothing any more, but they stay finite.
const LIMIT: f64 = 1e100;

pub fn bounded(change: f64) -> f64 {
    change.clamp(-LIMIT, LIMIT)
}

/// A small change of what a harvester is given.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Direction {
    /// Change of the real parameters; the others do not matter.
    pub parameters: Parameters,
    /// Change of the external force, N.
    pub force: f64,
}

impl Direction {
    /// One unit of the external force.
    pub fn of_force() -> Self {
        Self { parameters: Parameters::none(), force: 1.0 }
    }

    /// One unit of the real parameter `name`; none if there is no such parameter.
    pub fn of_parameter(name: &str) -> Option<Self> {
        let quantity = Parameters::TABLE.iter().find(|quantity| quantity.name == name)?;
        let mut parameters = Parameters::none();
        (quantity.set)(&mut parameters, 1.0);
        Some(Self { parameters, force: 0.0 })
    }
}

/// What changes besides the force, if the parameters do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ParameterChange {
    pub of: Parameters,
    half_travel: f64,
    /// Of g sin(beta), m/s^2.
    incline: f64,
    /// Of the ball's position at the start, m.
    start: f64,
    drive: DriveChange,
    membrane: MembraneChange,
    pub shape: ShapeChange,
}

/// Changes that are carried along, and the time from which they count.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize, serde::Deserialize)]
pub struct Changes {
    /// The force is changed from here on, s.
    pub since: f64,
    /// Of `z_M` - `z_m` at the last event of a free ball, m.
    pub displacement: f64,
    /// Of its rate then, m/s.
    pub rate: f64,
    /// Of the relative speed of the last impact, m/s.
    pub last_speed: f64,
    /// Of the sum of `U_DE4` - `U_in`, V.
    pub voltage_gain: f64,
    /// Of the sum of W, J.
    pub energy: f64,
    /// Of the energy lost, J.
    pub loss: f64,
}

/// Changes, and along what they are.
#[derive(Debug, Clone, PartialEq)]
pub struct Tangent {
    /// Nobody has asked for them yet: all are zero, and impacts are spared the work.
    pub idle: bool,
    /// Nothing but the time has come into them since they were forgotten.
    pub fresh: bool,
    /// Change of the external force, N.
    pub force: f64,
    /// Change of what it adds to `z_M''`, m/s^2.
    pub push: f64,
    pub changes: Changes,
    pub parameters: Option<Shared<ParameterChange>>,
}

/// How everything that a harvester shows changes, per unit of a [`Direction`]. Lists have the values left and right.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Sensitivities {
    /// Of `z_M`, `z_M'` and `z_M''`.
    pub cylinder: [f64; 3],
    /// Of `z_m`, `z_m'` and `z_m''`.
    pub ball: [f64; 3],
    /// Of `z_M` - `z_m`.
    pub relative_displacement: f64,
    /// Of the deflections.
    pub deflection: [f64; 2],
    /// Of `A_3` / `A_2`.
    pub area_ratio: [f64; 2],
    /// Of lambda sqrt(`A_3` / `A_2`).
    pub stretch: [f64; 2],
    /// Of 1 / `h_3`, the electric field per volt.
    pub field_per_volt: [f64; 2],
    /// Of the capacitances.
    pub capacitance: [f64; 2],
    /// Of the relative speed of the last impact.
    pub last_speed: f64,
    /// Of [`Harvester::effective_restitution`](crate::Harvester::effective_restitution), 1.
    pub rebound: f64,
    /// Of the sum of `U_DE4` - `U_in`.
    pub voltage_gain: f64,
    /// Of the sum of W.
    pub energy: f64,
    /// Of [`Harvester::energies`](crate::Harvester::energies).
    pub energies: Energies,
    /// Of the time in contact.
    pub contact_time: f64,
    /// Of the mount's force on the cylinder.
    pub mount_force: f64,
    /// Of the power that the damper takes.
    pub damping_power: f64,
    /// Of [`Harvester::next_impact`](crate::Harvester::next_impact); 0 if there is none.
    pub next_impact: f64,
    /// Of [`Harvester::next_knot`](crate::Harvester::next_knot); 0 if there is none.
    pub next_knot: f64,
}

impl Tangent {
    /// No change at all, until somebody asks for one.
    pub fn none() -> Self {
        Self { idle: true, fresh: false, force: 0.0, push: 0.0, changes: Changes::default(), parameters: None }
    }

    /// One more newton from `since`, s, on.
    pub fn of_force(since: f64, p: &Parameters) -> Self {
        let changes = Changes { since, ..Changes::default() };
        let push = if p.excitation_kind == ExcitationKind::Force { 1.0 / p.cylinder_mass } else { 0.0 };
        Self { idle: false, fresh: false, force: 1.0, push, changes, parameters: None }
    }

    /// A start at `since`, s, under the external `force`, N, moved along `direction`. `xi` multiplies the intensity of the
    /// phase noise.
    pub fn along(p: &Parameters, since: f64, force: f64, direction: &Direction, xi: f64) -> Self {
        let d = &direction.parameters;
        let heavier = d.cylinder_mass / p.cylinder_mass;
        let (amplitude, push) = match p.excitation_kind {
            ExcitationKind::Force => (
                (d.amplitude - p.amplitude * heavier) / p.cylinder_mass,
                (direction.force - force * heavier) / p.cylinder_mass,
            ),
            ExcitationKind::Motion => (d.acceleration, 0.0),
        };
        let drive = DriveChange { amplitude, frequency: d.frequency, phase: d.phase + xi * d.phase_noise };
        let half_travel = d.travel() / 2.0;
        let displacement = match p.projected_side() {
            Some(side) => side.sign() * half_travel,
            None => d.cylinder_position - d.ball_position,
        };
        let shape = PulseShape::new(p.stiffness_exponent, p.restitution);
        let change = ParameterChange {
            of: *d,
            half_travel,
            start: d.cylinder_position - displacement,
            incline: d.gravity * p.inclination.sin() + p.gravity * p.inclination.cos() * d.inclination,
            drive,
            membrane: MembraneChange::new(p, d),
            shape: ShapeChange::new(&shape, d.restitution),
        };
        let rate = d.cylinder_velocity - d.ball_velocity;
        Self {
            idle: false,
            fresh: false,
            force: direction.force,
            push,
            changes: Changes { since, displacement, rate, ..Changes::default() },
            parameters: Some(Shared::new(change)),
        }
    }

    /// One of the changes of the parameters, zero if they do not change.
    pub fn of(&self, change: impl Fn(&ParameterChange) -> f64) -> f64 {
        self.parameters.as_ref().map_or(0.0, |shared| change(shared))
    }

    fn half_travel(&self) -> f64 {
        self.of(|change| change.half_travel)
    }

    fn incline(&self) -> f64 {
        self.of(|change| change.incline)
    }

    pub fn membrane(&self) -> Option<&MembraneChange> {
        self.parameters.as_ref().map(|change| &change.membrane)
    }
}

/// A motion together with its changes.
#[derive(Clone, Copy)]
pub struct Tangential<'a> {
    pub parameters: &'a Parameters,
    pub membrane: &'a Membrane,
    pub motion: &'a Motion,
    pub noise: &'a Noise,
    pub tangent: &'a Tangent,
}

impl Tangential<'_> {
    /// Of `z_M` and `z_M'` at `time`, s.
    pub fn cylinder_change(&self, time: f64) -> [f64; 2] {
        let Tangent { push, changes: Changes { since, .. }, .. } = *self.tangent;
        let elapsed = time - since;
        let by_force = [0.5 * push * elapsed * elapsed, push * elapsed];
        let Some(change) = &self.tangent.parameters else { return by_force };
        let [position, velocity] = [change.of.cylinder_position, change.of.cylinder_velocity];
        let by_drive = self.change_by_drive(time, change);
        [by_force[0] + position + velocity * elapsed + by_drive[0], by_force[1] + velocity + by_drive[1]]
    }

    /// Of `z_M''` at `time`, s.
    pub fn acceleration_change(&self, time: f64) -> f64 {
        self.tangent.push + self.tangent.of(|change| self.motion.cylinder.acceleration_change(time, &change.drive))
    }

    /// Of `z_m''` at `time`, s.
    pub fn ball_acceleration_change(&self, time: f64) -> f64 {
        let is_carried = self.motion.ball.support().is_some();
        if is_carried { self.acceleration_change(time) } else { 0.0 - self.tangent.incline() }
    }

    /// Of `z_M` - `z_m` and its rate at `time`, s: to its own digits, however large the changes of both bodies are.
    pub fn motion_change(&self, time: f64) -> [f64; 2] {
        if let Some(side) = self.motion.ball.support() {
            return [side.sign() * self.tangent.half_travel(), 0.0];
        }
        let Tangent { push, changes: Changes { since, displacement, rate, .. }, .. } = *self.tangent;
        let last = self.motion.last.time;
        let (elapsed, pushed) = (time - last, time - since.max(last));
        let change = self.tangent.parameters.as_ref();
        let by_drive = change.map_or([0.0; 2], |change| self.motion_change_by_drive(time, change));
        let by_gravity = self.tangent.incline() * elapsed;
        [
            displacement + rate * elapsed + 0.5 * push * pushed * pushed + (by_drive[0] + 0.5 * by_gravity * elapsed),
            rate + push * pushed + (by_drive[1] + by_gravity),
        ]
    }

    /// What the harmonic force adds to them since the last event of the ball, which went on as fast as the cylinder then was.
    fn motion_change_by_drive(&self, time: f64, change: &ParameterChange) -> [f64; 2] {
        let [position, velocity] = self.change_by_drive(time, change);
        let since = self.motion.last.time;
        if since <= self.begin() {
            return [position, velocity];
        }
        let [from, rate] = self.change_by_drive(since, change);
        [position - from - rate * (time - since), velocity - rate]
    }

    /// Of `z_m` and `z_m'` at `time`, s.
    pub fn ball_change(&self, time: f64) -> [f64; 2] {
        let ([position, velocity], [displacement, rate]) = (self.cylinder_change(time), self.motion_change(time));
        [position - displacement, velocity - rate]
    }

    /// Time by which an impact at `time` on `side` at relative `speed` comes later.
    pub fn delay(&self, time: f64, side: Side, speed: f64) -> f64 {
        self.delay_by(self.motion_change(time)[0], side, speed)
    }

    /// The same when `z_M` - `z_m` at the time of the impact changes by `approach`, m.
    pub fn delay_by(&self, approach: f64, side: Side, speed: f64) -> f64 {
        bounded((self.tangent.half_travel() - side.sign() * approach) / speed)
    }

    /// Change of the next impact, at `time`, on `hit` at relative `speed`, of a ball that rests on `side` up to the `release`, s: it
    /// goes straight on from where, and as fast as, the wall lets it go.
    pub fn delay_after_release(&self, release: f64, side: Side, (time, hit, speed): (f64, Side, f64)) -> f64 {
        let ([from, velocity], [to, _]) = (self.cylinder_change(release), self.cylinder_change(time));
        let velocity = velocity + self.acceleration_before(release) * self.release_change(release);
        let elapsed = time - release;
        let by_gravity = 0.5 * self.tangent.incline() * elapsed * elapsed;
        let displacement = to - from - velocity * elapsed + by_gravity + side.sign() * self.tangent.half_travel();
        self.delay_by(displacement, hit, speed)
    }
}
