//! First-order changes of the motion: what [`Sensitivities`] are made of.
//!
//! They are carried along with the motion, in closed form. Between events the change of the cylinder is a polynomial in time
//! and that of a free ball is linear; phase-noise samples come at fixed times and leave both alone. An impact comes
//! earlier or later by the change of the gap over the relative speed, and deflection, rebound and everything summed over
//! the impacts change with the relative speed that it then has. A ball at rest moves with the wall. A release comes
//! where the acceleration of both is the same, zero, so that its time does not matter to first order, or at a jump of it,
//! whose time is known.

use super::energy::LedgerChange;
use super::{Energies, Harvester, Side};
use crate::cylinder::{CylinderState, DriveChange};
use crate::membrane::MembraneChange;
use crate::parameters::Parameters;
use crate::pulse::{PulseChange, Pulses, ShapeChange};

/// Relative speed, m/s, below which an impact grazes if the wall recedes from the ball faster and faster, so that a little
/// earlier or later they would just miss each other. The factor by which an impact magnifies changes grows as one over the
/// relative speed; a grazing impact, which penetrates by less than the rounding of the positions, counts as none: changes
/// pass it as they would if the ball missed the membrane. Slow impacts of a ball that the wall pushes are bounces of
/// a chattering sequence, whose changes are as small as they are.
pub const GRAZING_SPEED: f64 = 1e-7;

/// Bound of the changes of the ball in SI units. Chaotic motion magnifies changes at each impact; beyond this they say
/// nothing any more, but they stay finite.
const LIMIT: f64 = 1e100;

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
pub(super) struct ParameterChange {
    /// Of `z_M`, m, and `z_M'`, m/s, at the start.
    cylinder: [f64; 2],
    pub(super) drive: DriveChange,
    /// Of the intensity of the phase noise, rad, and of its hold time, s.
    pub(super) intensity: f64,
    pub(super) hold: f64,
    half_travel: f64,
    cylinder_mass: f64,
    ball_mass: f64,
    restitution: f64,
    bias: f64,
    membrane: MembraneChange,
    pub(super) shape: ShapeChange,
}

/// Changes that are carried along.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Tangent {
    /// Time from which on the force is changed, s.
    pub(super) since: f64,
    /// Nobody has asked for them yet: all are zero, and impacts are spared the work.
    pub(super) idle: bool,
    /// Nothing but the time has come into them since they were forgotten.
    pub(super) fresh: bool,
    /// Change of the external force over M, m/s^2.
    pub(super) push: f64,
    /// Of `z_M` - `z_m`, m, and its rate, m/s, at the last event of a free ball.
    pub(super) motion: [f64; 2],
    /// Of the sums in [`Totals`](super::Totals): relative speed of the last impact, m/s; voltage gain, V; energy, J.
    pub(super) totals: [f64; 3],
    /// Of the books of the energy.
    pub(super) ledger: LedgerChange,
    pub(super) parameters: Option<ParameterChange>,
}

/// An impact and its surroundings.
pub(super) struct Hit {
    pub(super) side: Side,
    pub(super) speed: f64,
    pub(super) peak: f64,
    /// Derivative of `C_3` / `C_2` - 1 with the deflection, 1/m.
    pub(super) excess_slope: f64,
    pub(super) wall: CylinderState,
}

/// How an impact changes.
#[derive(Default)]
pub(super) struct HitChange {
    pub(super) pulse: PulseChange,
    /// Of `z_M'`, and of how much faster than that the ball rebounds, at the time of the impact.
    pub(super) wall: [f64; 2],
    /// Of what the impact adds to the books.
    ledger: LedgerChange,
    /// Of `C_3` / `C_2` - 1.
    excess: f64,
    /// Of `z_M` - `z_m` and its rate at the time of the impact, after it.
    motion: [f64; 2],
}

/// How everything that a harvester shows changes, per unit of a [`Direction`]. Lists have the values left and right.
#[derive(Debug, Clone, Copy, PartialEq)]
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
    /// Of the sum of `U_DE4` - `U_in`.
    pub voltage_gain: f64,
    /// Of the sum of W.
    pub energy: f64,
    /// Of [`Harvester::energies`].
    pub energies: Energies,
    /// Of [`Harvester::next_impact`]; 0 if there is none.
    pub next_impact: f64,
    /// Of [`Harvester::next_knot`]; 0 if there is none.
    pub next_knot: f64,
}

