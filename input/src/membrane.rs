//! Measured membranes: `deflection,force` in m and N, or `deflection,force,capacitance` in m, N and F.

use std::io::BufRead;
use std::path::Path;

use crate::columns::{self, Column, Columns, ColumnsError, Form, Order};

const DEFLECTION: Column = Column { name: "deflection", unit: "m", order: Order::RisingFromZero };
const FORCE: Column = Column { name: "force", unit: "N", order: Order::RisingFromZero };
const CAPACITANCE: Column = Column { name: "capacitance", unit: "F", order: Order::PositiveNotFalling };

/// Headings, and how many points a membrane has.
const FORM: Form<2> =
    Form { headings: [&[DEFLECTION, FORCE], &[DEFLECTION, FORCE, CAPACITANCE]], rows: [3, 1_000_000] };

/// The points of a measured membrane.
#[derive(Debug, Clone, PartialEq)]
pub struct Points {
    /// m; increasing from 0.
    pub deflections: Vec<f64>,
    /// N; increasing from 0.
    pub forces: Vec<f64>,
    /// F, if they were measured; not falling.
    pub capacitances: Option<Vec<f64>>,
}

/// Reads the membrane at `path`.
///
/// # Errors
/// As [`columns::read`].
pub fn read(path: &Path) -> Result<Points, ColumnsError> {
    columns::read(path, &FORM).map(Points::from)
}

/// Reads a membrane.
///
/// # Errors
/// As [`columns::parse`].
pub fn parse(text: impl BufRead) -> Result<Points, ColumnsError> {
    columns::parse(text, &FORM).map(Points::from)
}

impl From<Columns> for Points {
    fn from(Columns { values, .. }: Columns) -> Self {
        let mut columns = values.into_iter();
        let mut next = || columns.next().unwrap_or_default();
        Self { deflections: next(), forces: next(), capacitances: columns.next() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_membrane_is_refused_with_its_line_and_value() {
        let allowed = "allowed is deflection,force (in m and N) or deflection,force,capacitance (in m, N and F)";
        for (text, said) in [
            ("deflection_mm,force\n0,0\n", format!("line 1: the heading is \"deflection_mm,force\"; {allowed}")),
            ("deflection,force\n0,0\n1e-3,0.1\n", "2 rows below the heading; at least 3 are needed".into()),
            ("deflection,force\n1e-3,0\n", "line 2: deflection = 0.001 m: the first row must be that of 0 m".into()),
            ("deflection,force\n0,0.1\n", "line 2: force = 0.1 N: the first row must be that of 0 N".into()),
            (
                "deflection,force\n0,0\n0,1\n",
                "line 3: deflection = 0 m is not above that of the row before, 0 m".into(),
            ),
            (
                "deflection,force\n0,0\n1,2\n2,2\n",
                "line 4: force = 2 N is not above that of the row before, 2 N".into(),
            ),
            ("deflection,force,capacitance\n0,0,0\n", "line 2: capacitance = 0 F must be above 0 F".into()),
            (
                "deflection,force,capacitance\n0,0,2\n1,1,1\n",
                "line 3: capacitance = 1 F is below that of the row before, 2 F".into(),
            ),
            ("deflection,force,capacitance\n0,0\n", "line 2: no capacitance in \"0,0\": a row has 3 numbers".into()),
        ] {
            assert_eq!(parse(text.as_bytes()).map_err(|error| error.to_string()), Err(said), "{text}");
        }
        let text = "deflection,force,capacitance\n0,0,1e-11\n1e-3,0.1,1e-11\n2e-3,0.3,2e-11\n";
        let points = parse(text.as_bytes()).unwrap();
        assert_eq!(points.forces, [0.0, 0.1, 0.3]);
        assert_eq!(points.capacitances.as_deref(), Some(&[1e-11, 1e-11, 2e-11][..]));
    }
}
