//! The XML that is packaged is the one that the variable table gives, and initial values depend on what its
//! `InitialUnknowns` say.

use HarvestingCircuit::Harvesting;
use fmu_export::{changed_references, model_description};
use fmu_host::initial::{found, promised};

#[test]
fn the_packaged_model_description_is_that_of_the_variable_table() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../modelDescription/HarvestingCircuit.xml");
    let made = model_description::<Harvesting>().unwrap();
    videg_golden::model_description(path, &made, |kept, made| changed_references(kept, made).unwrap());
}

/// Size that a variable typically has.
fn size(name: &str) -> f64 {
    match name.rsplit('.').next() {
        Some("capacitance") => 1e-11,
        Some("energy") => 1e-4,
        Some("charge" | "current") => 1e-8,
        _ => 1000.0,
    }
}

#[test]
fn initial_values_depend_on_what_the_table_says_and_on_nothing_else() {
    assert_eq!(found::<Harvesting>(3000, size), promised::<Harvesting>());
}
