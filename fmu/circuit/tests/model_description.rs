//! The XML that is packaged is the one that the variable table gives, and initial values depend on what its
//! `InitialUnknowns` say.

use HarvestingCircuit::Harvesting;
use fmu_export::{Standard, changed_references, model_description, terminals_and_icons};
use fmu_host::initial::{found, promised};
use fmu_host::slave::parameters;
use videg_circuit::Settings;

/// A file of the folder `modelDescription`.
macro_rules! kept {
    ($file:literal) => {
        concat!(env!("CARGO_MANIFEST_DIR"), "/../../modelDescription/", $file)
    };
}

#[test]
fn the_packaged_model_descriptions_are_those_of_the_variable_table() {
    let check = |path, made: &str| {
        videg_golden::model_description(path, made, |kept, made| changed_references(kept, made).unwrap());
    };
    check(kept!("HarvestingCircuit.xml"), &model_description::<Harvesting>(Standard::Fmi2).unwrap());
    check(kept!("fmi3/HarvestingCircuit.xml"), &model_description::<Harvesting>(Standard::Fmi3).unwrap());
    check(kept!("fmi3/HarvestingCircuit.terminalsAndIcons.xml"), &terminals_and_icons::<Harvesting>(true).unwrap());
}

#[test]
fn the_parameters_are_those_of_the_tables_of_the_circuit() {
    let names = Settings::QUANTITIES.iter().map(|it| it.name).chain(Settings::CHOICES.iter().map(|it| it.name));
    assert_eq!(parameters::<Harvesting>(), names.collect::<Vec<_>>());
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
