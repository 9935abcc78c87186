//! `videg sweep` as a command, and what stands in its folder.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use serde_json::Value;
use tempfile::TempDir;

/// Two seconds, averaged over the second.
pub const SHORT: [&str; 2] = ["--until", "2"];

pub const NOISY: [&str; 2] = ["--set", "excitation.phaseNoise=0.5"];

pub fn videg(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_videg"));
    command.args(arguments);
    command
}

/// A sweep of short runs into a folder.
pub fn sweep(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = videg(&["sweep"]);
    command.args(SHORT).args(arguments).arg("--output").arg(folder);
    command
}

pub fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Runs a command that must be done.
pub fn done(command: &mut Command) -> Output {
    let output = command.output().unwrap();
    assert!(output.status.success(), "{command:?}: {}", stderr(&output));
    output
}

/// Runs a command to its end, after it has been killed again and again.
#[allow(dead_code, reason = "not every test that includes this kills")]
pub fn run_though_killed(command: impl Fn() -> Command) {
    let mut random = fastrand::Rng::with_seed(5);
    for _ in 0..8 {
        let mut child = command().stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        std::thread::sleep(std::time::Duration::from_millis(random.u64(5..300)));
        child.kill().unwrap();
        child.wait().unwrap();
    }
    done(&mut command());
}

/// The JSON object of a command that must be done.
pub fn json(command: &mut Command) -> Value {
    serde_json::from_slice(&done(command.arg("--json")).stdout).unwrap()
}

/// What a command that must fail says; its exit code.
pub fn refused(command: &mut Command) -> (Option<i32>, String) {
    let output = command.output().unwrap();
    assert!(!output.status.success() && output.stdout.is_empty(), "{command:?}");
    let message = stderr(&output);
    assert_eq!(message.lines().count(), 1, "{message}");
    (output.status.code(), message)
}

pub fn folder() -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("sweep");
    (folder, path)
}

pub fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let mut names: Vec<_> = entries.map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

pub fn assert_same_results(one: &Path, other: &Path) {
    assert_eq!(names(one), names(other));
    for name in names(one) {
        let [a, b] = [one, other].map(|folder| fs::read(folder.join(&name)).unwrap());
        assert!(a == b, "{name} of {} and of {} differ", one.display(), other.display());
    }
}

/// What the sweep in `whole` leaves in `cut` if it ends after `length` bytes, with `more` behind them. Returns how many runs are complete.
pub fn cut_after(length: usize, whole: &Path, cut: &Path, more: &[u8]) -> usize {
    fs::remove_dir_all(cut).ok();
    fs::create_dir(cut).unwrap();
    fs::copy(whole.join("sweep.json"), cut.join("sweep.json")).unwrap();
    let bytes = fs::read(whole.join("sweep.csv")).unwrap();
    fs::write(cut.join("sweep.csv.part"), [&bytes[..length], more].concat()).unwrap();
    let lines = bytes[..length].split(|byte| *byte == b'\n').count() - 1;
    lines.saturating_sub(1)
}

/// Bytes of the results in `folder`.
pub fn size(folder: &Path) -> usize {
    fs::read(folder.join("sweep.csv")).unwrap().len()
}

pub fn rows(folder: &Path) -> Vec<Vec<String>> {
    let mut reader = csv::ReaderBuilder::new().has_headers(false).from_path(folder.join("sweep.csv")).unwrap();
    reader.records().map(|record| record.unwrap().iter().map(str::to_owned).collect()).collect()
}

pub fn column(folder: &Path, name: &str) -> Vec<String> {
    let rows = rows(folder);
    let index = rows[0].iter().position(|heading| heading == name).unwrap();
    rows[1..].iter().map(|row| row[index].clone()).collect()
}
