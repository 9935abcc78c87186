//! `videg crosscheck` as users meet it: judgements, exit codes, files, the folder for ngspice alone, hostile input.
//!
//! Without ngspice the tests that need it are skipped, but not by `./test.sh`, which sets `VIDEG_ALL_TOOLS`.
#![cfg(unix)]
#![allow(clippy::unwrap_used, clippy::panic, reason = "a panic is how a test fails")]

#[path = "../examples/random_crosschecks/draw.rs"]
#[allow(dead_code, reason = "the example takes more of it")]
mod draw;
#[path = "support/extent.rs"]
mod extent;
#[path = "support/tool.rs"]
mod tool;

use std::os::unix::fs::PermissionsExt as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::{LazyLock, Mutex, PoisonError};

use extent::extent;
use serde_json::Value;
use tempfile::TempDir;
use tool::{assert_refused, json, said, tool};
use videg::ngspice::Ngspice;

/// Runs the tool in `folder`, one at a time, because each run asks Cargo whether the FMUs are fresh.
fn videg(folder: &Path, arguments: &[&str], environment: &[(&str, &Path)]) -> Output {
    static FIRST: LazyLock<Mutex<()>> = LazyLock::new(|| {
        let folder = tempfile::tempdir().unwrap();
        assert!(tool(["fmu", "build"]).current_dir(folder.path()).status().unwrap().success());
        Mutex::new(())
    });
    let _held = FIRST.lock().unwrap_or_else(PoisonError::into_inner);
    tool(arguments).current_dir(folder).envs(environment.iter().copied()).output().unwrap()
}

fn ngspice() -> Option<PathBuf> {
    let found = Ngspice::find(None);
    assert!(found.is_ok() || std::env::var_os("VIDEG_ALL_TOOLS").is_none(), "{}", found.unwrap_err());
    found.inspect_err(|error| eprintln!("skipped: {error}")).ok().map(|ngspice| ngspice.program().to_owned())
}

fn check<'a>(value: &'a Value, name: &str) -> &'a Value {
    let checks = value["checks"].as_array().unwrap();
    checks.iter().find(|check| check["name"] == name).unwrap_or_else(|| panic!("no check {name} in {checks:#?}"))
}

/// The JSON of `videg crosscheck` in a new folder, which ends with `code`; none without ngspice.
fn crosscheck(arguments: &str, code: i32) -> Option<(TempDir, Value)> {
    ngspice()?;
    let folder = tempfile::tempdir().unwrap();
    let verb = ["crosscheck", "--json", "--output", "out/crosscheck-fig14"];
    let arguments: Vec<_> = verb.into_iter().chain(arguments.split_whitespace()).collect();
    let found = json(&videg(folder.path(), &arguments, &[]), code);
    Some((folder, found))
}

/// A script in the place of ngspice: it changes the netlist with `commands`, and then runs ngspice.
fn altered_ngspice(folder: &Path, program: &Path, commands: &str) -> PathBuf {
    let path = folder.join("altered-ngspice");
    std::fs::write(&path, format!("#!/bin/sh\n{commands}\nexec '{}' \"$@\"\n", program.display())).unwrap();
    std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o755)).unwrap();
    path
}

