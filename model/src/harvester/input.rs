//! The external force, and bounds on inputs.

use super::Harvester;
use crate::cylinder::Drive;
use crate::error::ModelError;

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
        check_force([force, rate])?;
        self.forget_changes();
        self.push(force, rate);
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

    /// Whether force, N, and voltages, V, and their rates, are those that act at present: setting them would change
    /// nothing.
    pub fn has_inputs(&self, [force, rate]: [f64; 2], voltages: [f64; 2], rates: [f64; 2]) -> bool {
        let ramps = self.voltages.iter().zip(voltages.iter().zip(rates));
        self.is_pushed_by([force, rate].map(|value| value / self.parameters.cylinder_mass))
            && ramps.into_iter().all(|(ramp, (value, rate))| ramp.at(self.time) == *value && ramp.rate == rate)
    }

    /// Whether this external force over M, m/s^2, and its rate, m/s^3, act at present.
    #[inline]
    fn is_pushed_by(&self, external: [f64; 2]) -> bool {
        let drive = &self.cylinder.drive;
        external == [drive.external + drive.external_rate * (self.time - self.cylinder.start), drive.external_rate]
    }

    #[inline]
    pub(super) fn push(&mut self, force: f64, rate: f64) {
        // Nothing pushes, as before: two quotients less for each step of a caller that sets its inputs anew.
        if [force, rate, self.cylinder.drive.external, self.cylinder.drive.external_rate] == [0.0; 4] {
            return;
        }
        let [external, external_rate] = [force, rate].map(|value| value / self.parameters.cylinder_mass);
        if !self.is_pushed_by([external, external_rate]) {
            self.restart(self.time, Drive { external, external_rate, ..self.cylinder.drive });
            self.look_ahead();
        }
    }
}

fn check_force([force, rate]: [f64; 2]) -> Result<(), ModelError> {
    within("externalForce", force, "N")?;
    within("derivative of externalForce", rate, "N/s")
}

/// An input, or its rate, within its bounds.
#[inline]
pub(super) fn within(name: &'static str, value: f64, unit: &'static str) -> Result<(), ModelError> {
    if value.abs() <= MAX_INPUT {
        return Ok(());
    }
    finite(name, value)?;
    Err(ModelError::Bounds { name, value, unit, min: -MAX_INPUT, max: MAX_INPUT })
}

pub(super) fn finite(name: &'static str, value: f64) -> Result<(), ModelError> {
    if value.is_finite() { Ok(()) } else { Err(ModelError::NotFinite { name, value }) }
}
