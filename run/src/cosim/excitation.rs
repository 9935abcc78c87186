//! The excitation of a run, for figures: samples over time, and their spectrum.

use std::path::Path;

use videg_model::{ExcitationKind, Setup};

use super::Device;
use super::spectrum::amplitudes;

/// Most samples; a longer time is cut off at its end.
const MOST: f64 = 262_144.0;

/// Samples of a period of the harmonic part.
const PER_PERIOD: f64 = 20.0;

/// The excitation of a run without phase noise, evenly sampled.
#[derive(Debug, Clone, PartialEq)]
pub struct Excitation {
    /// What it is: of a force, N, or an acceleration, m/s2.
    pub kind: ExcitationKind,
    /// Name of the file with the recorded part; empty if there is none.
    pub file: String,
    /// Whether phase noise is left out.
    pub has_noise: bool,
    /// Time of the first sample, s.
    pub start: f64,
    /// Time from sample to sample, s.
    pub spacing: f64,
    /// The samples, N or m/s2.
    pub values: Vec<f64>,
}

impl Excitation {
    /// That of a run of `device` to `until`, s; none if it is another model, or has its recording in its resources.
    pub fn of(device: &Device, until: f64) -> Option<Self> {
        let (parameters, file) = device.parameters.as_ref()?;
        if file.is_empty() {
            return Some(Self::sampled(&Setup::from(parameters), String::new(), until));
        }
        let recording = videg_data::recording::read(Path::new(file)).ok()?;
        Some(Self::sampled(&parameters.with_recording(Some(&recording)), file.clone(), until))
    }

    /// From 0 to `until`, s, or as long as nothing but a recording that is not repeated excites the cylinder.
    fn sampled(setup: &Setup<'_>, file: String, until: f64) -> Self {
        let p = setup.parameters;
        let harmonic = (p.harmonic_acceleration() > 0.0).then(|| 1.0 / (PER_PERIOD * p.frequency));
        let recorded = setup.recording.map(|recording| {
            let times = recording.times();
            let [first, last] = [times[0], times[times.len() - 1]];
            ([first, last].map(|time| time + p.file_offset), (last - first) / (times.len() - 1) as f64)
        });
        let ends = recorded.map(|(ends, _)| ends).filter(|_| harmonic.is_none() && !p.file_repeat);
        let [start, end] = ends.map_or([0.0, until], |[first, last]| [first.clamp(0.0, until), last.clamp(0.0, until)]);
        // A recording that lies outside of the run shows as nothing over the whole of it.
        let [start, end] = if start < end { [start, end] } else { [0.0, until] };
        let spacings = harmonic.into_iter().chain(recorded.map(|(_, spacing)| spacing));
        let spacing = spacings.fold((end - start) / 1000.0, f64::min);
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // from 1000 to the most
        let count = ((end - start) / spacing).round().min(MOST) as usize;
        let values = setup.excitation((0..count).map(|k| start + k as f64 * spacing));
        let (kind, has_noise) = (p.excitation_kind, p.is_noisy() && harmonic.is_some());
        Self { kind, file, has_noise, start, spacing, values }
    }

    /// Times, s, and values.
    pub fn series(&self) -> Vec<(f64, f64)> {
        self.values.iter().enumerate().map(|(k, value)| (self.start + k as f64 * self.spacing, *value)).collect()
    }

    /// End of the samples, s.
    pub fn end(&self) -> f64 {
        self.start + self.values.len() as f64 * self.spacing
    }

    /// The one-sided amplitude spectrum: frequencies, Hz, and amplitudes, N or m/s2.
    pub fn spectrum(&self) -> Vec<(f64, f64)> {
        amplitudes(&self.values, self.spacing)
    }

    /// Name and unit of what is prescribed.
    pub fn quantity(&self) -> [&'static str; 2] {
        if self.kind == ExcitationKind::Force { ["force", "N"] } else { ["acceleration", "m/s2"] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use videg_model::Parameters;
    use videg_model::Recording;

    #[test]
    fn the_spectrum_of_the_paper_has_one_line_of_its_force() {
        let excitation = Excitation::sampled(&Setup::from(&Parameters::default()), String::new(), 10.0);
        assert_eq!((excitation.values.len(), excitation.end(), excitation.quantity()), (1000, 10.0, ["force", "N"]));
        let (frequency, amplitude) = excitation.spectrum().into_iter().max_by(|a, b| a.1.total_cmp(&b.1)).unwrap();
        assert!((frequency - 2.0).abs() < 1e-12 && (amplitude - 0.5).abs() < 1e-12, "{frequency} Hz, {amplitude} N");
    }

    #[test]
    fn a_recording_alone_is_sampled_where_it_is() {
        let (times, values) = (0..=4000).map(|k| (f64::from(k) / 1000.0, f64::from(k % 2))).unzip();
        let recording = Recording::new(ExcitationKind::Motion, times, values).unwrap();
        let alone = Parameters { excitation_kind: ExcitationKind::Motion, file_offset: 1.0, ..Parameters::default() };
        for (parameters, until, start, end) in [
            (alone, 20.0, 1.0, 5.0),
            (alone, 3.0, 1.0, 3.0),
            (alone, 0.5, 0.0, 0.5),
            (Parameters { file_repeat: true, ..alone }, 20.0, 0.0, 20.0),
            (Parameters { acceleration: 1.0, ..alone }, 20.0, 0.0, 20.0),
        ] {
            let found = Excitation::sampled(&parameters.with_recording(Some(&recording)), String::new(), until);
            assert_eq!(found.start, start, "{until}");
            assert!((found.end() - end).abs() < 1e-9, "{} for {end}", found.end());
        }
        let found = Excitation::sampled(&alone.with_recording(Some(&recording)), String::new(), 1000.0);
        assert_eq!(found.values.len(), 4000, "its own samples");
        assert_eq!(found.quantity(), ["acceleration", "m/s2"]);
    }
}