#[test]
fn the_solvers_agree_on_the_paper_circuit_and_the_claims_are_judged() {
    let Some((folder, found)) = crosscheck("--until 2 --export for-ngspice", 0) else { return };
    for key in ["case", "until", "window", "impacts", "average_voltage_gain", "average_power_eq13", "circuit"] {
        assert!(!found[key].is_null(), "{key}");
    }
    for key in ["supply", "load", "zener", "diode", "stored", "converted", "surplus", "eq13"] {
        assert!(found["energy"][key].is_number(), "{key}");
    }
    assert!(found["charge"]["supply"].as_f64().unwrap() > 0.0);
    assert_eq!((&found["energy_by"], &found["passed"]), (&"embedded_exponential".into(), &true.into()));
    let names: Vec<_> = found["solvers"].as_array().unwrap().iter().map(|solver| solver["name"].clone()).collect();
    assert_eq!(names, ["embedded_ideal", "embedded_exponential", "ngspice_batch", "ngspice_live"]);
    let supply = check(&found, "supply energy");
    assert_eq!(supply["agreement"]["agree"], true, "{supply}");
    assert_eq!(check(&found, "load energy")["claim"]["holds"], false, "W of Eq. (13) is not what the load gets");
    let printed = check(&found, "the same by Eq. (12) as printed");
    assert_eq!(printed["claim"]["holds"], false);
    // ngspice has less, and the deviation says so.
    assert!(printed["values"]["ngspice_batch"].as_f64() < printed["analytic"].as_f64(), "{printed}");
    assert!(printed["claim"]["deviation"].as_f64().unwrap() < -0.2, "{printed}");
    assert!(found["comparison"][2]["ngspice"]["energy"]["surplus"].as_f64() > found["energy"]["surplus"].as_f64());
    for file in ["waveforms.csv", "checks.csv", "impacts.csv", "figure.svg", "report.html", "result.json"] {
        assert!(folder.path().join("out/crosscheck-fig14").join(file).is_file(), "{file}");
    }
    runs_by_ngspice_alone(&ngspice().unwrap(), &folder.path().join("for-ngspice"));
}

#[test]
#[ignore = "slow"]
fn the_solvers_agree_without_impacts_and_at_hundreds_of_kilovolts() {
    // In Fig. 9 only the leakage of diodes flows, and Table 3 moves many times the energy of the supply.
    let leaking = extent("--case fig9 --until 25", "--case fig9 --until 100");
    for arguments in [leaking, "--case table3-2hz --until 1", "--case table3-5hz --until 1"] {
        let Some((_, found)) = crosscheck(arguments, 0) else { return };
        assert_eq!(found["passed"], true, "{arguments}");
    }
}

/// Half of such circuits ended with "Timestep too small" where steps shrank without end at corners of C(t).
/// `cargo run --release --example random_crosschecks` does the same with any number of them.
#[test]
#[ignore = "slow"]
fn random_circuits_run_to_their_end_and_agree() {
    if ngspice().is_none() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    for index in 0..3 {
        let arguments = draw::arguments(2026, index);
        let all: Vec<_> = ["crosscheck", "--json"].into_iter().chain(arguments.iter().map(String::as_str)).collect();
        let found = videg(folder.path(), &all, &[]);
        assert_eq!(draw::outcome(&found), draw::Outcome::Agrees, "{}", arguments.join(" "));
        assert_eq!(draw::repeated(&found), Vec::<String>::new(), "{}", arguments.join(" "));
    }
}

/// By the trapezoidal rule the current of a diode swings, which a run with a time point on each corner of C(t) pays for
/// with 1.4e-3 to 4e-3 of its charge here; trapezoidal sums of currents that jump cost another 1e-4.
#[test]
#[ignore = "slow"]
fn ngspice_step_by_step_loses_no_charge_to_quick_loads() {
    let arguments = "--until 2 --topology isolated --release switch --set excitation.amplitude=2.672 \
        --set excitation.frequency=4.41 --set membrane.stiffness=111850 --set membrane.restitution=0.78 \
        --set ball.mass=5.09e-3 --set load.resistance=1.01e6 --set biasVoltage=3265";
    let Some((_, found)) = crosscheck(arguments, 0) else { return };
    for name in ["supply charge", "load charge", "load energy"] {
        let by = |solver: &str| check(&found, name)["values"][solver].as_f64().unwrap();
        let same_diodes = by("embedded_exponential");
        for solver in ["ngspice_batch", "ngspice_live"] {
            let deviation = by(solver) / same_diodes - 1.0;
            assert!(deviation.abs() < 1e-5, "{name} by {solver}: {deviation}");
        }
    }
}

