//! The command line as a user or a script meets it: exit codes, `--json`, the files written, and the paper's numbers.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a panic is how a test fails")]

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::{LazyLock, Mutex, PoisonError};

use approx::assert_relative_eq;
use serde_json::Value;
use tempfile::TempDir;

/// What came back from the tool.
struct Run {
    code: Option<i32>,
    stdout: String,
    stderr: String,
}

/// Runs the tool in a folder of its own, where `out/` does no harm.
///
/// One at a time: a run may ask Cargo whether the FMUs are fresh, and a Cargo that waits for another says so on stderr.
/// The first run compiles them.
fn videg(arguments: &[&str]) -> Run {
    static FOLDER: LazyLock<Mutex<TempDir>> = LazyLock::new(|| {
        let folder = tempfile::tempdir().unwrap();
        let built = run(&["fmu", "build"], folder.path());
        assert_eq!(built.code, Some(0), "{}", built.stderr);
        Mutex::new(folder)
    });
    let folder = FOLDER.lock().unwrap_or_else(PoisonError::into_inner);
    run(arguments, folder.path())
}

fn run(arguments: &[&str], folder: &Path) -> Run {
    let output = Command::new(env!("CARGO_BIN_EXE_videg")).args(arguments).current_dir(folder).output().unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    Run { code: output.status.code(), stdout: text(output.stdout), stderr: text(output.stderr) }
}

/// The JSON object that a successful run printed, and nothing beside it.
fn json(arguments: &[&str]) -> Value {
    let run = videg(arguments);
    assert_eq!(run.code, Some(0), "{arguments:?}: {}", run.stderr);
    assert_eq!(run.stderr, "", "{arguments:?}");
    let value: Value = serde_json::from_str(&run.stdout).unwrap();
    assert!(value.is_object(), "{arguments:?}: {}", run.stdout);
    value
}

/// A number of the object, by its path, e.g. `energy.load`.
fn number(value: &Value, path: &str) -> f64 {
    let found = path.split('.').fold(value, |value, key| &value[key]);
    found.as_f64().unwrap_or_else(|| panic!("{path} is no number in {value}"))
}

fn simulate(case: &str, more: &[&str]) -> Value {
    json(&[&["simulate", "--json", "--case", case], more].concat())
}

#[test]
fn the_periodic_case_gives_the_gain_of_the_paper() {
    let found = simulate("fig14", &[]);
    assert_relative_eq!(number(&found, "average_voltage_gain"), 8078.9, max_relative = 1e-4);
    assert_eq!(found["case"], "fig14");
    assert_eq!(number(&found, "until"), 100.0);
    assert_eq!(found["window"], serde_json::json!([50.0, 100.0]));
    assert!(found["impacts"].as_u64().unwrap() > 590);
}

/// At 2 Hz the ball comes to rest in each cycle. The paper's 0.061 W counts an impact at each step of a resting ball;
/// without those it is 0.0530 W at every step size.
#[test]
#[ignore = "slow"]
fn the_flashlight_gives_its_power_with_and_without_a_resting_ball() {
    let power = |case| {
        let run = videg(&["simulate", "--json", "--case", case]);
        number(&serde_json::from_str(&run.stdout).unwrap(), "average_power_eq13")
    };
    assert_relative_eq!(power("table3-5hz"), 0.1321, max_relative = 1e-3);
    assert_relative_eq!(power("table3-2hz"), 0.0530, max_relative = 5e-3);
}

