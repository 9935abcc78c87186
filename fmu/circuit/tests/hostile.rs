//! Values and arguments that make no sense, one by one: a status and a line in the log, never a crash.

use HarvestingCircuit as _; // links its C functions
use fmu_host::{Fmu, hostile, linked_functions};

#[allow(clippy::unwrap_used)] // a helper fails a test, too
fn fmu() -> Fmu {
    Fmu::new(linked_functions!(), include_str!("../../../modelDescription/HarvestingCircuit.xml")).unwrap()
}

#[test]
fn no_variable_takes_what_is_no_number_but_infinity_where_it_has_a_meaning() {
    let states = 2; // load.resistance, before and during initialisation
    assert_eq!(hostile::variables(&fmu()).unwrap(), states);
}

#[test]
fn no_argument_takes_what_is_no_number() {
    hostile::arguments(&fmu()).unwrap();
}
