//! Calls of the C functions of VibroImpactHarvester, in any order and with any arguments; each answer is checked against the
//! tables of FMI 2.0.
#![no_main]

use std::sync::LazyLock;

use VibroImpactHarvester as _; // links its C functions
use fmi2_host::{Fmu, linked_functions, run_tape};

static FMU: LazyLock<Fmu> = LazyLock::new(|| {
    let description = include_str!("../../modelDescription/VibroImpactHarvester.xml");
    Fmu::new(linked_functions!(model_exchange), description).unwrap_or_else(|error| panic!("{error}"))
});

libfuzzer_sys::fuzz_target!(|tape: &[u8]| run_tape(&FMU, tape).unwrap_or_else(|what| panic!("{what}")));
