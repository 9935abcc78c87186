//! The longest communication step: some ten seconds of work. A step of any length would have the importer wait without end for one that
//! it mistook. A fuzzer has less time.

use fmu_export::SlaveError;
use videg_model::{ContactLaw, Parameters};

use crate::harvester::Harvester;

/// In periods of the excitation.
const MAX_PERIODS: f64 = if cfg!(fuzzing) { 1e4 } else { 1e7 };

/// In hold intervals of the phase noise, or samples of a recording.
const MAX_HOLDS: f64 = if cfg!(fuzzing) { 1e5 } else { 1e8 };

/// The same under the compliant law, where a hold interval within a contact takes some 10 us.
const MAX_COMPLIANT_HOLDS: f64 = if cfg!(fuzzing) { 1e3 } else { 1e7 };

impl Harvester {
    /// Whether a step of `h`, s, is more work than anybody waits for.
    #[inline]
    pub(crate) fn is_too_long(&self, h: f64) -> bool {
        let Parameters { frequency, noise_hold, file_repeat, .. } = self.parameters;
        h * frequency > MAX_PERIODS
            || self.parameters.is_noisy() && h > self.most_holds() * noise_hold
            || file_repeat && self.spacing().is_some_and(|spacing| h > self.most_holds() * spacing)
    }

    /// Why a step of `h`, s, from `t`, s, is not taken.
    #[cold]
    pub(crate) fn too_long(&self, t: f64, h: f64) -> SlaveError {
        let Parameters { frequency, noise_hold, .. } = self.parameters;
        let holds = self.most_holds();
        let periods = (MAX_PERIODS / frequency, format!("{MAX_PERIODS} periods"));
        let noise = (holds * noise_hold, format!("{holds} times excitation.noiseHold"));
        let samples = (holds * self.spacing().unwrap_or(f64::INFINITY), format!("{holds} samples of the recording"));
        let (longest, bound) = if h > periods.0 {
            periods
        } else if self.parameters.is_noisy() && h > noise.0 {
            noise
        } else {
            samples
        };
        let message = format!("communicationStepSize = {h} s: it must be at most {longest} s, {bound}");
        SlaveError::discard(t, message)
    }

    /// Mean time from sample to sample, s, of a recording that goes on for ever.
    fn spacing(&self) -> Option<f64> {
        let recording = self.files.recorded.content().ok().flatten().filter(|_| self.parameters.file_repeat)?;
        let times = recording.times();
        Some((times.last()? - times.first()?) / (times.len() - 1) as f64)
    }

    /// Hold intervals or samples that a step may have.
    fn most_holds(&self) -> f64 {
        if self.parameters.contact_law == ContactLaw::Compliant { MAX_COMPLIANT_HOLDS } else { MAX_HOLDS }
    }
}
