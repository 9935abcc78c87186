//! What a harvester is made from.

use core::f64::consts::TAU;

use crate::error::ModelError;
use crate::membrane::table::ForceTable;
use crate::parameters::{ExcitationKind, MembraneLaw, Parameters};
use crate::recording::{Playback, Recording};

/// What a harvester is made from: parameters, the recording that excites it besides the harmonic force, and the table of its
/// membranes, if there are such.
#[derive(Debug, Clone, Copy)]
pub struct Setup<'a> {
    /// The parameters.
    pub parameters: &'a Parameters,
    /// The recording.
    pub recording: Option<&'a Recording>,
    /// The measured membrane of `membrane.law = table`.
    pub table: Option<&'a ForceTable>,
}

impl<'a> From<&'a Parameters> for Setup<'a> {
    fn from(parameters: &'a Parameters) -> Self {
        Self { parameters, recording: None, table: None }
    }
}

impl Parameters {
    /// These parameters with a recording: `Harvester::new(parameters.with_recording(Some(&recording)), 0.0)`.
    pub fn with_recording<'a>(&'a self, recording: Option<&'a Recording>) -> Setup<'a> {
        Setup { recording, ..self.into() }
    }

    /// These parameters with a measured membrane: `Harvester::new(parameters.with_table(Some(&table)), 0.0)`.
    pub fn with_table<'a>(&'a self, table: Option<&'a ForceTable>) -> Setup<'a> {
        Setup { table, ..self.into() }
    }
}

/// No film is pressed in as deep as that: its table is in another unit.
fn check_depth(table: &ForceTable, radius: f64) -> Result<(), ModelError> {
    /// In units of the membrane's radius: ten times what a film of rubber stands.
    const DEEPEST: f64 = 20.0;
    let (end, most) = (table.end(), DEEPEST * radius);
    if end > most { Err(ModelError::TableDepth { end, most, radius }) } else { Ok(()) }
}

impl<'a> Setup<'a> {
    /// The same with a measured membrane.
    #[must_use]
    pub fn with_table(self, table: Option<&'a ForceTable>) -> Self {
        Self { table, ..self }
    }

    /// Checks the parameters, that the recording is one of what they prescribe, and that there is a table where they ask for one.
    ///
    /// # Errors
    /// As [`Parameters::validate`]; a recording of the other kind; one that is repeated with less than 1e-6 s from sample to
    /// sample on average; a table deeper than 20 times the membrane's radius; no table under `membrane.law = table`, or one under another law.
    pub fn validate(&self) -> Result<(), ModelError> {
        self.parameters.validate()?;
        let is_measured = self.parameters.membrane_law == MembraneLaw::Table;
        if is_measured != self.table.is_some() {
            return Err(if is_measured { ModelError::NoTable } else { ModelError::UnusedTable });
        }
        self.table.map_or(Ok(()), |table| check_depth(table, self.parameters.membrane_radius()))?;
        self.recording.map_or(Ok(()), |recording| recording.validate(self.parameters))
    }

    /// The excitation without phase noise at these `times`, s: the force on the cylinder, N, or the acceleration that a shaker
    /// prescribes, m/s^2.
    pub fn excitation(&self, times: impl IntoIterator<Item = f64>) -> Vec<f64> {
        let (p, playback) = (self.parameters, self.playback());
        let mass = if p.excitation_kind == ExcitationKind::Force { p.cylinder_mass } else { 1.0 };
        let harmonic = |time: f64| p.harmonic_acceleration() * (TAU * p.frequency * time + p.phase).cos();
        let recorded = |time: f64| playback.as_ref().map_or(0.0, |playback| playback.segment_at(time).at(time));
        times.into_iter().map(|time| mass * (harmonic(time) + recorded(time))).collect()
    }

    /// The recording as it excites the harvester.
    pub(crate) fn playback(&self) -> Option<Playback> {
        self.recording.map(|recording| recording.playback(self.parameters))
    }
}
