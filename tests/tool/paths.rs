//! Paths that are not UTF-8, and what lies there without being a file.

use std::ffi::OsStr;
use std::os::unix::ffi::OsStrExt as _;
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

use crate::command::videg;
use crate::toy;

/// Runs a command, which must end by itself.
fn ended(command: &mut Command) -> Output {
    let mut child = command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let end = Instant::now() + Duration::from_secs(60);
    while child.try_wait().unwrap().is_none() {
        if Instant::now() > end {
            child.kill().unwrap();
            panic!("{command:?} waits for ever");
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    child.wait_with_output().unwrap()
}

#[test]
fn an_isolated_fmu_may_lie_and_be_unpacked_where_paths_are_not_utf_8() {
    let folder = tempfile::tempdir().unwrap();
    let temporary = folder.path().join(OsStr::from_bytes(b"t\xff"));
    std::fs::create_dir(&temporary).unwrap();
    let fmu = folder.path().join(OsStr::from_bytes(b"k\xff.fmu"));
    std::fs::rename(toy::fmu(folder.path(), "toy.fmu", &[]), &fmu).unwrap();
    let output = ended(videg(&["fmu", "check"]).arg(&fmu).env("TMPDIR", &temporary));
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    assert_eq!(std::fs::read_dir(&temporary).unwrap().count(), 0);
}

#[test]
fn pipes_that_nobody_writes_are_refused_and_not_waited_for() {
    let folder = tempfile::tempdir().unwrap();
    let make = |name: &str| {
        std::fs::create_dir_all(folder.path().join(name).parent().unwrap()).unwrap();
        assert!(Command::new("mkfifo").arg(folder.path().join(name)).status().unwrap().success());
    };
    make("pipe");
    make("shard/sweep.json");
    make("libVibroImpactHarvester.so");
    for (arguments, named) in [
        (&["fmu", "info", "pipe"][..], "pipe"),
        (&["fmu", "check", "pipe"], "pipe"),
        (&["fmu", "build", "--add-binary", "linux64=libVibroImpactHarvester.so"], "libVibroImpactHarvester.so"),
        (&["simulate", "--case-file", "pipe", "--output", "out"], "pipe"),
        (&["sweep", "pipe", "--output", "out"], "pipe"),
        (&["sweep", "merge", "shard", "--output", "out"], "shard/sweep.json"),
    ] {
        let output = ended(videg(arguments).current_dir(folder.path()));
        let told = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {told}");
        assert!(told.ends_with(&format!("{named}: it is a pipe, not a regular file\n")), "{arguments:?}: {told}");
    }
}

#[test]
fn a_case_file_may_come_through_a_pipe_that_the_shell_has_opened() {
    let folder = tempfile::tempdir().unwrap();
    let mut command = Command::new("sh");
    let run = "echo 'untill = 3' | \"$0\" simulate --case-file /dev/stdin --output out";
    command.args(["-c", run, env!("CARGO_BIN_EXE_videg")]).current_dir(folder.path());
    let output = ended(&mut command);
    let told = String::from_utf8(output.stderr).unwrap();
    assert!(told.contains("/dev/stdin: ") && told.contains("unknown field `untill`"), "it was read: {told}");
}
