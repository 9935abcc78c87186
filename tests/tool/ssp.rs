//! `videg ssp`: what is in the package, and what is refused. Tools that run it are tested in `tests/fmpy/test_ssp.py`.

use std::io::Read as _;
use std::path::Path;
use std::process::Command;

use serde_json::Value;

use crate::command::{json, refused, videg};

fn ssp(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = videg(&["ssp", "--output"]);
    command.arg(folder).args(arguments);
    command
}

/// What a successful run prints.
fn packaged(folder: &Path, arguments: &[&str]) -> Value {
    json(&mut ssp(folder, arguments))
}

fn entry(folder: &Path, name: &str) -> String {
    let file = std::fs::File::open(folder.join("Harvester.ssp")).unwrap();
    let mut text = String::new();
    zip::ZipArchive::new(file).unwrap().by_name(name).unwrap().read_to_string(&mut text).unwrap();
    text
}

fn parameters(packaged: &Value) -> Vec<&str> {
    packaged["parameters"].as_array().unwrap().iter().map(|name| name.as_str().unwrap()).collect()
}

#[test]
fn the_package_holds_both_fmus_their_connections_and_the_case() {
    let folder = tempfile::tempdir().unwrap();
    let found = packaged(folder.path(), &["--until", "30"]);
    assert_eq!((&found["case"], &found["warnings"]), (&"fig14".into(), &serde_json::json!([])));
    let set = parameters(&found);
    for name in ["cylinderPosition", "ballPosition", "ballVelocity"] {
        assert!(set.contains(&format!("harvester.initial.{name}").as_str()), "{set:?}");
    }
    let structure = entry(folder.path(), "SystemStructure.ssd");
    for (from, to, signal) in [
        ("harvester", "circuit", "left.capacitance"),
        ("harvester", "circuit", "right.capacitance"),
        ("circuit", "harvester", "left.voltage"),
        ("circuit", "harvester", "right.voltage"),
    ] {
        let connection = format!(
            "startElement=\"{from}\" startConnector=\"{signal}\" endElement=\"{to}\" endConnector=\"{signal}\""
        );
        assert!(structure.contains(&connection), "{connection} is not in {structure}");
    }
    assert!(structure.contains("<ssd:DefaultExperiment startTime=\"0.0\" stopTime=\"30.0\"/>"), "{structure}");
    let master = structure.split_once("<ssc:Annotation type=\"org.openmodelica\">").unwrap().1;
    assert!(master.contains("<oms:FixedStepMaster description=\"oms-ma\" stepSize=\"0.001\" "), "{structure}");
    let file = std::fs::File::open(folder.path().join("Harvester.ssp")).unwrap();
    let mut archive = zip::ZipArchive::new(file).unwrap();
    for fmu in ["VibroImpactHarvester", "HarvestingCircuit"] {
        assert!(archive.by_name(&format!("resources/{fmu}.fmu")).unwrap().size() > 0);
    }
}

/// Start values are left out; the last of a name wins; infinity and odd texts are spelt as XML wants them.
#[test]
fn parameters_are_what_differs_from_the_start_values() {
    let folder = tempfile::tempdir().unwrap();
    let case = folder.path().join("odd.toml");
    std::fs::write(&case, "name = 'a <b> & \"c\"'\ncase = 'fig14'\n").unwrap();
    let settings = [
        "membrane.restitution=0.3",
        "membrane.restitution=0.4",
        "ball.radius=0.005",
        "load.resistance=inf",
        "topology=isolated",
    ];
    let settings: Vec<_> = settings.iter().flat_map(|setting| ["--set", setting]).collect();
    let found = packaged(folder.path(), &[&["--case-file", case.to_str().unwrap()], &*settings].concat());
    let set = parameters(&found);
    assert!(!set.contains(&"harvester.ball.radius") && set.contains(&"circuit.topology"), "{set:?}");
    assert!(found["warnings"][0].as_str().unwrap().contains("circuit.topology is an enumeration"));
    let values = entry(folder.path(), "resources/system.ssv");
    for part in [
        "name=\"a &lt;b&gt; &amp; &quot;c&quot;\"",
        "<ssv:Parameter name=\"harvester.membrane.restitution\">\n      <ssv:Real value=\"0.4\"/>",
        "<ssv:Parameter name=\"circuit.load.resistance\">\n      <ssv:Real value=\"INF\"/>",
        "<ssv:Parameter name=\"circuit.topology\">\n      <ssv:Enumeration value=\"isolated\"/>",
    ] {
        assert!(values.contains(part), "{part} is not in {values}");
    }
}

/// Another geometry has another capacitance at rest than the circuit's start value.
#[test]
fn the_circuit_starts_with_the_capacitances_and_the_voltage_of_the_harvester() {
    let folder = tempfile::tempdir().unwrap();
    let found = packaged(folder.path(), &["--case", "table3-5hz", "--set", "biasVoltage=1500"]);
    let set = parameters(&found);
    for name in ["left.capacitance", "right.capacitance", "supply.voltage", "zener.voltage"] {
        assert!(set.contains(&format!("circuit.{name}").as_str()), "{name} is not in {set:?}");
    }
}

#[test]
fn equal_packages_are_equal_to_the_byte() {
    let folders = [(); 2].map(|()| tempfile::tempdir().unwrap());
    let [first, second] = folders.each_ref().map(|folder| {
        packaged(folder.path(), &[]);
        std::fs::read(folder.path().join("Harvester.ssp")).unwrap()
    });
    assert!(first == second);
}

#[test]
fn what_cannot_run_is_not_packaged() {
    for (arguments, expected) in [
        (&["--set", "ball.weight=1"][..], "ball.weight"),
        (&["--set", "membrane.restitution=2"], "membrane.restitution"),
        (&["--set", "release=storage", "--set", "storage.voltage=1500"], "storage.voltage = 1500 V"),
        (&["--case", "fig8"], "--case fig8"),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let (code, message) = refused(&mut ssp(folder.path(), arguments));
        assert!(code == Some(2) && message.contains(expected), "{arguments:?}: {message}");
        assert!(!folder.path().join("Harvester.ssp").exists());
    }
}
