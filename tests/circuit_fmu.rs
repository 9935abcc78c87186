//! A circuit FMU of the user in place of ours: against our own circuit under other names, against the law of constant charge, and against
//! what a person may get wrong.
#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, clippy::panic, reason = "a panic is how a test fails")]

use std::fs::File;
use std::io::{Read as _, Write as _};
use std::path::{Path, PathBuf};
use std::process::Output;

use proptest::prelude::*;
use serde_json::Value;
use zip::write::SimpleFileOptions;
use zip::{ZipArchive, ZipWriter};

#[path = "support/tool.rs"]
mod tool;
#[path = "hostile/toy.rs"]
#[allow(dead_code, reason = "only its FMUs are used")]
mod toy;

fn cosim(folder: &Path, arguments: &[&str]) -> Output {
    let arguments = [&["cosim", "--json", "--fresh", "--output", "out"][..], arguments].concat();
    tool::tool(arguments).current_dir(folder).output().unwrap()
}

fn run(folder: &Path, arguments: &[&str]) -> Value {
    tool::json(&cosim(folder, arguments), 0)
}

fn number(result: &Value, path: &[&str]) -> f64 {
    path.iter().fold(result, |value, key| &value[*key]).as_f64().unwrap_or_else(|| panic!("{path:?} in {result}"))
}

/// A time series: its names and rows.
fn series(folder: &Path) -> (Vec<String>, Vec<Vec<f64>>) {
    let mut reader = csv::Reader::from_path(folder.join("out/timeseries.csv")).unwrap();
    let names = reader.headers().unwrap().iter().map(str::to_owned).collect();
    let rows = reader.records().map(|row| row.unwrap().iter().map(|it| it.parse().unwrap()).collect());
    (names, rows.collect())
}

fn column(folder: &Path, name: &str) -> Vec<f64> {
    let (names, rows) = series(folder);
    let index = names.iter().position(|it| it == name).unwrap_or_else(|| panic!("{name} in {names:?}"));
    rows.iter().map(|row| row[index]).collect::<Vec<f64>>()
}

/// Our circuit FMU with a description in which each of `changes` is replaced.
fn renamed(folder: &Path, changes: &[(&str, &str)]) -> PathBuf {
    let built = tool::tool(["fmu", "build", "--output"]).arg(folder).output().unwrap();
    assert!(built.status.success(), "{}", tool::said(&built));
    let mut archive = ZipArchive::new(File::open(folder.join("HarvestingCircuit.fmu")).unwrap()).unwrap();
    let path = folder.join("foreign.fmu");
    let mut writer = ZipWriter::new(File::create(&path).unwrap());
    for index in 0..archive.len() {
        let mut entry = archive.by_index(index).unwrap();
        let (name, mut content) = (entry.name().unwrap().into_owned(), Vec::new());
        entry.read_to_end(&mut content).unwrap();
        if name == "modelDescription.xml" {
            let text = String::from_utf8(content).unwrap();
            let changed = changes.iter().fold(text, |text, (from, to)| {
                assert!(text.contains(from), "{from}");
                text.replace(from, to)
            });
            content = changed.into_bytes();
        }
        writer.start_file(name, SimpleFileOptions::default()).unwrap();
        writer.write_all(&content).unwrap();
    }
    writer.finish().unwrap();
    path
}

const NAMES: [(&str, &str); 8] = [
    ("name=\"left.capacitance\"", "name=\"C1\""),
    ("name=\"right.capacitance\"", "name=\"C2\""),
    ("name=\"left.voltage\"", "name=\"u[1]\""),
    ("name=\"right.voltage\"", "name=\"u[2]\""),
    ("name=\"load.energy\"", "name=\"W_load\""),
    ("name=\"supply.energy\"", "name=\"W_in\""),
    ("name=\"stored.energy\"", "name=\"W_stored\""),
    ("name=\"mechanical.energy\"", "name=\"W_mech\""),
];

