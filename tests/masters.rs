//! The masters: the order of each, what an adaptive step saves, and that all circuits go through all of them.
#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

use std::sync::LazyLock;

use serde_json::Value;
use tool::{json, said, tool};

#[path = "support/tool.rs"]
mod tool;

/// Seconds of Fig. 14: some thirty impacts.
const UNTIL: &str = "5";

fn run(arguments: &[&str]) -> Result<Value, String> {
    let folder = tempfile::tempdir().unwrap();
    let output = tool(["cosim", "--json", "--output"]).arg(folder.path()).args(arguments).output().unwrap();
    if output.status.success() { Ok(json(&output, 0)) } else { Err(said(&output)) }
}

/// A run of Fig. 14.
fn cosim(arguments: &[&str]) -> Value {
    run(&[&["--until", UNTIL], arguments].concat()).unwrap()
}

fn converted(run: &Value) -> f64 {
    run["energy"]["converted"].as_f64().unwrap()
}

/// Energy that the mechanics gave with a hundredth of the coarsest step below: its own error is 1e-4 of what is compared
/// with it.
static EXACT: LazyLock<f64> = LazyLock::new(|| converted(&cosim(&["--step", "1e-5"])));

fn coupling(run: &Value, key: &str) -> f64 {
    run["coupling"][key].as_f64().unwrap()
}

/// Steps taken and steps undone.
fn work(run: &Value) -> f64 {
    coupling(run, "steps") + coupling(run, "rejected")
}

/// The order over three halvings of the step from 1 ms on; a single halving depends on where the grid meets the pulses.
fn order(errors: [f64; 2]) -> f64 {
    (errors[0] / errors[1]).log2() / 3.0
}

/// Second order for both masters that know dC/dt or both ends of C(t), first for the one that does not. A quarter of an order
/// is what remains of higher ones at these steps.
#[test]
#[ignore = "slow"]
fn halving_the_step_shows_the_order_that_each_master_claims() {
    for (master, claimed) in [("gauss-seidel", 2.0), ("jacobi", 2.0), ("plain", 1.0)] {
        let runs = ["1e-3", "1.25e-4"].map(|step| cosim(&["--master", master, "--step", step]));
        let of_energy = order([0, 1].map(|k| (converted(&runs[k]) - *EXACT).abs()));
        assert!((of_energy - claimed).abs() < 0.25, "{master}: order {of_energy} instead of {claimed}");
    }
}

/// The work that circuit and harvester book apart vanishes with the step at the same orders. The sign of the residual changes
/// at 1 ms for Gauss-Seidel, so that finer steps are compared.
#[test]
#[ignore = "slow"]
fn the_residual_of_the_coupling_vanishes_with_the_step_at_the_order_of_the_master() {
    for (master, claimed) in [("gauss-seidel", 2.0), ("jacobi", 2.0), ("plain", 1.0)] {
        let residual = |step| coupling(&cosim(&["--master", master, "--step", step]), "residual").abs();
        let found = (residual("2.5e-4") / residual("6.25e-5")).log2() / 2.0;
        assert!((found - claimed).abs() < 0.25, "{master}: order {found} instead of {claimed}");
    }
}

#[test]
#[ignore = "slow"]
fn the_adaptive_master_reaches_the_accuracy_of_twice_the_steps() {
    for master in ["gauss-seidel", "jacobi"] {
        let adaptive = cosim(&["--master", master, "--adaptive", "1e-4"]);
        let step = format!("{:e}", 5.0 / (2.0 * work(&adaptive)));
        let fixed = cosim(&["--master", master, "--step", &step]);
        let [of_adaptive, of_fixed] = [&adaptive, &fixed].map(|run| (converted(run) - *EXACT).abs());
        assert!(coupling(&fixed, "steps") > 2.0 * work(&adaptive));
        assert!(of_adaptive < of_fixed, "{master}: {of_adaptive:e} J adaptive, {of_fixed:e} J with twice the steps");
    }
}

/// The tolerance is on signals that are off by the square of the step, so energies follow it proportionally.
#[test]
#[ignore = "slow"]
fn a_smaller_tolerance_gives_a_smaller_error() {
    for master in ["gauss-seidel", "jacobi"] {
        let error = |tolerance| (converted(&cosim(&["--master", master, "--adaptive", tolerance])) - *EXACT).abs();
        let [coarse, fine] = [error("1e-3"), error("1e-5")];
        assert!(coarse > 20.0 * fine, "{master}: {coarse:e} {fine:e}");
    }
}

