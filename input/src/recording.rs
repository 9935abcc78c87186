//! Recordings of an excitation: `time,acceleration` in s and m/s2, or `time,force` in s and N.

use std::io::BufRead;
use std::path::Path;

use crate::columns::{self, Column, Columns, ColumnsError, Form, Order};

const TIME: Column = Column { name: "time", unit: "s", order: Order::Rising };

/// Headings, and how many samples a recording has.
const FORM: Form<2> = Form {
    headings: [
        &[TIME, Column { name: "acceleration", unit: "m/s2", order: Order::Any }],
        &[TIME, Column { name: "force", unit: "N", order: Order::Any }],
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
    fn from(Columns { heading, values }: Columns) -> Self {
        let mut columns = values.into_iter();
        let mut next = || columns.next().unwrap_or_default();
        Self { is_acceleration: heading == 0, times: next(), values: next() }
    }
}