const MAP: &str = "[map]\nleft.capacitance = \"C1\"\nright.capacitance = \"C2\"\nleft.voltage = \"u[1]\"\n\
                   right.voltage = { variable = \"u[2]\" }\nsupply.energy = \"W_in\"\n[set]\nzener.voltage = 2100\n";

#[test]
fn our_circuit_under_other_names_gives_the_same_numbers() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    renamed(folder, &NAMES);
    std::fs::write(folder.join("map.toml"), MAP).unwrap();
    let given = [
        "--until",
        "10",
        "--set",
        "contact.law=compliant",
        "--set",
        "contact.electrostaticFeedback=true",
        "--set",
        "load.resistance=3e8",
    ];
    let ours = run(folder, &[&given[..], &["--circuit", "fmu", "--set", "zener.voltage=2100"]].concat());
    let foreign = ["--circuit-fmu", "foreign.fmu", "--map-file", "map.toml", "--map", "load.energy=W_load"];
    let without = run(folder, &[&given[..], &foreign].concat());
    // What is not mapped is worked out from C(t) and U(t), and what cannot be is null.
    for key in ["load", "supply", "zener", "diode", "leakage", "converted"] {
        assert_eq!(without["energy"][key], ours["energy"][key], "{key}");
    }
    // The work has the voltages at the communication points only, 1 ms apart.
    for (key, tolerance) in [("stored", 1e-9), ("mechanical", 2e-3)] {
        let (found, expected) = (number(&without, &["energy", key]), number(&ours, &["energy", key]));
        assert!((found / expected - 1.0).abs() < tolerance, "{key}: {found} against {expected}");
    }
    assert!((number(&without, &["net_power"]) / number(&ours, &["net_power"]) - 1.0).abs() < 1e-6);
    assert!(number(&without, &["balance", "relative_residual"]) < 1e-3);
    let all =
        [&given[..], &foreign, &["--map", "stored.energy=W_stored", "--map", "mechanical.energy=W_mech"]].concat();
    let with = run(folder, &[&all[..], &["--probe", "W_mech,load.current"]].concat());
    for key in
        ["net_power", "load_power", "supply_power", "energy", "charge", "impacts", "average_voltage_gain", "coupling"]
    {
        assert_eq!(with[key], ours[key], "{key}");
    }
    assert_eq!(column(folder, "W_mech"), column(folder, "mechanical.energy"));
    let adaptive = run(folder, &[&all[..], &["--adaptive", "1e-4"]].concat());
    assert!((number(&adaptive, &["energy", "load"]) / number(&ours, &["energy", "load"]) - 1.0).abs() < 1e-2);
}

/// Membranes with constant charge: u = Q / C. The capacitances are the inputs 0 and 1, the voltages the outputs 2 and 3, the
/// voltages at the start the parameters 4 and 5, all in the units of the FMU.
const CHARGE: [&str; 2] = [
    "BEGIN=self->kept=self->u[0]*self->u[4];",
    "VALUE(v)=((v)==2?self->kept/self->u[0]:(v)==3?self->kept/self->u[1]:self->u[(v)%8])",
];

fn variable(index: usize, name: &str, causality: &str, unit: &str) -> String {
    let (variability, start) = match causality {
        "parameter" => ("fixed\" initial=\"exact", " start=\"1\""),
        "input" => ("continuous", " start=\"1\""),
        _ => ("continuous", ""),
    };
    let unit = if unit.is_empty() { String::new() } else { format!(" unit=\"{unit}\"") };
    format!(
        "<ScalarVariable name=\"{name}\" valueReference=\"{index}\" causality=\"{causality}\" variability=\"{variability}\">\
         <Real{unit}{start}/></ScalarVariable>"
    )
}

const CAPABLE: &str = "canHandleVariableCommunicationStepSize=\"true\" canGetAndSetFMUstate=\"true\"";

