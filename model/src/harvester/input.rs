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
        within("externalForce", force, "N")?;
        within("derivative of externalForce", rate, "N/s")?;
        self.forget_changes();
        self.push(force, rate);
        Ok(())
    }

    #[inline]
    pub(super) fn push(&mut self, force: f64, rate: f64) {
        // Nothing pushes, as before: two quotients less for each step of a caller that sets its inputs anew.
        if [force, rate, self.cylinder.drive.external, self.cylinder.drive.external_rate] == [0.0; 4] {
            return;
        }
        let (mass, drive) = (self.parameters.cylinder_mass, &self.cylinder.drive);
        let (external, external_rate) = (force / mass, rate / mass);
        let present = drive.external + drive.external_rate * (self.time - self.cylinder.start);
        if external != present || external_rate != drive.external_rate {
            self.restart(self.time, Drive { external, external_rate, ..*drive });
            self.look_ahead();
        }
    }
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
