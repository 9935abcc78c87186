//! A measured membrane: what is read can be hit, and reads the same when it is written again.

use std::fmt::Write as _;

use videg_data::membrane;
use videg_input::columns;
use videg_model::{Case, Harvester, MembraneLaw, ModelError, Parameters, Side};

use crate::Target;

pub(crate) const TARGET: Target = Target { name: "membrane", check, seeds };

fn check(bytes: &[u8]) -> bool {
    let Ok(read) = columns::parse(bytes, &membrane::FORM) else { return false };
    let names: Vec<_> = membrane::FORM.headings[read.heading].iter().map(|column| column.name).collect();
    let mut text = names.join(",") + "\n";
    for row in 0..read.values[0].len() {
        let cells: Vec<_> = read.values.iter().map(|column| format!("{:?}", column[row])).collect();
        writeln!(text, "{}", cells.join(",")).unwrap();
    }
    assert_eq!(columns::parse(text.as_bytes(), &membrane::FORM).unwrap().values, read.values);
    let Ok(table) = membrane::parse(bytes) else { return false };
    let fig14 = Case::find("fig14").map_or_else(Parameters::default, |case| (case.parameters)());
    let parameters = Parameters { membrane_law: MembraneLaw::Table, ..fig14 };
    // Only a table that is too deep for the film is refused.
    let mut harvester = match Harvester::new(parameters.with_table(Some(&table)), 0.0) {
        Ok(harvester) => harvester,
        Err(ModelError::TableDepth { .. }) => return true,
        Err(error) => panic!("{error}"),
    };
    for k in 1..=400 {
        harvester.advance(2.5e-3 * f64::from(k)).unwrap();
        for side in Side::BOTH {
            let deflection = harvester.deflection(side);
            assert!(deflection.value >= 0.0 && deflection.value.is_finite() && deflection.rate.is_finite());
            assert!(harvester.capacitance(side).is_finite() && harvester.capacitance_rate(side).is_finite());
        }
    }
    assert!(harvester.totals().energy.is_finite());
    true
}

fn seeds() -> Vec<Vec<u8>> {
    [
        "deflection,force\n0,0\n1e-3,0.1\n2e-3,0.3\n",
        "\u{feff}deflection,force,capacitance\r\n0,0,1.5e-11\r\n5e-4, 0.01,1.5e-11\r\n3e-3,2,4e-11\r\n",
        "# of VHB\ndeflection , force\n\t0, 0\n# softly\n+0.5e-3,0.02\n1,1e3\n\n",
    ]
    .map(Vec::from)
    .to_vec()
}
