//! Standard normal samples by counter: sample k of a seed is the same however a run is split, saved or sharded, and
//! whether it is made alone or with others.
#![allow(clippy::inline_always)] // only what is inlined becomes part of a loop over vectors

use core::f32::consts::{LN_2, SQRT_2};

const LOW: u64 = 0xFFFF_FFFF;

/// Philox4x32-10 (Salmon, Moraes, Dror, Shaw: Parallel random numbers: as easy as 1, 2, 3; SC 2011). A word stands in
/// the low half of a `u64`, where vector instructions can multiply it; the high half means nothing.
#[inline(always)]
fn philox4x32(mut counter: [u64; 4], mut key: [u32; 2]) -> [u32; 4] {
    const MULTIPLIER: [u64; 2] = [0xD251_1F53, 0xCD9E_8D57];
    const WEYL: [u32; 2] = [0x9E37_79B9, 0xBB67_AE85];
    for _ in 0..10 {
        let products = [MULTIPLIER[0] * (counter[0] & LOW), MULTIPLIER[1] * (counter[2] & LOW)];
        let keys = key.map(u64::from);
        counter = [
            products[1] >> 32 ^ counter[1] ^ keys[0],
            products[1],
            products[0] >> 32 ^ counter[3] ^ keys[1],
            products[0],
        ];
        key = [key[0].wrapping_add(WEYL[0]), key[1].wrapping_add(WEYL[1])];
    }
    #[allow(clippy::cast_possible_truncation)] // to the low half
    counter.map(|word| word as u32)
}

/// Samples that are made together, from [`QUARTER`] values of the counter.
pub const GROUP: usize = 512;

const QUARTER: usize = GROUP / 4;

/// A group stands in rows as wide as the widest vectors, and goes on down each column: sums over neighbours are then
/// sums of rows.
pub const COLUMNS: usize = 8;

/// Samples in a column.
pub const ROWS: usize = GROUP / COLUMNS;

/// Place in its group of the sample with this number there.
#[inline(always)]
pub const fn place(number: usize) -> usize {
    number % ROWS * COLUMNS + number / ROWS
}

/// The 128 random bits that belong to `seed` and `counter`.
#[inline(always)]
fn bits(seed: i32, counter: u64) -> [u32; 4] {
    philox4x32([counter & LOW, counter >> 32, 0, 0], [seed.cast_unsigned(), 0])
}

/// Two independent standard normal samples (Box-Muller) in single precision, which vectors hold twice as many of: of the
/// `bits`, the first 30 make a number from 0 to 1, in steps of 2^-24 close to 1, and that the radius, which reaches 6.6; the others make
/// the angle. The error is below 4e-7 of the radius.
#[inline(always)]
fn pair(bits: [u32; 2]) -> [f32; 2] {
    /// 2^-31, and a quarter of a turn in 2^31 parts.
    const UNIT: f32 = 1.0 / 2_147_483_648.0;
    const QUARTER_TURN: f32 = 0.25 * UNIT;
    // Odd numbers, so that the logarithm is finite and the mean right.
    let uniform = UNIT * (bits[0] >> 1 | 1).cast_signed() as f32;
    let radius = (-2.0 * ln(uniform)).sqrt();
    // The last bit of the first word is the half turn.
    let radius = f32::from_bits(radius.to_bits() | bits[0] << 31);
    let [sin, cos] = sin_cos(QUARTER_TURN * bits[1].cast_signed() as f32);
    [radius * cos, radius * sin]
}

/// Natural logarithm of a normal, positive `x`, with a relative error below 4e-7.
#[inline(always)]
fn ln(x: f32) -> f32 {
    const MANTISSA: u32 = (1 << 23) - 1;
    const ROOT_HALF: u32 = (0.5 * SQRT_2).to_bits();
    // x = 2^exponent m with m from sqrt(1/2) to sqrt(2).
    let shifted = x.to_bits() + (1.0_f32.to_bits() - ROOT_HALF);
    let exponent = ((shifted >> 23).cast_signed() - 127) as f32;
    let m = f32::from_bits((shifted & MANTISSA) + ROOT_HALF);
    // ln m = 2 artanh s; least squares of (artanh(s) / s - 1) / s^2 in powers of s^2, up to s = 0.1716.
    let s = (m - 1.0) / (m + 1.0);
    let q = s * s;
    exponent * LN_2 + (2.0 * s + 2.0 * s * (q * (0.333_277_26 + q * 0.206_043_02)))
}

