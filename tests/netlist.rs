//! A netlist of the user, live with the harvester: against the built-in circuits, against laws of conservation and against
//! what a person may get wrong.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a panic is how a test fails")]
#![allow(clippy::format_push_string, reason = "a netlist is text, line by line")]

use std::path::Path;
use std::process::Output;

use proptest::prelude::*;
use serde_json::Value;
use tempfile::TempDir;

#[path = "support/tool.rs"]
mod tool;

/// Near-ideal diodes, as the built-in circuits have them.
const MODELS: &str = ".model charging D(IS=1e-13 N=0.01 RS=0 CJO=0)\n.options temp=27 tnom=27\n";

/// The paper's circuit as a person writes it.
fn paper(load: f64, zener: f64) -> String {
    format!(
        "The circuit of Fig. 8(a)\nVin in 0 2000\nDcharge in de charging\nXl de 0 deg_left\nXr de 0 deg_right\n\
         Dzener out de zener\nRload out 0 {load:e}\n.ic v(in)=2000 v(de)=2000\n{MODELS}\
         .model zener D(IS=1e-13 N=0.01 BV={zener:e} IBV=1e-13 NBV=0.01 RS=0 CJO=0)\n.tran 1m 1 uic\n.end\n"
    )
}

/// Each membrane with diodes of its own, into a storage.
fn storage(voltage: f64) -> String {
    format!(
        "Isolated membranes\nVin in 0 2000\n.subckt side m s\nDstorage m s charging\n.ends\n\
         D1 in l charging\nD2 in r charging\nXl l 0 deg_left\nXr r 0 deg_right\nXs1 l out side\nXs2 r out side\n\
         Vstorage out 0 {voltage:e}\n.ic v(in)=2000 v(l)=2000 v(r)=2000 v(out)={voltage:e}\n{MODELS}.end\n"
    )
}

fn folder(netlist: &str) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("my.cir"), netlist).unwrap();
    folder
}

fn cosim(folder: &Path, arguments: &[&str]) -> Output {
    let arguments = [&["cosim", "--json", "--fresh", "--output", "out"][..], arguments].concat();
    tool::tool(arguments).current_dir(folder).output().unwrap()
}

/// The result of a run with this netlist.
fn run(netlist: &str, arguments: &[&str]) -> Value {
    let folder = folder(netlist);
    tool::json(&cosim(folder.path(), &[&["--netlist", "my.cir"][..], arguments].concat()), 0)
}

fn built_in(arguments: &[&str]) -> Value {
    let folder = tempfile::tempdir().unwrap();
    tool::json(&cosim(folder.path(), arguments), 0)
}

fn number(result: &Value, path: &[&str]) -> f64 {
    path.iter().fold(result, |value, key| &value[*key]).as_f64().unwrap_or_else(|| panic!("{path:?} in {result}"))
}

/// The sum of the energies of all elements over half of the sum without signs.
fn closure(result: &Value) -> f64 {
    let energies: Vec<_> = result["elements"].as_object().unwrap().values().map(|it| it.as_f64().unwrap()).collect();
    energies.iter().sum::<f64>().abs() / (0.5 * energies.iter().map(|it| it.abs()).sum::<f64>())
}