#[test]
fn what_is_beyond_the_limits_of_the_model_warns_on_stderr_in_json_and_in_the_report() {
    for arguments in [
        &["simulate"][..],
        &["simulate", "--set", "contact.law=compliant"],
        &["cosim"],
        &["cosim", "--adaptive", "1e-3"],
    ] {
        let folder = tempfile::tempdir().unwrap();
        let arguments = [arguments, &["--json", "--case", "table3-2hz", "--until", "5", "--output", "out"]].concat();
        let run = run(&arguments, folder.path());
        assert_eq!(run.code, Some(0), "{arguments:?}: {}", run.stderr);
        let found: Value = serde_json::from_str(&run.stdout).unwrap();
        let report = std::fs::read_to_string(folder.path().join("out/report.html")).unwrap();
        let sides = ["left", "right"].map(|side| format!("{side} membrane: area ratio "));
        for warning in sides.into_iter().chain(["ball.mass / cylinder.mass = 4.417 is above 0.1".to_owned()]) {
            let matching =
                |texts: &[Value]| texts.iter().filter(|text| text.as_str().unwrap().contains(&warning)).count();
            assert_eq!(matching(found["warnings"].as_array().unwrap()), 1, "{arguments:?}: {found}");
            assert_eq!(run.stderr.matches(&warning).count(), 1, "{arguments:?}: {}", run.stderr);
            assert!(report.contains(&warning), "{arguments:?}");
        }
    }
}

#[test]
fn the_books_of_a_co_simulation_balance() {
    let found = json(&["cosim", "--json", "--until", "5"]);
    for key in ["until", "impacts", "average_voltage_gain", "average_power_eq13", "charge.supply", "charge.load"] {
        assert!(number(&found, key) > 0.0, "{key}");
    }
    assert_eq!(found["case"], "fig14");
    assert_eq!(found["window"], serde_json::json!([2.5, 5.0]));
    let energy = |key: &str| number(&found, &format!("energy.{key}"));
    let converted = energy("load") + energy("zener") + energy("diode") + energy("stored") - energy("supply");
    let scale = energy("supply");
    assert_relative_eq!(energy("converted"), converted, epsilon = 1e-9 * scale);
    assert_relative_eq!(energy("surplus"), energy("load") - energy("supply"), epsilon = 1e-9 * scale);
    assert_relative_eq!(energy("mechanical"), converted, epsilon = 1e-9 * scale);
    assert!(energy("eq13") > 0.0);
}

#[test]
fn what_leaks_is_an_entry_of_the_books_in_either_circuit() {
    let leaking = ["cosim", "--until", "2", "--set", "leakage.timeConstant=2"];
    for circuit in ["embedded", "fmu"] {
        let found = json(&[&leaking[..], &["--json", "--circuit", circuit]].concat());
        let energy = |key: &str| number(&found, &format!("energy.{key}"));
        let given = energy("load") + energy("zener") + energy("diode") + energy("leakage") + energy("stored");
        assert_relative_eq!(energy("mechanical"), given - energy("supply"), epsilon = 1e-9 * energy("supply"));
        // Two membranes at 2 kV and 15 pF, and somewhat more in contacts.
        let rest = 2.0 * 15e-12 * 2000.0 * 2000.0;
        assert!(energy("leakage") > rest && energy("leakage") < 1.5 * rest, "{found}");
    }
    let row = "load + Zener + diode + leakage + stored - supply";
    assert!(videg(&leaking).stdout.contains(row));
    assert!(!videg(&["cosim", "--until", "2"]).stdout.contains("leakage"));
    let refused = videg(&["cosim", "--set", "leakage.timeConstant=1e-7"]);
    assert_eq!(refused.code, Some(2), "{}", refused.stderr);
    assert!(refused.stderr.contains("leakage.timeConstant = 0.0000001 s is below 0.000001 s"), "{}", refused.stderr);
}

#[test]
#[ignore = "slow"]
fn the_circuit_of_the_paper_gains_only_where_its_membranes_are_pressed_in_far() {
    // A charge let out at U gains U - 2 U_in of its own: on one node a gain needs C3/C2 above 3.
    let surplus = |arguments: &[&str]| {
        let run = videg(&[&["cosim", "--json"], arguments].concat());
        assert_eq!(run.code, Some(0), "{arguments:?}: {}", run.stderr);
        number(&serde_json::from_str(&run.stdout).unwrap(), "energy.surplus")
    };
    let of_case = |case| surplus(&["--case", case, "--until", "2", "--step", "1e-4"]);
    assert_relative_eq!(of_case("table3-2hz"), 2.699, max_relative = 1e-3);
    assert!(of_case("fig14") < 0.0);
    // C3/C2 reaches 4.28 here. What gains is that the load is too slow to discharge the node to U_in.
    let soft = ["--set", "membrane.stiffness=1e5", "--set"];
    assert_relative_eq!(surplus(&[&soft[..], &["load.resistance=3e10"]].concat()), 1.732e-3, max_relative = 1e-3);
    assert!(surplus(&[&soft[..], &["load.resistance=1e9"]].concat()) < 0.0);
}

