//! The phase noise of Section 5.2: one sample xi holds for an interval, whose begins are multiples of the hold time.

pub mod block;
pub mod blocks;
pub mod intervals;
pub mod normal;

use self::block::{BLOCK, Block, place_in_block};
use self::blocks::{Blocks, LONGEST};
use crate::error::ModelError;
use crate::paper::excitation::noisy_phase;
use crate::parameters::{ContactLaw, ExcitationKind, NoiseModel, Parameters};

/// Farthest start from t = 0, s: times have digits below a microsecond up to there.
const MAX_START: f64 = 1e9;

/// How the hold intervals are passed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Passing {
    /// There is no noise.
    Never,
    /// One by one: in a contact that lasts, with friction, reaction, suspension or a prescribed motion, with a Wiener process, under an integrator; and where they are longer than
    /// a fiftieth of a period of the force, so that this costs nothing.
    Single,
    /// Many in one go.
    Blocks,
}

/// What never changes.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Settings {
    passing: Passing,
    model: NoiseModel,
    seed: i32,
    /// rad.
    phase: f64,
    /// sigma.
    intensity: f64,
    /// Length of a hold interval, s.
    hold: f64,
}

/// The phase of the excitation, and its noise.
#[derive(Debug)]
pub struct Noise {
    settings: Settings,
    /// Number of the sample in force.
    pub sample: u64,
    /// Value of the Wiener process, sqrt(s).
    pub walk: f64,
    blocks: Blocks,
}

/// Blocks follow from the rest.
impl PartialEq for Noise {
    fn eq(&self, other: &Self) -> bool {
        let state = |noise: &Self| (noise.settings, noise.sample, noise.walk);
        state(self) == state(other)
    }
}

impl Clone for Noise {
    fn clone(&self) -> Self {
        Self { blocks: self.blocks.clone(), ..*self }
    }

    /// Keeps the blocks, if they are those of the same force.
    fn clone_from(&mut self, source: &Self) {
        self.blocks.clone_from(&source.blocks);
        (self.settings, self.sample, self.walk) = (source.settings, source.sample, source.walk);
    }
}

impl Noise {
    /// The noise at sample number `sample`, where a Wiener process is at `walk`.
    pub fn new(p: &Parameters, sample: u64, walk: f64) -> Self {
        let is_fast = p.noise_model == NoiseModel::Held
            && p.contact_law == ContactLaw::Impulsive
            && !p.reaction
            && p.excitation_kind == ExcitationKind::Force
            && p.friction == 0.0
            && !p.is_suspended()
            && p.noise_hold <= LONGEST / p.frequency;
        let passing = match (p.is_noisy(), is_fast) {
            (false, _) => Passing::Never,
            (true, false) => Passing::Single,
            (true, true) => Passing::Blocks,
        };
        let (model, seed, phase) = (p.noise_model, p.seed, p.phase);
        let settings = Settings { passing, model, seed, phase, intensity: p.phase_noise, hold: p.noise_hold };
        Self { settings, sample, walk, blocks: Blocks::new(p) }
    }

    /// The noise at `start`, s; a start before t = 0 has sample 0.
    pub fn at_start(p: &Parameters, start: f64) -> Result<Self, ModelError> {
        /// Beyond this the grid of sample times has no digits to tell neighbours apart.
        const MAX_SAMPLES: f64 = 4_503_599_627_370_496.0; // 2^52
        let max = if p.is_noisy() { MAX_START.min(MAX_SAMPLES * p.noise_hold) } else { MAX_START };
        if !(start >= -MAX_START && start <= max) {
            return Err(ModelError::Bounds { name: "start time", value: start, unit: "s", min: -MAX_START, max });
        }
        let mut noise = Self::new(p, 0, 0.0);
        noise.sample = if p.is_noisy() { noise.sample_at(start) } else { 0 };
        Ok(noise)
    }

    /// From now on an integrator passes the intervals.
    pub fn pass_singly(&mut self) {
        if self.in_blocks() {
            self.settings.passing = Passing::Single;
        }
    }

    /// Whether hold intervals are passed many in one go.
    pub fn in_blocks(&self) -> bool {
        self.settings.passing == Passing::Blocks
    }

    /// Number of the hold interval that `time`, s, is in; 0 before t = 0.
    pub fn sample_at(&self, time: f64) -> u64 {
        let hold = self.settings.hold;
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // saturates
        let mut sample = (time / hold) as u64;
        // The quotient is rounded, the grid is the product.
        while (sample + 1) as f64 * hold <= time {
            sample += 1;
        }
        while sample > 0 && sample as f64 * hold > time {
            sample -= 1;
        }
        sample
    }

    /// Length of a hold interval, s.
    pub fn hold(&self) -> f64 {
        self.settings.hold
    }

    /// Begin of hold interval `sample`, s.
    pub fn begin_of(&self, sample: u64) -> f64 {
        sample as f64 * self.settings.hold
    }

    /// What remains of the present hold interval after `time`, s.
    pub fn rest_after(&self, time: f64) -> f64 {
        self.settings.hold - (time - self.begin_of(self.sample))
    }

    /// End of the present hold interval, s; none without noise.
    pub fn limit(&self) -> Option<f64> {
        (self.settings.passing != Passing::Never).then(|| self.begin_of(self.sample + 1))
    }

    /// How far ahead events are predicted, s, with this `period` of the excitation.
    pub fn horizon(&self, period: f64) -> f64 {
        if self.in_blocks() { period.min(BLOCK as f64 * self.settings.hold) } else { period }
    }

    /// xi in hold interval `sample`; a Wiener process is known at present only.
    pub fn xi(&self, sample: u64) -> f64 {
        match self.settings.model {
            NoiseModel::Held => normal::normal(self.settings.seed, sample),
            NoiseModel::Wiener => self.walk,
        }
    }

    /// Phase of the harmonic force in hold interval `sample`, rad.
    pub fn phase(&self, sample: u64) -> f64 {
        if self.settings.passing == Passing::Never { self.settings.phase } else { self.phase_with(self.xi(sample)) }
    }

    fn phase_with(&self, xi: f64) -> f64 {
        noisy_phase(self.settings.phase, self.settings.intensity, xi)
    }

    /// The same from the block of this interval, which has xi at hand.
    pub fn phase_in_block(&mut self, sample: u64) -> f64 {
        let xi = self.block(sample).sample(place_in_block(sample));
        self.phase_with(xi)
    }

    /// The block with hold interval `sample`.
    pub fn block(&mut self, sample: u64) -> &Block {
        self.blocks.block(sample)
    }

    /// The next sample comes into force.
    pub fn take_next(&mut self) {
        if self.settings.model == NoiseModel::Wiener {
            self.walk += self.settings.hold.sqrt() * normal::normal(self.settings.seed, self.sample);
        }
        self.sample += 1;
    }
}
