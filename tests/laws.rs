//! `videg simulate --law`: both laws of contact, one at a time and side by side.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a panic is how a test fails")]

use std::path::Path;
use std::process::Output;
use std::sync::LazyLock;

use approx::assert_relative_eq;
use serde_json::Value;
use tempfile::TempDir;
use tool::{assert_refused, json, tool};

#[path = "support/tool.rs"]
mod tool;

fn simulate(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = tool(["simulate", "--json", "--until", "5", "--output"]);
    command.arg(folder).args(arguments).output().unwrap()
}

/// The run of both laws, at which several tests look.
static BOTH: LazyLock<(Value, TempDir)> = LazyLock::new(|| run(&["--law", "both"]));

/// What a run prints, and its folder.
fn run(arguments: &[&str]) -> (Value, TempDir) {
    let folder = tempfile::tempdir().unwrap();
    (json(&simulate(folder.path(), arguments), 0), folder)
}

fn number(value: &Value, key: &str) -> f64 {
    value[key].as_f64().unwrap_or_else(|| panic!("{key} is no number in {value}"))
}

/// Columns of a time series, by name.
fn columns<const N: usize>(folder: &TempDir, file: &str, names: [&str; N]) -> Vec<[f64; N]> {
    let mut reader = csv::Reader::from_path(folder.path().join(file)).unwrap();
    let heading = reader.headers().unwrap().clone();
    let places = names.map(|name| heading.iter().position(|column| column == name).unwrap());
    let rows = reader.records().map(Result::unwrap);
    rows.map(|row| places.map(|place| row[place].parse().unwrap())).collect()
}

#[test]
fn each_law_of_both_is_the_one_that_runs_alone() {
    let (both, _) = &*BOTH;
    for law in ["impulsive", "compliant"] {
        let (alone, _) = run(&["--law", law]);
        let (set, _) = run(&["--set", &format!("contact.law={law}")]);
        for key in ["impacts", "events", "average_voltage_gain", "average_power_eq13"] {
            assert_eq!(both["laws"][law][key], alone[key], "{law}: {key}");
            assert_eq!(set[key], alone[key], "{law}: {key}");
        }
        assert_eq!(set["settings"], alone["settings"]);
    }
}

/// Without a setting of its own the run is the paper's, and so is what stands beside it; only what was asked for differs.
#[test]
fn the_run_that_both_reports_at_the_top_is_the_impulsive_one() {
    let ((both, _), (plain, _)) = (&*BOTH, run(&[]));
    for (key, value) in
        plain.as_object().unwrap().iter().filter(|(key, _)| !["files", "request"].contains(&key.as_str()))
    {
        assert_eq!(&both[key], value, "{key}");
    }
    let [impulsive, compliant] =
        ["impulsive", "compliant"].map(|law| number(&both["laws"][law], "average_voltage_gain"));
    assert!((compliant / impulsive - 1.0).abs() > 0.01, "{impulsive} V/s and {compliant} V/s");
}

/// Under the compliant law the ball is beyond half of its travel as long as it is in a membrane. From communication points
/// alone, so the bound is the rounding of positions (1e-17 m) over the speed at the end of a contact (above 1e-3 m/s).
#[test]
fn compliant_contacts_last_as_long_as_the_ball_is_beyond_its_travel() {
    let (both, folder) = &*BOTH;
    let half_travel = 0.5 * (0.042 + 2.0 * 0.006 - 2.0 * 0.005);
    let series = columns(folder, "timeseries-compliant.csv", ["time", "relativeDisplacement"]);
    let beyond = |row: &[f64; 2]| row[1].abs() > half_travel + 1e-12;
    let intervals = series.windows(2).filter(|pair| beyond(&pair[0]) || beyond(&pair[1]));
    let expected: f64 = intervals.map(|pair| pair[1][0] - pair[0][0]).sum();
    let compliant = &both["laws"]["compliant"];
    assert!(expected > 0.1, "{expected} s");
    assert_relative_eq!(number(compliant, "time_in_contact"), expected, max_relative = 1e-9);
    assert_eq!(compliant["contacts"], compliant["impacts"], "each impact of this case is a contact of its own");
    let mean = number(compliant, "mean_contact_duration");
    assert_relative_eq!(mean * number(compliant, "contacts"), expected, max_relative = 1e-9);
    assert!(number(compliant, "largest_contact_duration") >= mean);
}

