//! The phase of the excitation, and its noise (Section 5.2).

use super::course::hold_at;
use crate::error::ModelError;
use crate::noise;
use crate::parameters::{NoiseModel, Parameters};

/// Farthest start from t = 0, s: times have digits below a microsecond up to there.
const MAX_START: f64 = 1e9;

/// The phase noise: sample number and, read as a Wiener process, its value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Noise {
    pub(super) sample: u64,
    pub(super) walk: f64,
}

/// Number of the noise sample that holds at the start, s; a start before t = 0 gets sample 0.
pub(super) fn first_sample(parameters: &Parameters, start: f64) -> Result<u64, ModelError> {
    /// Beyond this the grid of sample times has no digits to tell neighbours apart.
    const MAX_SAMPLES: f64 = 4_503_599_627_370_496.0; // 2^52
    let noisy = parameters.phase_noise > 0.0;
    let max = if noisy { MAX_START.min(MAX_SAMPLES * parameters.noise_hold) } else { MAX_START };
    if !(start >= -MAX_START && start <= max) {
        return Err(ModelError::Bounds { name: "start time", value: start, unit: "s", min: -MAX_START, max });
    }
    Ok(if noisy { hold_at(parameters.noise_hold, start) } else { 0 })
}

/// Phase of the harmonic force under the present noise sample, rad.
pub(super) fn phase(parameters: &Parameters, noise: &Noise) -> f64 {
    if parameters.phase_noise == 0.0 {
        return parameters.phase;
    }
    parameters.phase + parameters.phase_noise * xi(parameters, noise)
}

/// The factor of the intensity of the phase noise.
pub(super) fn xi(parameters: &Parameters, noise: &Noise) -> f64 {
    match parameters.noise_model {
        NoiseModel::Held => noise::normal(parameters.seed, noise.sample),
        NoiseModel::Wiener => noise.walk,
    }
}