/// A description with capacitances and voltages in these units.
fn description(capacitance: &str, voltage: &str, capabilities: &str) -> String {
    let variables = [
        variable(0, "C left", "input", capacitance),
        variable(1, "C right", "input", capacitance),
        variable(2, "u*left", "output", voltage),
        variable(3, "u*right", "output", voltage),
        variable(4, "u0", "parameter", voltage),
        "<ScalarVariable name=\"count\" valueReference=\"0\" causality=\"output\"><Integer/></ScalarVariable>"
            .to_owned(),
    ];
    let unit = |name: &str, base: &str| format!("<Unit name=\"{name}\"><BaseUnit {base}/></Unit>");
    let farad = "kg=\"-1\" m=\"-2\" s=\"4\" A=\"2\"";
    let units = [
        unit("pF", &format!("{farad} factor=\"1e-12\"")),
        unit("kV", "kg=\"1\" m=\"2\" s=\"-3\" A=\"-1\" factor=\"1000\""),
        unit("K", "K=\"1\""),
        unit("degree", "kg=\"1\" m=\"2\" s=\"-3\" A=\"-1\" offset=\"3\""),
        "<Unit name=\"odd\"/>".to_owned(),
    ];
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<fmiModelDescription fmiVersion=\"2.0\" modelName=\"Charge\" guid=\"g\">\
         <CoSimulation modelIdentifier=\"Toy\" {capabilities}/><UnitDefinitions>{}</UnitDefinitions>\
         <ModelVariables>{}</ModelVariables><ModelStructure><Outputs><Unknown index=\"3\"/><Unknown index=\"4\"/>\
         <Unknown index=\"6\"/></Outputs></ModelStructure></fmiModelDescription>",
        units.concat(),
        variables.concat()
    )
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 12, ..ProptestConfig::default() })]

    #[test]
    fn constant_charge_is_kept_in_any_units(
        scale in prop_oneof![Just(None), (-12.0..12.0_f64, prop::bool::ANY).prop_map(Some)],
        restitution in 0.1..1.0_f64,
        start in 10.0..5000.0_f64,
        side in 0_usize..2,
        feedback in prop::bool::ANY,
        capable in prop::bool::ANY,
    ) {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        // Units that the FMU defines are converted; without units the factor is given.
        let (units, factors) = match scale {
            None => (["pF", "kV"], [1e12, 1e-3]),
            Some((exponent, negative)) => (["", ""], [10.0_f64.powf(exponent), if negative { -0.25 } else { 4.0 }]),
        };
        let capabilities = if capable { CAPABLE } else { "canHandleVariableCommunicationStepSize=\"true\"" };
        // The membrane that is used has the first input and the first output.
        toy::described(folder, "charge.fmu", &description(units[0], units[1], capabilities), &CHARGE);
        let name = ["left", "right"][side];
        let given = |factor: f64| scale.map_or_else(String::new, |_| format!("*{factor:e}"));
        let maps = [
            format!("{name}.capacitance=C left{}", given(factors[0])),
            format!("{name}.voltage=u*left{}", given(factors[1])),
            format!("{}=none", ["right", "left"][side]),
        ];
        let sets = [
            format!("u0={:e}", start * factors[1]),
            format!("membrane.restitution={restitution}"),
            format!("contact.electrostaticFeedback={feedback}"),
            format!("contact.law={}", if feedback { "compliant" } else { "impulsive" }),
        ];
        let mut words = vec!["--circuit-fmu", "charge.fmu", "--until", "3", "--probe", "u0"];
        words.extend(maps.iter().flat_map(|map| ["--map", map]));
        words.extend(sets.iter().flat_map(|set| ["--set", set]));
        if capable && feedback {
            words.extend(["--adaptive", "1e-3"]);
        }
        let result = run(folder, &words);
        prop_assert!(number(&result, &["impacts"]) > 0.0);
        prop_assert!(result["net_power"].is_null() && result["energy"]["load"].is_null());
        let capacitance = column(folder, &format!("{name}.capacitance"));
        let voltage = column(folder, &format!("{name}.voltage"));
        let charge: f64 = capacitance[0] * start;
        for (c, u) in capacitance.iter().zip(&voltage) {
            let found: f64 = c * u;
            prop_assert!((found / charge - 1.0).abs() < 1e-12, "{found} C against {charge} C");
        }
        let other = column(folder, &format!("{}.voltage", ["right", "left"][side]));
        prop_assert!(other.iter().all(|u| *u == 0.0));
        // All work of the mechanics is stored.
        let (c, initial) = (capacitance.last().unwrap(), 0.5 * capacitance[0] * start.powi(2));
        let gained = 0.5 * charge.powi(2) / c - initial;
        for key in ["stored", "mechanical"] {
            let found = number(&result, &["energy", key]);
            prop_assert!((found - gained).abs() < 1e-10 * initial, "{key}: {found} against {gained}");
        }
        let largest = capacitance.iter().copied().fold(0.0, f64::max);
        prop_assert!(largest > 1.05 * capacitance[0]);
    }
}

