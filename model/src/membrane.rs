//! The membrane as a variable capacitor: geometry under the ball, Eqs. (3) to (6), and capacitance, Eq. (1).

mod change;

pub(crate) use self::change::MembraneChange;

use core::f64::consts::PI;

use crate::parameters::{Parameters, VACUUM_PERMITTIVITY};

/// A pre-stretched circular membrane that a ball presses in at its centre.
///
/// The paper's Eq. (4) writes `r` for the ball's radius in `A_32`; it is `r_b`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Membrane {
    radius: f64,
    thickness: f64,
    prestretch: f64,
    permittivity: f64,
    ball_radius: f64,
    rest_capacitance: f64,
    exponent: f64,
    /// Eq. (10) is delta = (`loading` v^2)^`power`: (n + 1) m / (2 K), and 1 / (n + 1).
    loading: f64,
    power: f64,
}

/// Deflection, in units of `R_2`, from which on the membrane is nearly a needle. No ordinary one gets near.
const STEEP: f64 = 1e4;

/// Cosine of the angle alpha between the free membrane and its original plane, and 1 - cos(alpha) without cancellation.
#[derive(Debug, Clone, Copy)]
struct Tangent {
    cos: f64,
    versine: f64,
    /// d cos(alpha) / d delta, 1/m.
    cos_slope: f64,
}

impl Membrane {
    /// Membrane of validated `parameters`.
    pub fn new(parameters: &Parameters) -> Self {
        let radius = parameters.membrane_radius();
        let thickness = parameters.membrane_thickness();
        let permittivity = VACUUM_PERMITTIVITY * parameters.relative_permittivity;
        Self {
            radius,
            thickness,
            prestretch: parameters.prestretch,
            permittivity,
            ball_radius: parameters.ball_radius,
            rest_capacitance: permittivity * PI * radius * radius / thickness,
            exponent: parameters.stiffness_exponent,
            loading: 0.5 * (parameters.stiffness_exponent + 1.0) * parameters.ball_mass / parameters.stiffness,
            power: 1.0 / (parameters.stiffness_exponent + 1.0),
        }
    }

    /// `R_2`, m.
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// `h_2`, m.
    pub fn thickness(&self) -> f64 {
        self.thickness
    }

    /// lambda: stretch of the flat membrane.
    pub(crate) fn prestretch(&self) -> f64 {
        self.prestretch
    }

    /// `eps_0` `eps_r`, F/m.
    pub(crate) fn permittivity(&self) -> f64 {
        self.permittivity
    }

    /// `C_2`, F: Eq. (1) at stage 2 of Table 1.
    pub fn rest_capacitance(&self) -> f64 {
        self.rest_capacitance
    }

    /// Largest deflection delta, m, after an impact at relative `speed`, m/s: Eq. (10).
    pub fn deflection(&self, speed: f64) -> f64 {
        (self.loading * speed * speed).powf(self.power)
    }

    /// The angle alpha at `deflection`, m, from Eq. (5).
    ///
    /// Eq. (5) is `R_2` sin(alpha) - (delta - `r_b`) cos(alpha) = `r_b`, a quadratic in tan(alpha / 2). Its root below has
    /// no cancellation at small deflections, where Eq. (6) for cos(alpha) loses all digits; the two are equal.
    fn tangent(&self, deflection: f64) -> Tangent {
        let (r2, rb) = (self.radius, self.ball_radius);
        let root = (r2 * r2 + deflection * (deflection - 2.0 * rb)).sqrt();
        let half = deflection / (r2 + root);
        let square = half * half;
        let inverse = 1.0 / (1.0 + square);
        let complement =
            if deflection > STEEP * r2 { self.steep_complement(deflection, root, half) } else { 1.0 - square };
        let (cos, sin) = (complement * inverse, 2.0 * half * inverse);
        Tangent { cos, versine: half * sin, cos_slope: -sin * cos / root }
    }

    /// 1 - `half`^2 where that loses its digits: `R_2` + root - delta is taken from root^2 - delta^2 = `R_2`^2 - 2 `r_b` delta.
    ///
    /// Not inlined: the compiler would divide by the deflection ahead of the branch, by zero at rest, which a host may trap.
    #[cold]
    #[inline(never)]
    fn steep_complement(&self, deflection: f64, root: f64, half: f64) -> f64 {
        let (r2, rb) = (self.radius, self.ball_radius);
        let both = 1.0 + root / deflection;
        let rest = r2 * r2 + rb * (r2 * (r2 / deflection) - 2.0 * rb) / both;
        ((r2 - rb) + rest / (both * deflection)) / (r2 + root) * (1.0 + half)
    }

    /// cos(alpha) at `deflection`, m: Eq. (6).
    pub fn cos_alpha(&self, deflection: f64) -> f64 {
        self.tangent(deflection).cos
    }