/// What stands in the README of the folder is what ngspice prints there.
fn runs_by_ngspice_alone(program: &Path, folder: &Path) {
    let page = std::fs::read_to_string(folder.join("README.txt")).unwrap();
    let mut own = PathBuf::new();
    let mut printed = String::new();
    let mut compared = 0;
    for line in page.lines() {
        if let Some((name, _)) = line.split_once("/: ") {
            own = folder.join(name);
            let run = |file| Command::new(program).args(["-b", file]).current_dir(&own).output().unwrap();
            run("harvesting.cir");
            printed = String::from_utf8_lossy(&run("evaluate.cir").stdout).into_owned();
        } else if let Some((name, rest)) = line.strip_prefix("    ").and_then(|line| line.split_once(" = ")) {
            let number = |text: &str| text.split_whitespace().next().unwrap().parse::<f64>().unwrap();
            let found = printed.lines().find_map(|line| line.strip_prefix(&format!("{} = ", name.trim())));
            let (found, expected) = (number(found.unwrap_or_else(|| panic!("{name}: {printed}"))), number(rest));
            // Closed forms are met to some 1e-7. The scripts sum currents by the trapezoidal rule alone.
            let tolerance = if own.file_name().unwrap().to_string_lossy().starts_with("check_") { 1e-6 } else { 1e-4 };
            assert!((found / expected - 1.0).abs() < tolerance, "{}: {name} {found} {expected}", own.display());
            compared += 1;
        }
    }
    // Three circuits with four values each, three checks of the capacitor with one.
    assert_eq!(compared, 15, "{page}");
}

#[test]
fn other_circuits_are_checked_by_options_of_their_own() {
    for (arguments, label) in [
        ("--until 1.5 --release switch --topology sharedNode", "sharedNode, switch"),
        ("--until 1.5 --release storage --topology isolated", "isolated, storage"),
    ] {
        let Some((_, found)) = crosscheck(arguments, 0) else { return };
        assert!(found["circuit"].as_str().unwrap().starts_with(label), "{}", found["circuit"]);
        assert_eq!(found["energy"]["zener"], 0.0);
        assert!(found["conclusion"][0].as_str().unwrap().starts_with("The solvers agree"));
    }
}

/// The circuit has diodes that drop 0.3 V and more; a solver with ideal ones cannot give the same energies.
#[test]
#[ignore = "slow"]
fn real_diodes_fail_the_check_of_the_ideal_ones() {
    let Some((_, found)) = crosscheck("--until 1 --set diode.emissionCoefficient=1", 1) else { return };
    assert_eq!(found["passed"], false);
    let checks = found["checks"].as_array().unwrap();
    let failed: Vec<_> =
        checks.iter().map(|check| &check["agreement"]).filter(|found| found["agree"] == false).collect();
    assert!(!failed.is_empty());
    for agreement in failed {
        assert!(agreement["between"].as_str().unwrap().starts_with("embedded, ideal"), "{agreement}");
    }
    assert!(found["conclusion"][0].as_str().unwrap().contains("do NOT agree"));
}

/// An ngspice that is given C='...', I = C dV/dt, in place of Q='...' runs through and gets everything wrong.
#[test]
fn a_capacitor_of_the_wrong_form_fails() {
    let Some(program) = ngspice() else { return };
    let folder = tempfile::tempdir().unwrap();
    // Only in the tests of the capacitor: the circuits get stuck with it.
    let commands = "if grep -q 'check of the time-varying capacitor' harvesting.cir; then\n\
        sed -i -e '/^Cvidegleft p/d' -e \"s/Q='(V(videg_cl)-[^)]*)\\*1e-12\\*V(p,n)'/C='V(videg_cl)*1e-12'/\" \\
        harvesting.cir\nfi";
    let wrong = altered_ngspice(folder.path(), &program, commands);
    let arguments = ["crosscheck", "--json", "--until", "0.3"];
    let found = json(&videg(folder.path(), &arguments, &[("VIDEG_NGSPICE", &wrong)]), 1);
    for name in ["a charged capacitor that grows", "a capacitor that grows at constant voltage"] {
        assert_eq!(check(&found, name)["agreement"]["agree"], false, "{name}");
    }
}

