//! Random arguments, the same on every platform.

/// Where choices come from.
enum Source {
    /// `SplitMix64` (Steele, Lea, Flood 2014).
    Generator(u64),
    /// Bytes that somebody else chose, such as a fuzzer; zeros once they are used up.
    Tape(std::vec::IntoIter<u8>),
}

/// Choices, one after the other.
pub struct Random(Source);

impl Random {
    /// Choices that follow from a number.
    pub fn seeded(seed: u64) -> Self {
        Self(Source::Generator(seed))
    }

    /// Choices that are read from bytes, two each.
    pub fn from_tape(bytes: &[u8]) -> Self {
        Self(Source::Tape(Vec::from(bytes).into_iter()))
    }

    /// False once a tape has been read to its end.
    pub fn goes_on(&self) -> bool {
        !matches!(&self.0, Source::Tape(bytes) if bytes.len() == 0)
    }

    /// The next choice: 64 bits of the generator, 16 of a tape.
    pub fn bits(&mut self) -> u64 {
        match &mut self.0 {
            Source::Generator(state) => {
                *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
                let z = (*state ^ (*state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
                let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
                z ^ (z >> 31)
            }
            Source::Tape(bytes) => {
                let mut byte = || u64::from(bytes.next().unwrap_or_default());
                byte() | byte() << 8
            }
        }
    }

    /// A number below `bound`.
    #[allow(clippy::cast_possible_truncation)] // it is below a usize
    pub fn below(&mut self, bound: usize) -> usize {
        (self.bits() % bound.max(1) as u64) as usize
    }

    /// True once in `times`.
    pub fn once_in(&mut self, times: usize) -> bool {
        self.below(times) == 0
    }

    /// A Real between `low` and `high`.
    #[allow(clippy::cast_precision_loss)] // 53 bits
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * ((self.bits() >> 11) as f64 * 0.5_f64.powi(53))
    }

    /// One of these.
    pub fn pick<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[self.below(choices.len())]
    }

    /// A Real as parameters, inputs and states take it, or one that is none of them.
    pub fn real(&mut self) -> f64 {
        const ODD: [f64; 9] = [-0.0, -1.0, 1e300, -1e300, 1e-300, 5e-324, f64::NAN, f64::INFINITY, f64::NEG_INFINITY];
        const USUAL: [f64; 12] = [0.0, 1e-11, 1e-6, 1e-3, 0.02, 0.1, 0.3, 0.5, 1.0, 2.0, 5.0, 2000.0];
        if self.once_in(6) { self.pick(&ODD) } else { self.pick(&USUAL) }
    }

    /// An Integer, seldom a large one.
    pub fn integer(&mut self) -> i32 {
        self.pick(&[0, 1, 1, 1, 2, 3, -1, i32::MIN, i32::MAX])
    }

    /// Size of an array: none, one or many.
    pub fn size(&mut self) -> usize {
        self.pick(&[0, 1, 1, 1, 1, 2, 40])
    }
}
