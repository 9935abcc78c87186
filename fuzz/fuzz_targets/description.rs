//! `modelDescription.xml` of an FMU from anywhere, and values for its variables as a user types them.
#![no_main]

use videg::fmi::{ModelDescription, Value};

libfuzzer_sys::fuzz_target!(|document: &[u8]| {
    let Ok(description) = ModelDescription::parse(document, "fuzzed.fmu") else { return };
    for variable in &description.variables {
        for text in ["0", "-1.5", "1e999", "NaN", "true", "\u{0}", "closed"] {
            if let Ok(value) = Value::parse(&description, variable, text) {
                assert!(!value.type_name().is_empty());
            }
        }
        assert!(description.variable(&variable.name).is_ok(), "{}", variable.name);
    }
});
