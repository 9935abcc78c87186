//! Random numbers by counter: the number of a point is the same on any core, shard or machine, and costs no state.
//!
//! The words are those of SHA-256 of seed, purpose and counter, so that a design can be made again in any language.

use sha2::{Digest as _, Sha256};

/// A stream of independent random words; each has a number.
#[derive(Clone)]
pub struct Stream {
    prefix: Sha256,
}

impl Stream {
    /// The stream that belongs to `seed` and `purpose`, a variable's name.
    pub fn new(seed: u64, purpose: &str) -> Self {
        let mut prefix = Sha256::new();
        prefix.update(seed.to_le_bytes());
        prefix.update((purpose.len() as u64).to_le_bytes());
        prefix.update(purpose);
        Self { prefix }
    }

    /// Word number `counter` of kind `kind`: the first eight bytes of SHA-256 of seed, length of the purpose, purpose,
    /// kind and counter, numbers being 64-bit little-endian.
    pub fn word(&self, kind: u64, counter: u64) -> u64 {
        let mut hash = self.prefix.clone();
        hash.update(kind.to_le_bytes());
        hash.update(counter.to_le_bytes());
        let digest = hash.finalize();
        digest.iter().take(8).rev().fold(0, |word, &byte| word << 8 | u64::from(byte))
    }

    /// Number `counter`, uniform from 0 to below 1.
    pub fn unit(&self, counter: u64) -> f64 {
        const JITTER: u64 = 0;
        (self.word(JITTER, counter) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Where `index` of 0 to below `count` goes in a permutation of those, computed alone.
    ///
    /// A Feistel network permutes the smallest square power of two that holds them; what falls outside goes through it
    /// again, which ends since the network is a permutation (cycle walking: Black and Rogaway 2002).
    pub fn permuted(&self, index: u64, count: u64) -> u64 {
        let bits = count.next_power_of_two().trailing_zeros().div_ceil(2).max(1);
        let mut place = index;
        loop {
            place = self.feistel(place, bits);
            if place < count {
                return place;
            }
        }
    }

    /// Permutes the numbers of 2 `bits` bits.
    fn feistel(&self, number: u64, bits: u32) -> u64 {
        const ROUNDS: u64 = 6;
        let mask = (1 << bits) - 1;
        let halves = (number >> bits, number & mask);
        let (left, right) =
            (1..=ROUNDS).fold(halves, |(left, right), round| (right, left ^ self.word(round, right) & mask));
        left << bits | right
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_those_of_the_hash_that_the_documentation_names() {
        // python3 -c 'import hashlib; p = lambda n: n.to_bytes(8, "little"); print(int.from_bytes(hashlib.sha256(
        //   p(7) + p(1) + b"x" + p(3) + p(5)).digest()[:8], "little"))'
        assert_eq!(Stream::new(7, "x").word(3, 5), 13_767_164_298_411_185_178);
    }

    #[test]
    fn permutations_of_other_seeds_and_names_are_others_and_far_from_order() {
        let permutation = |seed, name| (0..100).map(|k| Stream::new(seed, name).permuted(k, 100)).collect::<Vec<_>>();
        let one = permutation(1, "a");
        assert!(one != permutation(2, "a") && one != permutation(1, "b"));
        // Rank correlation with the identity: its standard deviation is 0.1 for 100 numbers.
        let product: f64 = one.iter().zip(0..).map(|(&p, k)| (p as f64 - 49.5) * (f64::from(k) - 49.5)).sum();
        assert!((product / (100.0 * 9999.0 / 12.0)).abs() < 0.4);
    }

    #[test]
    fn units_are_uniform_and_independent_of_their_neighbours() {
        let stream = Stream::new(3, "a");
        let units: Vec<f64> = (0..100_000).map(|k| stream.unit(k)).collect();
        let n = units.len() as f64;
        let mean = units.iter().sum::<f64>() / n;
        assert!((mean - 0.5).abs() < 5.0 * (1.0 / 12.0 / n).sqrt(), "{mean}");
        let product = units.windows(2).map(|pair| (pair[0] - 0.5) * (pair[1] - 0.5)).sum::<f64>() / n;
        assert!(product.abs() < 5.0 / 12.0 / n.sqrt(), "{product}");
        assert!(units.iter().all(|unit| (0.0..1.0).contains(unit)));
        for part in 0..10 {
            let within = units.iter().filter(|unit| (**unit * 10.0).floor() == f64::from(part)).count() as f64;
            assert!((within - n / 10.0).abs() < 5.0 * (n * 0.09).sqrt(), "part {part}: {within}");
        }
    }
}
