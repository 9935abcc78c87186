//! Random call sequences with random arguments, for both interfaces: whatever a host does, it gets the answer that the
//! standard gives.

use crate::common::toy;
use fmu_export::{CallState, Function, Guid, Standard};
use fmu_host::{Fmu, linked_functions, run};
use std::ffi::CString;

/// Sequences; few for Miri, which is a thousand times slower.
const SEQUENCES: u64 = if cfg!(miri) { 60 } else { 100_000 };

#[allow(clippy::unwrap_used)] // a helper fails a test, too
fn toy() -> Fmu {
    let guid = CString::new(Guid::of::<toy::Toy>(Standard::Fmi2).to_string()).unwrap();
    let functions = linked_functions!(model_exchange);
    Fmu { functions, guid, variables: toy::COUNT_OF_VARIABLES, favourite: Some(toy::TROUBLE), states: 1, indicators: 1 }
}

#[test]
fn a_hundred_thousand_random_call_sequences_go_as_the_tables_say() {
    let census = run(&toy(), 0..SEQUENCES).unwrap();
    if !cfg!(miri) {
        // Warnings are the model's alone, and it gives few.
        let enough = |(status, count): (usize, &u64)| *count > if status == 1 { 100 } else { 1000 };
        assert!(census.statuses.iter().enumerate().all(enough), "all sorts of status: {:?}", census.statuses);
        // Co-simulation has seven states that an instance can be in, model exchange too.
        assert_eq!(CallState::ALL.len() - 4, 9); // two are of FMI 3.0, in two more no instance is
        let cells = (Function::ALL.len() - 1) * (7 + 7);
        assert_eq!(census.cells.len(), cells, "every function in every state");
    }
}
