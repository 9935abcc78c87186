//! Recordings of an excitation: `time,acceleration` in s and m/s2, or `time,force` in s and N.

use std::io::BufRead;
use std::path::Path;

use crate::columns::{self, Columns, ColumnsError, Form, Heading};

/// Headings, and how many samples a recording has.
const FORM: Form<2> = Form {
    headings: [
        Heading { names: ["time", "acceleration"], units: ["s", "m/s2"] },
        Heading { names: ["time", "force"], units: ["s", "N"] },
    ],
    rows: [2, 1_000_000],
};

/// The samples of a recording.
#[derive(Debug, Clone, PartialEq)]
pub struct Samples {
    /// Whether an acceleration is recorded, m/s2, not a force, N.
    pub is_acceleration: bool,
    /// When, s; increasing.
    pub times: Vec<f64>,
    /// What.
    pub values: Vec<f64>,
}

/// Reads the recording at `path`.
///
/// # Errors
/// As [`columns::read`].
pub fn read(path: &Path) -> Result<Samples, ColumnsError> {
    columns::read(path, &FORM).map(Samples::from)
}

/// Reads a recording.
///
/// # Errors
/// As [`columns::parse`].
pub fn parse(text: impl BufRead) -> Result<Samples, ColumnsError> {
    columns::parse(text, &FORM).map(Samples::from)
}

impl From<Columns> for Samples {
    fn from(Columns { heading, values: [times, values] }: Columns) -> Self {
        Self { is_acceleration: heading == 0, times, values }
    }
}