#[test]
fn where_ngspice_stops_all_solvers_are_reported_up_to_there_and_open_claims_named() {
    let Some(program) = ngspice() else { return };
    let folder = tempfile::tempdir().unwrap();
    // It runs circuits up to 0.7 s only, and then says that it gives up.
    let commands = "if grep -q 'videg: harvesting circuit' harvesting.cir; then\n\
        sed -i 's/^tran \\([^ ]*\\) [^ ]* /tran \\1 0.7 /' harvesting.cir\n\
        echo 'doAnalyses: TRAN:  Timestep too small; time = 0.7'\nfi";
    let short = altered_ngspice(folder.path(), &program, commands);
    let output = videg(
        folder.path(),
        &["crosscheck", "--json", "--until", "1.5", "--output", "out/crosscheck-fig14"],
        &[("VIDEG_NGSPICE", &short)],
    );
    let found = json(&output, 1);
    assert_eq!(found["passed"], false);
    let stopped = found["stopped"].as_array().unwrap();
    let main = stopped.iter().find(|stop| stop["task"] == "ngspice, batch").unwrap_or_else(|| panic!("{stopped:?}"));
    let reached = main["reached"].as_f64().unwrap();
    assert!(reached > 0.69 && reached <= 0.7 && main["until"] == 1.5, "{main}");
    let reason = main["reason"].as_str().unwrap();
    assert!(reason.contains("Timestep too small") && reason.contains("also with steps of at most 5e-5 s"), "{reason}");
    assert!(
        main["open"].as_array().unwrap().iter().any(|claim| claim.as_str().unwrap().contains("W of Eq. (13)")),
        "{main}"
    );
    // Up to there all four solvers stand side by side and agree; what the embedded one has is of the whole run.
    let supply = check(&found, &format!("supply energy, up to {reached:.6} s"));
    for solver in ["embedded_ideal", "embedded_exponential", "ngspice_batch", "ngspice_live"] {
        assert!(supply["values"][solver].as_f64().unwrap() > 0.0, "{supply}");
    }
    assert_eq!(supply["agreement"]["agree"], true, "{supply}");
    let reasons: Vec<_> = stopped.iter().map(|stop| stop["reason"].as_str().unwrap()).collect();
    assert_eq!(draw::outcome(&output), draw::Outcome::GaveUp(reasons.join("; ")));
    let times: Vec<_> = found["solvers"].as_array().unwrap().iter().map(|solver| solver["reached"].clone()).collect();
    assert_eq!(times, [1.5.into(), 1.5.into(), main["reached"].clone(), 1.5.into()]);
    let said = said(&output);
    assert!(
        said.contains("ngspice, batch: ngspice stopped at 0.7") && said.contains("What stays open beyond 0.69"),
        "{said}"
    );
    let waveforms = std::fs::read_to_string(folder.path().join("out/crosscheck-fig14/waveforms.csv")).unwrap();
    assert!(waveforms.lines().last().unwrap().contains(",,,,,,,"), "no zeros where nothing was found");
    assert!(folder.path().join("out/crosscheck-fig14/report.html").is_file());
}

#[test]
fn without_the_shared_library_the_other_solvers_are_reported() {
    if ngspice().is_none() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let none = ("VIDEG_NGSPICE_LIBRARY", Path::new("/nowhere/libngspice.so.0"));
    let found = json(&videg(folder.path(), &["crosscheck", "--json", "--until", "0.5"], &[none]), 1);
    let stopped = found["stopped"].as_array().unwrap();
    assert!(stopped.len() == 1 && stopped[0]["task"] == "ngspice, live" && stopped[0]["reached"] == 0.0, "{stopped:?}");
    assert!(stopped[0]["reason"].as_str().unwrap().contains("apt install libngspice0"), "{stopped:?}");
    assert_eq!(check(&found, "supply energy")["agreement"]["agree"], true);
}

#[test]
fn without_ngspice_one_line_says_how_to_install_it() {
    let folder = tempfile::tempdir().unwrap();
    let found = videg(folder.path(), &["crosscheck", "--until", "1"], &[("VIDEG_NGSPICE", Path::new("/nowhere"))]);
    assert_refused(&found, &["ngspice not found", "/nowhere", "apt install ngspice"]);
}

