//! Output on a terminal: no line is wider than the window, and colours come where they are wanted.

use std::path::Path;
use std::process::Command;

use unicode_width::UnicodeWidthStr as _;

use crate::command::{done, videg};

/// What a command prints on a terminal of these columns, with what `environment` says.
fn shown(folder: &Path, columns: usize, environment: &str, arguments: &str) -> String {
    let tool = env!("CARGO_BIN_EXE_videg");
    let line = format!("stty cols {columns} rows 50 && {environment} exec '{tool}' {arguments}");
    let mut script = Command::new("script");
    script.args(["--quiet", "--return", "--command", &line, "/dev/null"]).current_dir(folder);
    // A service of continuous integration sets CI, which asks for colours on any terminal.
    for name in ["NO_COLOR", "CLICOLOR_FORCE", "CLICOLOR", "CI", "COLUMNS"] {
        script.env_remove(name);
    }
    let output = script.env("TERM", "xterm-256color").stdin(std::process::Stdio::null()).output().unwrap();
    String::from_utf8(output.stdout).unwrap().replace("\r\n", "\n")
}

/// Whether the program that gives a terminal is there.
fn has_script() -> bool {
    let found = Command::new("script").arg("--version").output().is_ok();
    assert!(found || std::env::var_os("VIDEG_ALL_TOOLS").is_none(), "script (util-linux) is missing");
    found
}

/// A line as it stays: without colours, and without what a progress bar has overwritten.
fn lasting(line: &str) -> String {
    let last = line.rsplit('\r').next().unwrap_or_default();
    anstream::adapter::strip_str(last).to_string()
}

#[test]
fn no_line_is_wider_than_the_terminal() {
    if !has_script() {
        return;
    }
    let guard = tempfile::tempdir().unwrap();
    for arguments in [
        "--help",
        "cosim --help",
        "sweep --help",
        "cosim --until 2 --output cosim",
        "simulate --until 2 --law both",
        "simulate --until 2 --set membrane.restitutoin=0.5",
        "dynamics --samples 20 --transient 5 --orbits --periods 1 --output dynamics",
        "sweep --until 2 --vary membrane.restitution=0.5,0.6 --output sweep",
        "reproduce --quick table1 fig8 fig9 fig14",
        "export --until 2 --output x.lib",
    ] {
        for columns in [60, 80, 120] {
            let text = shown(guard.path(), columns, "", arguments);
            assert!(text.lines().count() > 1 || arguments.contains("restitutoin"), "{arguments}: {text}");
            // A progress bar goes back to its line.
            for line in text.lines().filter(|line| !line.ends_with("\u{1b}[1A")).map(lasting) {
                let width = line.width();
                assert!(width <= columns, "{arguments}: {width} columns on a terminal of {columns}:\n{line}");
            }
        }
    }
}

#[test]
fn colours_come_where_the_terminal_has_them_and_the_user_wants_them() {
    if !has_script() {
        return;
    }
    let guard = tempfile::tempdir().unwrap();
    let arguments = "reproduce table1 --output reproduce";
    let has_colour = |environment: &str| {
        let text = shown(guard.path(), 100, environment, arguments);
        assert!(text.contains("agrees"), "{text}");
        text.contains("\u{1b}[32magrees")
    };
    let found = ["", "NO_COLOR=1", "TERM=dumb", "NO_COLOR=1 CLICOLOR_FORCE=1"].map(has_colour);
    assert_eq!(found, [true, false, false, false]);
    assert!(shown(guard.path(), 100, "", "simulate --case nowhere").contains("\u{1b}[1m\u{1b}[31mvideg:"));
    let piped = |force: bool| {
        let mut command = videg(&["reproduce", "table1", "--output", "reproduce"]);
        command.current_dir(guard.path()).env_remove("NO_COLOR");
        if force {
            command.env("CLICOLOR_FORCE", "1");
        }
        String::from_utf8(done(&mut command).stdout).unwrap().contains('\u{1b}')
    };
    assert_eq!([piped(false), piped(true)], [false, true]);
}
