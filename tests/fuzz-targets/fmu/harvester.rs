//! Targets of VibroImpactHarvester.

use std::sync::LazyLock;

use VibroImpactHarvester::Harvester;
use fmu_host::{Fmu, linked_functions};
use videg_fuzz_targets::Target;
use videg_fuzz_targets::fmu::{self, calls, state, states, tapes};

static FMU: LazyLock<Fmu> = LazyLock::new(|| {
    Fmu::new(linked_functions!(model_exchange), fmu::HARVESTER).unwrap_or_else(|error| panic!("{error}"))
});

/// The targets.
pub const TARGETS: [Target; 2] = [
    Target { name: "calls_harvester", check: |tape| calls(&FMU, tape), seeds: tapes },
    Target { name: "state_harvester", check: state::<Harvester>, seeds: states::<Harvester> },
];
