//! What the harmonic force does in the hold intervals of the phase noise, many of them at once.
//!
//! In one hold interval of length h, whose middle the force passes at the angle a, Eq. (7) changes the velocity by (A /
//! M) h (sin x / x) cos a, where x = pi `f_0` h, and takes the cylinder farther than it would get without a force by
//! constant multiples of cos a and sin a. Both follow from the number of the interval alone. They are worked out and
//! summed for a block at a time, on a grid of numbers that no step of a caller moves, in loops that become vector
//! instructions: the state at the begin of any interval of the block is then a closed form in the state at that of
//! another.
#![allow(clippy::inline_always)] // only what is inlined becomes part of a loop over vectors

use core::f64::consts::{PI, TAU};

use super::block::{BLOCK, Block};
use super::normal::{self, Aligned};
use crate::numerics::elementary::{ShortSine, cos_and_short_sin, round};
use crate::numerics::product::{cycle_fraction, product_error};
use crate::paper::excitation::noisy_phase;
use crate::parameters::Parameters;

/// Number, in its block, of the hold interval at each place.
static NUMBERS: Aligned<[f64; BLOCK]> = {
    let (mut numbers, mut k) = ([0.0; BLOCK], 0);
    while k < BLOCK {
        numbers[normal::place(k)] = k as f64;
        k += 1;
    }
    Aligned(numbers)
};

/// The longest hold intervals that are passed in blocks, in periods of the force: the short series of the sine adds less than
/// the rounding of the closed forms to the position then.
pub const LONGEST: f64 = 0.02;

/// The harmonic force with held phase noise.
#[derive(Clone, Copy, PartialEq)]
struct Force {
    seed: i32,
    /// Of the noise, and the phase, in turns.
    intensity: f64,
    phase: f64,
    frequency: f64,
    hold: f64,
    /// Turns of the force in one hold interval, without whole ones.
    turns: f64,
    /// Change of velocity, m/s, at cos a = 1.
    push: f64,
    /// Twice the part of the position at sin a = 1 in that at cos a = 1, which is the mean of the velocities.
    lag: ShortSine,
}

impl Force {
    fn new(p: &Parameters) -> Self {
        let (hold, x) = (p.noise_hold, PI * p.frequency * p.noise_hold);
        let push = p.harmonic_acceleration() * hold;
        Self {
            seed: p.seed,
            intensity: p.phase_noise / TAU,
            phase: p.phase / TAU,
            frequency: p.frequency,
            hold,
            turns: cycle_fraction(p.frequency, hold),
            push: push * x.sin() / x,
            lag: ShortSine::times(lag(x)),
        }
    }

    /// Angle in the middle of hold interval `sample`, in turns, without phase and noise.
    fn carrier(&self, sample: u64) -> f64 {
        let middle = sample as f64 + 0.5;
        let time = middle * self.hold;
        cycle_fraction(self.frequency, time) + self.frequency * product_error(middle, self.hold, time)
    }

