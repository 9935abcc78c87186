//! Standard normal samples by counter: sample k of a seed is the same however a run is split, saved or sharded.

use core::f64::consts::TAU;

/// Philox4x32-10 (Salmon, Moraes, Dror, Shaw: Parallel random numbers: as easy as 1, 2, 3; SC 2011).
fn philox4x32(mut counter: [u32; 4], mut key: [u32; 2]) -> [u32; 4] {
    const MULTIPLIER: [u64; 2] = [0xD251_1F53, 0xCD9E_8D57];
    const WEYL: [u32; 2] = [0x9E37_79B9, 0xBB67_AE85];
    for _ in 0..10 {
        let [low0, high0] = halves(MULTIPLIER[0] * u64::from(counter[0]));
        let [low1, high1] = halves(MULTIPLIER[1] * u64::from(counter[2]));
        counter = [high1 ^ counter[1] ^ key[0], low1, high0 ^ counter[3] ^ key[1], low0];
        key = [key[0].wrapping_add(WEYL[0]), key[1].wrapping_add(WEYL[1])];
    }
    counter
}

/// Low and high 32 bits of `x`.
fn halves(x: u64) -> [u32; 2] {
    #[allow(clippy::cast_possible_truncation)] // taking the low half is the point
    [x as u32, (x >> 32) as u32]
}

/// Samples 2 `pair` and 2 `pair` + 1 of the standard normal sequence that belongs to `seed` (Box-Muller).
pub fn normal_pair(seed: i32, pair: u64) -> [f64; 2] {
    let [low, high] = halves(pair);
    let [a, b, c, d] = philox4x32([low, high, 0, 0], [seed.cast_unsigned(), 0]);
    let unit = |x: u32, y: u32| ((u64::from(x) << 32 | u64::from(y)) >> 11) as f64 * (0.5_f64).powi(53);
    // 1 - u lies in (0, 1]: its logarithm is finite.
    let radius = (-2.0 * (1.0 - unit(a, b)).ln()).sqrt();
    let (sin, cos) = (TAU * unit(c, d)).sin_cos();
    [radius * cos, radius * sin]
}

/// Sample `index` of the standard normal sequence that belongs to `seed`.
pub fn normal(seed: i32, index: u64) -> f64 {
    let pair = normal_pair(seed, index / 2);
    pair[usize::from(index % 2 == 1)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn philox_gives_the_known_answers_of_its_authors() {
        // Random123, file kat_vectors, lines "philox4x32 10".
        let zero = [0x6627_e8d5, 0xe169_c58d, 0xbc57_ac4c, 0x9b00_dbd8];
        assert_eq!(philox4x32([0; 4], [0; 2]), zero);
        let ones = [0x408f_276d, 0x41c8_3b0e, 0xa20b_c7c6, 0x6d54_51fd];
        assert_eq!(philox4x32([u32::MAX; 4], [u32::MAX; 2]), ones);
        let counter = [0x243f_6a88, 0x85a3_08d3, 0x1319_8a2e, 0x0370_7344];
        let pi = [0xd16c_fe09, 0x94fd_cceb, 0x5001_e420, 0x2412_6ea1];
        assert_eq!(philox4x32(counter, [0xa409_3822, 0x299f_31d0]), pi);
    }

    #[test]
    fn samples_have_the_moments_of_a_standard_normal() {
        let n = 200_000_u64;
        let moment = |p: i32| (0..n).map(|k| normal(7, k).powi(p)).sum::<f64>() / n as f64;
        // Standard errors: 1/sqrt(n), sqrt(2/n), sqrt(96/n); five of them allowed.
        assert!(moment(1).abs() < 0.012, "mean {}", moment(1));
        assert!((moment(2) - 1.0).abs() < 0.016, "variance {}", moment(2));
        assert!((moment(4) - 3.0).abs() < 0.11, "fourth moment {}", moment(4));
        let lag = (1..n).map(|k| normal(7, k) * normal(7, k - 1)).sum::<f64>() / n as f64;
        assert!(lag.abs() < 0.012, "correlation of neighbours {lag}");
    }

    #[test]
    fn another_seed_gives_other_samples() {
        assert_ne!(normal(1, 0), normal(2, 0));
        assert_ne!(normal(1, 0), normal(-1, 0));
    }
}
