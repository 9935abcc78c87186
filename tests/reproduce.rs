//! `videg reproduce`: its numbers, its files, and what it says to bad input.
#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::Duration;

use serde_json::Value;
use tool::{assert_refused, json, said, tool};

#[path = "support/signals.rs"]
mod signals;
#[path = "support/tool.rs"]
mod tool;
#[path = "support/waiting.rs"]
mod waiting;

fn reproduce(folder: &Path, arguments: &[&str]) -> Output {
    tool(["reproduce", "--json", "--output"]).arg(folder).args(arguments).output().unwrap()
}

fn made(folder: &Path, arguments: &[&str]) -> Value {
    json(&reproduce(folder, arguments), 0)
}

/// A finding of an item, by the beginning of its quantity.
fn finding<'a>(run: &'a Value, item: &str, place: &str, quantity: &str) -> &'a Value {
    let items = run["items"].as_array().unwrap();
    let findings = items.iter().find(|made| made["name"] == item).unwrap()["findings"].as_array().unwrap();
    let is =
        |finding: &&Value| finding["place"] == place && finding["quantity"].as_str().unwrap().starts_with(quantity);
    findings.iter().find(is).unwrap()
}

fn close(value: &Value, expected: f64, tolerance: f64) {
    let value = value.as_f64().unwrap();
    assert!((value / expected - 1.0).abs() <= tolerance, "{value} for {expected}");
}

/// The columns of a CSV file with a line of headings; an empty cell is NaN.
fn columns(path: &Path) -> Vec<Vec<f64>> {
    let text = fs::read_to_string(path).unwrap();
    let rows: Vec<Vec<f64>> = text
        .lines()
        .skip(1)
        .map(|line| line.split(',').map(|cell| cell.parse().unwrap_or(f64::NAN)).collect())
        .collect();
    (0..rows[0].len()).map(|k| rows.iter().map(|row| row[k]).collect()).collect()
}

#[test]
#[ignore = "slow"]
fn table_3_is_reproduced_and_its_2_hz_row_is_shown_to_be_an_artefact_of_stepping() {
    let folder = tempfile::tempdir().unwrap();
    let run = made(folder.path(), &["table3"]);
    let power = |frequency: &str, quantity: &str| finding(&run, "table3", &format!("Table 3, {frequency}"), quantity);
    close(&power("5 Hz", "P, Eq. (14)")["videg"], 0.1321, 1e-3);
    assert_eq!(power("5 Hz", "P, Eq. (14)")["verdict"], "agrees");
    assert_eq!(power("5 Hz", "power density")["verdict"], "agrees");
    close(&power("2 Hz", "P, Eq. (14)")["videg"], 0.0530, 2e-3);
    assert_eq!(power("2 Hz", "P, Eq. (14)")["verdict"], "explained");
    close(&power("2 Hz", "P by the paper's")["videg"], 0.061, 1e-2);
    let columns = columns(&folder.path().join("table3.csv"));
    let (steps, powers, impacts) = (&columns[0], &columns[1], &columns[2]);
    let at = |step: f64| steps.iter().position(|&other| other == step).unwrap();
    // What the paper's method gives depends on the step, and the impacts that it counts grow without bound.
    for (step, power) in [(1e-4, 0.0652), (1e-5, 0.0612), (1e-6, 0.0591)] {
        assert!((powers[at(step)] / power - 1.0).abs() < 2e-3, "{} at {step}", powers[at(step)]);
    }
    assert!(impacts[at(1e-6)] > 5.0 * impacts[at(1e-5)] && impacts[at(1e-5)] > 5.0 * impacts[at(1e-4)]);
    // Without rest there is nothing to count twice.
    let fast = &columns[5];
    assert!((fast[at(1e-6)] / fast[at(1e-5)] - 1.0).abs() < 1e-3, "{fast:?}");
}

