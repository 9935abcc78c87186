//! Recordings of an excitation: `time,acceleration` in s and m/s2, or `time,force` in s and N.

use std::io::BufRead;
use std::path::Path;

use videg_input::columns::{self, Column, Columns, Form, Order};
use videg_model::{ExcitationKind, Recording};

use crate::DataError;

const TIME: Column = Column { name: "time", unit: "s", order: Order::Rising };

/// Headings, and how many samples a recording has.
pub const FORM: Form<2> = Form {
    headings: [
        &[TIME, Column { name: "acceleration", unit: "m/s2", order: Order::Any }],
        &[TIME, Column { name: "force", unit: "N", order: Order::Any }],
    ],
    rows: Recording::SAMPLES,
};

/// Reads the recording at `path`.
///
/// # Errors
/// As [`columns::read`] and [`Recording::new`].
pub fn read(path: &Path) -> Result<Recording, DataError> {
    recording(columns::read(path, &FORM)?)
}

/// Reads a recording.
///
/// # Errors
/// As [`columns::parse`] and [`Recording::new`].
pub fn parse(text: impl BufRead) -> Result<Recording, DataError> {
    recording(columns::parse(text, &FORM)?)
}

fn recording(Columns { heading, values, lines }: Columns) -> Result<Recording, DataError> {
    let kind = if heading == 0 { ExcitationKind::Motion } else { ExcitationKind::Force };
    let mut columns = values.into_iter();
    let mut next = || columns.next().unwrap_or_default();
    Recording::new(kind, next(), next()).map_err(|error| DataError::new(&lines, error))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_no_recording_may_have_is_named_with_its_line() {
        for (text, said) in [
            ("time,force\n0,1\n# a burst\n1,1e301\n", "line 4: force = 1e301 N is outside [-1e12, 1e12] N"),
            (
                "time,acceleration\n0,1\n1e-13,1\n",
                "line 3: time = 1e-13 s must exceed that of the point before, 0 s, by 1e-12 s",
            ),
        ] {
            let error = parse(text.as_bytes()).unwrap_err().to_string();
            assert!(error.contains(said), "{error}");
        }
    }
}