#[test]
fn the_largest_values_are_those_of_the_time_series() {
    let (both, folder) = &*BOTH;
    for law in ["impulsive", "compliant"] {
        for (key, names) in [
            ("largest_deflection", ["left.deflection", "right.deflection"]),
            ("largest_capacitance", ["left.capacitance", "right.capacitance"]),
        ] {
            let series = columns(folder, &format!("timeseries-{law}.csv"), names);
            let largest = series.into_iter().flatten().fold(0.0, f64::max);
            assert_eq!(number(&both["laws"][law], key), largest, "{law}: {key}");
        }
    }
}

/// The FMU sums up the time in contact by itself, without communication points.
#[test]
fn time_in_contact_is_what_the_fmu_sums_up() {
    let (both, _) = &*BOTH;
    let path = videg::package::build_all(&videg::package::Options::default()).unwrap().remove(0);
    let fmu = fmu_import::Fmu::open(&path).unwrap();
    let mut harvester = fmu.instantiate("harvester", fmu_import::Logging::default()).unwrap();
    for setting in both["settings"].as_array().unwrap() {
        harvester.set_by_name(setting["name"].as_str().unwrap(), setting["value"].as_str().unwrap()).unwrap();
    }
    harvester.set_by_name("contact.law", "compliant").unwrap();
    harvester.setup_experiment(0.0, None, None).unwrap();
    harvester.enter_initialization_mode().unwrap();
    harvester.exit_initialization_mode().unwrap();
    harvester.do_step(0.0, 5.0).unwrap();
    let mut time = [0.0];
    let reference = fmu.description().variable("contact.time").unwrap().value_reference;
    harvester.get_real(&[reference], &mut time).unwrap();
    // A start or an end closer than 1e-6 s (1e-3 of the step) to a point of the grid is not landed on.
    let compliant = &both["laws"]["compliant"];
    let bound = 2e-6 * number(compliant, "impacts");
    assert_relative_eq!(number(compliant, "time_in_contact"), time[0], epsilon = bound);
}

#[test]
fn the_folder_holds_both_time_series_one_figure_and_one_report() {
    let (both, folder) = &*BOTH;
    let names = ["timeseries-impulsive.csv", "timeseries-compliant.csv", "figure.svg", "report.html", "result.json"];
    let listed: Vec<_> = both["files"].as_array().unwrap().iter().map(|file| file.as_str().unwrap()).collect();
    assert_eq!(listed, names.map(|name| folder.path().join(name).to_str().unwrap().to_owned()));
    let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).unwrap();
    assert_eq!(serde_json::from_str::<Value>(&read("result.json")).unwrap(), *both);
    for file in ["figure.svg", "report.html"] {
        assert!(read(file).contains("impulsive law") && read(file).contains("compliant law"), "{file}");
    }
    assert!(read("report.html").contains("The compliant law gives a &#60;U&#62; of "));
}

/// No ball moves, no membrane is hit: nothing is divided by nothing.
#[test]
fn a_run_without_a_contact_has_no_durations() {
    let at_rest = ["excitation.amplitude=0", "initial.cylinderVelocity=0", "initial.ballVelocity=0"];
    let at_rest = at_rest.iter().flat_map(|setting| ["--set", *setting]);
    let centred = ["--set", "initial.ballPosition=0", "--set", "initial.cylinderPosition=0"];
    let arguments: Vec<_> = ["--law", "both"].into_iter().chain(at_rest).chain(centred).collect();
    let (both, _) = run(&arguments);
    for law in ["impulsive", "compliant"] {
        let law = &both["laws"][law];
        assert_eq!((number(law, "contacts"), number(law, "time_in_contact")), (0.0, 0.0));
        assert!(law["mean_contact_duration"].is_null() && law["largest_contact_duration"].is_null());
    }
}

