//! What reaches a terminal, and how the tool ends where nobody reads what it says.

use std::io::PipeWriter;
use std::path::Path;
use std::process::{Command, Stdio};

use crate::command::{self, stderr as said, videg};

/// A sweep of two short runs into `folder`: of the first, or of both, the ball does not fit.
fn sweep(folder: &Path, radii: &str) -> Command {
    command::sweep(folder, &["--vary", &format!("membrane.initialRadius={radii}")])
}

const BOTH: &str = "0.001,0.0011";

/// A pipe whose reader has gone.
fn gone() -> PipeWriter {
    std::io::pipe().unwrap().1
}

#[test]
fn a_reader_that_has_gone_leaves_the_exit_code_as_it_would_have_been() {
    let guard = tempfile::tempdir().unwrap();
    let [some, all] = ["some", "all"].map(|name| guard.path().join(name));
    for (mut command, code) in [
        (sweep(&some, "0.001,0.00315"), 0),
        (sweep(&all, BOTH), 1),
        (videg(&["--help"]), 0),
        (videg(&["--version"]), 0),
        (videg(&["completions", "bash"]), 0),
        (videg(&["sweep", "--points", "0"]), 2),
        (videg(&["--nonsense"]), 2),
        (videg(&["fmu", "info", "missing.fmu"]), 2),
    ] {
        let output = command.stdout(gone()).output().unwrap();
        assert_eq!(output.status.code(), Some(code), "{command:?}: {}", said(&output));
        let output = command.stdout(Stdio::null()).stderr(gone()).output().unwrap();
        assert_eq!(output.status.code(), Some(code), "{command:?}");
    }
}

#[test]
fn control_characters_reach_no_terminal_and_leave_json_as_it_is() {
    let guard = tempfile::tempdir().unwrap();
    let folder = guard.path().join("a\u{1b}[2J\u{9b}b");
    let output = sweep(&folder, BOTH).output().unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.contains("a\\u{1b}[2J\\u{9b}b"), "{text}");
    assert!(!text.contains(|c: char| c.is_control() && c != '\n'), "{text:?}");
    let output = sweep(&folder, BOTH).arg("--json").output().unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(!text.contains(|c: char| c.is_control() && c != '\n'), "{text:?}");
    let json: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(json["files"][0], folder.join("sweep.csv").to_str().unwrap());
}
