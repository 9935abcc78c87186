//! The XML that is packaged is the one that the variable table gives.

use fmu_export::{changed_references, model_description};

#[test]
fn the_packaged_model_description_is_that_of_the_variable_table() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../modelDescription/HarvestingCircuit.xml");
    let made = model_description::<HarvestingCircuit::Harvesting>().unwrap();
    videg_golden::model_description(path, &made, |kept, made| changed_references(kept, made).unwrap());
}