#[test]
fn the_charge_of_a_cycle_is_that_of_the_supply_voltage() {
    let ratio = |arguments: &[&str]| {
        let printed = videg(&[&["cosim", "--until", "10"], arguments].concat()).stdout;
        let row = printed.lines().find(|line| line.contains("supply charge / (U_in dC)")).unwrap().to_owned();
        row.split_whitespace().find_map(|word| word.parse::<f64>().ok()).unwrap()
    };
    assert_relative_eq!(ratio(&[]), ratio(&["--set", "supply.voltage=4000"]), max_relative = 1e-3);
}

#[test]
fn inputs_are_set_where_the_standard_has_them() {
    for verb in ["simulate", "cosim"] {
        let run = videg(&[verb, "--until", "1", "--set", "externalForce=0.001"]);
        assert_eq!((run.code, run.stderr.contains("forbids")), (Some(0), false), "{verb}: {}", run.stderr);
    }
    let sweep = ["sweep", "--vary", "ball.radius=0.005,0.09", "--set", "left.voltage=1000", "--output"];
    let folder = tempfile::tempdir().unwrap();
    let run = videg(&[&sweep[..], &[folder.path().to_str().unwrap()]].concat());
    let results = std::fs::read_to_string(folder.path().join("sweep.csv")).unwrap();
    assert!(results.contains("ball.radius = 0.09") && !results.contains("forbids"), "{}: {results}", run.stderr);
}

/// C(t) goes into the circuit piecewise linear, so energies converge with the square of the communication step.
#[test]
fn energies_converge_with_the_communication_step() {
    let converted = |step| number(&json(&["cosim", "--json", "--until", "5", "--step", step]), "energy.converted");
    let (coarse, middle, fine) = (converted("2e-3"), converted("1e-3"), converted("5e-4"));
    assert!((coarse - middle).abs() > 2.5 * (middle - fine).abs(), "{coarse:e} {middle:e} {fine:e}");
    assert_relative_eq!(middle, fine, max_relative = 1e-3);
}

#[test]
fn a_storage_gains_the_most_at_the_voltage_that_it_has_by_default() {
    for topology in ["topology=sharedNode", "topology=isolated"] {
        let with = |more: &[&str]| {
            let storage = ["cosim", "--json", "--until", "10", "--set", topology, "--set", "release=storage"];
            number(&json(&[&storage, more].concat()), "energy.surplus")
        };
        let [low, best, high] =
            [with(&["--set", "storage.voltage=2150"]), with(&[]), with(&["--set", "storage.voltage=3200"])];
        assert!(best > 0.0 && best > low && best > high, "{topology}: {low} J, {best} J, {high} J");
    }
}

#[test]
fn settings_of_the_circuit_are_left_out_of_a_simulation_with_a_warning() {
    let run = videg(&["simulate", "--json", "--until", "2", "--set", "load.resistance=5"]);
    assert_eq!(run.code, Some(0));
    assert!(run.stderr.contains("load.resistance left out"), "{}", run.stderr);
}

#[test]
fn settings_and_case_files_change_the_run() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("soft.toml");
    std::fs::write(&file, "case = 'fig14'\nuntil = 4\n[set]\nmembrane.restitution = 0.3\n").unwrap();
    let from_file = json(&["simulate", "--json", "--case-file", file.to_str().unwrap()]);
    let set = simulate("fig14", &["--until", "4", "--set", "membrane.restitution=0.3"]);
    let plain = simulate("fig14", &["--until", "4"]);
    assert_eq!(from_file["average_voltage_gain"], set["average_voltage_gain"]);
    assert_ne!(plain["average_voltage_gain"], set["average_voltage_gain"]);
}

