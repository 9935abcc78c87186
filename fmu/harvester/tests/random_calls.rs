//! Random call sequences with random arguments on the FMU as it is exported.

use VibroImpactHarvester as _; // links its C functions
use fmu_host::{Fmu, linked_functions, run};

/// Of up to 32 calls each; some seconds without optimisation.
const SEQUENCES: u64 = 50_000;

#[test]
fn random_call_sequences_go_as_the_tables_say() {
    let description = include_str!("../../../modelDescription/VibroImpactHarvester.xml");
    let fmu = Fmu::new(linked_functions!(model_exchange), description).unwrap();
    let census = run(&fmu, 0..SEQUENCES).unwrap();
    let [ok, warning, discard, error, fatal] = census.statuses;
    assert!(ok > 1000 && warning > 0 && error > 1000 && fatal == 0 && discard > 0, "{:?}", census.statuses);
}