fn ngspice_is_missing() -> bool {
    let missing = tool::tool(["cosim", "--circuit", "ngspice", "--until", "0.01", "--json"])
        .current_dir(tempfile::tempdir().unwrap().path())
        .output()
        .is_ok_and(|output| tool::said(&output).contains("cannot load the shared library"));
    missing && std::env::var_os("VIDEG_ALL_TOOLS").is_none()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 3, ..ProptestConfig::default() })]

    #[test]
    #[ignore = "slow"]
    fn the_built_in_circuits_written_by_hand_give_their_energies(
        load in 8.0..11.0_f64, zener in 2000.0..2300.0_f64, out in 2050.0..2500.0_f64, restitution in 0.5..0.9_f64
    ) {
        if ngspice_is_missing() {
            return Ok(());
        }
        let load = 10_f64.powf(load);
        let common = ["--until".to_owned(), "5".to_owned(), "--set".to_owned(), format!("membrane.restitution={restitution}")];
        let of = |settings: &[String]| {
            let all: Vec<_> = common.iter().cloned().chain(settings.iter().flat_map(|it| ["--set".to_owned(), it.clone()])).collect();
            all
        };
        let paper_settings = [format!("load.resistance={load}"), format!("zener.voltage={zener}")];
        let storage_settings =
            ["topology=isolated".to_owned(), "release=storage".to_owned(), format!("storage.voltage={out}")];
        for (netlist, settings, arguments) in [
            (paper(load, zener), &paper_settings[..], vec![]),
            (storage(out), &storage_settings[..], vec!["--gain", "Vstorage", "--cost", "Vin"]),
        ] {
            let common: Vec<_> = common.iter().map(String::as_str).collect();
            let own = run(&netlist, &[&common[..], &arguments].concat());
            let of = of(settings);
            let of: Vec<_> = of.iter().map(String::as_str).collect();
            let ngspice = built_in(&[&["--circuit", "ngspice"], &of[..]].concat());
            let embedded = built_in(&[&["--set", "diode.model=exponential"], &of[..]].concat());
            let moved = number(&ngspice, &["energy", "supply"]).abs();
            for key in ["supply", "load", "stored", "mechanical"] {
                let [own, ngspice, embedded] = [&own, &ngspice, &embedded].map(|it| number(it, &["energy", key]));
                // Two runs of ngspice with reltol = 1e-8.
                prop_assert!((own - ngspice).abs() <= 1e-8 * moved, "{key}: {own} for {ngspice} of {moved}");
                prop_assert!((own - embedded).abs() <= 1e-4 * moved, "{key}: {own} for {embedded} of {moved}");
            }
            prop_assert!(closure(&own) < 1e-9, "{}", closure(&own));
        }
    }

    /// Resistors, capacitors, inductors, sources, a bridge of diodes and a transistor with random values between the membranes and a chain of nodes.
    #[test]
    #[ignore = "slow"]
    fn the_ledger_of_any_circuit_closes(values in prop::collection::vec((0..6_usize, -1.0..1.0_f64), 6..14), frequency in 1.0..200.0_f64) {
        if ngspice_is_missing() {
            return Ok(());
        }
        let mut netlist = format!("Random\nVin in 0 100\nVac n0 0 sin(0 50 {frequency})\nRac n0 0 1meg\n");
        for (k, (kind, value)) in values.iter().enumerate() {
            let (a, b, scale) = (format!("n{k}"), format!("n{}", k + 1), 10_f64.powf(*value));
            netlist += &match kind {
                0 => format!("R{k} {a} {b} {}\n", 1e5 * scale),
                1 => format!("R{k} {a} {b} {}\nC{k} {b} 0 {}\n", 1e4 * scale, 1e-8 * scale),
                2 => format!("L{k} {a} {b} {}\nRl{k} {b} 0 {}\n", scale, 1e6 * scale),
                3 => format!("D{k} {a} {b} d1\nRd{k} {b} 0 {}\n", 1e6 * scale),
                4 => format!(
                    "Da{k} {a} p{k} d1\nDb{k} 0 p{k} d1\nDc{k} q{k} {a} d1\nDd{k} q{k} 0 d1\nRb{k} p{k} q{k} {}\n\
                     Rp{k} p{k} 0 1e8\nRq{k} q{k} 0 1e8\nR{k} {a} {b} 1e5\n",
                    1e5 * scale
                ),
                _ => format!("B{k} {b} 0 v=V({a})*{value}\nRv{k} {b} 0 1e6\n"),
            };
        }
        netlist += &format!(
            "Xl in0 0 deg_left\nRin in in0 1e7\nDx in0 mid d1\nXr mid 0 deg_right\nRmid mid n{} 1e9\n\
             .model d1 d(is=1e-12 n=1 cjo=0)\n.options reltol=1e-6 abstol=1e-10 gmin=1e-14\n.tran 1m 1\n.end\n",
            values.len()
        );
        let result = run(&netlist, &["--until", "0.5"]);
        prop_assert!(closure(&result) < 1e-5, "{}: {netlist}\n{result}", closure(&result));
    }
}

#[test]
fn with_electrostatic_feedback_the_balance_closes_to_the_order_of_the_coupling() {
    if ngspice_is_missing() {
        return;
    }
    let residual = |step: &str| {
        let feedback = [
            "--set",
            "contact.electrostaticFeedback=true",
            "--set",
            "contact.law=compliant",
            "--until",
            "4",
            "--step",
            step,
        ];
        let result = run(&paper(1e9, 2000.0), &feedback);
        assert!(number(&result, &["balance", "converted"]) > 0.0);
        number(&result, &["balance", "residual"]).abs()
    };
    let [coarse, fine] = ["2e-3", "5e-4"].map(residual);
    // Second order: a sixteenth; a step at a corner of a diode may cost some of it.
    assert!(fine < coarse / 6.0, "{coarse} {fine}");
}