#[test]
fn the_stages_the_force_law_and_the_shape_are_those_of_the_paper() {
    let folder = tempfile::tempdir().unwrap();
    let run = made(folder.path(), &["table1", "fig4", "fig7"]);
    close(&finding(&run, "fig4", "Eq. (2)", "K,")["videg"], 4.0847e5, 1e-6);
    close(&finding(&run, "fig4", "Eq. (2)", "n,")["videg"], 2.6, 1e-9);
    assert_eq!(finding(&run, "fig7", "Figure 7", "A_3 / A_2")["verdict"], "agrees");
    let stages = columns(&folder.path().join("table1.csv"));
    let (area, thickness, capacitance, voltage, charge) = (&stages[2], &stages[3], &stages[4], &stages[5], &stages[6]);
    for k in 0..4 {
        assert!((area[k] * thickness[k] / (area[0] * thickness[0]) - 1.0).abs() < 1e-12, "incompressible");
        assert!((charge[k] - 1e-3 * capacitance[k] * voltage[k]).abs() < 1e-9, "nC of pF and V");
    }
    assert!((capacitance[2] / capacitance[1] - (area[2] / area[1]).powi(2)).abs() < 1e-9, "Eq. (1)");
    assert!((charge[3] / charge[2] - 1.0).abs() < 1e-12 && voltage[3] > voltage[2], "the charge is kept");
    for file in ["table1", "fig4", "fig7"] {
        for extension in ["csv", "svg", "png"] {
            assert!(fs::metadata(folder.path().join(file).with_extension(extension)).unwrap().len() > 100);
        }
    }
    let report = fs::read_to_string(folder.path().join("report.html")).unwrap();
    assert!(["Table 1", "Figure 4", "Figure 7", "Versions"].iter().all(|heading| report.contains(heading)));
}

#[test]
fn a_harvesting_cycle_has_the_corners_of_table_1_and_lies_within_them() {
    let folder = tempfile::tempdir().unwrap();
    let run = made(folder.path(), &["table1", "fig8"]);
    let stages = columns(&folder.path().join("table1.csv"));
    let (capacitance, voltage) = (&stages[4], &stages[5]);
    let number = |quantity: &str| finding(&run, "fig8", "Figure 8(b)", quantity)["videg"].as_f64().unwrap();
    let enclosed = number("the cycle 2-3-4 over W");
    assert!((enclosed / (capacitance[2] / capacitance[1] - 1.0) - 1.0).abs() < 1e-9, "{enclosed}");
    let path = columns(&folder.path().join("fig8.csv"));
    assert!(path[0].len() > 100 && path[0].windows(2).all(|pair| pair[0] < pair[1]));
    let largest = |column: usize| path[column].iter().copied().fold(0.0, f64::max);
    assert!((largest(1) / capacitance[2] - 1.0).abs() < 1e-4, "it goes through stage 3");
    for kind in 0..3 {
        let (volts, charge) = (&path[2 + 2 * kind], &path[3 + 2 * kind]);
        for (k, charge) in charge.iter().enumerate() {
            assert!((charge - 1e-3 * path[1][k] * volts[k]).abs() < 1e-9, "nC of pF and V");
            assert!(volts[k] >= voltage[1] - 1e-6 && volts[k] <= voltage[3] + 1e-6);
        }
    }
    // A slow discharge comes near stage 4; a storage holds its voltage; the idle membrane takes its share.
    assert!(largest(2) > 0.95 * voltage[3] && (largest(4) - 2911.0).abs() < 1e-6 && largest(6) < 0.8 * voltage[3]);
    let triangle = 0.5e-6 * voltage[1] * voltage[1] * (capacitance[2] - capacitance[1]) * enclosed;
    let slow = number("converted in a cycle, switch") / triangle;
    assert!(slow > 0.9 && slow < 1.0, "{slow} of the triangle");
    // Of a path that closes: what it encloses.
    let area: f64 = (0..path[0].len())
        .map(|k| (k, (k + 1) % path[0].len()))
        .map(|(k, next)| 0.5e-3 * (path[4][k] + path[4][next]) * (path[5][k] - path[5][next]))
        .sum();
    let storage = number("converted in a cycle, storage");
    assert!((area / storage - 1.0).abs() < 1e-3, "{area} uJ for {storage}");
}

#[test]
fn a_name_that_does_not_exist_is_an_error_with_a_hint_and_nothing_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let output = reproduce(&folder.path().join("out"), &["fig41"]);
    assert_refused(&output, &["reproduce fig41: no such table or figure; did you mean fig4?", "table1", "all"]);
    assert!(!folder.path().join("out").exists());
}

#[test]
fn without_ngspice_only_the_crosscheck_by_name_fails() {
    let folder = tempfile::tempdir().unwrap();
    let run = |name: &str| {
        let mut command = tool(["reproduce", name, "--json", "--output"]);
        command.arg(folder.path()).env("VIDEG_NGSPICE", "/nowhere").output().unwrap()
    };
    let named = run("crosscheck");
    assert_eq!(named.status.code(), Some(2));
    assert!(said(&named).contains("/nowhere"));
    assert_eq!(run("table1").status.code(), Some(0));
}

