//! A pre-stretched membrane that a ball presses in at its centre, as a spring and a variable capacitor.

mod elasticity;
mod film;
pub(crate) mod loading;
pub(crate) mod material;
mod pchip;
mod spring;
pub(crate) mod table;
pub(crate) mod viscosity;

use self::elasticity::Elasticity;
use self::table::ForceTable;
use self::viscosity::Viscosity;
use crate::paper::membrane;
use crate::parameters::VACUUM_PERMITTIVITY;
use crate::setup::Setup;

/// The membranes of a harvester, both alike. Deflections in m.
#[derive(Debug, Clone, PartialEq)]
pub struct Membrane {
    /// `R_2`, m.
    pub(crate) radius: f64,
    /// `h_2`, m.
    pub(crate) thickness: f64,
    /// lambda: stretch of the flat membrane.
    pub(crate) prestretch: f64,
    /// `eps_0` `eps_r`, F/m.
    pub(crate) permittivity: f64,
    /// `r_b`, m.
    pub(crate) ball_radius: f64,
    /// `C_2`, F.
    pub(crate) rest_capacitance: f64,
    /// Mass, kg, whose kinetic energy it takes up.
    mass: f64,
    elasticity: Elasticity,
    /// What makes a film viscous.
    pub(crate) viscosity: Option<Viscosity>,
}