    /// `A_3` / `A_2` - 1 at `deflection`, m: Eqs. (3) and (4), written without cancellation.
    pub fn area_excess(&self, deflection: f64) -> f64 {
        self.area_excess_by(&self.tangent(deflection))
    }

    fn area_excess_by(&self, &Tangent { cos, versine, .. }: &Tangent) -> f64 {
        let (r2, rb) = (self.radius * self.radius, self.ball_radius * self.ball_radius);
        versine * (rb + (r2 - rb) / cos) / r2
    }

    /// `A_3` / `A_2` at `deflection`, m: Eqs. (3) and (4).
    pub fn area_ratio(&self, deflection: f64) -> f64 {
        1.0 + self.area_excess(deflection)
    }

    /// Thickness `h_3`, m, at `deflection`, m: Table 1, constant volume.
    pub fn thickness_at(&self, deflection: f64) -> f64 {
        self.thickness / self.area_ratio(deflection)
    }

    /// lambda sqrt(`A_3` / `A_2`): the stretch, equal in both directions, of the area at `deflection`, m.
    pub fn stretch(&self, deflection: f64) -> f64 {
        self.prestretch * self.area_ratio(deflection).sqrt()
    }

    /// U / `h_3`, V/m: the electric field at `deflection`, m, under `voltage`, V.
    pub fn field(&self, deflection: f64, voltage: f64) -> f64 {
        voltage / self.thickness_at(deflection)
    }

    /// Capacitance, F, at `deflection`, m: Eq. (1) with constant volume, C = `C_2` (A / `A_2`)^2.
    pub fn capacitance(&self, deflection: f64) -> f64 {
        self.rest_capacitance * (1.0 + self.capacitance_excess(deflection))
    }

    /// `C_3` / `C_2` - 1 at `deflection`, m, without cancellation.
    pub fn capacitance_excess(&self, deflection: f64) -> f64 {
        let excess = self.area_excess(deflection);
        excess * (2.0 + excess)
    }

    /// The same and its derivative, 1/m.
    pub(crate) fn capacitance_excess_and_slope(&self, deflection: f64) -> [f64; 2] {
        let tangent = self.tangent(deflection);
        let excess = self.area_excess_by(&tangent);
        let slope = self.area_slope_by_cos(tangent.cos) * tangent.cos_slope;
        [excess * (2.0 + excess), 2.0 * (1.0 + excess) * slope]
    }

    /// dC/dx, F/m, at `deflection` x, m: the derivative of [`Membrane::capacitance`].
    pub fn capacitance_slope(&self, deflection: f64) -> f64 {
        2.0 * self.rest_capacitance * self.area_ratio(deflection) * self.area_slope(deflection)
    }

    /// Derivative of `A_3` / `A_2`, 1/m, at `deflection`, m.
    fn area_slope(&self, deflection: f64) -> f64 {
        let Tangent { cos, cos_slope, .. } = self.tangent(deflection);
        self.area_slope_by_cos(cos) * cos_slope
    }

    /// d(`A_3` / `A_2`) / d cos(alpha). The versine is 1 - cos: the two terms of the product rule, collected.
    fn area_slope_by_cos(&self, cos: f64) -> f64 {
        let (r2, rb) = (self.radius * self.radius, self.ball_radius * self.ball_radius);
        -(rb + (r2 - rb) / (cos * cos)) / r2
    }

    /// `U_DE4`, V, after an impact that pressed the membrane to `deflection`, m, at `bias` `U_in`, V: Eq. (12).
    pub fn released_voltage(&self, deflection: f64, bias: f64) -> f64 {
        bias * (1.0 + self.capacitance_excess(deflection))
    }

    /// W, J, of an impact that pressed the membrane to `deflection`, m, at `bias` `U_in`, V: Eq. (13).
    pub fn impact_energy(&self, deflection: f64, bias: f64) -> f64 {
        0.5 * bias * bias * self.rest_capacitance * self.capacitance_excess(deflection)
    }

    /// Sum of `C_3` / `C_2` - 1 over the endless impacts at `speed`, r `speed`, r^2 `speed`, ... (m/s), r < 1.
    ///
    /// Terms are added one by one until the deflection is so small that the excess is a power of the speed: with
    /// `A_3` / `A_2` - 1 -> (delta / `R_2`)^2 / 2 it goes as speed^(4 / (n + 1)), and the rest is a geometric series.
    pub fn excess_of_chatter(&self, speed: f64, restitution: f64) -> f64 {
        let mut sum = 0.0;
        let (_, excess) = self.bounces(speed, restitution, |_, excess| sum += excess);
        // 1 - r^(4 / (n + 1)), with its digits for r near 1, and without the logarithm of 0.
        let exponent = 4.0 / (self.exponent + 1.0);
        let complement = if restitution > 0.0 { -(exponent * restitution.ln()).exp_m1() } else { 1.0 };
        sum + excess / complement
    }