#[test]
#[ignore = "slow"]
fn the_same_command_gives_the_same_bytes_of_data_on_any_number_of_cores() {
    let folders = [tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap()];
    let items = ["table1", "table2", "fig10", "fig11", "fig16", "tuning", "dynamics", "--quick"];
    let cores = std::thread::available_parallelism().unwrap().get();
    made(folders[0].path(), &items);
    // One core, where the system can be asked for it.
    let mut alone = Command::new("taskset");
    alone.args(["-c", "0", env!("CARGO_BIN_EXE_videg"), "reproduce", "--json", "--output"]).arg(folders[1].path());
    let alone = alone.args(items).output();
    if cores == 1 || !alone.is_ok_and(|output| output.status.success()) {
        made(folders[1].path(), &items);
    }
    let mut compared = 0;
    for entry in fs::read_dir(folders[0].path()).unwrap() {
        let name = entry.unwrap().file_name();
        if Path::new(&name).extension().is_some_and(|extension| extension == "csv" || extension == "svg") {
            let [one, other] = folders.each_ref().map(|folder| fs::read(folder.path().join(&name)).unwrap());
            assert!(one == other, "{}", name.display());
            compared += 1;
        }
    }
    assert!(compared >= 8, "{compared} files");
}

#[test]
fn a_folder_that_cannot_be_made_is_an_error() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    fs::write(&file, "").unwrap();
    assert_refused(&reproduce(&file.join("below"), &["table1"]), &["cannot make the output folder"]);
}

/// What stands in a folder and the folders in it.
fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).into_iter().flatten().map(|entry| entry.unwrap().path());
    entries.flat_map(|path| if path.is_dir() { files(&path) } else { vec![path] }).collect()
}

fn assert_nothing_is_half_written(folder: &Path) {
    let there = files(folder);
    assert!(!there.iter().any(|path| path.extension().is_some_and(|extension| extension == "part")), "{there:?}");
}

#[test]
#[cfg(target_os = "linux")]
fn a_signal_leaves_nothing_half_written_and_the_last_line_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let mut random = fastrand::Rng::with_seed(1);
    for round in 0..8 {
        let mut command = tool(["reproduce", "table1", "fig7", "audit", "--quick", "--output"]);
        command.arg(folder.path());
        let mut command = signals::with_default_signals(&command);
        let mut child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
        let part = folder.path().join("audit/timeseries.csv.part");
        if round == 0 {
            waiting::wait_for(|| part.exists().then_some(()));
        } else {
            std::thread::sleep(Duration::from_millis(random.u64(100..3000)));
        }
        let _ = Command::new("kill").args(["-INT", &child.id().to_string()]).stderr(Stdio::null()).status().unwrap();
        let code = child.wait().unwrap().code();
        let said = std::io::read_to_string(child.stderr.take().unwrap()).unwrap();
        assert_nothing_is_half_written(folder.path());
        let last = said.lines().last().unwrap_or_default();
        let (is_told, is_removed) = (last.contains("is complete"), last.contains(&*part.to_string_lossy()));
        match code {
            Some(130) => assert!(said.is_empty() || last.starts_with("videg: interrupted; "), "{said}"),
            code => assert!(round > 0 && matches!(code, None | Some(0)), "{code:?}: {said}"),
        }
        assert!(round > 0 || (is_told && is_removed), "{said}");
    }
}

#[test]
#[cfg(unix)]
#[ignore = "slow"]
fn a_failure_leaves_nothing_half_written_and_says_so() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("fig7.csv")).unwrap();
    let output = reproduce(folder.path(), &["table1", "fig7"]);
    let said = said(&output);
    assert_eq!(output.status.code(), Some(2), "{said}");
    let complete = format!("; what is in {} is complete, of this run or an earlier one", folder.path().display());
    assert!(said.contains("cannot write") && said.contains("fig7.csv") && said.contains(&complete), "{said}");
    assert!(folder.path().join("table1.csv").is_file());
    assert_nothing_is_half_written(folder.path());
    // A limit on the length of files stands for a full disk: the time series of 100 s gets longer than 4 or 8 MB.
    let mut limited = Command::new("sh");
    limited.args(["-c", "trap '' XFSZ; ulimit -f 8192; exec \"$0\" \"$@\"", env!("CARGO_BIN_EXE_videg")]);
    let output = limited.args(["reproduce", "audit", "--output"]).arg(folder.path()).output().unwrap();
    let said = tool::said(&output);
    assert!(output.status.code() == Some(2) && said.contains("timeseries.csv: File too large"), "{said}");
    assert!(said.contains(&complete) && !said.contains(".part"), "{said}");
    assert_nothing_is_half_written(folder.path());
}
