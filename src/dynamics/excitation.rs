//! What excites a harvester, read from files, and after what time it repeats.

use std::path::Path;

use videg_data::{DataError, membrane, recording};
use videg_model::{ForceTable, Parameters, Recording, Setup};

use super::DynamicsError;
use crate::scenario::Setting;

/// Variables that name a file.
const RECORDING: &str = "excitation.file";
const MEMBRANE: &str = "membrane.file";

/// By how much a recording may miss a whole number of periods of the harmonic excitation, as part of itself.
const COMMENSURATE: f64 = 1e-9;

/// What a harvester is made from besides its parameters.
#[derive(Debug, Clone, Default)]
pub struct Files {
    /// The recording that excites it.
    pub recording: Option<Recording>,
    /// Its measured membrane.
    pub table: Option<ForceTable>,
}

impl Files {
    /// Those that the settings name, beside their case file if there is one, and the other settings. Of several, the last counts.
    ///
    /// # Errors
    /// A file that cannot be read, or does not hold what it should.
    pub(super) fn read(settings: &[Setting]) -> Result<(Self, Vec<Setting>), DynamicsError> {
        let named = |name: &str| {
            let setting = settings.iter().rev().find(|setting| setting.name == name);
            setting.map(Setting::value_for_fmu).filter(|file| !file.is_empty())
        };
        let recording =
            named(RECORDING).map(|file| recording::read(Path::new(&*file)).map_err(refused(RECORDING, &file)));
        let table = named(MEMBRANE).map(|file| membrane::read(Path::new(&*file)).map_err(refused(MEMBRANE, &file)));
        let is_other = |setting: &&Setting| setting.name != RECORDING && setting.name != MEMBRANE;
        let files = Self { recording: recording.transpose()?, table: table.transpose()? };
        Ok((files, settings.iter().filter(is_other).cloned().collect()))
    }

    /// What a harvester with these `parameters` is made from.
    pub fn setup<'a>(&'a self, parameters: &'a Parameters) -> Setup<'a> {
        Setup { parameters, recording: self.recording.as_ref(), table: self.table.as_ref() }
    }
}

fn refused(name: &'static str, file: &str) -> impl FnOnce(DataError) -> DynamicsError {
    let file = file.to_owned();
    move |reason| DynamicsError::File { name, file, reason: reason.to_string() }
}

/// Time, s, after which the excitation repeats, from 0 on: a period of the harmonic one, or a recording.
///
/// # Errors
/// A recording that is played once or begins after 0, or holds no whole number of periods of the harmonic excitation beside it.
pub(super) fn period(setup: &Setup<'_>) -> Result<f64, DynamicsError> {
    let p = setup.parameters;
    let Some(recording) = setup.recording else { return Ok(1.0 / p.frequency) };
    let times = recording.times();
    let (first, duration) = (p.file_offset + times[0], times[times.len() - 1] - times[0]);
    if !p.file_repeat {
        return Err(DynamicsError::RecordedOnce);
    }
    if first > 0.0 {
        return Err(DynamicsError::RecordedLate { first });
    }
    let (periods, whole) = (duration * p.frequency, (duration * p.frequency).round());
    if p.harmonic_acceleration() > 0.0 && (whole < 1.0 || (periods - whole).abs() > COMMENSURATE * whole) {
        return Err(DynamicsError::Incommensurate { duration, periods, frequency: p.frequency });
    }
    Ok(duration)
}
