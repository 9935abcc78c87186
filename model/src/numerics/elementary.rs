//! Sine and cosine from sums, products and bit patterns alone: a loop over an array of arguments becomes vector
//! instructions, and every machine, with whatever vectors and mathematical library, gives the same bits.
#![allow(clippy::inline_always)] // only what is inlined becomes part of a loop over vectors

use core::f64::consts::TAU;

/// Adding it to a double below 2^51 rounds that to the nearest integer, which then stands in the low bits of the sum.
const ROUNDER: f64 = 6_755_399_441_055_744.0; // 1.5 * 2^52

/// The same for the nearest multiple of 1/2.
const HALVES_ROUNDER: f64 = 0.5 * ROUNDER;

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

/// x, x^2 and x^4.
#[derive(Clone, Copy)]
struct Powers([f64; 3]);

impl Powers {
    #[inline(always)]
    fn of(x: f64) -> Self {
        Self([x, x * x, (x * x) * (x * x)])
    }
}

/// Polynomial of 5 or 8 `coefficients`, constant first, by Estrin's scheme: it waits less for its own results than
/// Horner's.
#[inline(always)]
fn sum<const N: usize>(coefficients: &[f64; N], Powers([x, x2, x4]): Powers) -> f64 {
    let two = |k: usize| coefficients[k] + x * coefficients[k + 1];
    let four = |k: usize| two(k) + x2 * two(k + 2);
    match N {
        5 => four(0) + x4 * coefficients[4],
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

    /// Sine, with an error below 6e-16.
    #[inline(always)]
    pub fn sin(self) -> f64 {
        self.signed(self.rest) * sum(&SINE, self.powers)
    }

    /// Cosine, with an error below 4e-16.
    #[inline(always)]
    pub fn cos(self) -> f64 {
        self.signed(1.0) - self.signed(self.powers.0[0]) * sum(&COSINE, self.powers)
    }
}

/// A series of some multiple of the sine.
#[derive(Clone, Copy, PartialEq)]
pub struct ShortSine {
    multiple: f64,
    /// Those of [`COSINE`], fewer of them, times the multiple.
    coefficients: [f64; 5],
}

impl ShortSine {
    /// So many times the sine, at least none, with an error below 3e-10 of its amplitude.
    pub fn times(multiple: f64) -> Self {
        let coefficients =
            [19.739_208_618_746, -64.939_352_863_491, 85.453_798_982_546_5, -60.147_644_934_349_1, 25.003_320_340_009];
        Self { multiple, coefficients: coefficients.map(|coefficient| multiple * coefficient) }
    }
}

/// Cosine of -1/2 to 1/2 turn, with an error below 6e-16, and a multiple of its sine. It has no half turns to tell apart and takes
/// fewer instructions than [`ReducedAngle`], but small sines do not keep their digits.
#[inline(always)]
pub fn cos_and_short_sin(turns: f64, sine: &ShortSine) -> [f64; 2] {
    let complement = 0.25 - turns.abs();
    let powers = Powers::of(complement * complement);
    let sine = sine.multiple - powers.0[0] * sum(&sine.coefficients, powers);
    [complement * sum(&SINE, powers), sine.copysign(turns)]
}

/// Sine and cosine of an angle of so many `turns`, below 2^50 of them, with errors below 6e-16.
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
        fn sine_and_cosine_have_the_errors_that_they_say(
            quarters in -40..40_i32, rest in -0.125_f64..0.125, multiple in 0.0_f64..3.0,
        ) {
            // Below an eighth of a turn in size, where the library's functions take the angle as it is.
            let (turns, (s, c)) = (0.25 * f64::from(quarters) + rest, (TAU * rest).sin_cos());
            let expected = match quarters.rem_euclid(4) {
                0 => [s, c],
                1 => [c, -s],
                2 => [-s, -c],
                _ => [-c, s],
            };
            let rounding = 6e-16 + TAU * f64::EPSILON * turns.abs();
            let angle = ReducedAngle::of(turns);
            for (value, expected, error) in [
                (angle.sin(), expected[0], rounding),
                (angle.cos(), expected[1], rounding),
            ] {
                prop_assert!((value - expected).abs() <= error, "{turns} turns: {value} {expected}");
            }
            prop_assert_eq!(sin_cos(turns), [angle.sin(), angle.cos()]);
            let [cos, sin] = cos_and_short_sin(turns - round(turns), &ShortSine::times(multiple));
            prop_assert!((cos - expected[1]).abs() <= rounding, "{turns} turns: {cos}");
            prop_assert!((sin - multiple * expected[0]).abs() <= 3e-10 * multiple, "{turns} turns: {sin}");
        }

        #[test]
        fn a_small_sine_keeps_its_digits(exponent in -300.0..-2.0_f64, half in -2..2_i32) {
            let x = exponent.exp2();
            let [sin, _] = sin_cos(x);
            prop_assert!((sin - (TAU * x).sin()).abs() <= 4.0 * f64::EPSILON * sin, "{x} turns");
            let angle = ReducedAngle::new(x, half.unsigned_abs().into());
            prop_assert_eq!(angle.sin().abs(), sin);
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
    }
}
