//! Sweeps over harvester and circuit.

use std::fs;
use std::path::Path;

use crate::command::{
    assert_same_results, column, cut_after, done, folder, json, refused, rows, run_though_killed, size, stderr, sweep,
    videg,
};

/// The circuit with isolated membranes and a switch.
const BETTER: [&str; 4] = ["--set", "topology=isolated", "--set", "release=switch"];

const VARIED: [&str; 4] = ["--vary", "zener.voltage=2100:2700:4", "--vary", "membrane.restitution=0.3:0.9:5"];

fn numbers(folder: &Path, name: &str) -> Vec<f64> {
    column(folder, name).iter().map(|text| text.parse().unwrap()).collect()
}

#[test]
#[ignore = "slow"]
fn powers_are_those_of_co_simulation() {
    let (_guard, folder) = folder();
    let film = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/film.csv");
    let film = format!("membrane.file={film}");
    for (round, what) in [
        vec!["--set", "zener.voltage=2450"],
        vec!["--set", "release=storage"],
        vec!["--set", "zener.voltage=2200", "--set", "leakage.timeConstant=10", "--set", "load.resistance=1e10"],
        vec!["--set", "membrane.law=table", "--set", &film, "--set", "zener.voltage=2300"],
        vec!["--set", "contact.law=compliant", "--set", "zener.voltage=2300"],
    ]
    .into_iter()
    .enumerate()
    {
        let swept = folder.join(round.to_string());
        let what = [&BETTER[..], &what].concat();
        let given = ["--record", "net_power", "--record", "load.energy", "--record", "ball.position"];
        let varied = ["--vary", "membrane.restitution=0.6,0.8"];
        let sweep = [&["sweep", "--until", "6"][..], &what, &given, &varied, &["--output"]].concat();
        done(videg(&sweep).arg(&swept));
        let single = ["cosim", "--until", "6", "--step", "1e-4", "--set", "membrane.restitution=0.8", "--output"];
        let run = json(videg(&[&single[..1], &what, &single[1..]].concat()).arg(swept.join("cosim")));
        let expected = run["net_power"].as_f64().unwrap();
        let supply = run["supply_power"].as_f64().unwrap();
        let found = numbers(&swept, "net_power")[1];
        assert!((found - expected).abs() < 1e-3 * supply, "{what:?}: {found:e} against {expected:e}");
        let load = run["energy"]["load"].as_f64().unwrap();
        assert!((numbers(&swept, "load.energy")[1] - load).abs() < 1e-3 * load, "{what:?}");
        let position = numbers(&swept, "ball.position")[1];
        assert!(position.abs() < 1.0 && position != 0.0, "{position}");
        let gain = run["average_voltage_gain"].as_f64().unwrap();
        assert!((numbers(&swept, "average_voltage_gain")[1] / gain - 1.0).abs() < 1e-9);
    }
}

#[test]
fn coupled_sweeps_have_the_same_bytes_in_shards_and_after_a_cut() {
    let (_guard, folder) = folder();
    let [whole, shared, merged, cut] = ["whole", "shared", "merged", "cut"].map(|name| folder.join(name));
    let noisy = ["--set", "excitation.phaseNoise=0.5", "--set", "excitation.noiseHold=1e-3", "--samples", "2"];
    let what = [&BETTER[..], &VARIED, &noisy].concat();
    done(&mut sweep(&whole, &what));
    // Powers are recorded though nobody asked.
    assert_eq!(rows(&whole)[0][9..12], ["net_power", "load_power", "supply_power"]);
    for shard in ["1/3", "2/3", "3/3"] {
        done(sweep(&shared, &what).args(["--shard", shard, "--jobs", "1"]));
    }
    done(videg(&["sweep", "merge", "--output"]).arg(&merged).arg(&shared));
    assert_same_results(&whole, &merged);
    let complete = cut_after(size(&whole) / 2, &whole, &cut, b"");
    assert!(complete > 10);
    assert_eq!(json(&mut sweep(&cut, &what))["resumed_from"], complete);
    assert_same_results(&whole, &cut);
}

#[test]
fn a_coupled_sweep_that_is_killed_again_and_again_comes_to_the_same_bytes() {
    let (_guard, folder) = folder();
    let [whole, killed] = ["whole", "killed"].map(|name| folder.join(name));
    let what =
        [&BETTER[..], &["--vary", "membrane.restitution=0.3:0.9:40", "--vary", "zener.voltage=2100:2700:30"]].concat();
    done(&mut sweep(&whole, &what));
    run_though_killed(|| sweep(&killed, &what));
    assert_same_results(&whole, &killed);
}

