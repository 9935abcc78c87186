//! The XML that is packaged is the one that the variable table gives, and initial values depend on what its
//! `InitialUnknowns` say.

mod common;

use VibroImpactHarvester::Harvester;
use common::differences::natural_size;
use fmu_export::{Standard, changed_references, model_description, terminals_and_icons};
use fmu_host::initial::{found, on_inputs, promised};
use fmu_host::slave::parameters;
use videg_model::Parameters;

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
    check(kept!("VibroImpactHarvester.xml"), &model_description::<Harvester>(Standard::Fmi2).unwrap());
    check(kept!("fmi3/VibroImpactHarvester.xml"), &model_description::<Harvester>(Standard::Fmi3).unwrap());
    check(kept!("fmi3/VibroImpactHarvester.terminalsAndIcons.xml"), &terminals_and_icons::<Harvester>(true).unwrap());
}

#[test]
fn the_parameters_are_those_of_the_tables_of_the_model() {
    let names = Parameters::TABLE.iter().map(|it| it.name).chain(Parameters::CHOICES.iter().map(|it| it.name));
    assert_eq!(parameters::<Harvester>(), names.collect::<Vec<_>>());
}

/// Starts; enough to find each dependency on an input.
const STARTS: usize = 10_000;

/// So that many of the starts lie beyond a membrane, or run into one.
fn size(name: &str) -> f64 {
    match name {
        "initial.cylinderPosition" | "initial.ballPosition" => 0.05,
        "initial.cylinderVelocity" | "initial.ballVelocity" | "externalForce" => 0.5,
        "left.voltage" | "right.voltage" => 3000.0,
        "contact.restingReal" | "impact.countReal" => 1.0,
        _ => natural_size(name),
    }
}

#[test]
fn initial_values_depend_on_what_the_table_says_and_on_nothing_else() {
    let (found, promised) = (found::<Harvester>(STARTS, size), promised::<Harvester>());
    let hidden: Vec<_> = found.difference(&promised).collect();
    assert!(hidden.is_empty(), "the table does not say so: {hidden:?}");
    let (found, promised) = (on_inputs::<Harvester>(&found), on_inputs::<Harvester>(&promised));
    let idle: Vec<_> = promised.difference(&found).collect();
    assert!(idle.is_empty(), "the table says so, but it is not: {idle:?}");
}

/// What importers look at for algebraic loops: at the start as later, voltages act on the electric fields alone, but for the
/// end of a contact that the Maxwell force has a part in.
#[test]
fn of_the_inputs_few_initial_values_depend() {
    let pairs: Vec<_> = on_inputs::<Harvester>(&promised::<Harvester>()).into_iter().collect();
    let expected = [
        ("der(ball.velocity)", "externalForce"),
        ("der(cylinder.velocity)", "externalForce"),
        ("impact.nextTime", "externalForce"),
        ("left.electricField", "left.voltage"),
        ("mount.force", "externalForce"),
        ("pulse.nextKnot", "externalForce"),
        ("pulse.nextKnot", "left.voltage"),
        ("pulse.nextKnot", "right.voltage"),
        ("right.electricField", "right.voltage"),
    ];
    assert_eq!(pairs, expected);
}