const BOTH: [&str; 8] = [
    "--map",
    "left.capacitance=C left",
    "--map",
    "right.capacitance=C right",
    "--map",
    "left.voltage=u*left",
    "--map",
    "right.voltage=u*right",
];

#[test]
fn a_mapping_that_cannot_be_is_refused_before_the_run() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    toy::described(folder, "charge.fmu", &description("pF", "kV", CAPABLE), &CHARGE);
    toy::described(folder, "stiff.fmu", &description("pF", "kV", ""), &CHARGE);
    for (name, units) in [("kelvin", "K"), ("undefined", "odd"), ("offset", "degree")] {
        toy::described(folder, &format!("{name}.fmu"), &description("pF", units, CAPABLE), &CHARGE);
    }
    for (name, text) in [
        ("key.toml", "[maps]\n"),
        ("list.toml", "[map]\nleft.voltage = [1]\n"),
        ("zero.toml", "[map]\nleft.voltage = { variable = \"u*left\", factor = 0 }\n"),
        ("odd.toml", "[map]\nleft.voltage = { variable = \"u*left\", scale = 1 }\n"),
        ("input.toml", "[set]\n\"C left\" = 3\n"),
        ("unknown.toml", "[set]\nu1 = 3\n"),
    ] {
        std::fs::write(folder.join(name), text).unwrap();
    }
    let map = |extra: &[&'static str]| [&BOTH[..], extra].concat();
    let cases: [(&str, Vec<&str>, &[&str]); 25] = [
        ("charge", vec![], &["--map left.capacitance=VARIABLE", "is missing", "C left, C right", "--map left=none"]),
        ("charge", BOTH[..4].to_vec(), &["--map left.voltage=VARIABLE", "u*left, u*right"]),
        ("charge", BOTH[..6].to_vec(), &["--map right.voltage=VARIABLE", "--map right=none"]),
        ("charge", vec!["--map", "left.voltage=u*lef"], &["left.voltage=u*lef", "did you mean \"u*left\""]),
        ("charge", vec!["--map", "left.voltag=u*left"], &["left.voltag=u*left", "did you mean left.voltage?"]),
        ("charge", vec!["--map", "left.voltage"], &["--map left.voltage", "NAME=VARIABLE"]),
        ("charge", map(&["--map", "left.voltage=u0"]), &["is given twice"]),
        ("charge", vec!["--map", "left=none", "--map", "right=none"], &["a membrane at least is needed"]),
        ("charge", map(&["--map", "left=none"]), &["there is no left membrane"]),
        ("charge", vec!["--map", "left.voltage=none"], &["left=none"]),
        ("charge", vec!["--map", "left=C left"], &["allowed: none"]),
        ("charge", vec!["--map", "left.capacitance=u*left"], &["causality output", "allowed is an input"]),
        ("charge", map(&["--map", "load.energy=C left"]), &["causality input", "allowed is an output"]),
        ("charge", map(&["--map", "load.energy=count"]), &["type Integer, allowed is Real"]),
        ("charge", map(&["--map", "load.energy=u*left"]), &["is in kV", "no multiple of J"]),
        ("charge", vec!["--map", "left.voltage=u*left*0"], &["factor 0"]),
        ("kelvin", BOTH.to_vec(), &["is in K", "no multiple of V"]),
        ("undefined", BOTH.to_vec(), &["is in odd", "give a factor"]),
        ("offset", BOTH.to_vec(), &["is in degree", "allowed are multiples"]),
        ("charge", map(&["--set", "u1=3"]), &["--set u1", "did you mean u0?"]),
        ("charge", map(&["--set", "C left=3"]), &["--set C left", "an input that the harvester sets"]),
        ("charge", map(&["--probe", "u1"]), &["--probe u1", "did you mean u0?"]),
        ("stiff", BOTH.to_vec(), &["canHandleVariableCommunicationStepSize", "--master plain"]),
        ("stiff", map(&["--master", "plain", "--until", "1.00005"]), &["1.00005 is not", "multiples of --step 0.001"]),
        ("stiff", map(&["--adaptive", "1e-3"]), &["--adaptive", "\"Charge\" cannot"]),
    ];
    for (fmu, words, parts) in cases {
        let fmu = format!("{fmu}.fmu");
        let until = if words.contains(&"--until") { &[][..] } else { &["--until", "1"] };
        let output = cosim(folder, &[&["--circuit-fmu", &fmu][..], until, &words].concat());
        tool::assert_refused(&output, parts);
    }
    for (file, parts) in [
        ("key.toml", ["key.toml", "maps"]),
        ("list.toml", ["list.toml: map.left.voltage", "array"]),
        ("zero.toml", ["map.left.voltage", "factor 0"]),
        ("odd.toml", ["map.left.voltage", "scale"]),
        ("input.toml", ["input.toml: set.C left", "an input that the harvester sets"]),
        ("unknown.toml", ["unknown.toml: set.u1", "u0"]),
        ("missing.toml", ["cannot read missing.toml", "No such file"]),
    ] {
        let words = [&["--circuit-fmu", "charge.fmu", "--until", "1", "--map-file", file][..], &BOTH].concat();
        tool::assert_refused(&cosim(folder, &words), &parts);
    }
    let options = |words: &[&str]| cosim(folder, words);
    tool::assert_refused(&options(&["--map", "left=none"]), &["--circuit-fmu"]);
    tool::assert_refused(&options(&["--circuit-fmu", "charge.fmu", "--circuit", "fmu"]), &["--circuit"]);
    tool::assert_refused(&options(&["--circuit-fmu", "charge.fmu", "--netlist", "a.cir"]), &["--netlist"]);
    let plain = [&["--circuit-fmu", "stiff.fmu", "--until", "1", "--master", "plain"][..], &BOTH].concat();
    let result = run(folder, &plain);
    assert_eq!(number(&result, &["coupling", "steps"]), 1000.0);
}

#[test]
fn an_fmu_that_fails_ends_the_run_but_not_the_tool() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for (name, step, parts) in [
        ("crash", "STEP=if(time>0.5)abort();", ["0.5", "SIGABRT"]),
        ("hang", "STEP=if(time>0.5)for(;;);", ["time-limit", "1 s"]),
        ("nan", "STEP=if(time>0.5)self->kept=0.0/0.0;", ["u*left = NaN", "finite"]),
        ("error", "STEP=if(time>0.5)return 3;", ["fmi2DoStep", "Error"]),
    ] {
        let macros = [CHARGE[0], CHARGE[1], step];
        toy::described(folder, &format!("{name}.fmu"), &description("pF", "kV", CAPABLE), &macros);
        let fmu = format!("{name}.fmu");
        let words = [&["--circuit-fmu", &fmu, "--until", "1", "--time-limit", "1"][..], &BOTH].concat();
        let output = cosim(folder, &words);
        assert_eq!(output.status.code(), Some(2), "{name}: {}", tool::said(&output));
        let said = tool::said(&output);
        assert!(parts.iter().any(|part| said.contains(part)) && said.contains("timeseries.csv.part"), "{name}: {said}");
    }
}
