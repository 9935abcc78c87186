//! Calls of the FMU as it is exported: values and arguments that make no sense, one by one, and random sequences.

use HarvestingCircuit as _; // links its C functions
use fmu_export::abi::fmi3::*;
use fmu_host::{Fmu, fmi3, hostile, linked_functions, linked_functions3, run};

fmu_host::linked_names3!();

/// Random sequences of up to 32 calls each; some seconds without optimisation.
const SEQUENCES: u64 = 50_000;

#[allow(clippy::unwrap_used)] // a helper fails a test, too
fn fmu() -> Fmu {
    Fmu::new(linked_functions!(), include_str!("../../../modelDescription/HarvestingCircuit.xml")).unwrap()
}

#[test]
fn no_variable_takes_what_is_no_number_but_infinity_where_it_has_a_meaning() {
    let states = 4; // load.resistance and leakage.timeConstant, before and during initialisation
    assert_eq!(hostile::variables(&fmu()).unwrap(), states);
}

#[test]
fn no_argument_takes_what_is_no_number() {
    hostile::arguments(&fmu()).unwrap();
}

#[test]
fn random_call_sequences_go_as_the_tables_say() {
    let census = run(&fmu(), 0..SEQUENCES).unwrap();
    let [ok, warning, _, error, fatal] = census.statuses;
    assert!(ok > 1000 && warning == 0 && error > 1000 && fatal == 0, "{:?}", census.statuses);
}

#[test]
fn random_call_sequences_of_fmi_3_go_as_the_table_says() {
    let description = include_str!("../../../modelDescription/fmi3/HarvestingCircuit.xml");
    let fmu = fmi3::Fmu::new(linked_functions3!(), description).unwrap();
    let fmi3::Census { statuses: [ok, _, _, error, fatal], cells, restored } = fmi3::run(&fmu, 0..SEQUENCES);
    assert!(ok > 1000 && error > 1000 && fatal == 0 && restored > 1000, "{ok}, {error}, {fatal}, {restored}");
    assert_eq!(cells.len(), 70 * 5, "every function in every state but the fatal one");
}