/// A ball that comes to rest in each cycle by ever slower impacts, whose pulses are ever longer.
#[test]
fn pulses_that_overlap_earn_a_warning() {
    let (chattering, _) = run(&["--law", "both", "--case", "table3-2hz"]);
    let warnings: Vec<_> = chattering["warnings"].as_array().unwrap().iter().filter_map(Value::as_str).collect();
    let impacts = &chattering["laws"]["impulsive"]["impacts"];
    let expected = format!("contacts ended in {impacts} impacts");
    assert!(warnings.iter().any(|text| text.starts_with("impulsive law") && text.contains(&expected)), "{warnings:?}");
    assert!(!warnings.iter().any(|text| text.starts_with("compliant law")), "{warnings:?}");
    assert_eq!(BOTH.0["warnings"], serde_json::json!([]));
}

#[test]
fn a_setting_of_another_law_is_refused() {
    for (law, setting) in [("both", "impulsive"), ("both", "compliant"), ("compliant", "impulsive"), ("impulsive", "2")]
    {
        let folder = tempfile::tempdir().unwrap();
        let set = format!("contact.law={setting}");
        let output = simulate(folder.path(), &["--law", law, "--set", &set]);
        assert_refused(&output, &[&format!("--law {law}"), &format!("contact.law = {setting}")]);
    }
    let (found, _) = run(&["--law", "compliant", "--set", "contact.law=2"]);
    assert!(number(&found, "impacts") > 0.0);
}

#[test]
fn what_the_impulsive_law_cannot_do_names_that_law() {
    let folder = tempfile::tempdir().unwrap();
    let output = simulate(folder.path(), &["--law", "both", "--set", "contact.electrostaticFeedback=true"]);
    assert_refused(&output, &["--law both, impulsive law: contact.electrostaticFeedback = true"]);
}

/// The Maxwell force of the circuit's voltages acts under the compliant law: harvester and circuit book the same work, up to
/// the second order of the communication step (2.7e-5 of the energy moved at 1 ms).
#[test]
fn a_co_simulation_under_the_compliant_law_with_feedback_keeps_its_books() {
    let folder = tempfile::tempdir().unwrap();
    let mut command = tool(["cosim", "--json", "--until", "5", "--set", "contact.law=compliant"]);
    command.args(["--set", "contact.electrostaticFeedback=true", "--output"]).arg(folder.path());
    let found = json(&command.output().unwrap(), 0);
    assert!(number(&found, "impacts") > 0.0);
    assert!(number(&found["coupling"], "relative_residual").abs() < 1e-4, "{}", found["coupling"]);
}

/// The same of an inclined, suspended capsule with friction: all that moves energy is in the balance.
#[test]
fn a_co_simulation_of_an_inclined_suspended_rubbing_capsule_keeps_its_books() {
    let folder = tempfile::tempdir().unwrap();
    let settings = [
        "contact.law=compliant",
        "contact.electrostaticFeedback=true",
        "cylinder.inclination=0.01",
        "ball.friction=0.02",
        "cylinder.suspensionStiffness=3",
        "cylinder.suspensionDamping=0.01",
    ];
    let mut command = tool(["cosim", "--json", "--until", "5", "--adaptive", "1e-5", "--output"]);
    command.arg(folder.path()).args(settings.iter().flat_map(|setting| ["--set", setting]));
    let found = json(&command.output().unwrap(), 0);
    let balance = |key: &str| number(&found["balance"], key);
    assert!(number(&found, "impacts") > 5.0);
    for moved in ["friction", "gravity", "suspension", "damping"] {
        assert!(balance(moved) != 0.0, "{moved}");
    }
    assert!(balance("relative_residual") < 1e-5, "{}", found["balance"]);
    let of_cylinder = ["cylinder_kinetic", "suspension", "damping"].map(balance).iter().sum::<f64>();
    assert!((balance("excitation") - of_cylinder).abs() < 1e-12);
}
