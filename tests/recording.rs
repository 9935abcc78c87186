//! A recorded excitation on the command line: wherever its file is and whoever reads it, the run is the same.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a panic is how a test fails")]

use std::fmt::Write as _;
use std::path::Path;
use std::process::Command;

use serde_json::Value;
use tempfile::TempDir;

/// What the tool prints, in this folder.
fn videg(folder: &Path, arguments: &[&str]) -> Result<String, String> {
    let output = Command::new(env!("CARGO_BIN_EXE_videg")).args(arguments).current_dir(folder).output().unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    if output.status.success() { Ok(text(output.stdout)) } else { Err(text(output.stderr)) }
}

fn gain(folder: &Path, arguments: &[&str]) -> f64 {
    let run = [&["simulate", "--json", "--until", "5"], arguments].concat();
    let result: Value = serde_json::from_str(&videg(folder, &run).unwrap()).unwrap();
    result["average_voltage_gain"].as_f64().unwrap()
}

/// Writes the cosine of Fig. 14 as an acceleration of this size, m/s2, once in each millisecond of 5 s.
fn write(path: &Path, amplitude: f64) {
    let mut text = "time,acceleration\n".to_owned();
    for k in 0..=5000 {
        let time = f64::from(k) / 1000.0;
        writeln!(text, "{time},{}", amplitude * (4.0 * std::f64::consts::PI * time).cos()).unwrap();
    }
    std::fs::write(path, text).unwrap();
}

/// A folder with the recording `shaker.csv`.
fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    write(&folder.path().join("shaker.csv"), 4.0);
    folder
}

const MOTION: [&str; 2] = ["--set", "excitation.kind=motion"];

#[test]
fn a_cosine_recorded_is_nearly_the_cosine_itself_and_the_report_shows_it() {
    let folder = folder();
    let recorded = [&MOTION[..], &["--set", "excitation.file=shaker.csv", "--fresh", "--output", "out"]].concat();
    let exact = gain(folder.path(), &[&MOTION[..], &["--set", "excitation.acceleration=4"]].concat());
    let found = gain(folder.path(), &recorded);
    // Straight lines over a millisecond leave out up to 1/2 (4 pi 0.5e-3)^2 = 2e-5 of the cosine.
    assert!((found / exact - 1.0).abs() < 1e-3 && found != exact, "{found} for {exact}");
    let report = std::fs::read_to_string(folder.path().join("out/report.html")).unwrap();
    assert!(
        report
            .contains("with the recording shaker.csv; (b) its one-sided amplitude spectrum in m/s2, from 5000 samples")
    );
}

#[test]
fn a_file_is_found_from_where_the_user_stands_beside_a_case_file_and_for_an_isolated_fmu() {
    let folder = folder();
    let here = [&MOTION[..], &["--set", "excitation.file=shaker.csv"]].concat();
    let expected = gain(folder.path(), &here);
    assert_eq!(gain(folder.path(), &[&here[..], &["--isolate"]].concat()), expected);

    let elsewhere = tempfile::tempdir().unwrap();
    let case = folder.path().join("case.toml");
    std::fs::write(&case, "[set]\nexcitation.kind = 'motion'\nexcitation.file = 'shaker.csv'\n").unwrap();
    assert_eq!(gain(elsewhere.path(), &["--case-file", case.to_str().unwrap()]), expected);
    let error = videg(elsewhere.path(), &[&["simulate"], &here[..]].concat()).unwrap_err();
    assert!(error.contains("excitation.file = \"shaker.csv\": No such file"), "{error}");
}

#[test]
fn a_sweep_varies_files_and_their_scale() {
    let folder = folder();
    write(&folder.path().join("weak.csv"), 2.0);
    let sweep = |output: &str, vary: [&str; 2]| {
        let until = ["sweep", "--until", "5", "--output", output];
        let vary = ["--vary", vary[0], "--vary", vary[1]];
        videg(folder.path(), &[&until[..], &MOTION, &vary].concat()).unwrap();
        let results = std::fs::read_to_string(folder.path().join(output).join("sweep.csv")).unwrap();
        let rows = results.lines().skip(1).map(|row| row.split(',').map(str::to_owned).collect::<Vec<_>>());
        rows.collect::<Vec<_>>()
    };
    let rows = sweep("both", ["excitation.file=shaker.csv,weak.csv", "excitation.fileScale=0.5,1"]);
    let names: Vec<_> = rows.iter().map(|row| (row[3].as_str(), row[4].as_str())).collect();
    assert_eq!(names, [("shaker.csv", "0.5"), ("shaker.csv", "1.0"), ("weak.csv", "0.5"), ("weak.csv", "1.0")]);
    let gain = |row: &[String]| row[5].parse::<f64>().unwrap();
    let halved = (gain(&rows[0]) / gain(&rows[3]) - 1.0).abs();
    assert!(halved < 1e-6, "half of 4 m/s2 are 2 m/s2: {rows:?}");
    assert!(gain(&rows[0]) != gain(&rows[1]));
}

#[test]
fn a_resource_is_in_the_harvester_alone_and_its_archive_is_reproducible() {
    let folder = folder();
    let build = |output: &str| {
        let arguments = ["fmu", "build", "--resource", "shaker.csv", "--output", output];
        videg(folder.path(), &arguments).unwrap();
        ["VibroImpactHarvester", "HarvestingCircuit"]
            .map(|name| std::fs::read(folder.path().join(output).join(format!("{name}.fmu"))).unwrap())
    };
    assert!(build("first") == build("second"), "the same archives");
    let contains = |archive: &[u8]| archive.windows(20).any(|bytes| bytes == b"resources/shaker.csv");
    let [harvester, circuit] = build("first");
    assert!(contains(&harvester) && !contains(&circuit));
    let info = videg(folder.path(), &["fmu", "info", "--json", "first/VibroImpactHarvester.fmu"]).unwrap();
    let info: Value = serde_json::from_str(&info).unwrap();
    let variables = info["variables"].as_array().unwrap();
    let file = variables.iter().find(|variable| variable["name"] == "excitation.file").unwrap();
    assert_eq!((&file["type"], &file["start"]), (&Value::from("String"), &Value::from("")));
    videg(folder.path(), &["fmu", "check", "first/VibroImpactHarvester.fmu"]).unwrap();
    let twice = ["fmu", "build", "--resource", "shaker.csv", "--resource", "shaker.csv", "--output", "third"];
    let error = videg(folder.path(), &twice).unwrap_err();
    assert!(error.contains("file shaker.csv: resources/shaker.csv is in the FMU already"), "{error}");
}
