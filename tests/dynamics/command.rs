//! The verb as a user meets it: files, `--json`, refusals.

use std::process::Command;

use serde_json::Value;

/// Exit code, stdout and stderr of `videg dynamics` in a folder of its own, and the files there.
fn dynamics(arguments: &[&str]) -> (Option<i32>, String, String, Vec<String>) {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("out");
    let run = Command::new(env!("CARGO_BIN_EXE_videg"))
        .args(["dynamics", "--output"])
        .arg(&output)
        .args(arguments)
        .current_dir(folder.path())
        .output()
        .unwrap();
    let mut files: Vec<String> = std::fs::read_dir(&output)
        .map(|entries| entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect())
        .unwrap_or_default();
    files.sort();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    (run.status.code(), text(run.stdout), text(run.stderr), files)
}

#[test]
fn everything_that_is_asked_for_is_written_and_said() {
    let (code, stdout, stderr, files) = dynamics(&[
        "--case",
        "capsule-1-1",
        "--orbits",
        "--periods",
        "1",
        "--basins",
        "5",
        "--samples",
        "20",
        "--vary",
        "cylinder.length=0.4:0.6:11",
        "--json",
    ]);
    assert_eq!((code, stderr.as_str()), (Some(0), ""));
    let expected = [
        "basins.csv",
        "basins.png",
        "basins.svg",
        "bifurcation.csv",
        "bifurcation.png",
        "bifurcation.svg",
        "bifurcations.csv",
        "branches.csv",
        "multipliers.png",
        "multipliers.svg",
        "orbit-impacts.csv",
        "orbits.csv",
        "poincare.csv",
        "poincare.png",
        "poincare.svg",
        "report.html",
        "result.json",
    ];
    assert_eq!(files, expected);
    let found: Value = serde_json::from_str(&stdout).unwrap();
    let stable = found["orbits"].as_array().unwrap().iter().find(|orbit| orbit["stable"] == true).unwrap();
    assert_eq!(
        (&stable["impacts_left"], &stable["impacts_right"], &stable["order"]),
        (&1.into(), &1.into(), &"LR".into())
    );
    assert_eq!(found["recurrence"], 1);
    assert!(found["lyapunov_exponent"].as_f64().unwrap() < 0.0);
    let gains = [&stable["average_voltage_gain"], &found["average_voltage_gain"]].map(|gain| gain.as_f64().unwrap());
    assert!((gains[0] - gains[1]).abs() < 1e-6 * gains[0], "{gains:?}");
    let bifurcations =
        found["branches"].as_array().unwrap().iter().flat_map(|it| it["bifurcations"].as_array().unwrap());
    assert!(bifurcations.into_iter().any(|it| it["kind"] == "period doubling"));
    let shares = found["attractors"].as_array().unwrap().iter().map(|it| it["share"].as_f64().unwrap());
    assert!((shares.sum::<f64>() - 1.0).abs() < 1e-12);
}

#[test]
fn a_measured_membrane_is_found_beside_its_case_file() {
    let folder = tempfile::tempdir().unwrap();
    let deflections = (0..=100).map(|k| 1e-4 * f64::from(k));
    let rows: Vec<_> = deflections.map(|x| format!("{x:e},{:e}", 408_470.0 * x.powf(2.6))).collect();
    std::fs::write(folder.path().join("film.csv"), format!("deflection,force\n{}\n", rows.join("\n"))).unwrap();
    let file = folder.path().join("own.toml");
    let text = "case = 'fig14'\n[set]\nmembrane.law = 'table'\nmembrane.file = 'film.csv'\n";
    std::fs::write(&file, text).unwrap();
    let gain = |arguments: &[&str]| {
        let (code, stdout, stderr, _) = dynamics(&[arguments, &["--samples", "10", "--json"]].concat());
        assert_eq!(code, Some(0), "{stderr}");
        serde_json::from_str::<Value>(&stdout).unwrap()["average_voltage_gain"].as_f64().unwrap()
    };
    let [measured, power] = [gain(&["--case-file", file.to_str().unwrap()]), gain(&["--case", "fig14"])];
    assert!((measured / power - 1.0).abs() < 1e-4, "{measured} {power}");
}

#[test]
fn what_cannot_run_ends_with_2_and_one_line_that_names_it() {
    let cases: [(&[&str], &[&str]); 14] = [
        (&["--set", "excitation.phaseNoise=0.5"], &["excitation.phaseNoise = 0.5", "repeats"]),
        (&["--orbits", "--vary", "initial.ballPosition=0:1e-3:3"], &["--vary initial.ballPosition"]),
        (&["--vary", "contact.law=impulsive,compliant"], &["--vary contact.law", "real parameter"]),
        (&["--vary", "membrane.restitution=0.5"], &["--vary membrane.restitution", "at least 2"]),
        (&["--vary", "membrane.restitution=0.5:1.5:5"], &["membrane.restitution = 1.25"]),
        (&["--vary", "membrane.restitution=0.1:0.9"], &["--vary membrane.restitution", "needs a count"]),
        (&["--vary", "membrane.restitution=0:1:1000000"], &["--vary membrane.restitution", "1000000", "100000"]),
        (&["--vary", "membrane.restitution=0:1:100000", "--samples", "1000"], &["--samples 1000", "20000000"]),
        (&["--set", "externalForce=0.1"], &["externalForce"]),
        (&["--set", "excitation.file=shaker.csv"], &["excitation.file = \"shaker.csv\"", "No such file"]),
        (&["--set", "membrane.law=table", "--set", "membrane.file=film.csv"], &["membrane.file = \"film.csv\""]),
        (&["--set", "membrane.law=table"], &["membrane.law = table", "membrane.file"]),
        (&["--samples", "3"], &["--samples", "4..=1000000"]),
        (&["--basins", "10", "--basins-speed", "nan"], &["--basins-speed NaN"]),
    ];
    for (arguments, parts) in cases {
        let (code, stdout, stderr, files) = dynamics(arguments);
        assert_eq!((code, stdout.as_str(), files.len()), (Some(2), "", 0), "{arguments:?}: {stderr}");
        assert_eq!(stderr.lines().count(), 1, "{arguments:?}: {stderr}");
        assert!(parts.iter().all(|part| stderr.contains(part)), "{arguments:?}: {stderr}");
    }
}