#[test]
fn the_circuit_fmu_agrees_with_the_embedded_circuit_under_every_master_and_setting() {
    let masters = [&["gauss-seidel"][..], &["jacobi"], &["plain"], &["gauss-seidel", "--adaptive", "1e-3"]];
    let masters = masters.map(|master| [&["--master"], master].concat());
    let settings = [
        &["load.resistance=inf"][..],
        &["load.resistance=0"],
        &["release=storage"],
        &["release=storage", "storage.voltage=2200", "topology=isolated"],
    ];
    let settings = settings.map(|settings| settings.iter().flat_map(|setting| ["--set", *setting]).collect());
    for arguments in masters.into_iter().chain(settings) {
        let [embedded, fmu] =
            ["embedded", "fmu"].map(|circuit| cosim(&[&["--circuit", circuit], &*arguments].concat()));
        for count in ["steps", "rejected"] {
            assert_eq!(embedded["coupling"][count], fmu["coupling"][count], "{arguments:?}");
        }
        for group in ["energy", "charge"] {
            let scale = embedded[group]["supply"].as_f64().unwrap();
            for (key, value) in embedded[group].as_object().unwrap() {
                let difference = value.as_f64().unwrap() - fmu[group][key].as_f64().unwrap();
                // They differ in how the end of a ramp is rounded.
                assert!(difference.abs() <= 1e-9 * scale, "{arguments:?}: {group}.{key} differs by {difference:e}");
            }
        }
    }
}

/// How a run of the harvester is divided into steps changes nothing in it, so an impact that is missed would be seen: with a
/// ball that comes to rest, and with phase noise, under which impacts are predicted for some time only.
#[test]
fn the_adaptive_master_undoes_steps_without_a_trace_in_the_mechanics() {
    for case in
        [&["--case", "table3-2hz"][..], &["--set", "excitation.phaseNoise=0.5", "--set", "excitation.noiseHold=1e-3"]]
    {
        let fixed = cosim(case);
        for master in ["gauss-seidel", "jacobi"] {
            let adaptive = cosim(&[case, &["--master", master, "--adaptive", "1e-3"]].concat());
            assert!(coupling(&adaptive, "rejected") > 0.0);
            for key in ["impacts", "average_voltage_gain", "average_power_eq13"] {
                assert_eq!(adaptive[key], fixed[key], "{case:?} {master} {key}");
            }
            let deviation = converted(&adaptive) / converted(&fixed) - 1.0;
            assert!(deviation.abs() < 0.05, "{case:?} {master}: {deviation}");
        }
    }
}

#[test]
fn couplings_that_make_no_sense_are_refused_by_name_and_bound() {
    for (arguments, expected) in [
        (&["--adaptive", "0"][..], "--adaptive 0: must lie from 1e-12 to 0.1"),
        (&["--adaptive", "-1"], "--adaptive -1: must lie from 1e-12 to 0.1"),
        (&["--adaptive", "NaN"], "--adaptive NaN: must lie from 1e-12 to 0.1"),
        (&["--adaptive", "0.2"], "--adaptive 0.2: must lie from 1e-12 to 0.1"),
        (&["--adaptive", "1e-3", "--master", "plain"], "--adaptive 0.001: --master plain keeps to a regular grid"),
        (&["--master", "chaos"], "'chaos'"),
        (&["--adaptive", "1e-3", "--circuit", "ngspice"], "ngspice never can; allowed: embedded, fmu"),
    ] {
        let error = run(&[&["--until", "0.1"], arguments].concat()).unwrap_err();
        assert!(error.contains(expected) && error.lines().count() == 1, "{arguments:?}: {error}");
    }
}

const FEEDBACK: [&str; 6] =
    ["--set", "contact.law=compliant", "--set", "contact.electrostaticFeedback=true", "--set", "contact.reaction=true"];

/// With the Maxwell force both sides act on each other. The residual of the coupling is then an error of the energy balance.
#[test]
#[ignore = "slow"]
fn the_orders_of_the_masters_hold_when_the_circuit_acts_back_on_the_ball() {
    for (master, claimed) in [("gauss-seidel", 2.0), ("jacobi", 2.0), ("plain", 1.0)] {
        let residual = |step| {
            let run = cosim(&[&FEEDBACK[..], &["--master", master, "--step", step]].concat());
            coupling(&run, "residual").abs()
        };
        let found = (residual("5e-4") / residual("1.25e-4")).log2() / 2.0;
        assert!((found - claimed).abs() < 0.35, "{master}: order {found} instead of {claimed}");
    }
}

/// Work of the excitation = kinetic + elastic + lost in impacts + into load, Zener, diodes and field - from the supply.
#[test]
#[ignore = "slow"]
fn the_energy_of_harvester_and_circuit_balances_over_the_whole_run() {
    std::thread::scope(|scope| {
        for circuit in ["embedded", "fmu"] {
            scope.spawn(move || {
                let options = ["--until", "40", "--adaptive", "1e-5", "--circuit", circuit];
                let run = run(&[&FEEDBACK[..], &options].concat()).unwrap();
                let balance = |key: &str| run["balance"][key].as_f64().unwrap();
                let given = balance("excitation");
                assert!(given > 0.05, "{circuit}: the excitation gave {given} J only");
                let taken = ["kinetic", "cylinder_kinetic", "elastic", "impact_loss"].map(balance).iter().sum::<f64>();
                let energy = |key: &str| run["energy"][key].as_f64().unwrap();
                let electrical =
                    energy("load") + energy("zener") + energy("diode") + energy("stored") - energy("supply");
                let residual = given - taken - electrical;
                assert!(electrical > 0.02 * given, "{circuit}: {electrical} J of {given} J");
                assert!(residual.abs() < 1e-6 * given, "{circuit}: {residual} J of {given} J");
                assert!(balance("relative_residual") < 1e-6, "{circuit}: {}", balance("relative_residual"));
            });
        }
    });
}