    /// Works out block `number`, with the widest vectors that this machine has.
    fn fill(&self, block: &mut Block, number: u64) {
        #[cfg(target_arch = "x86_64")]
        #[allow(unsafe_code)] // the only way to call a function that needs more than the oldest machine has
        {
            if is_x86_feature_detected!("avx512f") && is_x86_feature_detected!("avx512dq") {
                // SAFETY: the machine has just said that it has these instructions.
                return unsafe { self.fill_by_eight(block, number) };
            }
            if is_x86_feature_detected!("avx2") {
                // SAFETY: as above.
                return unsafe { self.fill_by_four(block, number) };
            }
        }
        self.fill_plainly(block, number);
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx512f,avx512dq")]
    fn fill_by_eight(&self, block: &mut Block, number: u64) {
        self.fill_plainly(block, number);
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2")]
    fn fill_by_four(&self, block: &mut Block, number: u64) {
        self.fill_plainly(block, number);
    }

    #[inline(always)]
    fn fill_plainly(&self, block: &mut Block, number: u64) {
        block.number = number;
        let carrier = self.phase + self.carrier(number * BLOCK as u64);
        normal::normals(self.seed, number, &mut block.samples.0);
        // Processors look ahead over two short chains of results better than over a long one.
        for k in 0..BLOCK {
            let xi = f64::from(f32::from_bits(block.samples.0[k]));
            let turns = noisy_phase(carrier + NUMBERS.0[k] * self.turns, self.intensity, xi);
            block.position.0[k] = turns - round(turns);
        }
        block.units = [self.push, 0.5 * self.push * self.hold];
        block.sum(self.hold, |turns| cos_and_short_sin(turns, &self.lag));
    }
}

/// 1 / x - cot x, of the hold intervals that blocks consist of.
fn lag(x: f64) -> f64 {
    let q = x * x;
    x / 3.0 * (1.0 + q / 15.0 * (1.0 + q * (2.0 / 21.0) * (1.0 + q / 10.0)))
}

/// The block in which a harvester is and the next one. They follow from its parameters, so that all are equal, and a
/// copy works them out again.
pub struct Blocks {
    force: Force,
    blocks: Vec<Block>,
}

impl Blocks {
    /// Hold intervals of a harvester with these parameters; they must not be longer than [`LONGEST`].
    pub fn new(parameters: &Parameters) -> Self {
        Self { force: Force::new(parameters), blocks: Vec::new() }
    }

    /// The block with hold interval number `sample`.
    pub fn block(&mut self, sample: u64) -> &Block {
        let number = sample / BLOCK as u64;
        if self.blocks.is_empty() {
            self.blocks = vec![Block::EMPTY; 2];
        }
        let block = &mut self.blocks[usize::from(number % 2 == 1)];
        if block.number != number {
            self.force.fill(block, number);
        }
        block
    }
}

impl Clone for Blocks {
    fn clone(&self) -> Self {
        Self { force: self.force, blocks: Vec::new() }
    }

    /// Keeps its own blocks if they are those of the same force, so that a run that is taken back over and over works
    /// them out and takes memory for them once. The price: each saved state that was once run from holds two blocks of 10 KiB as
    /// long as it is held.
    fn clone_from(&mut self, source: &Self) {
        if self.force != source.force {
            self.blocks = Vec::new();
        }
        self.force = source.force;
    }
}

impl core::fmt::Debug for Blocks {
    fn fmt(&self, formatter: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        formatter.debug_struct("Blocks").finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::cylinder::{CylinderMotion, Drive};
    use crate::motion::mount::Load;
    use crate::recording::Segment;
    use core::f64::consts::TAU;
    use proptest::prelude::*;

    /// Few where Miri interprets them, which takes far longer.
    const CASES: u32 = if cfg!(miri) { 2 } else { 256 };

    proptest! {
        #![proptest_config(ProptestConfig { cases: CASES, failure_persistence: None, ..ProptestConfig::default() })]

        #[test]
        fn a_block_adds_up_the_closed_forms_of_its_hold_intervals(
            intensity in 0.0_f64..20.0, frequency in 0.5_f64..50.0, part in prop_oneof![1e-6_f64..1e-4, 1e-4..LONGEST],
            number in prop_oneof![0..4_u64, 1_000_000..1_000_010_u64], seed in any::<i32>(), phase in -7.0_f64..7.0,
        ) {
            let hold = part / frequency;
            let p = Parameters { phase_noise: intensity, frequency, noise_hold: hold, ..Parameters::default() };
            let p = Parameters { phase, seed, ..p };
            let mut block = Block::EMPTY;
            Force::new(&p).fill(&mut block, number);
            let amplitude = p.amplitude / p.cylinder_mass;
            for k in 0..BLOCK {
                let sample = number * BLOCK as u64 + k as u64;
                let phase = phase + intensity * normal::normal(seed, sample);
                let drive = Drive { amplitude, frequency, phase, external: 0.0, external_rate: 0.0, recorded: Segment::NONE };
                let [start, end] = [sample, sample + 1].map(|sample| sample as f64 * hold);
                let motion = CylinderMotion::new(start, 0.0, 0.0, drive, Load::NONE);
                // Rounding of the times, of the angles and of the differences that the closed form consists of.
                let angle = 16.0 * f64::EPSILON * (phase.abs() + TAU) + TAU * frequency * 4.0 * f64::EPSILON * end;
                let (time, swing) = (4.0 * f64::EPSILON * end, amplitude / (TAU * frequency).powi(2));
                let velocity = amplitude * (time + angle / (TAU * frequency));
                let position = amplitude * hold * time + swing * (1.0 + TAU * frequency * hold) * angle;
                // Rounding of the sums.
                let length = BLOCK as f64 * hold;
                let [velocity, position] =
                    [velocity + 2e-15 * amplitude * length, position + 2e-15 * amplitude * length * length];
                let ([v, z], [next_v, next_z]) = (block.at(k, hold), block.at(k + 1, hold));
                prop_assert!((next_v - v - motion.at(end).velocity).abs() <= velocity, "velocity, {k}");
                prop_assert!((next_z - z - hold * v - motion.at(end).position).abs() <= position, "position, {k}");
            }
            prop_assert_eq!(block.at(0, hold), [0.0, 0.0]);
            prop_assert!((0..BLOCK).all(|k| block.sample(k) == normal::normal(seed, number * BLOCK as u64 + k as u64)));
        }

        #[test]
        fn vectors_of_any_width_give_the_same_bits(
            seed in any::<i32>(), number in 0..1_000_000_u64, intensity in 0.0..10.0,
        ) {
            let force = Force::new(&Parameters { phase_noise: intensity, seed, ..Parameters::default() });
            let mut blocks = [(); 3].map(|()| Box::new(Block::EMPTY));
            force.fill_plainly(&mut blocks[0], number);
            force.fill(&mut blocks[1], number);
            fill_by_four_if_possible(&force, &mut blocks[2], number);
            let bits_at = |block: &Block, k| block.at(k, force.hold).map(f64::to_bits);
            let bits = blocks.map(|block| (0..=BLOCK).map(|k| bits_at(&block, k)).collect::<Vec<_>>());
            prop_assert_eq!(&bits[0], &bits[1]);
            prop_assert_eq!(&bits[0], &bits[2]);
        }
    }

    #[test]
    fn a_copy_of_other_blocks_works_out_its_own() {
        let new = |seed| Blocks::new(&Parameters { phase_noise: 1.0, seed, ..Parameters::default() });
        let [mut blocks, other, mut fresh] = [new(1), new(2), new(2)];
        let bits = |block: &Block| (0..=BLOCK).map(|k| block.at(k, 1e-5).map(f64::to_bits)).collect::<Vec<_>>();
        let first = bits(blocks.block(0));
        blocks.clone_from(&other);
        assert_eq!(bits(blocks.block(0)), bits(fresh.block(0)));
        assert_ne!(bits(blocks.block(0)), first);
        assert_eq!(format!("{blocks:?}"), "Blocks { .. }");
    }

    fn fill_by_four_if_possible(force: &Force, block: &mut Block, number: u64) {
        #[cfg(target_arch = "x86_64")]
        #[allow(unsafe_code)] // as in Force::fill
        if is_x86_feature_detected!("avx2") {
            // SAFETY: the machine has just said that it has these instructions.
            return unsafe { force.fill_by_four(block, number) };
        }
        force.fill_plainly(block, number);
    }

    #[test]
    fn the_lag_is_that_of_the_longest_hold_intervals_and_has_the_limit_of_short_ones() {
        for x in [0.01_f64, 0.03, PI * LONGEST] {
            // The difference loses digits.
            let exact = 1.0 / x - 1.0 / x.tan();
            assert!((lag(x) - exact).abs() < (4.0 * f64::EPSILON / (x * x) + 1e-13) * exact, "{x}");
        }
        assert!((lag(1e-5) - 1e-5 / 3.0 * (1.0 + 1e-10 / 15.0)).abs() < 1e-21);
        assert!(lag(1e9).is_finite());
    }
}