/// Whether an impact at relative `speed`, m/s, grazes, under the wall's `acceleration`, m/s^2.
pub(super) fn grazes(side: Side, speed: f64, acceleration: f64) -> bool {
    speed <= 0.0 || (speed < GRAZING_SPEED && side.sign() * acceleration <= 0.0)
}

pub(super) fn bounded(change: f64) -> f64 {
    change.clamp(-LIMIT, LIMIT)
}

impl Tangent {
    /// No change at all, until somebody asks for one.
    pub(super) fn none() -> Self {
        Self { idle: true, push: 0.0, ..Self::of_force(0.0, 1.0) }
    }

    /// One more newton from `since`, s, on.
    pub(super) fn of_force(since: f64, cylinder_mass: f64) -> Self {
        let (motion, totals, ledger) = ([0.0; 2], [0.0; 3], LedgerChange::default());
        Self { since, idle: false, fresh: false, push: 1.0 / cylinder_mass, motion, totals, ledger, parameters: None }
    }

    /// The start of `harvester` under the external `force`, N, moved along `direction`. `xi` multiplies the intensity of
    /// the phase noise.
    pub(super) fn along(harvester: &Harvester, force: f64, direction: &Direction, xi: f64) -> Self {
        let (p, d) = (&harvester.parameters, &direction.parameters);
        let heavier = d.cylinder_mass / p.cylinder_mass;
        let drive = DriveChange {
            amplitude: (d.amplitude - p.amplitude * heavier) / p.cylinder_mass,
            frequency: d.frequency,
            phase: d.phase + xi * d.phase_noise,
        };
        let half_travel = d.travel() / 2.0;
        let displacement = match p.projected_side() {
            Some(side) => side.sign() * half_travel,
            None => d.cylinder_position - d.ball_position,
        };
        let change = ParameterChange {
            cylinder: [d.cylinder_position, d.cylinder_velocity],
            drive,
            intensity: d.phase_noise,
            hold: d.noise_hold,
            half_travel,
            cylinder_mass: d.cylinder_mass,
            ball_mass: d.ball_mass,
            restitution: d.restitution,
            bias: d.bias_voltage,
            membrane: MembraneChange::new(p, d),
            shape: harvester.shape.change(d.stiffness_exponent, d.restitution),
        };
        Self {
            idle: false,
            fresh: false,
            since: harvester.time,
            push: (direction.force - force * heavier) / p.cylinder_mass,
            motion: [displacement, d.cylinder_velocity - d.ball_velocity],
            totals: [0.0; 3],
            ledger: LedgerChange::default(),
            parameters: Some(change),
        }
    }

    pub(super) fn half_travel(&self) -> f64 {
        self.parameters.map_or(0.0, |change| change.half_travel)
    }

    fn membrane(&self) -> Option<&MembraneChange> {
        self.parameters.as_ref().map(|change| &change.membrane)
    }

    pub(super) fn cylinder_mass(&self) -> f64 {
        self.parameters.map_or(0.0, |change| change.cylinder_mass)
    }

    pub(super) fn ball_mass(&self) -> f64 {
        self.parameters.map_or(0.0, |change| change.ball_mass)
    }

    pub(super) fn restitution(&self) -> f64 {
        self.parameters.map_or(0.0, |change| change.restitution)
    }

    /// Of `z_M'` at the start, m/s.
    pub(super) fn initial_velocity(&self) -> f64 {
        self.parameters.map_or(0.0, |change| change.cylinder[1])
    }
}

impl Harvester {
    /// Changes are those with the external force from now on.
    #[inline]
    pub(super) fn forget_changes(&mut self) {
        if !self.tangent.fresh {
            self.tangent = Tangent { fresh: true, ..Tangent::of_force(self.time, self.parameters.cylinder_mass) };
            self.pulses.iter_mut().for_each(Pulses::forget_changes);
        }
        self.tangent.since = self.time;
    }

