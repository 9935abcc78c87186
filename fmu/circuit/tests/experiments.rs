//! The experiment that the FMU carries (FMI-LS-REF): its reference results are what the FMU gives.

use HarvestingCircuit::Harvesting;
use fmu_host::experiment::{Inputs, reference};
use videg_golden::Golden;

const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/extra/org.fmi-standard.fmi-ls-ref");
const GOLDEN: Golden = Golden::new("UPDATE_EXPERIMENTS", "cargo test -p videg-fmu-circuit --test experiments");

/// As `experiments.exp` says: 2 s.
const STEPS: (u32, f64) = (80, 0.025);

const OUTPUTS: [&str; 5] = ["left.voltage", "load.voltage", "supply.energy", "load.energy", "converted.energy"];

#[test]
fn reference_results_are_what_the_fmu_gives() {
    let inputs = Inputs::read(include_str!("../extra/org.fmi-standard.fmi-ls-ref/pulses-in.csv")).unwrap();
    let expected = reference::<Harvesting>(&inputs, &OUTPUTS, STEPS).unwrap();
    GOLDEN.file(format!("{FOLDER}/pulses-ref.csv"), &expected);
}