impl Membrane {
    /// Membrane of a validated `setup`, or of parameters alone; where `membrane.law = table` has no table, that of Eq. (2).
    pub fn new<'a>(setup: impl Into<Setup<'a>>) -> Self {
        let setup = setup.into();
        let parameters = setup.parameters;
        let (radius, thickness) = (parameters.membrane_radius(), parameters.membrane_thickness());
        let permittivity = VACUUM_PERMITTIVITY * parameters.relative_permittivity;
        let elasticity = Elasticity::of(&setup);
        let measured = elasticity.table().and_then(ForceTable::rest_capacitance);
        Self {
            radius,
            thickness,
            prestretch: parameters.prestretch,
            permittivity,
            ball_radius: parameters.ball_radius,
            rest_capacitance: measured.unwrap_or_else(|| membrane::capacitance(permittivity, radius, thickness)),
            mass: parameters.impact_mass(),
            elasticity,
            viscosity: Viscosity::of(parameters),
        }
    }

    /// `R_2`, m.
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// `C_2`, F: Eq. (1) at stage 2 of Table 1, or as it was measured.
    pub fn rest_capacitance(&self) -> f64 {
        self.rest_capacitance
    }

    pub(crate) fn angle(&self, deflection: f64) -> membrane::Angle {
        membrane::angle(self.radius, self.ball_radius, deflection)
    }

    /// cos(alpha): Eq. (6).
    pub fn cos_alpha(&self, deflection: f64) -> f64 {
        self.angle(deflection).cos
    }

    /// `A_3` / `A_2`: Eqs. (3) and (4).
    pub fn area_ratio(&self, deflection: f64) -> f64 {
        1.0 + self.area_excess(deflection)
    }

    pub(crate) fn area_excess(&self, deflection: f64) -> f64 {
        membrane::area_excess(self.radius, self.ball_radius, &self.angle(deflection))
    }

    /// Derivative of `A_3` / `A_2`, 1/m.
    pub(crate) fn area_slope(&self, deflection: f64) -> f64 {
        let membrane::Angle { cos, cos_slope, .. } = self.angle(deflection);
        membrane::area_slope(self.radius, self.ball_radius, cos) * cos_slope
    }

    /// Thickness `h_3`, m: Table 1, constant volume.
    pub fn thickness_at(&self, deflection: f64) -> f64 {
        self.thickness / self.area_ratio(deflection)
    }

    /// lambda sqrt(`A_3` / `A_2`): the stretch of the area, equal in both directions.
    pub fn stretch(&self, deflection: f64) -> f64 {
        self.prestretch * self.area_ratio(deflection).sqrt()
    }

    /// U / `h_3`, V/m: the electric field under `voltage`, V.
    pub fn field(&self, deflection: f64, voltage: f64) -> f64 {
        voltage / self.thickness_at(deflection)
    }

    /// Capacitance, F: Eq. (1) with constant volume, C = `C_2` (A / `A_2`)^2, or as it was measured.
    pub fn capacitance(&self, deflection: f64) -> f64 {
        self.rest_capacitance * (1.0 + self.capacitance_excess(deflection))
    }

    /// `C_3` / `C_2` - 1, without cancellation.
    pub fn capacitance_excess(&self, deflection: f64) -> f64 {
        match self.measured_excess_and_slope(deflection) {
            Some([excess, _]) => excess,
            None => membrane::capacitance_excess(self.area_excess(deflection)),
        }
    }

    /// W of an impact at relative `speed`, m/s, J: Eq. (13) at the largest deflection of Eq. (10), with `bias`, V.
    pub fn impact_energy(&self, bias: f64, speed: f64) -> f64 {
        let excess = self.capacitance_excess(self.deflection(speed));
        crate::paper::impact::energy(bias, self.rest_capacitance(), excess)
    }

    /// The same and its derivative, 1/m.
    pub(crate) fn capacitance_excess_and_slope(&self, deflection: f64) -> [f64; 2] {
        if let Some(measured) = self.measured_excess_and_slope(deflection) {
            return measured;
        }
        let angle = self.angle(deflection);
        let excess = membrane::area_excess(self.radius, self.ball_radius, &angle);
        let slope = membrane::area_slope(self.radius, self.ball_radius, angle.cos) * angle.cos_slope;
        [membrane::capacitance_excess(excess), 2.0 * (1.0 + excess) * slope]
    }

    /// dC/dx, F/m: the derivative of [`Membrane::capacitance`].
    pub fn capacitance_slope(&self, deflection: f64) -> f64 {
        match self.measured_excess_and_slope(deflection) {
            Some([_, slope]) => self.rest_capacitance * slope,
            None => 2.0 * self.rest_capacitance * self.area_ratio(deflection) * self.area_slope(deflection),
        }
    }

    #[inline]
    fn measured_excess_and_slope(&self, deflection: f64) -> Option<[f64; 2]> {
        self.elasticity.table()?.capacitance_excess_and_slope(deflection)
    }

    /// Sum of `C_3` / `C_2` - 1 over the endless impacts at `speed`, r `speed`, r^2 `speed`, ... (m/s), r < 1.
    ///
    /// Terms are added one by one until the deflection is so small that the excess is a power of the speed, and the rest is a
    /// geometric series.
    pub(crate) fn excess_of_chatter(&self, speed: f64, restitution: f64) -> f64 {
        let mut sum = 0.0;
        let (speed, excess) = self.bounces(speed, restitution, |_, excess| sum += excess);
        // 1 - r^p, with its digits for r near 1, and without the logarithm of 0.
        let exponent = self.excess_exponent(speed);
        let complement = if restitution > 0.0 { -(exponent * restitution.ln()).exp_m1() } else { 1.0 };
        sum + excess / complement
    }

    /// Power with which `C_3` / `C_2` - 1 of an impact grows with small `speed`, m/s: with
    /// `A_3` / `A_2` - 1 -> (delta / `R_2`)^2 / 2 and a force as x^n that is 4 / (n + 1).
    fn excess_exponent(&self, speed: f64) -> f64 {
        let deflection = self.deflection(speed);
        let grows = match self.measured_excess_and_slope(deflection) {
            Some([excess, slope]) if excess > 0.0 => deflection * slope / excess,
            _ => 2.0,
        };
        2.0 * grows / (self.exponent(deflection) + 1.0)
    }

    /// Shows speed and excess of each of these impacts to `term`, as long as the excess is no power of the speed. Returns
    /// speed and excess of the first that is.
    pub(crate) fn bounces(&self, speed: f64, restitution: f64, mut term: impl FnMut(f64, f64)) -> (f64, f64) {
        const POWER_LAW_BELOW: f64 = 1e-12;
        const MAX_TERMS: u32 = 1000;
        let mut speed = speed;
        let mut excess = self.capacitance_excess(self.deflection(speed));
        for _ in 0..MAX_TERMS {
            if excess < POWER_LAW_BELOW {
                break;
            }
            term(speed, excess);
            speed *= restitution;
            excess = self.capacitance_excess(self.deflection(speed));
        }
        (speed, excess)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parameters::Parameters;
    use approx::assert_relative_eq;

    #[test]
    fn a_flat_membrane_has_the_capacitance_of_equation_1_and_its_slope_is_the_derivative() {
        let membrane = Membrane::new(&Parameters::default());
        // 8.8541878188e-12 F/m x 3.4 x pi (6.3 mm)^2 / 0.25 mm
        assert_relative_eq!(membrane.rest_capacitance(), 1.501_476_744_842_152e-11, max_relative = 1e-14);
        assert_eq!(membrane.capacitance_slope(0.0), 0.0);
        for k in 1..=200 {
            let (x, h) = (5e-5 * f64::from(k), 1e-6);
            let c = |x: f64| membrane.capacitance(x);
            let slope = (8.0 * (c(x + h) - c(x - h)) - (c(x + 2.0 * h) - c(x - 2.0 * h))) / (12.0 * h);
            assert_relative_eq!(membrane.capacitance_slope(x), slope, max_relative = 1e-8);
        }
    }

    #[test]
    fn the_sum_over_a_chattering_sequence_is_that_of_its_terms() {
        let m = Membrane::new(&Parameters::default());
        for (speed, r) in [(0.1, 0.5), (1e-3, 0.9), (0.3, 0.0), (1e-6, 0.6)] {
            let direct: f64 = (0..2000).map(|k| m.capacitance_excess(m.deflection(speed * f64::powi(r, k)))).sum();
            assert_relative_eq!(m.excess_of_chatter(speed, r), direct, max_relative = 1e-6);
        }
    }
}
