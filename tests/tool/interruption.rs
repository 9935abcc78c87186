//! Signals: the program ends its children, removes its temporary folders, and says by its exit code which signal it was.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use tempfile::TempDir;

use crate::command::videg;
use crate::waiting::wait_for;
use crate::{has_ended, signals, toy};

/// The exit code of `program`, which has `signal` sent to it when the file at `mark` has the number of a child; that child is
/// gone then, and so is what was in the folder of temporary files, if anything `is_unpacked`.
fn interrupted(program: &mut Command, signal: &str, mark: &Path, temporary: &Path, is_unpacked: bool) -> Option<i32> {
    let mut program = signals::with_default_signals(program.env("TMPDIR", temporary));
    let mut program = program.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    let child = wait_for(|| std::fs::read_to_string(mark).ok().filter(|text| text.ends_with('\n')));
    assert_eq!(std::fs::read_dir(temporary).unwrap().count() > 0, is_unpacked, "to be removed");
    let id = program.id().to_string();
    assert!(Command::new("kill").args([&format!("-{signal}"), &id]).status().unwrap().success());
    let status = wait_for(|| program.try_wait().unwrap());
    let left: Vec<_> = std::fs::read_dir(temporary).unwrap().map(|entry| entry.unwrap().path()).collect();
    assert!(left.is_empty(), "{signal}: {left:?} stays");
    wait_for(|| has_ended(child.trim()).then_some(()));
    let told = std::io::read_to_string(program.stderr.take().unwrap()).unwrap();
    let told: Vec<_> = told.lines().filter(|line| line.starts_with("videg: ")).collect();
    assert!(
        told.len() == 1 && told[0].starts_with("videg: interrupted"),
        "that the child was ended is nothing to tell: {told:?}"
    );
    status.code()
}

/// A folder, the file in it that takes the number of a child, and the folder in it of temporary files.
fn folders() -> (TempDir, PathBuf, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let (mark, temporary) = (folder.path().join("pid"), folder.path().join("tmp"));
    std::fs::create_dir(&temporary).unwrap();
    (folder, mark, temporary)
}

/// The macro of an FMU that writes the number of its process to `mark` in this place, and takes its time.
fn pausing(place: &str, mark: &Path) -> String {
    let file = mark.display();
    format!("{place}=FILE *f = fopen(\"{file}\", \"w\"); fprintf(f, \"%d\\n\", getpid()); fclose(f); for (;;) pause();")
}

#[test]
fn a_signal_leaves_neither_the_worker_of_an_fmu_nor_its_folder() {
    for (signal, code) in [("INT", 130), ("TERM", 143), ("HUP", 129), ("QUIT", 131)] {
        let (folder, mark, temporary) = folders();
        let step = pausing("STEP", &mark);
        let path = toy::fmu(folder.path(), "toy.fmu", &[&step]);
        let program = &mut videg(&["fmu", "check"]);
        assert_eq!(interrupted(program.arg(path), signal, &mark, &temporary, true), Some(code));
    }
}

/// Once its runs have begun, it ends them in order; before, there is nothing to keep.
#[test]
fn a_signal_before_the_first_run_of_a_sweep_leaves_nothing() {
    let (folder, mark, temporary) = folders();
    let load = pausing("LOADING", &mark);
    let path = toy::fmu(folder.path(), "toy.fmu", &[&load]);
    let mut program = videg(&["sweep", "--samples", "2", "--until", "1", "--fmu"]);
    program.arg(path);
    program.arg("--output").arg(folder.path().join("out"));
    assert_eq!(interrupted(&mut program, "TERM", &mark, &temporary, true), Some(143));
    assert!(!folder.path().join("out").exists());
}

#[test]
fn a_signal_leaves_no_cargo_that_goes_on_building() {
    let (folder, mark, temporary) = folders();
    let cargo = script(folder.path(), "cargo", &mark);
    let mut program = videg(&["fmu", "build", "--output"]);
    program.arg(folder.path().join("out"));
    // Where nothing is built yet.
    program.env("CARGO", cargo).env("CARGO_TARGET_DIR", folder.path().join("target")).env_remove("VIDEG_NO_BUILD");
    assert_eq!(interrupted(&mut program, "TERM", &mark, &temporary, false), Some(143));
}

/// A program that writes its number to `mark` and takes its time.
fn script(folder: &Path, name: &str, mark: &Path) -> PathBuf {
    use std::os::unix::fs::PermissionsExt as _;
    let path = folder.join(name);
    std::fs::write(&path, format!("#!/bin/sh\necho $$ > '{}'\nsleep 300 & wait\n", mark.display())).unwrap();
    std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o755)).unwrap();
    path
}

#[test]
fn a_signal_leaves_neither_ngspice_nor_its_folder() {
    let (folder, mark, temporary) = folders();
    let ngspice = script(folder.path(), "ngspice", &mark);
    let mut program = videg(&["crosscheck", "--until", "0.05", "--output"]);
    program.arg(folder.path().join("out"));
    program.env("VIDEG_NGSPICE", &ngspice);
    assert_eq!(interrupted(&mut program, "TERM", &mark, &temporary, true), Some(143));
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
