//! Signals: the program ends its children, removes its temporary folders, and says by its exit code which signal it was.
#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, clippy::panic, reason = "a panic is how a test fails")]

use std::path::Path;
use std::process::{Command, Stdio};

#[path = "support/signals.rs"]
mod signals;
#[path = "hostile/toy.rs"]
mod toy;
#[path = "support/waiting.rs"]
mod waiting;

use waiting::wait_for;

fn has_ended(process: &str) -> bool {
    let stat = std::fs::read_to_string(Path::new("/proc").join(process).join("stat"));
    stat.map_or(true, |stat| stat.contains(") Z "))
}

/// The exit code of `program`, which has `signal` sent to it when the file at `mark` has the number of a child; that child is
/// gone then, and the folder of temporary files empty.
fn interrupted(program: &mut Command, signal: &str, mark: &Path, temporary: &Path) -> Option<i32> {
    let mut program = signals::with_default_signals(program.env("TMPDIR", temporary));
    let mut program = program.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    let child = wait_for(|| std::fs::read_to_string(mark).ok().filter(|text| text.ends_with('\n')));
    assert!(std::fs::read_dir(temporary).unwrap().count() > 0, "there is a folder to be removed");
    let id = program.id().to_string();
    assert!(Command::new("kill").args([&format!("-{signal}"), &id]).status().unwrap().success());
    let status = wait_for(|| program.try_wait().unwrap());
    let left: Vec<_> = std::fs::read_dir(temporary).unwrap().map(|entry| entry.unwrap().path()).collect();
    assert!(left.is_empty(), "{signal}: {left:?} stays");
    wait_for(|| has_ended(child.trim()).then_some(()));
    let told = std::io::read_to_string(program.stderr.take().unwrap()).unwrap();
    assert!(!told.contains("videg: "), "that the child was ended is nothing to tell: {told}");
    status.code()
}

#[test]
fn a_signal_leaves_neither_the_worker_of_an_fmu_nor_its_folder() {
    for (signal, code) in [("INT", 130), ("TERM", 143), ("HUP", 129), ("QUIT", 131)] {
        let folder = tempfile::tempdir().unwrap();
        let (mark, temporary) = (folder.path().join("pid"), folder.path().join("tmp"));
        std::fs::create_dir(&temporary).unwrap();
        let file = mark.display();
        let step = format!(
            "STEP=FILE *f = fopen(\"{file}\", \"w\"); fprintf(f, \"%d\\n\", getpid()); fclose(f); for (;;) pause();"
        );
        let path = toy::fmu(folder.path(), "toy.fmu", &[&step]);
        let mut program = Command::new(env!("CARGO_BIN_EXE_videg"));
        program.args(["fmu", "check"]).arg(path);
        assert_eq!(interrupted(&mut program, signal, &mark, &temporary), Some(code));
    }
}

#[test]
fn a_signal_leaves_neither_ngspice_nor_its_folder() {
    use std::os::unix::fs::PermissionsExt as _;
    let folder = tempfile::tempdir().unwrap();
    let (mark, temporary) = (folder.path().join("pid"), folder.path().join("tmp"));
    std::fs::create_dir(&temporary).unwrap();
    let ngspice = folder.path().join("ngspice");
    std::fs::write(&ngspice, format!("#!/bin/sh\necho $$ > '{}'\nsleep 300 & wait\n", mark.display())).unwrap();
    std::fs::set_permissions(&ngspice, std::fs::Permissions::from_mode(0o755)).unwrap();
    let mut program = Command::new(env!("CARGO_BIN_EXE_videg"));
    program.args(["crosscheck", "--until", "0.05", "--output"]).arg(folder.path().join("out"));
    program.env("VIDEG_NGSPICE", &ngspice);
    assert_eq!(interrupted(&mut program, "TERM", &mark, &temporary), Some(143));
}

/// As `nohup` starts it, and a shell in a script what ends in `&`.
#[test]
fn a_signal_that_the_program_was_started_to_ignore_stays_ignored() {
    let folder = tempfile::tempdir().unwrap();
    let mark = folder.path().join("pid");
    let file = mark.display();
    // The signals come during the first step.
    let step = format!(
        "STEP=static int n; if (!n++) {{ FILE *f = fopen(\"{file}\", \"w\"); fprintf(f, \"\\n\"); fclose(f); sleep(2); }}"
    );
    let path = toy::fmu(folder.path(), "toy.fmu", &[&step]);
    let mut program = Command::new("env");
    program
        .args(["--default-signal", "--ignore-signal=INT,HUP"])
        .arg(env!("CARGO_BIN_EXE_videg"))
        .args(["fmu", "check"]);
    let mut program = program.arg(path).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    wait_for(|| mark.exists().then_some(()));
    for signal in ["-INT", "-HUP"] {
        assert!(Command::new("kill").args([signal, &program.id().to_string()]).status().unwrap().success());
    }
    let code = wait_for(|| program.try_wait().unwrap()).code();
    assert!(!matches!(code, None | Some(129 | 130)), "{code:?}");
}
