//! A recorded excitation: samples of a force or an acceleration over time, and straight lines between them.
//!
//! What a harvester does with it depends on `excitation.fileScale`, `excitation.fileOffset` and `excitation.fileRepeat`: the
//! samples are multiplied by the first and come later by the second. Before the first sample there is nothing. After the last
//! one there is nothing either, or the recording begins again.

use core::fmt;
use std::sync::Arc;

use crate::error::ModelError;
use crate::fingerprint::fingerprint;
use crate::parameters::{ExcitationKind, Parameters};
use crate::points::PointQuantity;

/// Largest size of a sample, N or m/s^2: times the largest scale it is as large as the largest external force.
const MAX_VALUE: f64 = 1e12;

/// Largest size of a time, s: up to here times have digits below a microsecond.
const MAX_TIME: f64 = 1e9;

/// Least time between two samples, s.
const MIN_SPACING: f64 = 1e-12;

/// Least mean time between two samples of a recording that is repeated, s: without end, more samples than that would take for
/// ever.
const MIN_REPEATED_SPACING: f64 = 1e-6;

/// A recorded force or acceleration. Copies share the samples.
#[derive(Clone)]
pub struct Recording(Arc<Samples>);

#[derive(PartialEq)]
struct Samples {
    kind: ExcitationKind,
    times: Vec<f64>,
    values: Vec<f64>,
    fingerprint: u64,
}

impl Recording {
    /// Least and most samples of a recording.
    pub const SAMPLES: [usize; 2] = [2, 1_000_000];

    /// The recording of a force, N, or of the acceleration of the cylinder, m/s^2, with these `values` at these `times`, s.
    ///
    /// # Errors
    /// Lists of different lengths, of less than 2 or more than 1e6 samples; a time beyond 1e9 s before or after zero, or less
    /// than 1e-12 s after the one before; a value beyond 1e12; NaN. Samples are counted from 0.
    pub fn new(kind: ExcitationKind, times: Vec<f64>, values: Vec<f64>) -> Result<Self, ModelError> {
        if times.len() != values.len() {
            return Err(ModelError::SamplePairs { times: times.len(), values: values.len() });
        }
        let [min, max] = Self::SAMPLES;
        if !(min..=max).contains(&times.len()) {
            return Err(ModelError::SampleCount { count: times.len(), min, max });
        }
        let (name, unit) = if kind == ExcitationKind::Force { ("force", "N") } else { ("acceleration", "m/s2") };
        let point = |(index, fault)| ModelError::Point { index, what: "recording", fault };
        let time = PointQuantity { name: "time", unit: "s", min: -MAX_TIME, max: MAX_TIME, rise: MIN_SPACING };
        time.check(&times).map_err(point)?;
        let value = PointQuantity { name, unit, min: -MAX_VALUE, max: MAX_VALUE, rise: f64::NEG_INFINITY };
        value.check(&values).map_err(point)?;
        let fingerprint = fingerprint(kind == ExcitationKind::Motion, times.iter().chain(&values));
        Ok(Self(Arc::new(Samples { kind, times, values, fingerprint })))
    }

    /// What is recorded.
    pub fn kind(&self) -> ExcitationKind {
        self.0.kind
    }

    /// Times of the samples, s.
    pub fn times(&self) -> &[f64] {
        &self.0.times
    }

    /// The samples, N or m/s^2.
    pub fn values(&self) -> &[f64] {
        &self.0.values
    }

    /// A number that hardly any other recording has; never 0.
    pub(crate) fn fingerprint(&self) -> u64 {
        self.0.fingerprint
    }
}

impl PartialEq for Recording {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0) || self.0 == other.0
    }
}

impl fmt::Debug for Recording {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Samples { kind, times, fingerprint, .. } = &*self.0;
        let samples = times.len();
        write!(out, "Recording {{ kind: {kind:?}, samples: {samples}, fingerprint: {fingerprint:#x} }}")
    }
}

impl Recording {
    /// The recording as it excites a harvester of these parameters.
    pub(crate) fn playback(&self, p: &Parameters) -> Playback {
        let mass = if p.excitation_kind == ExcitationKind::Force { p.cylinder_mass } else { 1.0 };
        let Parameters { file_scale, file_offset: offset, file_repeat: repeats, .. } = *p;
        Playback { recording: self.clone(), factor: file_scale / mass, offset, repeats }
    }

    /// Checks that it is one of what the parameters prescribe.
    ///
    /// # Errors
    /// A recording of the other kind; one that is repeated with less than 1e-6 s from sample to sample on average.
    pub(crate) fn validate(&self, p: &Parameters) -> Result<(), ModelError> {
        if self.kind() != p.excitation_kind {
            return Err(ModelError::RecordingKind { is_motion: self.kind() == ExcitationKind::Motion });
        }
        let spacing = self.0.duration() / (self.times().len() - 1) as f64;
        if p.file_repeat && spacing < MIN_REPEATED_SPACING {
            return Err(ModelError::RepeatedTooFast { spacing, min: MIN_REPEATED_SPACING });
        }
        Ok(())
    }
}

