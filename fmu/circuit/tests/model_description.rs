//! The XML that is packaged is the one that the variable table gives.

use fmi2_export::{changed_references, model_description};
use videg_golden::Golden;

/// Run with `UPDATE_MODEL_DESCRIPTION=1` to write the file after a change of the table. Value references that are known stay:
/// to move them nevertheless, which breaks masters, takes `UPDATE_VALUE_REFERENCES=1` as well.
#[test]
fn the_packaged_model_description_is_that_of_the_variable_table() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../modelDescription/HarvestingCircuit.xml");
    let expected = model_description::<HarvestingCircuit::Harvesting>().unwrap();
    if std::env::var_os("UPDATE_VALUE_REFERENCES").is_none() {
        let kept = std::fs::read_to_string(path).unwrap_or_default();
        let changed = changed_references(&kept, &expected).unwrap();
        let advice = "a new variable goes into a group of its own at the end of VARIABLES, docs/releasing.md";
        assert!(changed.is_empty(), "{advice}:\n{}", changed.join("\n"));
    }
    Golden::new("UPDATE_MODEL_DESCRIPTION", "cargo test --workspace").file(path, &expected);
}
