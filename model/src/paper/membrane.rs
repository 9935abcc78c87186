//! The membrane as a variable capacitor: Eqs. (1) and (3) to (6).
//!
//! Differences from the flat membrane are written without cancellation: at small deflections the equations as the paper
//! prints them lose all digits. The paper's Eq. (4) writes `r` for the ball's radius in `A_32`; it is `r_b`.

use core::f64::consts::PI;

/// Deflection, in units of `R_2`, from which on the membrane is nearly a needle.
const STEEP: f64 = 1e4;

/// The angle alpha between the free part of the membrane and its original plane.
#[derive(Debug, Clone, Copy)]
pub struct Angle {
    /// cos(alpha).
    pub cos: f64,
    /// 1 - cos(alpha), without cancellation.
    pub versine: f64,
    /// d cos(alpha) / d delta, 1/m.
    pub cos_slope: f64,
}

/// Eq. (1): capacitance, F, of a flat membrane of this `permittivity`, F/m, `radius`, m, and `thickness`, m.
pub fn capacitance(permittivity: f64, radius: f64, thickness: f64) -> f64 {
    permittivity * PI * radius * radius / thickness
}

/// Eq. (1): at constant volume, `C_3` / `C_2` - 1 from `A_3` / `A_2` - 1.
pub fn capacitance_excess(area_excess: f64) -> f64 {
    area_excess * (2.0 + area_excess)
}

/// Eqs. (3) and (4): `A_3` / `A_2` - 1, where the membrane has this angle; `radius`: `R_2`, m, `ball`: `r_b`, m.
pub fn area_excess(radius: f64, ball: f64, &Angle { cos, versine, .. }: &Angle) -> f64 {
    let (r2, rb) = (radius * radius, ball * ball);
    versine * (rb + (r2 - rb) / cos) / r2
}

/// Derivative of Eqs. (3) and (4) with respect to cos(alpha): the two terms of the product rule, collected.
pub fn area_slope(radius: f64, ball: f64, cos: f64) -> f64 {
    let (r2, rb) = (radius * radius, ball * ball);
    -(rb + (r2 - rb) / (cos * cos)) / r2
}

/// Eqs. (5) and (6): the angle at the deflection delta, m.
///
/// Eq. (5) is `R_2` sin(alpha) - (delta - `r_b`) cos(alpha) = `r_b`, a quadratic in tan(alpha / 2). Its root below has
/// no cancellation at small deflections; cos(alpha) equals that of Eq. (6).
pub fn angle(radius: f64, ball: f64, delta: f64) -> Angle {
    let root = (radius * radius + delta * (delta - 2.0 * ball)).sqrt();
    let half = delta / (radius + root);
    let square = half * half;
    let inverse = 1.0 / (1.0 + square);
    let complement =
        if delta > STEEP * radius { steep_complement(radius, ball, delta, root, half) } else { 1.0 - square };
    let (cos, sin) = (complement * inverse, 2.0 * half * inverse);
    Angle { cos, versine: half * sin, cos_slope: -sin * cos / root }
}

/// 1 - `half`^2 where that loses its digits: `R_2` + root - delta is taken from root^2 - delta^2 = `R_2`^2 - 2 `r_b` delta.
///
/// Not inlined: the compiler would divide by the deflection ahead of the branch, by zero at rest, which a host may trap.
#[cold]
#[inline(never)]
fn steep_complement(radius: f64, ball: f64, delta: f64, root: f64, half: f64) -> f64 {
    let both = 1.0 + root / delta;
    let rest = radius * radius + ball * (radius * (radius / delta) - 2.0 * ball) / both;
    ((radius - ball) + rest / (both * delta)) / (radius + root) * (1.0 + half)
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    const R2: f64 = 0.0063;
    const RB: f64 = 0.005;

    /// Eq. (6), as the paper prints it.
    fn equation_6(delta: f64) -> f64 {
        let numerator = -2.0 * RB * (delta - RB) + 2.0 * R2 * (R2 * R2 + delta * delta - 2.0 * delta * RB).sqrt();
        numerator / (2.0 * (R2 * R2 + (delta - RB).powi(2)))
    }

    #[test]
    fn angle_and_area_are_those_of_the_equations_as_printed() {
        for k in 1..=500 {
            let delta = 1e-4 * f64::from(k);
            let there = angle(R2, RB, delta);
            let (cos, sin) = (there.cos, (1.0 - there.cos * there.cos).sqrt());
            assert_relative_eq!(cos, equation_6(delta), max_relative = 1e-9);
            let tan = (delta - RB * (1.0 - cos)) / (R2 - RB * sin);
            assert_relative_eq!(sin / cos, tan, max_relative = 1e-9);
            let cap = 2.0 * PI * RB * RB * (1.0 - cos);
            let cone = (PI * R2 * R2 - PI * RB * RB * (1.0 - cos * cos)) / cos;
            let area_ratio = 1.0 + area_excess(R2, RB, &there);
            assert_relative_eq!(area_ratio, (cap + cone) / (PI * R2 * R2), max_relative = 1e-9);
        }
    }

    #[test]
    fn small_deflections_keep_their_digits() {
        // A_3 / A_2 - 1 -> (delta / R_2)^2 / 2
        let excess = area_excess(R2, RB, &angle(R2, RB, 1e-9));
        assert_relative_eq!(excess, 0.5 * (1e-9 / R2).powi(2), max_relative = 1e-6);
        assert_eq!(area_excess(R2, RB, &angle(R2, RB, 0.0)), 0.0);
    }
}
