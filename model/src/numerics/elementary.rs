//! Logarithm, sine and cosine from sums, products, quotients and bit patterns alone: a loop over an array of arguments
//! becomes vector instructions, and every machine, with whatever vectors and mathematical library, gives the same bits.
#![allow(clippy::inline_always)] // only what is inlined becomes part of a loop over vectors

use core::f64::consts::{FRAC_PI_2, LN_2, SQRT_2};

/// Adding it to a double below 2^51 rounds that to the nearest integer, which then stands in the low bits of the sum.
const ROUNDER: f64 = 6_755_399_441_055_744.0; // 1.5 * 2^52

const MANTISSA: u64 = (1 << 52) - 1;
const ONE: u64 = 1.0_f64.to_bits();
const SIGN: u64 = 1 << 63;

/// An integer that is nearest to `x`. From 2^51 on it may be a neighbouring integer.
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

/// Natural logarithm of a normal, positive `x`, by `TERMS` terms of a series: 10 make it right to rounding, 6 leave a
/// relative error below 1e-10.
#[inline(always)]
pub fn ln<const TERMS: usize>(x: f64) -> f64 {
    const ROOT_HALF: u64 = (0.5 * SQRT_2).to_bits();
    const BIG: f64 = 4_503_599_627_370_496.0; // 2^52
    /// 1 / 3, 1 / 5, ...: the Taylor series of artanh s, without s, in powers of s^2.
    const ARTANH: [f64; 9] =
        [1.0 / 3.0, 1.0 / 5.0, 1.0 / 7.0, 1.0 / 9.0, 1.0 / 11.0, 1.0 / 13.0, 1.0 / 15.0, 1.0 / 17.0, 1.0 / 19.0];
    // x = 2^exponent m with m from sqrt(1/2) to sqrt(2).
    let shifted = x.to_bits() + (ONE - ROOT_HALF);
    let exponent = f64::from_bits(shifted >> 52 | BIG.to_bits()) - (BIG + 1023.0);
    let m = f64::from_bits((shifted & MANTISSA) + ROOT_HALF);
    // ln m = 2 artanh s: s <= 0.1716, and the first term left out is (s^2)^TERMS / (2 TERMS + 1) of the sum.
    let s = (m - 1.0) / (m + 1.0);
    let q = s * s;
    exponent * LN_2 + (2.0 * s + 2.0 * s * (q * sum::<9>(&ARTANH, TERMS - 1, Powers::of(q))))
}

/// x, x^2 and x^4.
#[derive(Clone, Copy)]
struct Powers([f64; 3]);

impl Powers {
    #[inline(always)]
    fn of(x: f64) -> Self {
        Self([x, x * x, (x * x) * (x * x)])
    }
}

/// Polynomial of the first `terms`, up to 9, of the `coefficients`, constant first, by Estrin's scheme: it waits less
/// for its own results than Horner's.
#[inline(always)]
fn sum<const N: usize>(coefficients: &[f64; N], terms: usize, Powers([x, x2, x4]): Powers) -> f64 {
    let two = |k: usize| match terms - k {
        1 => coefficients[k],
        _ => coefficients[k] + x * coefficients[k + 1],
    };
    let four = |k: usize| match terms - k {
        1 | 2 => two(k),
        _ => two(k) + x2 * two(k + 2),
    };
    match terms {
        ..=4 => four(0),
        5..=8 => four(0) + x4 * four(4),
        _ => four(0) + x4 * (four(4) + x4 * four(8)),
    }
}

/// Sine and cosine of an angle in `quarters` of a turn, below 2^51 of them, to rounding.
#[inline(always)]
pub fn sin_cos(quarters: f64) -> [f64; 2] {
    let rounded = quarters + ROUNDER;
    turned::<8>(quarters - (rounded - ROUNDER), rounded.to_bits())
}

