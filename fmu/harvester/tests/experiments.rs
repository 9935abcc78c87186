//! The experiments that the FMU carries (FMI-LS-REF): their reference results are what the FMU gives.

use VibroImpactHarvester::Harvester;
use fmu_host::experiment::{Inputs, reference};
use videg_golden::Golden;

const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/extra/org.fmi-standard.fmi-ls-ref");
const GOLDEN: Golden = Golden::new("UPDATE_EXPERIMENTS", "cargo test -p videg-fmu-harvester --test experiments");

/// As `experiments.exp` says: 2 s.
const STEPS: (u32, f64) = (80, 0.025);

const OUTPUTS: [&str; 6] =
    ["cylinder.position", "ball.position", "left.capacitance", "right.capacitance", "gain.voltage", "impact.countReal"];

#[test]
fn reference_results_are_what_the_fmu_gives() {
    let inputs = Inputs::read(include_str!("../extra/org.fmi-standard.fmi-ls-ref/forced-in.csv")).unwrap();
    for (name, inputs) in [("free", Inputs::NONE), ("forced", inputs)] {
        let expected = reference::<Harvester>(&inputs, &OUTPUTS, STEPS).unwrap();
        let impacts = expected.lines().last().and_then(|line| line.rsplit(',').next()).unwrap();
        assert!(impacts.parse::<f64>().unwrap() > 3.0, "{name}: {impacts} impacts");
        GOLDEN.file(format!("{FOLDER}/{name}-ref.csv"), &expected);
    }
}