/// C(t) of a harvester that runs with many circuits is kept, whichever axis comes first and however many threads there are.
#[test]
fn the_order_of_runs_leaves_their_numbers() {
    let (_guard, folder) = folder();
    let films = [("0.3", "2100.0"), ("0.3", "2700.0"), ("0.6", "2100.0"), ("0.6", "2700.0")];
    let axes = ["membrane.restitution=0.3,0.6", "zener.voltage=2100,2300,2500,2700"];
    let of = |name: &str, order: [&str; 2], jobs: &str| {
        let to = folder.join(name);
        done(&mut sweep(&to, &[&BETTER[..], &["--vary", order[0], "--vary", order[1], "--jobs", jobs]].concat()));
        let names = ["membrane.restitution", "zener.voltage", "net_power", "load_power", "average_voltage_gain"];
        let mut rows: Vec<_> = (0..8).map(|k| names.map(|name| column(&to, name)[k].clone())).collect();
        rows.sort();
        rows
    };
    let one = of("one", axes, "1");
    assert_eq!(one, of("two", axes, "2"));
    assert_eq!(one, of("other", [axes[1], axes[0]], "2"));
    for (k, (restitution, voltage)) in films.into_iter().enumerate() {
        let (single, varied) = (folder.join(k.to_string()), format!("zener.voltage={voltage}"));
        let set = format!("membrane.restitution={restitution}");
        let set = ["--set", &set, "--vary", &varied];
        done(&mut sweep(&single, &[&BETTER[..], &set].concat()));
        let row = one.iter().find(|row| row[0] == restitution && row[1] == voltage).unwrap();
        assert_eq!(column(&single, "net_power"), [row[2].clone()]);
    }
}

/// What the two FMUs and the sweep have, by their own lists.
#[test]
fn every_variable_can_be_recorded_and_every_quantity_varied() {
    let (_guard, folder) = folder();
    let harvester = fmu_import::ModelDescription::parse(&description("VibroImpactHarvester"), "harvester").unwrap();
    let circuit = fmu_import::ModelDescription::parse(&description("HarvestingCircuit"), "circuit").unwrap();
    let variables = || harvester.variables.iter().chain(circuit.variables.iter().filter(|it| !it.is_input()));
    let texts = |it: &&fmu_import::Variable| !matches!(it.kind, fmu_import::Kind::String { .. });
    let mut names: Vec<String> = variables().filter(texts).map(|it| it.name.clone()).collect();
    names.retain(|name| name != "switch.band");
    names.extend(["net_power", "load_power", "supply_power", "field_over_limit"].map(str::to_owned));
    names.sort();
    names.dedup();
    assert!(names.len() > 120, "{}", names.len());
    let record: Vec<&str> = names.iter().flat_map(|name| ["--record", name]).collect();
    done(&mut sweep(&folder.join("recorded"), &[&BETTER[..], &["--vary", "switch.band=0.02,0.03"], &record].concat()));
    let head = rows(&folder.join("recorded"))[0].clone();
    for name in &names {
        assert!(head.contains(name), "{name} is not among {head:?}");
    }
    let mut varied = 0;
    for variable in variables().filter(|it| it.is_settable()) {
        let fmu_import::Kind::Real { start: Some(start), .. } = variable.kind else { continue };
        let vary = format!("{}={start:?}", variable.name);
        let to = folder.join(&variable.name);
        let output = sweep(&to, &["--set", "topology=isolated", "--vary", &vary]).output().unwrap();
        if variable.is_input() {
            assert!(stderr(&output).contains("a sweep with a circuit cannot set it"), "{vary}: {}", stderr(&output));
            continue;
        }
        assert!(output.status.success() || stderr(&output).contains("runs failed"), "{vary}: {}", stderr(&output));
        varied += 1;
    }
    assert!(varied > 50, "{varied}");
}

fn description(name: &str) -> Vec<u8> {
    fs::read(format!("{}/modelDescription/{name}.xml", env!("CARGO_MANIFEST_DIR"))).unwrap()
}

#[test]
fn what_a_coupled_sweep_cannot_do_is_said() {
    let (_guard, folder) = folder();
    let (code, said) = refused(&mut sweep(&folder, &["--set", "zener.volt=3", "--vary", "ball.mass=1e-3,2e-3"]));
    assert!(code == Some(2) && said.contains("did you mean zener.voltage?"), "{said}");
    let (code, said) = refused(&mut sweep(&folder, &["--vary", "load.resistance=-3:-1:3"]));
    assert!(code == Some(2) && said.contains("load.resistance"), "{said}");
    let (_, said) = refused(&mut sweep(&folder, &["--set", "net_power=1", "--vary", "ball.mass=1e-3,2e-3"]));
    assert!(said.contains("net_power") && said.contains("cannot be set"), "{said}");
    let missing = ["--set", "excitation.file=none.csv", "--vary", "load.resistance=1e8,1e9"];
    let (code, said) = refused(&mut sweep(&folder, &missing));
    assert!(code == Some(2) && said.contains("excitation.file") && said.contains("none.csv"), "{said}");
    // A point that the circuit refuses is a row with its reason.
    let output = done(&mut sweep(&folder, &["--vary", "zener.voltage=1000,2000"]));
    assert!(stderr(&output).contains("1 of 2 runs failed"));
    assert!(column(&folder, "error")[0].contains("zener.voltage = 1000 V is below supply.voltage"));
    let feedback = ["--set", "contact.law=compliant", "--set", "contact.electrostaticFeedback=true"];
    let again = folder.join("feedback");
    let output = sweep(&again, &[&feedback[..], &["--vary", "load.resistance=1e8,1e9"]].concat()).output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    assert!(column(&again, "error")[0].contains("contact.electrostaticFeedback"));
}
