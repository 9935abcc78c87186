//! How an impact changes, and what it does to the changes.

use super::ledger::kinetic;
use super::{Tangent, Tangential, bounded};
use crate::membrane::Membrane;
use crate::motion::cylinder::CylinderState;
use crate::motion::pulse::PulseChange;
use crate::motion::side::Side;
use crate::paper::impact;
use crate::paper::impact::GRAZING_SPEED;
use crate::parameters::Parameters;

/// Whether an impact at relative `speed`, m/s, grazes, where dz'' is this `acceleration`, m/s^2.
pub fn grazes(side: Side, speed: f64, acceleration: f64) -> bool {
    speed <= 0.0 || (speed < GRAZING_SPEED && side.sign() * acceleration <= 0.0)
}

/// An impact and its surroundings.
pub struct Hit {
    pub side: Side,
    /// m/s.
    pub speed: f64,
    /// delta, m.
    pub peak: f64,
    /// Derivative of `C_3` / `C_2` - 1 with the deflection, 1/m.
    pub excess_slope: f64,
    pub wall: CylinderState,
}

/// How an impact changes.
#[derive(Default)]
pub struct HitChange {
    pub pulse: PulseChange,
    /// Of how much faster than the wall the ball rebounds.
    pub slip: f64,
    /// Of the energy lost.
    loss: f64,
    /// Of `C_3` / `C_2` - 1.
    excess: f64,
    /// Of `z_M` - `z_m` and its rate at the time of the impact, after it.
    motion: [f64; 2],
}

impl Tangential<'_> {
    /// How an impact changes; the ball has not rebounded yet.
    pub fn change_of(&self, hit: &Hit) -> HitChange {
        let Hit { side, speed, peak, excess_slope, .. } = *hit;
        let CylinderState { time, acceleration, .. } = hit.wall;
        let motion = self.motion_change(time);
        if grazes(side, speed, acceleration + self.motion.mount.incline) {
            return HitChange { motion, slip: -motion[1], ..HitChange::default() };
        }
        let (sign, restitution) = (side.sign(), self.parameters.restitution);
        let relative = acceleration + self.motion.mount.incline;
        let delay = self.delay_by(motion[0], side, speed);
        let speed_change = sign * (motion[1] + relative * delay);
        let rebound_change = self.tangent.rebound_change(restitution, speed, speed_change);
        let membrane = self.tangent.membrane();
        let peak_change = bounded(self.membrane.deflection_change(speed, peak, speed_change, membrane));
        HitChange {
            pulse: PulseChange { start: delay, speed: bounded(speed_change), peak: peak_change },
            slip: bounded(sign * rebound_change),
            loss: self.loss_change(speed, bounded(speed_change)),
            excess: excess_slope * peak_change + self.membrane.excess_change_by_geometry(peak, membrane),
            motion: [
                sign * (self.tangent.half_travel() + impact::rebound(restitution, speed) * delay),
                -sign * rebound_change - relative * delay,
            ]
            .map(bounded),
        }
    }

    /// Change of the energy that an impact at relative `speed` takes, when that changes by so much, m/s.
    fn loss_change(&self, speed: f64, speed_change: f64) -> f64 {
        let (r, dr) = (self.parameters.restitution, self.tangent.of(|change| change.of.restitution));
        let mass = self.tangent.ball_mass(self.parameters.ball_mass);
        let energy = 0.5 * self.parameters.ball_mass * speed * speed;
        bounded((1.0 - r * r) * kinetic(mass, [speed, speed_change]) - 2.0 * r * dr * energy)
    }
}

impl Tangent {
    fn rebound_change(&self, restitution: f64, speed: f64, speed_change: f64) -> f64 {
        restitution * speed_change + self.of(|change| change.of.restitution) * speed
    }

    /// Carries the changes over an impact with this `excess`.
    pub fn pass_impact(&mut self, p: &Parameters, membrane: &Membrane, change: &HitChange, excess: f64) {
        [self.changes.displacement, self.changes.rate] = change.motion;
        self.changes.last_speed = change.pulse.speed;
        self.changes.loss += change.loss;
        self.credit(p, membrane, excess, change.excess);
    }

    /// The same for the endless rest of a chattering sequence behind an impact at relative `speed`.
    pub fn pass_tail(&mut self, p: &Parameters, membrane: &Membrane, speed: f64, excess: f64) {
        let restitution = p.restitution;
        let by_restitution = self.of(|change| change.of.restitution);
        let rebound_change = self.rebound_change(restitution, speed, self.changes.last_speed);
        let rebound = impact::rebound(restitution, speed);
        let change =
            membrane.excess_of_chatter_change(rebound, restitution, rebound_change, by_restitution, self.membrane());
        self.credit(p, membrane, excess, change);
    }

    /// The changes of what an impact with this `excess` adds: Eqs. (12) and (13).
    fn credit(&mut self, p: &Parameters, membrane: &Membrane, excess: f64, excess_change: f64) {
        let (bias, capacitance) = (p.bias_voltage, membrane.rest_capacitance);
        self.changes.voltage_gain += impact::voltage_gain(bias, excess_change);
        self.changes.energy += impact::energy(bias, capacitance, excess_change);
        if let Some(change) = &self.parameters {
            self.changes.voltage_gain += impact::voltage_gain(change.of.bias_voltage, excess);
            self.changes.energy += (bias * change.of.bias_voltage * capacitance
                + 0.5 * bias * bias * change.membrane.rest_capacitance)
                * excess;
        }
    }
}
