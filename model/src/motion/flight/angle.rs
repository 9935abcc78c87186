//! The angle of the harmonic force at a place of a flight, and what it has passed through since the start.

#![allow(clippy::inline_always)] // what is taken at each event, and not inlined everywhere otherwise

use core::f64::consts::TAU;

use crate::numerics::elementary::ReducedAngle;

/// Functions of the angle phi that the force has passed through, each to its own digits however small phi is.
#[derive(Debug, Clone, Copy, Default)]
pub struct Swept {
    /// sin phi.
    pub sine: f64,
    /// 1 - cos phi.
    pub versine: f64,
    /// phi - sin phi.
    pub lag: f64,
}

/// The angle at a place.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Angle {
    /// Its sine and cosine.
    pub(super) sine: [f64; 2],
    pub(super) swept: Swept,
}

impl Angle {
    /// Up to here phi - sin phi is a short series, and beyond, that and 1 - cos phi as differences keep all but seven bits.
    pub(super) const SMALL: f64 = 0.25;

    /// The angle that lies `phi`, rad, that is `turns` but for whole ones, after one with this sine and cosine.
    #[inline(always)]
    pub(super) fn new(start: [f64; 2], phi: f64, turns: f64) -> Self {
        Self::swept(start, Swept::new(phi, turns))
    }

    /// The angle that lies so far after one with this sine and cosine.
    #[inline(always)]
    fn swept([sin, cos]: [f64; 2], swept: Swept) -> Self {
        let Swept { sine, versine, .. } = swept;
        Self { sine: [sin + (cos * sine - sin * versine), cos - (sin * sine + cos * versine)], swept }
    }

    /// The start's own angle, one turn later.
    pub(super) fn after_a_turn(self) -> Self {
        Self { swept: Swept { lag: TAU, ..Swept::default() }, ..self }
    }

    /// The angle that has this sine and cosine and lies `phi`, rad, after one that has those of `start`.
    #[inline]
    pub(super) fn known(start: [f64; 2], sine: [f64; 2], phi: f64) -> Self {
        let swept = sine[0] * start[1] - sine[1] * start[0];
        let versine = 1.0 - (sine[0] * start[0] + sine[1] * start[1]);
        Self { sine, swept: Swept { sine: swept, versine, lag: phi - swept } }
    }
}

impl Swept {
    /// The same for the angle `phi`, rad, that is `turns` but for whole ones.
    #[inline(always)]
    pub fn new(phi: f64, turns: f64) -> Self {
        let half = 0.5 * turns;
        // Most flights are that short, and what is known beforehand is not waited for.
        let angle = if half.abs() <= 0.25 { ReducedAngle::new(half, 0) } else { ReducedAngle::of(half) };
        let [sin, cos] = [angle.sin(), angle.cos()];
        let (sine, versine) = (2.0 * sin * cos, 2.0 * sin * sin);
        let lag = if phi.abs() < Angle::SMALL { small_lag(phi) } else { phi - sine };
        Self { sine, versine, lag }
    }
}

/// phi - sin phi up to [`Angle::SMALL`]: its Taylor series.
#[inline(always)]
fn small_lag(phi: f64) -> f64 {
    let q = phi * phi;
    let square = q * q;
    let low = 1.0 / 6.0 - q * (1.0 / 120.0);
    let high = (1.0 / 5040.0 - q * (1.0 / 362_880.0)) + square * (1.0 / 39_916_800.0 - q * (1.0 / 6_227_020_800.0));
    phi * q * (low + square * high)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::elementary::sin_cos;
    use proptest::prelude::*;

    /// phi - sin phi by its series, whose terms fall from the first on.
    fn lag(phi: f64) -> f64 {
        let (mut term, mut sum) = (phi * phi * phi / 6.0, 0.0);
        for n in 1..40 {
            sum += term;
            let n = f64::from(n);
            term *= -phi * phi / ((2.0 * n + 2.0) * (2.0 * n + 3.0));
        }
        sum
    }

    fn close(ours: f64, expected: f64, digits: f64, more: f64, what: &str) -> Result<(), TestCaseError> {
        let allowed = digits * f64::EPSILON * expected.abs() + more;
        prop_assert!((ours - expected).abs() <= allowed, "{what}: {ours} {expected}");
        Ok(())
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(if cfg!(miri) { 4 } else { 4000 }))]

        #[test]
        fn small_angles_keep_their_digits(exponent in -40.0..3.0_f64, sign in prop_oneof![Just(1.0), Just(-1.0)], start in 0.0..1.0_f64) {
            let phi = sign * exponent.exp2();
            let start = sin_cos(start);
            let Angle { sine, swept } = Angle::new(start, phi, phi / TAU);
            let rounding = if phi.abs() < 1.0 { 0.0 } else { 4.0 * f64::EPSILON * phi.abs() };
            close(swept.sine, phi.sin(), 4.0, rounding, "sine")?;
            close(swept.versine, 2.0 * (0.5 * phi).sin().powi(2), 8.0, rounding, "versine")?;
            close(swept.lag, lag(phi), 200.0, rounding, "lag")?;
            let angle = start[0].atan2(start[1]) + phi;
            prop_assert!((sine[0] - angle.sin()).abs() < 1e-15 + rounding && (sine[1] - angle.cos()).abs() < 1e-15 + rounding);
        }
    }
}
