//! External force and voltages.

use super::Harvester;
use crate::contact::Ramp;
use crate::error::ModelError;
use crate::motion::cylinder::Drive;
use crate::motion::side::Side;
use crate::sensitivity::Tangent;

/// Largest force, voltage and rate of these, in SI units. Far beyond any use, and small enough that no energy of a run up to
/// 1e9 s is infinite, whatever the parameters.
const MAX_INPUT: f64 = 1e18;

impl Harvester {
    /// Sets the external force on the cylinder from now on: `force`, N, growing by `rate`, N/s. Setting the
    /// constant force again that acts already changes nothing in the motion, to the last bit.
    /// [`Harvester::sensitivities`] are counted from here.
    ///
    /// # Errors
    /// A force or rate that is not finite, or beyond 1e18 N or N/s.
    #[inline]
    pub fn set_external_force(&mut self, force: f64, rate: f64) -> Result<(), ModelError> {
        // No force, as before, and changes that have nothing but the time in them: so it is in most steps of a caller that sets
        // its inputs anew.
        if self.tangent.fresh && force == 0.0 && rate == 0.0 && !self.motion.cylinder.drive.pushes() {
            self.tangent.changes.since = self.time;
            return Ok(());
        }
        self.change_external_force(force, rate)
    }

    fn change_external_force(&mut self, force: f64, rate: f64) -> Result<(), ModelError> {
        check_force([force, rate])?;
        if self.has_closed_changes() && !self.tangent.fresh {
            self.tangent = Tangent { fresh: true, ..Tangent::of_force(self.time, &self.parameters) };
            self.pulses.forget_changes();
        }
        self.tangent.changes.since = self.time;
        self.push(force, rate);
        self.begin_differences();
        Ok(())
    }

    /// A copy under this force, N, these voltages, V, and their rates from now on, with the changes that this one has.
    ///
    /// # Errors
    /// As [`Harvester::set_external_force`] and [`Harvester::set_voltages`].
    pub fn under_inputs(&self, force: [f64; 2], voltages: [f64; 2], rates: [f64; 2]) -> Result<Self, ModelError> {
        check_force(force)?;
        let mut copy = self.clone();
        copy.push(force[0], force[1]);
        copy.set_voltages(voltages, rates)?;
        Ok(copy)
    }

    /// Whether setting force, N, and voltages, V, and their rates, would change nothing in the motion.
    pub fn has_inputs(&self, [force, rate]: [f64; 2], voltages: [f64; 2], rates: [f64; 2]) -> bool {
        self.is_pushed_by([force, rate].map(|value| value / self.parameters.cylinder_mass))
            && Side::BOTH.into_iter().all(|side| {
                let k = side.index();
                // A contact that is due begins under them.
                let acts = self.feels_voltage(side) || self.is_due();
                !acts || self.voltages[k].is(self.time, voltages[k], rates[k])
            })
    }

    /// Whether the ball is on the membrane at `side`, and feels its voltage.
    fn feels_voltage(&self, side: Side) -> bool {
        self.parameters.electrostatic_feedback
            && self.motion.ball.contact().is_some_and(|contact| contact.state.side == side)
    }

    /// Whether this external force over M, m/s^2, and its rate, m/s^3, act at present.
    fn is_pushed_by(&self, external: [f64; 2]) -> bool {
        let drive = self.motion.drive_at(self.time);
        external == [drive.external, drive.external_rate]
    }

    pub(super) fn push(&mut self, force: f64, rate: f64) {
        let drive = self.motion.cylinder.drive;
        let [external, external_rate] = [force, rate].map(|value| value / self.parameters.cylinder_mass);
        if !self.is_pushed_by([external, external_rate]) {
            self.restart(self.time, Drive { external, external_rate, ..drive });
            self.look_ahead();
        }
    }

    /// Sets the voltages across the left and the right membrane from now on, V, and their rates, V/s. They act with
    /// [`electrostatic_feedback`](crate::Parameters::electrostatic_feedback) only.
    ///
    /// # Errors
    /// A voltage or rate that is not finite, or beyond 1e18 V or V/s.
    #[inline]
    pub fn set_voltages(&mut self, voltages: [f64; 2], rates: [f64; 2]) -> Result<(), ModelError> {
        let [left, right] = &self.voltages;
        if rates[0] == 0.0 && rates[1] == 0.0 && left.stays_at(voltages[0]) && right.stays_at(voltages[1]) {
            return Ok(());
        }
        self.change_voltages(voltages, rates)
    }

    fn change_voltages(&mut self, voltages: [f64; 2], rates: [f64; 2]) -> Result<(), ModelError> {
        for side in Side::BOTH {
            let (value, rate) = (voltages[side.index()], rates[side.index()]);
            within("voltage of a membrane", value, "V")?;
            within("derivative of the voltage of a membrane", rate, "V/s")?;
            let ramp = &mut self.voltages[side.index()];
            if ramp.is(self.time, value, rate) {
                continue;
            }
            *ramp = Ramp { start: self.time, value, rate };
            if self.feels_voltage(side) {
                let time = self.time;
                let (motion, forces, limit, ledger, _) = self.parts();
                motion.change_voltages_in_contact(forces, limit, ledger, time);
                self.look_ahead();
            }
        }
        Ok(())
    }

    /// Voltage across the membrane at `side`, V.
    pub fn voltage(&self, side: Side) -> f64 {
        self.voltages[side.index()].at(self.time)
    }
}

pub(super) fn check_force([force, rate]: [f64; 2]) -> Result<(), ModelError> {
    within("externalForce", force, "N")?;
    within("derivative of externalForce", rate, "N/s")
}

/// An input, or its rate, within its bounds.
#[inline]
fn within(name: &'static str, value: f64, unit: &'static str) -> Result<(), ModelError> {
    if value.abs() <= MAX_INPUT {
        return Ok(());
    }
    finite(name, value)?;
    Err(ModelError::Bounds { name, value, unit, min: -MAX_INPUT, max: MAX_INPUT })
}

pub(super) fn finite(name: &'static str, value: f64) -> Result<(), ModelError> {
    if value.is_finite() { Ok(()) } else { Err(ModelError::NotFinite { name, value }) }
}