/// Sine and cosine of -1/4 to 1/4 of a turn, with errors below 3e-7: least squares of sin(2 pi x) / x and of
/// (1 - cos(2 pi x)) / x^2 in powers of x^2, at Chebyshev points.
#[inline(always)]
fn sin_cos(x: f32) -> [f32; 2] {
    const SINE: [f32; 5] = [6.283_185_5, -41.341_682, 81.602_48, -76.581_28, 39.760_723];
    const COSINE: [f32; 4] = [19.739_182, -64.935_16, 85.252_36, -56.327_694];
    let q = x * x;
    let q2 = q * q;
    let sine = (SINE[0] + q * SINE[1]) + q2 * ((SINE[2] + q * SINE[3]) + q2 * SINE[4]);
    let cosine = (COSINE[0] + q * COSINE[1]) + q2 * (COSINE[2] + q * COSINE[3]);
    [x * sine, 1.0 - q * cosine]
}

/// Begins where a cache line does: no vector lies across two.
#[derive(Clone)]
#[repr(align(64))]
pub struct Aligned<T>(pub T);

/// Makes `samples` the bits of those from number [`GROUP`] `group` on of the standard normal sequence that belongs to
/// `seed`, each at its [`place`].
#[inline(always)]
pub fn normals(seed: i32, group: u64, samples: &mut [u32; GROUP]) {
    for k in 0..QUARTER {
        let [a, b, c, d] = bits(seed, group * QUARTER as u64 + k as u64);
        (samples[k], samples[k + 2 * QUARTER]) = (a, b);
        (samples[k + QUARTER], samples[k + 3 * QUARTER]) = (c, d);
    }
    for k in 0..2 * QUARTER {
        let pair = pair([samples[k], samples[k + 2 * QUARTER]]);
        [samples[k], samples[k + 2 * QUARTER]] = pair.map(f32::to_bits);
    }
}

/// Sample `index` of the standard normal sequence that belongs to `seed`, as [`normals`] makes it.
pub fn normal(seed: i32, index: u64) -> f64 {
    const N: u64 = QUARTER as u64;
    #[allow(clippy::cast_possible_truncation)] // less than GROUP
    let (group, place) = (index / GROUP as u64, place((index % GROUP as u64) as usize) as u64);
    let [a, b, c, d] = bits(seed, group * N + place % N);
    let [cos, sin] = pair(if (place / N).is_multiple_of(2) { [a, b] } else { [c, d] });
    f64::from(if place < 2 * N { cos } else { sin })
}

#[cfg(test)]
mod tests {
    use core::f64::consts::{PI, TAU};

    use proptest::prelude::*;

    use super::*;

    #[test]
    fn philox_gives_the_known_answers_of_its_authors() {
        // Random123, file kat_vectors, lines "philox4x32 10".
        let zero = [0x6627_e8d5, 0xe169_c58d, 0xbc57_ac4c, 0x9b00_dbd8];
        assert_eq!(philox4x32([0; 4], [0; 2]), zero);
        let ones = [0x408f_276d, 0x41c8_3b0e, 0xa20b_c7c6, 0x6d54_51fd];
        assert_eq!(philox4x32([LOW; 4], [u32::MAX; 2]), ones);
        let counter = [0x243f_6a88, 0x85a3_08d3, 0x1319_8a2e, 0x0370_7344];
        let pi = [0xd16c_fe09, 0x94fd_cceb, 0x5001_e420, 0x2412_6ea1];
        assert_eq!(philox4x32(counter, [0xa409_3822, 0x299f_31d0]), pi);
    }

    const CASES: u32 = if cfg!(miri) { 20 } else { 20_000 };

    proptest! {
        #![proptest_config(ProptestConfig { cases: CASES, failure_persistence: None, ..ProptestConfig::default() })]

        #[test]
        fn pairs_are_those_of_box_and_muller(bits: [u32; 2]) {
            // Single precision has steps near 1.
            let uniform = f64::from((bits[0] >> 1 | 1) as f32) / 2_f64.powi(31);
            let half_turn = PI * f64::from(bits[0] & 1);
            let angle = half_turn + TAU * f64::from(bits[1].cast_signed()) / 2_f64.powi(33);
            let radius = (-2.0 * uniform.ln()).sqrt();
            let [cos, sin] = pair(bits).map(f64::from);
            prop_assert!((cos - radius * angle.cos()).abs() <= 4e-7 * radius, "{cos}");
            prop_assert!((sin - radius * angle.sin()).abs() <= 4e-7 * radius, "{sin}");
        }

        #[test]
        fn the_logarithm_has_the_error_that_it_says(exponent in -31..1_i32, m in 0.5_f32..1.0, steps in 1..1000_u16) {
            // Close to 1 it keeps its digits.
            for x in [m * 2.0_f32.powi(exponent), 1.0 - f32::from(steps) / 16_777_216.0] {
                let expected = f64::from(x).ln();
                prop_assert!((f64::from(ln(x)) - expected).abs() <= 4e-7 * expected.abs(), "ln {x}");
            }
        }
    }