#[test]
fn the_output_folder_holds_everything_whole() {
    for verb in ["cosim", "simulate"] {
        let folder = tempfile::tempdir().unwrap();
        let output = folder.path().join("new/folder");
        let printed = json(&[verb, "--json", "--until", "2", "--output", output.to_str().unwrap()]);
        let mut names: Vec<_> = std::fs::read_dir(&output)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        assert_eq!(names, ["figure.svg", "report.html", "result.json", "timeseries.csv"], "{verb}");
        let read = |name: &str| std::fs::read_to_string(output.join(name)).unwrap();
        assert_eq!(serde_json::from_str::<Value>(&read("result.json")).unwrap(), printed);
        assert!(read("figure.svg").contains("<svg") && read("report.html").contains("</html>"), "{verb}");
        let csv = read("timeseries.csv");
        assert!(csv.starts_with("time,left.capacitance,right.capacitance,"), "{verb}");
        assert!(csv.lines().last().unwrap().starts_with("2.0,"), "{verb}");
    }
}

#[test]
fn without_json_the_table_is_on_stdout_and_the_files_are_named() {
    let run = videg(&["cosim", "--until", "2"]);
    assert_eq!((run.code, run.stderr.as_str()), (Some(0), ""));
    for part in ["fig14", "<U>, Eq. (15)", "Zener", "report.html"] {
        assert!(run.stdout.contains(part), "{part} is not in:\n{}", run.stdout);
    }
    assert!(!run.stdout.contains('\u{1b}'), "colours for a reader that is no terminal");
}

/// Each with parts of its message: the thing, the value, and what is allowed.
#[test]
fn what_cannot_run_ends_with_2_and_one_line_that_names_it() {
    let cases: [(&[&str], &[&str]); 17] = [
        (&["simulate", "--case", "fig8"], &["--case", "fig8", "fig14"]),
        (&["cosim", "--case", "fig8"], &["--case", "fig8", "fig14"]),
        (&["simulate", "--set", "ball.weight=1"], &["ball.weight"]),
        (&["cosim", "--set", "load.resistence=1"], &["load.resistence", "load.resistance"]),
        (&["simulate", "--set", "ball.mass"], &["--set", "ball.mass", "variable.name=VALUE"]),
        (&["simulate", "--set", "ball.mass=heavy"], &["ball.mass", "heavy", "number"]),
        (&["simulate", "--set", "membrane.restitution=1.5"], &["membrane.restitution", "1.5", "0 .. 1"]),
        (&["cosim", "--set", "topology=star"], &["topology", "star", "sharedNode, isolated"]),
        (
            &["cosim", "--set", "release=storage", "--set", "storage.voltage=1500"],
            &["storage.voltage = 1500 V", "supply.voltage = 2000 V"],
        ),
        (&["simulate", "--until", "10", "--window", "5,20"], &["--window", "20 s", "10 s"]),
        (&["simulate", "--window", "5"], &["--window", "'5'", "50,100"]),
        (&["simulate", "--until", "-1"], &["--until", "-1 s", "1e9 s"]),
        (&["simulate", "--until", "long"], &["--until", "'long'"]),
        (&["cosim", "--step", "0"], &["--step", "0 s", "above 0"]),
        (&["cosim", "--circuit", "paper"], &["--circuit", "'paper'", "embedded, ngspice, fmu"]),
        (&["simulate", "--case-file", "missing.toml"], &["missing.toml", "No such file"]),
        (&["destroy"], &["destroy"]),
    ];
    for (arguments, parts) in cases {
        assert_refused(arguments, parts);
    }
}

/// In a folder of their own, where no build of other packages takes their place.
#[test]
#[cfg(unix)]
fn libraries_that_are_as_new_as_their_sources_are_not_built_again() {
    let folder = tempfile::tempdir().unwrap();
    assert_eq!(videg(&["fmu", "build"]).code, Some(0));
    let build = |target: &Path| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_videg"));
        command.args(["fmu", "build", "--output"]).arg(folder.path());
        command.env("CARGO", "false").env_remove("VIDEG_NO_BUILD");
        command.env("CARGO_TARGET_DIR", target).output().unwrap()
    };
    let target = std::env::var_os("CARGO_TARGET_DIR")
        .map_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("target"), PathBuf::from);
    let fresh = build(&target);
    assert!(fresh.status.success(), "{fresh:?}");
    if cfg!(debug_assertions) {
        // Those of a release lie beside the program.
        let nothing_there = build(&folder.path().join("target"));
        assert_eq!(nothing_there.status.code(), Some(2), "{nothing_there:?}");
    }
}

