//! Targets of HarvestingCircuit.

use std::sync::LazyLock;

use HarvestingCircuit::Harvesting;
use fmu_host::{Fmu, linked_functions};
use videg_fuzz_targets::Target;
use videg_fuzz_targets::fmu::{self, calls, state, states, tapes};

static FMU: LazyLock<Fmu> =
    LazyLock::new(|| Fmu::new(linked_functions!(), fmu::CIRCUIT).unwrap_or_else(|error| panic!("{error}")));

/// The targets.
pub const TARGETS: [Target; 2] = [
    Target { name: "calls_circuit", check: |tape| calls(&FMU, tape), seeds: tapes },
    Target { name: "state_circuit", check: state::<Harvesting>, seeds: states::<Harvesting> },
];
