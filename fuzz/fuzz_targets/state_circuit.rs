//! The content of a serialised state of HarvestingCircuit, behind its checksum.
#![no_main]

use HarvestingCircuit::Harvesting;

libfuzzer_sys::fuzz_target!(
    init: videg_fuzz::write_seeds::<Harvesting>(),
    |content: &[u8]| videg_fuzz::state::<Harvesting>(content)
);