    /// Of `z_M` and `z_M'` at `time`, s.
    pub(super) fn cylinder_change(&self, time: f64) -> [f64; 2] {
        let Tangent { since, push, .. } = self.tangent;
        let elapsed = time - since;
        let by_force = [0.5 * push * elapsed * elapsed, push * elapsed];
        let Some(change) = &self.tangent.parameters else { return by_force };
        let [position, velocity] = change.cylinder;
        let by_drive = self.change_by_force(time, change);
        [by_force[0] + position + velocity * elapsed + by_drive[0], by_force[1] + velocity + by_drive[1]]
    }

    /// Of `z_M` - `z_m` and its rate at `time`, s: to its own digits, however large the changes of both bodies are.
    pub(super) fn motion_change(&self, time: f64) -> [f64; 2] {
        if let Some(side) = self.ball.resting {
            return [side.sign() * self.tangent.half_travel(), 0.0];
        }
        let Tangent { since, push, motion: [displacement, rate], .. } = self.tangent;
        let (elapsed, pushed) = (time - self.ball.since, time - since.max(self.ball.since));
        let by_drive = self.tangent.parameters.map_or([0.0; 2], |change| self.motion_change_by_drive(time, &change));
        [displacement + rate * elapsed + 0.5 * push * pushed * pushed + by_drive[0], rate + push * pushed + by_drive[1]]
    }

    /// What the harmonic force adds to them since the last event of the ball, which went on as fast as the cylinder then was.
    fn motion_change_by_drive(&self, time: f64, change: &ParameterChange) -> [f64; 2] {
        let [position, velocity] = self.change_by_force(time, change);
        let since = self.ball.since;
        if since <= self.cylinder.start {
            return [position, velocity];
        }
        let [from, rate] = self.change_by_force(since, change);
        [position - from - rate * (time - since), velocity - rate]
    }

    /// Of `z_m` and `z_m'` at `time`, s.
    pub(super) fn ball_change(&self, time: f64) -> [f64; 2] {
        let ([position, velocity], [displacement, rate]) = (self.cylinder_change(time), self.motion_change(time));
        [position - displacement, velocity - rate]
    }

    /// Time by which an impact at `time` on `side` at relative `speed` comes later.
    pub(super) fn delay(&self, time: f64, side: Side, speed: f64) -> f64 {
        self.delay_by(self.motion_change(time)[0], side, speed)
    }

    /// The same when `z_M` - `z_m` at the time of the impact changes by `approach`, m.
    pub(super) fn delay_by(&self, approach: f64, side: Side, speed: f64) -> f64 {
        bounded((self.tangent.half_travel() - side.sign() * approach) / speed)
    }

    /// How an impact changes; the ball has not rebounded yet.
    pub(super) fn change_of(&self, hit: &Hit) -> HitChange {
        let Hit { side, speed, peak, excess_slope, .. } = *hit;
        let CylinderState { time, acceleration, .. } = hit.wall;
        let [_, velocity] = self.cylinder_change(time);
        let motion = self.motion_change(time);
        if grazes(side, speed, acceleration) {
            return HitChange { motion, wall: [velocity, -motion[1]], ..HitChange::default() };
        }
        let (sign, restitution) = (side.sign(), self.parameters.restitution);
        let delay = self.delay_by(motion[0], side, speed);
        let wall_change = velocity + acceleration * delay;
        let speed_change = sign * (motion[1] + acceleration * delay);
        let rebound_change = self.rebound_change(speed, speed_change);
        let membrane = self.tangent.membrane();
        let peak_change = bounded(self.membrane.deflection_change(speed, peak, speed_change, membrane));
        HitChange {
            pulse: PulseChange { start: delay, speed: bounded(speed_change), peak: peak_change },
            wall: [wall_change, sign * rebound_change].map(bounded),
            ledger: self.ledger_change(hit, bounded(speed_change), bounded(wall_change)),
            excess: excess_slope * peak_change + self.membrane.excess_change_by_geometry(peak, membrane),
            motion: [
                sign * (self.tangent.half_travel() + restitution * speed * delay),
                -sign * rebound_change - acceleration * delay,
            ]
            .map(bounded),
        }
    }

