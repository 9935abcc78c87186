//! The content of a serialised state of VibroImpactHarvester, behind its checksum.
#![no_main]

use VibroImpactHarvester::Harvester;

libfuzzer_sys::fuzz_target!(
    init: videg_fuzz::write_seeds::<Harvester>(),
    |content: &[u8]| videg_fuzz::state::<Harvester>(content)
);