#[test]
fn a_membrane_alone_keeps_its_charge_and_one_that_is_not_there_has_no_voltage() {
    if ngspice_is_missing() {
        return;
    }
    let netlist = "Alone\nXLeft Node 0 deg_left\nRbleed node 0 1e18\n.ic v(node)=1k\n.tran 1m 1 0 1m uic\n.end\n";
    let folder = folder(netlist);
    let arguments = ["--netlist", "my.cir", "--probe", "Node,v(node)", "--until", "2"];
    let result = tool::json(&cosim(folder.path(), &arguments), 0);
    assert_eq!(result["elements"].as_object().unwrap().keys().collect::<Vec<_>>(), ["Rbleed", "XLeft"]);
    let text = std::fs::read_to_string(folder.path().join("out/timeseries.csv")).unwrap();
    let rows: Vec<Vec<&str>> = text.lines().map(|line| line.split(',').collect()).collect();
    let column = |name: &str| rows[0].iter().position(|it| *it == name).unwrap();
    let value = |row: &[&str], name: &str| row[column(name)].parse::<f64>().unwrap();
    let charge = 1000.0 * value(&rows[1], "left.capacitance");
    let mut largest = 0.0_f64;
    for row in &rows[1..] {
        let [voltage, probe] = ["left.voltage", "Node"].map(|name| value(row, name));
        assert_eq!((voltage, value(row, "right.voltage")), (probe, 0.0));
        assert_eq!(probe, value(row, "v(node)"));
        let kept = voltage * value(row, "left.capacitance") / charge;
        assert!((kept - 1.0).abs() < 1e-6, "{kept}");
        largest = largest.max(1000.0 - voltage);
    }
    assert!(largest > 100.0, "the membrane is pressed in: {largest} V");
}

#[test]
fn powers_are_those_of_the_window_and_names_those_of_the_netlist() {
    if ngspice_is_missing() {
        return;
    }
    let netlist = paper(1e10, 2000.0);
    let whole = ["--until", "4", "--window", "0,4"];
    let result = run(&netlist, &[&whole[..], &["--gain", "rload", "--cost", "VIN"]].concat());
    let energy = |key| number(&result, &["energy", key]);
    let power = (energy("load") - energy("supply") + energy("stored")) / 4.0;
    assert!((number(&result, &["net_power"]) / power - 1.0).abs() < 1e-12);
    assert_eq!(number(&result, &["elements", "Rload"]), energy("load"));
    assert_eq!(number(&result, &["elements", "Vin"]), -energy("supply"));
    // The heat of the Zener diode may be what somebody is after.
    let heat = run(&netlist, &[&whole[..], &["--gain", "Rload,Dzener"]].concat());
    let sum = number(&result, &["elements", "Rload"]) + number(&result, &["elements", "Dzener"]);
    assert!((number(&heat, &["load_power"]) / (sum / 4.0) - 1.0).abs() < 1e-9);
}

#[test]
fn what_does_not_fit_is_refused_before_the_run() {
    if ngspice_is_missing() {
        return;
    }
    let netlist = paper(1e9, 2000.0);
    let two = netlist.replace("Xr de 0 deg_right", "Xr de 0 deg_left");
    let none = netlist.replace("deg_left", "side").replace("deg_right", "side") + "";
    let none = none.replace(".end\n", ".subckt side a b\nR1 a b 1\n.ends\n.end\n");
    for (netlist, arguments, expected) in [
        (&netlist, &["--gain", "Rlaod"][..], "--gain Rlaod: the netlist has no such element; did you mean rload?"),
        (&netlist, &["--cost", "Xl"], "--cost Xl: is a membrane"),
        (&netlist, &["--gain", "Rload", "--cost", "Rload"], "--cost Rload: is a gain, too"),
        (&netlist, &["--probe", "ot"], "--probe ot: the netlist has no such node; did you mean out?"),
        (&netlist, &["--probe", "i(Rload)"], "--probe i(Rload): the netlist has no such voltage source"),
        (&netlist, &["--set", "load.resistance=1e9"], "load.resistance: with --netlist the netlist has the values"),
        (&netlist, &["--circuit", "ngspice"], "cannot be used with"),
        (&netlist, &["--adaptive", "1e-4"], "cannot"),
        (&two, &[], "deg_left is in the circuit twice, as xl and xr"),
        (&none, &[], "the circuit has no membrane: neither deg_left nor deg_right"),
    ] {
        let folder = folder(netlist);
        let output = cosim(folder.path(), &[&["--netlist", "my.cir", "--until", "1"][..], arguments].concat());
        tool::assert_refused(&output, &[expected]);
    }
}

#[test]
fn commands_of_a_trusted_netlist_are_executed_and_its_analyses_left_out() {
    if ngspice_is_missing() {
        return;
    }
    let control = ".control\nalter Rload = 1e10\ntran 1m 1\nquit\n.endc\n.end\n";
    let altered = paper(1e9, 2000.0).replace(".end\n", control);
    let changed = run(&altered, &["--until", "1", "--trust"]);
    let expected = run(&paper(1e10, 2000.0), &["--until", "1"]);
    let load = |result: &Value| number(result, &["elements", "Rload"]);
    assert!((load(&changed) / load(&expected) - 1.0).abs() < 1e-9, "{changed} {expected}");
    assert!(changed["warnings"].to_string().contains("tran of the control section is left out"));
}
