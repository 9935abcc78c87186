//! What a harvester shows at its present time.

use super::{Harvester, Totals};
use crate::flight::Side;
use crate::membrane::Membrane;
use crate::parameters::{ContactLaw, Parameters};
use crate::pulse::{Deflection, Knot};

impl Harvester {
    /// The parameters.
    pub fn parameters(&self) -> &Parameters {
        &self.parameters
    }

    /// The membrane, the same at both ends.
    pub fn membrane(&self) -> &Membrane {
        &self.membrane
    }

    /// Present time, s.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// `z_M`, m.
    pub fn cylinder_position(&self) -> f64 {
        self.cylinder_position_at(self.time)
    }

    /// `z_M'`, m/s.
    pub fn cylinder_velocity(&self) -> f64 {
        self.cylinder_velocity_at(self.time)
    }

    /// `z_M''`, m/s^2, Eq. (7).
    pub fn cylinder_acceleration(&self) -> f64 {
        self.cylinder.acceleration(self.time) + self.recoil_acceleration()
    }

    /// `z_m`, m.
    pub fn ball_position(&self) -> f64 {
        self.ball_position_at(self.time)
    }

    /// `z_m'`, m/s.
    pub fn ball_velocity(&self) -> f64 {
        self.ball_velocity_at(self.time)
    }

    /// dz = `z_M` - `z_m`, m.
    pub fn relative_displacement(&self) -> f64 {
        self.relative_displacement_at(self.time)
    }

    /// Deflection of the membrane at `side` and its rate.
    pub fn deflection(&self, side: Side) -> Deflection {
        if self.parameters.contact_law == ContactLaw::Compliant {
            return self.touch_deflection(side);
        }
        self.pulses[side.index()].at(&self.shape, self.time)
    }

    /// Capacitance of the membrane at `side`, F, Eq. (1).
    pub fn capacitance(&self, side: Side) -> f64 {
        self.membrane.capacitance(self.deflection(side).value)
    }

    /// Time derivative of the capacitance at `side`, F/s.
    pub fn capacitance_rate(&self, side: Side) -> f64 {
        let deflection = self.deflection(side);
        self.membrane.capacitance_slope(deflection.value) * deflection.rate
    }

    /// The membrane on which the ball rests: it does not move relative to it. Under the compliant law that is a ball which
    /// the wall's push holds at a deflection; one that swings about its equilibrium does not rest.
    pub fn resting(&self) -> Option<Side> {
        self.ball.resting.or(self.held())
    }

    /// Sums over all impacts so far.
    pub fn totals(&self) -> &Totals {
        &self.totals
    }

    /// The next peak or end of a pulse on each membrane.
    pub(super) fn pulse_knots(&self) -> impl Iterator<Item = Knot<'_>> {
        self.pulses.iter().filter_map(|pulses| pulses.next_knot(&self.shape, self.time))
    }
}