#[test]
fn what_cannot_run_is_named() {
    if ngspice().is_none() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    for (arguments, parts) in [
        (&["--release", "spark"][..], &["--release", "spark", "storage"][..]),
        (&["--set", "load.resistance=inf", "--until", "1"], &["load.resistance = inf"]),
        (&["--set", "load.resistance=1\n.control\nshell touch pwned\n.endc"], &["load.resistance"]),
    ] {
        assert_refused(&videg(folder.path(), &[&["crosscheck"], arguments].concat(), &[]), parts);
    }
    assert!(!folder.path().join("pwned").exists());
}

#[test]
fn hostile_names_run_nothing_and_stay_in_the_folder() {
    if ngspice().is_none() {
        return;
    }
    let outer = tempfile::tempdir().unwrap();
    let folder = outer.path().join("inner");
    std::fs::create_dir(&folder).unwrap();
    let name = "../../evil; .control; shell touch pwned";
    let description = "\\n.control\\nshell touch pwned\\n.endc";
    let case = format!("name = \"{name}\"\ndescription = \"{description}\"\nuntil = 0.3\n");
    std::fs::write(folder.join("case.toml"), case).unwrap();
    let arguments = ["crosscheck", "--json", "--case-file", "case.toml", "--export", "for\n.control"];
    json(&videg(&folder, &arguments, &[]), 0);
    let within = |folder: &Path| -> Vec<String> {
        let mut names: Vec<_> =
            std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    };
    assert_eq!(within(outer.path()), ["inner"]);
    assert_eq!(within(&folder), ["case.toml", "for\n.control", "out"]);
    let page = std::fs::read_to_string(folder.join("for\n.control/README.txt")).unwrap();
    assert!(!page.lines().any(|line| line.starts_with(".control") || line.starts_with("shell")), "{page}");
}

#[test]
fn an_export_overwrites_its_own_files_only_and_follows_no_link() {
    if ngspice().is_none() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let target = folder.path().join("target");
    let run = || videg(folder.path(), &["crosscheck", "--json", "--until", "0.3", "--export", "target"], &[]);
    std::fs::create_dir(&target).unwrap();
    std::fs::write(target.join("README.txt"), "mine").unwrap();
    assert_refused(&run(), &["--export", "README.txt", "not of an earlier export"]);
    assert_eq!(std::fs::read_to_string(target.join("README.txt")).unwrap(), "mine");
    std::fs::remove_file(target.join("README.txt")).unwrap();
    json(&run(), 0);
    json(&run(), 0);
    let precious = folder.path().join("precious");
    std::fs::write(&precious, "mine").unwrap();
    std::fs::remove_file(target.join("circuit/evaluate.cir")).unwrap();
    std::os::unix::fs::symlink(&precious, target.join("circuit/evaluate.cir")).unwrap();
    assert_refused(&run(), &["evaluate.cir", "not of an earlier export"]);
    assert_eq!(std::fs::read_to_string(&precious).unwrap(), "mine");
}

#[test]
#[ignore = "slow"]
fn a_sweep_finds_the_voltage_of_release_that_the_closed_form_predicts() {
    let Some((folder, run)) = crosscheck("--sweep --until 5", 0) else { return };
    let (curves, predicted) = (run["sweep"]["voltage"].as_array().unwrap(), &run["sweep"]["predicted"]);
    assert_eq!(curves.len(), 6);
    for curve in curves.iter().filter(|curve| curve["circuit"].as_str().unwrap().ends_with("storage")) {
        let isolated = curve["circuit"].as_str().unwrap().starts_with("isolated");
        let predicted = predicted[usize::from(isolated)].as_f64().unwrap();
        let points: Vec<[f64; 2]> = (curve["points"].as_array().unwrap().iter())
            .map(|point| ["x", "converted"].map(|key| point[key].as_f64().unwrap()))
            .collect();
        let best = points.iter().copied().max_by(|a, b| a[1].total_cmp(&b[1])).unwrap()[0];
        // The grid has 26 voltages, and a short run weighs its first pulses more than the closed form does.
        assert!((best / predicted - 1.0).abs() < 0.05, "{}: {best} V, predicted {predicted} V", curve["circuit"]);
    }
    let files = folder.path().join("out/crosscheck-fig14");
    for file in ["sweep.csv", "sweep.svg", "report.html"] {
        assert!(files.join(file).is_file(), "{file}");
    }
}
