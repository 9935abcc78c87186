//! The XML that is packaged is the one that the variable table gives.

use fmi2_export::model_description;

/// Run with `UPDATE_MODEL_DESCRIPTION=1` to write the file after a change of the table.
#[test]
fn the_packaged_model_description_is_that_of_the_variable_table() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../modelDescription/VibroImpactHarvester.xml");
    let expected = model_description::<VibroImpactHarvester::Harvester>().unwrap();
    if std::env::var_os("UPDATE_MODEL_DESCRIPTION").is_some() {
        std::fs::write(path, &expected).unwrap();
    }
    let packaged = std::fs::read_to_string(path).unwrap_or_default();
    assert!(packaged == expected, "{path} is out of date: run `UPDATE_MODEL_DESCRIPTION=1 cargo test --workspace`");
}
