//! Logarithm, sine and cosine from sums, products, quotients and bit patterns alone: a loop over an array of arguments
//! becomes vector instructions, and every machine, with whatever vectors and mathematical library, gives the same bits.
#![allow(clippy::inline_always)] // only what is inlined becomes part of a loop over vectors

use core::f64::consts::{LN_2, SQRT_2, TAU};

/// Adding it to a double below 2^51 rounds that to the nearest integer, which then stands in the low bits of the sum.
const ROUNDER: f64 = 6_755_399_441_055_744.0; // 1.5 * 2^52

const MANTISSA: u64 = (1 << 52) - 1;
const ONE: u64 = 1.0_f64.to_bits();
const SIGN: u64 = 1 << 63;

/// An integer that is nearest to `x`. From 2^51 on it may be another one, by which the two differ.
#[inline(always)]
pub fn round(x: f64) -> f64 {
    (x + ROUNDER) - ROUNDER
}

/// `x`, below 2^51, less a whole number; from 0 to 1.
#[inline(always)]
pub fn fraction(x: f64) -> f64 {
    let rest = x - round(x);
    if rest < 0.0 { rest + 1.0 } else { rest }
}

/// Number in [0, 1) with the 52 leading bits of `bits`.
#[inline(always)]
pub fn unit(bits: u64) -> f64 {
    f64::from_bits(bits >> 12 | ONE) - 1.0
}

/// Natural logarithm of a normal, positive `x`.
#[inline(always)]
pub fn ln(x: f64) -> f64 {
    const ROOT_HALF: u64 = (0.5 * SQRT_2).to_bits();
    const BIG: f64 = 4_503_599_627_370_496.0; // 2^52
    // x = 2^exponent m with m from sqrt(1/2) to sqrt(2).
    let shifted = x.to_bits() + (ONE - ROOT_HALF);
    let exponent = f64::from_bits(shifted >> 52 | BIG.to_bits()) - (BIG + 1023.0);
    let m = f64::from_bits((shifted & MANTISSA) + ROOT_HALF);
    // ln m = 2 artanh s: s <= 0.1716, and the first term left out is below half a unit in the last place.
    let s = (m - 1.0) / (m + 1.0);
    let q = s * s;
    let mut sum = 1.0 / 19.0;
    for odd in [17.0, 15.0, 13.0, 11.0, 9.0, 7.0, 5.0, 3.0] {
        sum = sum * q + 1.0 / odd;
    }
    exponent * LN_2 + (2.0 * s + 2.0 * s * (q * sum))
}

/// Sine and cosine of an angle in `turns`, below 2^49 of them.
#[inline(always)]
pub fn sin_cos(turns: f64) -> [f64; 2] {
    /// 1 / (2 3), 1 / (4 5), ...: from one term of a Taylor series to the next.
    const fn factors<const N: usize>(first: f64) -> [f64; N] {
        let mut factors = [0.0; N];
        let (mut k, mut n, mut product) = (0, first, 1.0);
        while k < N {
            product /= -n * (n + 1.0);
            factors[k] = product;
            (k, n) = (k + 1, n + 2.0);
        }
        factors
    }
    const SINE: [f64; 7] = factors(2.0);
    const COSINE: [f64; 8] = factors(1.0);
    let rounded = 4.0 * turns + ROUNDER;
    let quarter = rounded.to_bits();
    let x = TAU * (turns - 0.25 * (rounded - ROUNDER));
    let q = x * x;
    let (mut sine, mut cosine) = (SINE[6], COSINE[7]);
    for k in (0..6).rev() {
        sine = sine * q + SINE[k];
    }
    for k in (0..7).rev() {
        cosine = cosine * q + COSINE[k];
    }
    let (sine, cosine) = ((x + x * (q * sine)).to_bits(), (1.0 + q * cosine).to_bits());
    // Odd quarters swap the two; the second bit of the quarter's number, and of the next one's, is the sign.
    let swap = (sine ^ cosine) & 0_u64.wrapping_sub(quarter & 1);
    let signs = [quarter << 62, (quarter + 1) << 62].map(|bits| bits & SIGN);
    [f64::from_bits(sine ^ swap ^ signs[0]), f64::from_bits(cosine ^ swap ^ signs[1])]
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]

        #[test]
        fn the_logarithm_is_right_to_rounding(exponent in -52..3_i32, m in 0.5_f64..1.0) {
            let x = m * 2.0_f64.powi(exponent);
            prop_assert!((ln(x) - x.ln()).abs() <= 4.0 * f64::EPSILON * x.ln().abs(), "ln {x}");
        }

        #[test]
        fn close_to_one_the_logarithm_keeps_its_digits(distance in 1e-15_f64..1e-3) {
            for x in [1.0 - distance, 1.0 + distance] {
                prop_assert!((ln(x) - x.ln()).abs() <= 4.0 * f64::EPSILON * x.ln().abs(), "ln {x}");
            }
        }

        #[test]
        fn sine_and_cosine_are_right_to_rounding(eighths in -40..40_i32, rest in -0.07_f64..0.07) {
            // Below an eighth of a turn in size, where the library's functions take the angle as it is.
            let (turns, angle) = (0.25 * f64::from(eighths) + rest, TAU * rest);
            let [sin, cos] = sin_cos(turns);
            let rounding = TAU * f64::EPSILON * turns.abs().max(1.0);
            let (s, c) = angle.sin_cos();
            let expected = match eighths.rem_euclid(4) {
                0 => [s, c],
                1 => [c, -s],
                2 => [-s, -c],
                _ => [-c, s],
            };
            let errors = [sin - expected[0], cos - expected[1]];
            prop_assert!(errors.iter().all(|error| error.abs() <= rounding), "{turns} turns: {errors:?}");
        }

        #[test]
        fn a_unit_lies_in_its_interval(bits in any::<u64>()) {
            prop_assert!((0.0..1.0).contains(&unit(bits)));
        }
    }

    #[test]
    fn quarters_and_ends_are_exact() {
        for (turns, expected) in [(0.0, [0.0, 1.0]), (0.25, [1.0, 0.0]), (0.5, [0.0, -1.0]), (-0.25, [-1.0, 0.0])] {
            assert_eq!(sin_cos(turns), expected, "{turns}");
            assert_eq!(sin_cos(turns + 3000.0), expected, "{turns}");
        }
        assert_eq!(ln(1.0), 0.0);
        assert_eq!([unit(0), unit(u64::MAX)], [0.0, 1.0 - f64::EPSILON]);
    }
}