/// Stacks that no address space holds stand for a system that gives no more threads.
#[test]
#[cfg(target_os = "linux")]
fn a_system_without_threads_makes_it_slow_or_is_named() {
    assert_eq!(videg(&["fmu", "build"]).code, Some(0));
    let folder = tempfile::tempdir().unwrap();
    let starved = |arguments: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_videg"));
        command.args(arguments).current_dir(folder.path());
        command.env("RUST_MIN_STACK", "9999999999999999").env("VIDEG_NO_BUILD", "1");
        let output = command.output().unwrap();
        (output.status.code(), String::from_utf8(output.stderr).unwrap())
    };
    for verb in [
        &["cosim", "--until", "1"][..],
        &["reproduce", "fig4", "--quick"],
        &["sweep", "--samples", "2", "--until", "1"],
    ] {
        let (code, said) = starved(verb);
        assert_eq!(code, Some(0), "{verb:?}: {said}");
    }
    for (verb, what) in [
        (&["cosim", "--isolate", "--until", "1"][..], " fmu-worker for the FMU: "),
        (&["cosim", "--circuit", "ngspice", "--until", "1"], " ngspice-worker: "),
        (&["crosscheck", "--until", "0.05"], "cannot start "),
    ] {
        let (code, said) = starved(verb);
        let is_one_line = said.lines().count() == 1 && said.starts_with("videg: ");
        assert!(code == Some(2) && is_one_line && said.contains(what), "{verb:?}: {said}");
    }
}

/// A wrong value is that of the file and the key, or of the option, from which it came.
#[test]
fn an_error_about_a_value_names_the_file_and_key_or_the_option_that_said_it() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("my.toml");
    let path = file.to_str().unwrap();
    let none: &[&str] = &[];
    for (text, options, said) in [
        ("set.ball.weight = 1", none, "FILE: set.ball.weight: neither the harvester nor the circuit"),
        (
            "set.membrane.restitution = 7",
            none,
            "FILE: set.membrane.restitution: membrane.restitution = 7 is out of range",
        ),
        ("set.topology = 'star'", none, "FILE: set.topology: topology = star: allowed"),
        ("until = -1", none, "FILE: until = -1 s: must lie"),
        ("step = 200", none, "FILE: step = 200 s: must lie above 0 and not above --until = 100 s"),
        ("until = 10", &["--step", "20"], "--step = 20 s: must lie above 0 and not above FILE: until = 10 s"),
        ("window = [60, 50]", none, "FILE: window end = 50 s: must lie above its start 60 s"),
        ("case = 'fig8'", none, "FILE: case = fig8: no such case"),
        ("case = 'fig8'", &["--case", "fig7"], "--case fig7: no such case"),
        ("until = -1", &["--until", "-2"], "--until = -2 s: must lie"),
        ("set.ball.mass = 1", &["--set", "ball.weight=1"], "--set ball.weight: neither"),
        (
            "",
            &["--set", "membrane.restitution=7"],
            "--set membrane.restitution: membrane.restitution = 7 is out of range",
        ),
    ] {
        std::fs::write(&file, text).unwrap();
        for verb in ["simulate", "cosim"] {
            let run = videg(&[&[verb, "--case-file", path], options].concat());
            assert_eq!(run.code, Some(2), "{verb} {text} {options:?}: {}", run.stderr);
            let expected = format!("videg: {}", said.replace("FILE", path));
            assert!(run.stderr.starts_with(&expected), "{verb} {text} {options:?}: {}", run.stderr);
        }
    }
    std::fs::write(&file, "until = 1\nset.release = 'storage'\nset.storage.voltage = 2500").unwrap();
    for verb in ["cosim", "ssp"] {
        assert_refused(
            &[verb, "--case-file", path, "--set", "supply.voltage=1", "--set", "supply.voltage=3000"],
            &["storage.voltage = 2500 V", &format!("({path}: set.storage.voltage, --set supply.voltage)")],
        );
    }
    std::fs::write(&file, "set.contact.law = 'compliant'").unwrap();
    assert_refused(
        &["simulate", "--case-file", path, "--law", "impulsive"],
        &[&format!("--law impulsive: {path}: set.contact.law = compliant says otherwise")],
    );
    // A law of the case is none that the user gave.
    let gain =
        |case, more: &[&str]| simulate(case, &[&["--until", "20"], more].concat())["average_voltage_gain"].clone();
    assert_eq!(gain("capsule-soft", &["--law", "impulsive"]), gain("capsule-1-1", &[]));
    assert_ne!(gain("capsule-soft", &[]), gain("capsule-1-1", &[]));
}