    /// Samples `from` to `to`, both multiples of [`GROUP`].
    fn samples(seed: i32, from: u64, to: u64) -> Vec<f64> {
        let n = GROUP as u64;
        let in_order = |group| {
            let mut samples = [0; GROUP];
            normals(seed, group, &mut samples);
            (0..GROUP).map(move |number| f64::from(f32::from_bits(samples[place(number)])))
        };
        (from / n..to / n).flat_map(in_order).collect()
    }

    fn mean(values: impl ExactSizeIterator<Item = f64>) -> f64 {
        let n = values.len() as f64;
        values.sum::<f64>() / n
    }

    const MANY: u64 = 1 << 21;

    /// Five standard errors of the mean of [`MANY`] values with this variance.
    fn five_errors(variance: f64) -> f64 {
        5.0 * (variance / MANY as f64).sqrt()
    }

    #[test]
    fn one_by_one_or_together_samples_have_the_same_bits() {
        for first in [0, GROUP as u64 * 777, 1 << 40] {
            let together = samples(-3, first, first + 2 * GROUP as u64);
            for (k, sample) in together.iter().enumerate() {
                assert_eq!(sample.to_bits(), normal(-3, first + k as u64).to_bits(), "{first} + {k}");
            }
        }
    }

    #[test]
    #[cfg_attr(miri, ignore = "two million samples of safe code")]
    fn samples_have_the_moments_of_a_standard_normal() {
        for seed in [7, -1] {
            let samples = samples(seed, 0, MANY);
            let moment = |p: i32| mean(samples.iter().map(|xi| xi.powi(p)));
            // E x^2p = (2 p - 1)!!: 1, 3, 15, 105, 945, 10395, 135135, ...
            let expected = [(1, 0.0, 1.0), (2, 1.0, 2.0), (3, 0.0, 15.0), (4, 3.0, 96.0), (6, 15.0, 10_395.0 - 225.0)];
            for (p, value, variance) in expected {
                assert!((moment(p) - value).abs() < five_errors(variance), "moment {p}: {}", moment(p));
            }
        }
    }

    #[test]
    #[cfg_attr(miri, ignore = "two million samples of safe code")]
    fn samples_fill_the_tails_as_a_standard_normal_does() {
        let samples = samples(11, 0, MANY);
        // erfc(z / sqrt 2): P(|xi| > z).
        for (z, p) in [(0.5, 0.617_075), (1.0, 0.317_311), (2.0, 0.045_500_3), (3.0, 2.699_80e-3), (4.0, 6.334_25e-5)] {
            for sign in [1.0, -1.0] {
                let beyond = mean(samples.iter().map(|xi| f64::from(u8::from(sign * xi > z))));
                assert!((beyond - 0.5 * p).abs() < five_errors(0.5 * p), "beyond {z}: {beyond}");
            }
        }
        let largest = samples.iter().fold(0.0_f64, |largest, xi| largest.max(xi.abs()));
        assert!((4.5..6.5).contains(&largest), "{largest}");
    }

    #[test]
    #[cfg_attr(miri, ignore = "two million samples of safe code")]
    fn samples_do_not_depend_on_each_other() {
        let samples = samples(5, 0, MANY + 1024);
        // Neighbours, those that come from the same counter or bits, those of other columns, and of the next group.
        for lag in [1, 2, 3, ROWS / 4, ROWS / 2, 3 * ROWS / 4, ROWS, 2 * ROWS, GROUP, 4 * GROUP] {
            let pairs = || samples[..samples.len() - 1024].iter().zip(&samples[lag..]);
            let product = mean(pairs().map(|(a, b)| a * b));
            assert!(product.abs() < five_errors(1.0), "lag {lag}: {product}");
            let squares = mean(pairs().map(|(a, b)| (a * a - 1.0) * (b * b - 1.0)));
            assert!(squares.abs() < five_errors(4.0), "squares, lag {lag}: {squares}");
        }
    }

    #[test]
    #[cfg_attr(miri, ignore = "two million samples of safe code")]
    fn samples_of_other_seeds_are_independent() {
        let [a, b, c] = [1, 2, -1].map(|seed| samples(seed, 0, MANY));
        for (a, b) in [(&a, &b), (&a, &c), (&b, &c)] {
            let product = mean(a.iter().zip(b).map(|(a, b)| a * b));
            assert!(product.abs() < five_errors(1.0), "{product}");
        }
    }
}