    /// Shows speed and excess of each of these impacts to `term`, as long as the excess is no power of the speed. Returns
    /// speed and excess of the first that is.
    fn bounces(&self, speed: f64, restitution: f64, mut term: impl FnMut(f64, f64)) -> (f64, f64) {
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

    /// Exponent n of the force law, Eq. (2).
    pub fn exponent(&self) -> f64 {
        self.exponent
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    fn membrane() -> Membrane {
        Membrane::new(&Parameters::default())
    }

    /// Eq. (6), as the paper prints it.
    fn equation_6(r2: f64, rb: f64, delta: f64) -> f64 {
        let numerator = -2.0 * rb * (delta - rb) + 2.0 * r2 * (r2 * r2 + delta * delta - 2.0 * delta * rb).sqrt();
        numerator / (2.0 * (r2 * r2 + (delta - rb).powi(2)))
    }

    #[test]
    fn the_angle_solves_equations_5_and_6_at_every_deflection() {
        let (r2, rb) = (0.0063, 0.005);
        for k in 1..=500 {
            let delta = 1e-4 * f64::from(k);
            let cos = membrane().cos_alpha(delta);
            assert_relative_eq!(cos, equation_6(r2, rb, delta), max_relative = 1e-9);
            let sin = (1.0 - cos * cos).sqrt();
            let tan = (delta - rb * (1.0 - cos)) / (r2 - rb * sin);
            assert_relative_eq!(sin / cos, tan, max_relative = 1e-9);
        }
    }

    #[test]
    fn the_area_is_the_sum_of_equation_4() {
        let (r2, rb) = (0.0063_f64, 0.005_f64);
        for k in 1..=500 {
            let delta = 1e-4 * f64::from(k);
            let cos = equation_6(r2, rb, delta);
            let cap = 2.0 * PI * rb * rb * (1.0 - cos);
            let cone = (PI * r2 * r2 - PI * rb * rb * (1.0 - cos * cos)) / cos;
            assert_relative_eq!(membrane().area_ratio(delta), (cap + cone) / (PI * r2 * r2), max_relative = 1e-9);
        }
    }

    #[test]
    fn a_flat_membrane_has_the_capacitance_of_equation_1() {
        // 8.8541878188e-12 F/m x 3.4 x pi (6.3 mm)^2 / 0.25 mm
        assert_relative_eq!(membrane().rest_capacitance(), 1.501_476_744_842_152e-11, max_relative = 1e-14);
        assert_eq!(membrane().area_excess(0.0), 0.0);
        assert_eq!(membrane().capacitance_slope(0.0), 0.0);
    }

    #[test]
    fn small_deflections_keep_their_digits() {
        // A_3 / A_2 - 1 -> (delta / R_2)^2 / 2
        let delta = 1e-9;
        assert_relative_eq!(membrane().area_excess(delta), 0.5 * (delta / 0.0063_f64).powi(2), max_relative = 1e-6);
    }

    #[test]
    fn the_slope_of_the_capacitance_is_its_derivative() {
        for k in 1..=200 {
            let (x, h) = (5e-5 * f64::from(k), 1e-6);
            let c = |x: f64| membrane().capacitance(x);
            let slope = (8.0 * (c(x + h) - c(x - h)) - (c(x + 2.0 * h) - c(x - 2.0 * h))) / (12.0 * h);
            assert_relative_eq!(membrane().capacitance_slope(x), slope, max_relative = 1e-8);
        }
    }

    #[test]
    fn the_deflection_turns_the_kinetic_energy_into_the_work_of_the_force_law() {
        let delta = membrane().deflection(0.4);
        let work = 4.0847e5 / 3.6 * delta.powf(3.6);
        assert_relative_eq!(work, 0.5 * 0.0035 * 0.16, max_relative = 1e-13);
    }

    #[test]
    fn voltage_gain_and_energy_of_an_impact_obey_the_second_form_of_equation_14() {
        let (m, bias) = (membrane(), 2000.0);
        let delta = m.deflection(0.3);
        let gain = m.released_voltage(delta, bias) - bias;
        assert_relative_eq!(
            m.impact_energy(delta, bias),
            0.5 * m.rest_capacitance() * bias * gain,
            max_relative = 1e-13
        );
    }

    #[test]
    fn the_sum_over_a_chattering_sequence_is_that_of_its_terms() {
        let m = membrane();
        for (speed, r) in [(0.1, 0.5), (1e-3, 0.9), (0.3, 0.0), (1e-6, 0.6)] {
            let direct: f64 = (0..2000).map(|k| m.capacitance_excess(m.deflection(speed * f64::powi(r, k)))).sum();
            assert_relative_eq!(m.excess_of_chatter(speed, r), direct, max_relative = 1e-6);
        }
    }
}
