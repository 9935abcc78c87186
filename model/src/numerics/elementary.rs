//! Logarithm, sine and cosine from sums, products, quotients and bit patterns alone: a loop over an array of arguments
//! becomes vector instructions, and every machine, with whatever vectors and mathematical library, gives the same bits.
#![allow(clippy::inline_always)] // only what is inlined becomes part of a loop over vectors

use core::f64::consts::{LN_2, SQRT_2, TAU};

/// Adding it to a double below 2^51 rounds that to the nearest integer, which then stands in the low bits of the sum.
const ROUNDER: f64 = 6_755_399_441_055_744.0; // 1.5 * 2^52

/// The same for the nearest multiple of 1/2.
const HALVES_ROUNDER: f64 = 0.5 * ROUNDER;

const MANTISSA: u64 = (1 << 52) - 1;
const ONE: u64 = 1.0_f64.to_bits();

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

/// Number from `start`, a power of two, up to twice that, with the 52 leading bits of `bits`.
#[inline(always)]
pub fn in_binade(start: f64, bits: u64) -> f64 {
    f64::from_bits(start.to_bits() | bits >> 12)
}

/// Natural logarithm of a normal, positive `x`, with a relative error below 2e-11.
#[inline(always)]
pub fn ln(x: f64) -> f64 {
    const ROOT_HALF: u64 = (0.5 * SQRT_2).to_bits();
    const BIG: f64 = 4_503_599_627_370_496.0; // 2^52
    /// Chebyshev expansion of (artanh(s) / s - 1) / s^2 in powers of s^2, up to s = 0.1716.
    const ARTANH: [f64; 4] =
        [0.333_333_332_768_920_3, 0.200_000_611_386_841_36, 0.142_753_905_533_683_22, 0.116_656_837_418_832_84];
    // x = 2^exponent m with m from sqrt(1/2) to sqrt(2).
    let shifted = x.to_bits() + (ONE - ROOT_HALF);
    let exponent = f64::from_bits(shifted >> 52 | BIG.to_bits()) - (BIG + 1023.0);
    let m = f64::from_bits((shifted & MANTISSA) + ROOT_HALF);
    // ln m = 2 artanh s.
    let s = (m - 1.0) / (m + 1.0);
    let q = s * s;
    exponent * LN_2 + (2.0 * s + 2.0 * s * (q * sum(&ARTANH, Powers::of(q))))
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

/// Polynomial of up to 8 `coefficients`, constant first, by Estrin's scheme: it waits less for its own results than
/// Horner's.
#[inline(always)]
fn sum<const N: usize>(coefficients: &[f64; N], Powers([x, x2, x4]): Powers) -> f64 {
    let two = |k: usize| coefficients[k] + x * coefficients[k + 1];
    let four = |k: usize| two(k) + x2 * two(k + 2);
    match N {
        4 => four(0),
        6 => four(0) + x4 * two(4),
        _ => four(0) + x4 * four(4),
    }
}

/// Coefficients of sin(2 pi x) / x in powers of x^2, for x from -1/4 to 1/4: least squares of the sine at Chebyshev points.
/// The first is 2 pi, so that small angles keep their digits.
const SINE: [f64; 8] = [
    TAU,
    -41.341_702_240_397_44,
    81.605_249_275_349_41,
    -76.705_859_668_530_22,
    42.058_689_040_500_98,
    -15.094_485_728_672_009,
    3.817_137_900_755_142,
    -0.691_502_413_774_851_8,
];
const SHORT_SINE: [f64; 6] = [
    6.283_185_306_485_778_6,
    -41.341_701_929_219_92,
    81.605_209_381_542_54,
    -76.703_666_015_816_85,
    41.999_960_835_557_89,
    -14.336_856_000_340_191,
];

/// The same of (1 - cos(2 pi x)) / x^2.
const COSINE: [f64; 8] = [
    19.739_208_802_178_71,
    -64.939_394_022_664_25,
    85.456_817_206_004_05,
    -60.244_641_314_206_9,
    26.426_254_094_158_562,
    -7.903_462_913_082_838,
    1.713_221_898_173_760_4,
    -0.271_957_914_283_024_85,
];
const SHORT_COSINE: [f64; 6] = [
    19.739_208_801_337_67,
    -64.939_393_764_028_52,
    85.456_790_564_726_08,
    -60.243_375_564_758_24,
    26.395_765_882_378_043,
    -7.540_628_222_619_867,
];

/// An angle as the nearest number of half turns and the rest.
#[derive(Clone, Copy)]
pub struct ReducedAngle {
    /// From -1/4 to 1/4 of a turn.
    rest: f64,
    /// The sign bit if the half turns are odd: both functions change their sign.
    sign: u64,
    powers: Powers,
}

impl ReducedAngle {
    /// So many `turns`, below 2^50 of them.
    #[inline(always)]
    pub fn of(turns: f64) -> Self {
        Self::near(turns, turns)
    }

    /// The same if they are `about` so many, which may be known sooner.
    #[inline(always)]
    pub fn near(turns: f64, about: f64) -> Self {
        let rounded = about + HALVES_ROUNDER;
        Self::new(turns - (rounded - HALVES_ROUNDER), rounded.to_bits())
    }

    /// `rest`, from -1/4 to 1/4 of a turn, and a half turn if the lowest bit of `halves` is set.
    #[inline(always)]
    pub fn new(rest: f64, halves: u64) -> Self {
        Self { rest, sign: halves << 63, powers: Powers::of(rest * rest) }
    }

    #[inline(always)]
    fn signed(self, value: f64) -> f64 {
        f64::from_bits(value.to_bits() ^ self.sign)
    }

    /// Sine, with an error below 4e-16.
    #[inline(always)]
    pub fn sin(self) -> f64 {
        self.signed(self.rest) * sum(&SINE, self.powers)
    }

    /// Cosine, with an error below 4e-16.
    #[inline(always)]
    pub fn cos(self) -> f64 {
        self.signed(1.0) - self.signed(self.powers.0[0]) * sum(&COSINE, self.powers)
    }

    /// Sine, with an error below 2e-11.
    #[inline(always)]
    pub fn short_sin(self) -> f64 {
        self.signed(self.rest * sum(&SHORT_SINE, self.powers))
    }

    /// Cosine, with an error below 1e-12.
    #[inline(always)]
    pub fn short_cos(self) -> f64 {
        self.signed(1.0 - self.powers.0[0] * sum(&SHORT_COSINE, self.powers))
    }
}

/// Sine and cosine of an angle of so many `turns`, below 2^50 of them, with errors below 4e-16.
#[inline(always)]
pub fn sin_cos(turns: f64) -> [f64; 2] {
    let angle = ReducedAngle::of(turns);
    [angle.sin(), angle.cos()]
}

#[cfg(test)]
mod tests {
    use super::*;

    use proptest::prelude::*;

    /// Few where Miri interprets them, which takes far longer.
    const CASES: u32 = if cfg!(miri) { 20 } else { 20_000 };

    proptest! {
        #![proptest_config(ProptestConfig { cases: CASES, failure_persistence: None, ..ProptestConfig::default() })]

        #[test]
        fn the_logarithm_has_the_error_that_it_says(exponent in -52..3_i32, m in 0.5_f64..1.0, distance in 1e-15_f64..1e-3) {
            // Close to 1 it keeps its digits.
            for x in [m * 2.0_f64.powi(exponent), 1.0 - distance, 1.0 + distance] {
                prop_assert!((ln(x) - x.ln()).abs() <= 2e-11 * x.ln().abs(), "ln {x}");
            }
        }

        #[test]
        fn sine_and_cosine_have_the_errors_that_they_say(quarters in -40..40_i32, rest in -0.125_f64..0.125) {
            // Below an eighth of a turn in size, where the library's functions take the angle as it is.
            let (turns, (s, c)) = (0.25 * f64::from(quarters) + rest, (TAU * rest).sin_cos());
            let expected = match quarters.rem_euclid(4) {
                0 => [s, c],
                1 => [c, -s],
                2 => [-s, -c],
                _ => [-c, s],
            };
            let rounding = 4e-16 + TAU * f64::EPSILON * turns.abs();
            let angle = ReducedAngle::of(turns);
            for (value, expected, error) in [
                (angle.sin(), expected[0], rounding),
                (angle.cos(), expected[1], rounding),
                (angle.short_sin(), expected[0], 2e-11),
                (angle.short_cos(), expected[1], 1e-12),
            ] {
                prop_assert!((value - expected).abs() <= error, "{turns} turns: {value} {expected}");
            }
            prop_assert_eq!(sin_cos(turns), [angle.sin(), angle.cos()]);
        }

        #[test]
        fn a_small_sine_keeps_its_digits(exponent in -300.0..-2.0_f64, half in -2..2_i32) {
            let x = exponent.exp2();
            let [sin, _] = sin_cos(x);
            prop_assert!((sin - (TAU * x).sin()).abs() <= 4.0 * f64::EPSILON * sin, "{x} turns");
            let angle = ReducedAngle::new(x, half.unsigned_abs().into());
            prop_assert_eq!(angle.sin().abs(), sin);
        }

        #[test]
        fn a_number_lies_in_its_binade(bits in any::<u64>(), exponent in -1000..1000_i32) {
            let start = 2.0_f64.powi(exponent);
            prop_assert!((start..2.0 * start).contains(&in_binade(start, bits)));
        }
    }

    #[test]
    fn ends_are_right() {
        for (turns, expected) in [(0.0, [0.0, 1.0]), (0.25, [1.0, 0.0]), (0.5, [0.0, -1.0]), (-0.25, [-1.0, 0.0])] {
            for turns in [turns, turns + 3000.0] {
                let values = sin_cos(turns);
                assert!(
                    values.iter().zip(expected).all(|(value, expected)| (value - expected).abs() < 2e-16),
                    "{turns}"
                );
            }
        }
        assert_eq!(sin_cos(1000.5), [0.0, -1.0]);
        assert_eq!(ln(1.0), 0.0);
        let last = [in_binade(1.0, 0), in_binade(1.0, u64::MAX)];
        assert_eq!(last, [1.0, 2.0 - f64::EPSILON]);
    }
}