/// Sine and cosine of the angle `x`, from -1/2 to 1/2 of a quarter turn, and as many whole quarters as the two low bits
/// of `quarter` say, by `TERMS` terms of the sine's series and one more of the cosine's: 8 make them right to rounding,
/// 6 leave an error below 1e-11.
#[inline(always)]
pub fn turned<const TERMS: usize>(x: f64, quarter: u64) -> [f64; 2] {
    /// Coefficients of the Taylor series from (pi / 2)^`first` / `first`! on.
    const fn series<const N: usize>(first: u32) -> [f64; N] {
        let mut coefficients = [0.0; N];
        let (mut k, mut n, mut factor) = (0, 0, 1.0);
        while k < N {
            if n >= first && (n - first).is_multiple_of(2) {
                coefficients[k] = if k % 2 == 0 { factor } else { -factor };
                k += 1;
            }
            n += 1;
            factor *= FRAC_PI_2 / n as f64;
        }
        coefficients
    }
    const SINE: [f64; 8] = series(1);
    const COSINE: [f64; 8] = series(2);
    let q = x * x;
    let powers = Powers::of(q);
    let sine = (x * sum::<8>(&SINE, TERMS, powers)).to_bits();
    let cosine = (1.0 - q * sum::<8>(&COSINE, TERMS, powers)).to_bits();
    // Odd quarters swap the two; the second bit of the quarter's number, and of the next one's, is the sign.
    let swap = (sine ^ cosine) & 0_u64.wrapping_sub(quarter & 1);
    let signs = [quarter << 62, (quarter + 1) << 62].map(|bits| bits & SIGN);
    [f64::from_bits(sine ^ swap ^ signs[0]), f64::from_bits(cosine ^ swap ^ signs[1])]
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::TAU;
    use proptest::prelude::*;

    /// Few where Miri interprets them, which takes far longer.
    const CASES: u32 = if cfg!(miri) { 20 } else { 20_000 };

    proptest! {
        #![proptest_config(ProptestConfig { cases: CASES, failure_persistence: None, ..ProptestConfig::default() })]

        #[test]
        fn the_logarithm_is_right_to_rounding(exponent in -52..3_i32, m in 0.5_f64..1.0) {
            let x = m * 2.0_f64.powi(exponent);
            prop_assert!((ln::<10>(x) - x.ln()).abs() <= 4.0 * f64::EPSILON * x.ln().abs(), "ln {x}");
        }

        #[test]
        fn close_to_one_the_logarithm_keeps_its_digits(distance in 1e-15_f64..1e-3) {
            for x in [1.0 - distance, 1.0 + distance] {
                prop_assert!((ln::<10>(x) - x.ln()).abs() <= 4.0 * f64::EPSILON * x.ln().abs(), "ln {x}");
            }
        }

        #[test]
        fn sine_and_cosine_are_right_to_rounding(quarters in -40..40_i32, rest in -0.125_f64..0.125) {
            // Below an eighth of a turn in size, where the library's functions take the angle as it is.
            let (turns, angle) = (0.25 * f64::from(quarters) + rest, TAU * rest);
            let [sin, cos] = sin_cos(4.0 * turns);
            let rounding = TAU * f64::EPSILON * turns.abs().max(1.0);
            let (s, c) = angle.sin_cos();
            let expected = match quarters.rem_euclid(4) {
                0 => [s, c],
                1 => [c, -s],
                2 => [-s, -c],
                _ => [-c, s],
            };
            let errors = [sin - expected[0], cos - expected[1]];
            prop_assert!(errors.iter().all(|error| error.abs() <= rounding), "{turns} turns: {errors:?}");
        }

        #[test]
        fn fewer_terms_leave_the_error_that_they_say(m in 0.5_f64..2.0, x in -0.5_f64..0.5) {
            prop_assert!((ln::<6>(m) - m.ln()).abs() <= 1e-10 * m.ln().abs(), "ln {m}");
            let ([sin, cos], (s, c)) = (turned::<6>(x, 0), (FRAC_PI_2 * x).sin_cos());
            prop_assert!((sin - s).abs() < 1e-11 && (cos - c).abs() < 1e-11, "{x} quarters");
        }

        #[test]
        fn a_unit_lies_in_its_interval(bits in any::<u64>()) {
            prop_assert!((0.0..1.0).contains(&unit(bits)));
        }
    }

    #[test]
    fn quarters_and_ends_are_exact() {
        for (turns, expected) in [(0.0, [0.0, 1.0]), (0.25, [1.0, 0.0]), (0.5, [0.0, -1.0]), (-0.25, [-1.0, 0.0])] {
            assert_eq!(sin_cos(4.0 * turns), expected, "{turns}");
            assert_eq!(sin_cos(4.0 * (turns + 3000.0)), expected, "{turns}");
        }
        assert_eq!(ln::<10>(1.0), 0.0);
        assert_eq!([unit(0), unit(u64::MAX)], [0.0, 1.0 - f64::EPSILON]);
    }
}