    fn rebound_change(&self, speed: f64, speed_change: f64) -> f64 {
        self.parameters.restitution * speed_change + self.tangent.restitution() * speed
    }

    /// Carries the changes over an impact with this `excess`.
    pub(super) fn take_over(&mut self, change: &HitChange, excess: f64) {
        self.tangent.motion = change.motion;
        self.tangent.totals[0] = change.pulse.speed;
        self.tangent.ledger.wall += change.ledger.wall;
        self.tangent.ledger.loss += change.ledger.loss;
        self.credit_change(excess, change.excess);
    }

    /// The same for the endless rest of a chattering sequence behind an impact at relative `speed`.
    pub(super) fn take_over_tail(&mut self, speed: f64, excess: f64) {
        let restitution = self.parameters.restitution;
        let by_restitution = self.tangent.restitution();
        let rebound_change = self.rebound_change(speed, self.tangent.totals[0]);
        let membrane = self.tangent.membrane();
        let rebound = restitution * speed;
        let change =
            self.membrane.excess_of_chatter_change(rebound, restitution, rebound_change, by_restitution, membrane);
        self.credit_change(excess, change);
    }

    /// The changes of what an impact with this `excess` adds: Eqs. (12) and (13).
    fn credit_change(&mut self, excess: f64, excess_change: f64) {
        let (bias, capacitance) = (self.parameters.bias_voltage, self.membrane.rest_capacitance());
        let [_, voltage_gain, energy] = &mut self.tangent.totals;
        *voltage_gain += bias * excess_change;
        *energy += 0.5 * bias * bias * capacitance * excess_change;
        if let Some(change) = &self.tangent.parameters {
            *voltage_gain += change.bias * excess;
            *energy +=
                (bias * change.bias * capacitance + 0.5 * bias * bias * change.membrane.rest_capacitance) * excess;
        }
    }

    /// First-order changes of everything, per newton of the external force: that set by the last
    /// [`Harvester::set_external_force`], moved by a constant and held since then. Of a harvester made by
    /// [`Harvester::along`], before that is called: per unit of its direction. Of any other harvester they are zero before.
    ///
    /// They are those of the side that the state is on: after an event at the present time. Events stay in their order, a
    /// ball at rest stays there. Grazing impacts ([`GRAZING_SPEED`]) count as none, so that all values are
    /// finite. The membrane is flat at the
    /// instant of an impact, and its changes are zero then.
    pub fn sensitivities(&self) -> Sensitivities {
        let (cylinder, ball) = (self.cylinder_change(self.time), self.ball_change(self.time));
        let deflection =
            [Side::Left, Side::Right].map(|side| self.pulses[side.index()].change_at(&self.shape, self.time));
        let values = [Side::Left, Side::Right].map(|side| self.deflection(side).value);
        let membrane = self.tangent.membrane();
        let by_drive = self.tangent.parameters.map_or(0.0, |c| self.cylinder.acceleration_change(self.time, &c.drive));
        let acceleration = self.tangent.push + by_drive;
        let after_due = self.is_due().then(|| self.after_due()).flatten();
        let foreseeing = after_due.as_ref().unwrap_or(self);
        let next_impact = foreseeing.next_impact_change();
        let [last_speed, voltage_gain, energy] = self.tangent.totals;
        Sensitivities {
            cylinder: [cylinder[0], cylinder[1], acceleration],
            ball: [ball[0], ball[1], if self.ball.resting.is_some() { acceleration } else { 0.0 }],
            relative_displacement: self.motion_change(self.time)[0],
            deflection,
            area_ratio: [0, 1].map(|k| self.membrane.area_change(values[k], deflection[k], membrane)),
            stretch: [0, 1].map(|k| self.membrane.stretch_change(values[k], deflection[k], membrane)),
            field_per_volt: [0, 1].map(|k| self.membrane.field_change(values[k], deflection[k], membrane)),
            capacitance: [0, 1].map(|k| self.membrane.capacitance_change(values[k], deflection[k], membrane)),
            last_speed,
            voltage_gain,
            energy,
            energies: self.energies_change(),
            next_impact,
            next_knot: foreseeing.next_knot_change(next_impact),
        }
    }
}
