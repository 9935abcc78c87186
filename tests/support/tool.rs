//! The command-line tool as a test runs it.
#![allow(dead_code, reason = "each test takes what it needs")]

use std::ffi::OsStr;
use std::process::{Command, Output};

use serde_json::Value;

/// The tool with these arguments.
pub fn tool(arguments: impl IntoIterator<Item = impl AsRef<OsStr>>) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_videg"));
    command.args(arguments);
    command
}

/// The text on stderr.
pub fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// The JSON document of a run that ended with `code`.
pub fn json(output: &Output, code: i32) -> Value {
    assert_eq!(output.status.code(), Some(code), "{}", said(output));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Checks that the run did not start: code 2, nothing on stdout, one line on stderr with all `parts`.
pub fn assert_refused(output: &Output, parts: &[&str]) {
    let said = said(output);
    assert_eq!((output.status.code(), output.stdout.len(), said.lines().count()), (Some(2), 0, 1), "{said}");
    for part in parts {
        assert!(said.contains(part), "{part} is not in: {said}");
    }
}
