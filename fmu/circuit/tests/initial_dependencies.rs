//! `InitialUnknowns` of `ModelStructure`: initial values depend on what the table says.

use HarvestingCircuit::Harvesting;
use fmu_host::initial::{found, promised};

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
