//! Measured membranes: `deflection,force` in m and N, or `deflection,force,capacitance` in m, N and F.

use std::io::BufRead;
use std::path::Path;

use videg_input::columns::{self, Column, Columns, Form, Order};
use videg_model::ForceTable;

use crate::DataError;

const DEFLECTION: Column = Column { name: "deflection", unit: "m", order: Order::RisingFromZero };
const FORCE: Column = Column { name: "force", unit: "N", order: Order::RisingFromZero };
const CAPACITANCE: Column = Column { name: "capacitance", unit: "F", order: Order::NotFalling };

/// Headings, and how many points a membrane has.
pub const FORM: Form<2> =
    Form { headings: [&[DEFLECTION, FORCE], &[DEFLECTION, FORCE, CAPACITANCE]], rows: ForceTable::POINTS };

/// Reads the membrane at `path`.
///
/// # Errors
/// As [`columns::read`] and [`ForceTable::new`].
pub fn read(path: &Path) -> Result<ForceTable, DataError> {
    table(columns::read(path, &FORM)?)
}

/// Reads a membrane.
///
/// # Errors
/// As [`columns::parse`] and [`ForceTable::new`].
pub fn parse(text: impl BufRead) -> Result<ForceTable, DataError> {
    table(columns::parse(text, &FORM)?)
}

fn table(Columns { values, lines, .. }: Columns) -> Result<ForceTable, DataError> {
    let mut columns = values.into_iter();
    let mut next = || columns.next().unwrap_or_default();
    let (deflections, forces) = (next(), next());
    ForceTable::new(deflections, forces, columns.next()).map_err(|error| DataError::new(&lines, error))
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
            (
                "deflection,force,capacitance\n0,0,2\n1,1,1\n",
                "line 3: capacitance = 1 F is below that of the row before, 2 F".into(),
            ),
            ("deflection,force,capacitance\n0,0\n", "line 2: no capacitance in \"0,0\": a row has 3 numbers".into()),
        ] {
            assert_eq!(parse(text.as_bytes()).map_err(|error| error.to_string()), Err(said), "{text}");
        }
        let text = "deflection,force,capacitance\n0,0,1e-11\n1e-3,0.1,1e-11\n2e-3,0.3,2e-11\n";
        assert_eq!(parse(text.as_bytes()).unwrap().deflections(), [0.0, 1e-3, 2e-3]);
        for (text, said) in [
            ("deflection,force\n0,0\n# once more\n1,2\n2,1e301\n", "line 5: force = 1e301 N is outside [0, 1e9] N"),
            (
                "deflection,force\n0,0\n1e-3,1e-16\n1,1\n",
                "line 3: force = 1e-16 N must exceed that of the point before, 0 N, by 1e-15 N",
            ),
            (
                "deflection,force,capacitance\n0,0,0\n1,1,1\n2,2,2\n",
                "line 2: capacitance = 0 F is outside [1e-18, 1] F",
            ),
        ] {
            assert_eq!(parse(text.as_bytes()).unwrap_err().to_string(), said);
        }
    }
}
