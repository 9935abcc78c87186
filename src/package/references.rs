//! Experiments that an FMU carries, with their reference results: the layered standard FMI-LS-REF.

use super::entries::Entries;

/// Where the layered standard has them.
const FOLDER: &str = "extra/org.fmi-standard.fmi-ls-ref";

macro_rules! files {
    ($folder:literal: $($name:literal)*) => {
        &[$(($name, include_str!(concat!("../../fmu/", $folder, "/extra/org.fmi-standard.fmi-ls-ref/", $name)))),*]
    };
}

const HARVESTER: &[(&str, &str)] =
    files!("harvester": "fmi-ls-manifest.xml" "experiments.exp" "free-ref.csv" "forced-in.csv" "forced-ref.csv");
const CIRCUIT: &[(&str, &str)] =
    files!("circuit": "fmi-ls-manifest.xml" "experiments.exp" "pulses-in.csv" "pulses-ref.csv");

/// Adds them to an archive, if the model has any.
pub(super) fn add(identifier: &str, entries: &mut Entries) {
    let files = match identifier {
        "VibroImpactHarvester" => HARVESTER,
        "HarvestingCircuit" => CIRCUIT,
        _ => return,
    };
    for (name, text) in files {
        entries.add(&format!("{FOLDER}/{name}"), *text);
    }
}
