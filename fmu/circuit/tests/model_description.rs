//! The XML that is packaged is the one that the variable table gives.

use fmi2_export::model_description;
use videg_golden::Golden;

/// Run with `UPDATE_MODEL_DESCRIPTION=1` to write the file after a change of the table.
#[test]
fn the_packaged_model_description_is_that_of_the_variable_table() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../modelDescription/HarvestingCircuit.xml");
    let expected = model_description::<HarvestingCircuit::Harvesting>().unwrap();
    Golden::new("UPDATE_MODEL_DESCRIPTION", "cargo test --workspace").file(path, &expected);
}
