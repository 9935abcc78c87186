//! `modelDescription.xml` of an FMU from anywhere, and values for its variables as a user types them.

use fmu_import::{ModelDescription, Value};

use crate::{Target, fmu};

pub(crate) const TARGET: Target = Target { name: "description", check, seeds };

fn check(document: &[u8]) -> bool {
    let Ok(description) = ModelDescription::parse(document, "fuzzed.fmu") else { return false };
    for variable in &description.variables {
        for text in ["0", "-1.5", "1e999", "NaN", "true", "\u{0}", "closed"] {
            if let Ok(value) = Value::parse(&description, variable, text) {
                assert!(!matches!(value, Value::Real(number) if number.is_nan()), "{}", variable.name);
                assert!(value.type_name() == variable.kind.name() && value.check(variable).is_ok(), "{value:?}");
            }
        }
        assert!(description.variable(&variable.name).is_ok(), "{}", variable.name);
    }
    true
}

fn seeds() -> Vec<Vec<u8>> {
    let of_fmi_2 = [fmu::SMALL_DESCRIPTION, fmu::HARVESTER, fmu::CIRCUIT];
    of_fmi_2.into_iter().chain(fmu::OF_FMI_3).map(|text| text.as_bytes().to_vec()).collect()
}