impl Samples {
    fn duration(&self) -> f64 {
        self.times[self.times.len() - 1] - self.times[0]
    }
}

/// A stretch of time in which the recorded part of the cylinder's acceleration is a straight line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Segment {
    /// 0 before the first sample, and counted on from there, over all repetitions.
    pub number: u64,
    /// When it begins, s; before the first sample any time.
    pub start: f64,
    /// When it ends, s.
    pub end: f64,
    /// Force over M or acceleration at the start, m/s^2.
    pub value: f64,
    /// Its rate, m/s^3.
    pub rate: f64,
}

impl Segment {
    /// Nothing is recorded.
    pub const NONE: Self = Self { number: 0, start: 0.0, end: f64::INFINITY, value: 0.0, rate: 0.0 };

    /// The recorded part at `time`, s, in m/s^2.
    #[inline]
    pub fn at(&self, time: f64) -> f64 {
        self.value + self.rate * (time - self.start)
    }
}

/// A recording as it excites a harvester.
#[derive(Debug, Clone, PartialEq)]
pub struct Playback {
    pub recording: Recording,
    /// `excitation.fileScale`, over M if the recording is that of a force.
    factor: f64,
    /// s.
    offset: f64,
    repeats: bool,
}

impl Playback {
    /// When segment `number` begins, s; not that before the first sample. Sums of times from the start would add up their rounding.
    fn begin_of(&self, number: u64) -> f64 {
        let Samples { times, .. } = &*self.recording.0;
        let (cycle, index) = self.place(number);
        if cycle == 0 {
            return self.offset + times[index];
        }
        // Rounded like that of the next repetition, no sample comes after it.
        let [this, next] = [cycle, cycle + 1].map(|cycle| cycle as f64 * self.recording.0.duration());
        self.offset + (this + times[index]).min(next + times[0])
    }

    /// Repetition of segment `number`, and the sample with which it begins.
    #[allow(clippy::cast_possible_truncation)] // an index
    fn place(&self, number: u64) -> (u64, usize) {
        let (index, segments) = (number.saturating_sub(1), self.recording.0.times.len() as u64 - 1);
        if self.repeats && index >= segments {
            (index / segments, (index % segments) as usize)
        } else {
            (0, index.min(segments) as usize)
        }
    }

    /// Number of the last segment, that after the last sample; none if the recording is repeated.
    fn last(&self) -> Option<u64> {
        (!self.repeats).then(|| self.recording.0.times.len() as u64)
    }

    /// Segment `number`, or the last one.
    pub fn segment(&self, number: u64) -> Segment {
        let Samples { times, values, .. } = &*self.recording.0;
        if number == 0 {
            let end = self.begin_of(1);
            return Segment { start: end, end, ..Segment::NONE };
        }
        let start = self.begin_of(number);
        if let Some(last) = self.last().filter(|last| number >= *last) {
            return Segment { number: last, start, ..Segment::NONE };
        }
        let (_, index) = self.place(number);
        let rate = (values[index + 1] - values[index]) / (times[index + 1] - times[index]);
        let [value, rate] = [values[index], rate].map(|value| self.factor * value);
        Segment { number, start, end: self.begin_of(number + 1), value, rate }
    }

    /// The segment that follows.
    #[inline]
    pub fn segment_after(&self, segment: &Segment) -> Segment {
        let Samples { times, values, .. } = &*self.recording.0;
        let number = segment.number + 1;
        if self.last().is_some_and(|last| number >= last) {
            return self.segment(number);
        }
        let (cycle, index) = self.place(number);
        let [[t0, t1], [v0, v1]] = [times, values].map(|list| [list[index], list[index + 1]]);
        let end = if cycle == 0 && !self.repeats { self.offset + t1 } else { self.begin_of(number + 1) };
        let [value, rate] = [v0, (v1 - v0) / (t1 - t0)].map(|value| self.factor * value);
        Segment { number, start: segment.end, end, value, rate }
    }

    /// The segment at `time`, s: where two meet, that which begins.
    pub fn segment_at(&self, time: f64) -> Segment {
        let Samples { times, .. } = &*self.recording.0;
        let cycle = (time - self.begin_of(1)) / self.recording.0.duration();
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // saturates
        let cycle = if self.repeats { cycle as u64 } else { 0 };
        let segments = times.len() as u64 - 1;
        let local = time - self.offset - cycle as f64 * self.recording.0.duration();
        let mut number = cycle * segments + times.partition_point(|sample| *sample <= local) as u64;
        // These differences are rounded otherwise than the begins.
        let last = self.last().unwrap_or(u64::MAX);
        while number < last && self.begin_of(number + 1) <= time {
            number += 1;
        }
        while number > 0 && self.begin_of(number) > time {
            number -= 1;
        }
        self.segment(number)
    }
}