fn assert_refused(arguments: &[&str], parts: &[&str]) {
    let Run { code, stdout, stderr } = videg(arguments);
    assert_eq!((code, stdout.as_str()), (Some(2), ""), "{arguments:?}: {stderr}");
    assert_eq!(stderr.lines().count(), 1, "{arguments:?}: {stderr}");
    for part in parts {
        assert!(stderr.contains(part), "{arguments:?} does not name {part}: {stderr}");
    }
}

#[test]
fn the_fmus_are_built_where_asked_and_described() {
    let folder = tempfile::tempdir().unwrap();
    let built = json(&["fmu", "build", "--json", "--output", folder.path().to_str().unwrap()]);
    for (index, identifier) in ["VibroImpactHarvester", "HarvestingCircuit"].into_iter().enumerate() {
        let path = folder.path().join(format!("{identifier}.fmu"));
        assert_eq!(built["fmus"][index], path.to_str().unwrap());
        let info = json(&["fmu", "info", "--json", path.to_str().unwrap()]);
        assert_eq!((&info["model_identifier"], &info["fmi_version"]), (&identifier.into(), &"2.0".into()));
        assert_eq!(info["platforms"].as_array().unwrap().len(), 1);
        let variables = info["variables"].as_array().unwrap();
        assert!(variables.iter().any(|variable| variable["name"] == "left.capacitance" && variable["unit"] == "F"));
        let text = videg(&["fmu", "info", path.to_str().unwrap()]);
        assert!(text.code == Some(0) && text.stdout.contains("left.capacitance"), "{}", text.stdout);
        let widest = text.stdout.lines().map(|line| line.chars().count()).max();
        assert!(widest <= Some(120), "{widest:?} columns:\n{}", text.stdout);
    }
}

#[test]
fn what_is_no_fmu_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str, content: &[u8]| {
        let path = folder.path().join(name);
        std::fs::write(&path, content).unwrap();
        path.to_str().unwrap().to_owned()
    };
    let missing = folder.path().join("missing.fmu");
    assert_refused(&["fmu", "info", missing.to_str().unwrap()], &["missing.fmu", "No such file"]);
    assert_refused(&["fmu", "info", &file("text.fmu", b"no FMU at all\n")], &["text.fmu", "not a readable FMU"]);
    assert_refused(&["fmu", "info", &file("nothing.fmu", b"")], &["nothing.fmu", "not a readable FMU"]);
    // The end record of an archive without entries.
    let empty = [b"PK\x05\x06".as_slice(), &[0; 18]].concat();
    assert_refused(&["fmu", "info", &file("empty.fmu", &empty)], &["empty.fmu", "modelDescription.xml"]);
}

#[test]
fn completions_and_help_are_data() {
    for (shell, registers) in [
        ("bash", "complete -o bashdefault -F _videg videg"),
        ("zsh", "compdef _videg videg"),
        ("fish", "--command videg"),
        ("elvish", "arg-completer[videg]"),
        ("powershell", "-CommandName 'videg'"),
    ] {
        let completions = videg(&["completions", shell]);
        assert!(completions.code == Some(0) && completions.stderr.is_empty(), "{shell}: {}", completions.stderr);
        assert!(completions.stdout.contains(registers), "{}", completions.stdout);
    }
    let help = videg(&["--help"]);
    assert!(help.code == Some(0) && help.stdout.contains("cosim") && help.stderr.is_empty());
}
