//! What verbs write, on a disk that fails: the old file or the new one, never half of it.

use std::path::Path;
use std::process::Command;

use crate::disk::{self, Fault, Files, files, is_partial};
use crate::extent;

/// A verb and what it writes, short.
type Verb = (&'static str, &'static [&'static str]);

const VERBS: [Verb; 3] = [
    ("cosim", &["cosim", "--until", "0.5", "--step", "0.01"]),
    ("simulate", &["simulate", "--until", "0.5", "--step", "0.01"]),
    ("fmu build", &["fmu", "build"]),
];

fn command(arguments: &[&str], folder: &Path) -> Command {
    let mut command = disk::videg(arguments);
    command.arg("--output").arg(folder);
    command
}

/// Runs the verb undisturbed in `folder`; what it leaves there.
fn written(arguments: &[&str], folder: &Path) -> Files {
    std::fs::create_dir_all(folder).unwrap();
    let output = command(arguments, folder).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    files(folder)
}

/// That each file is the old one or the new one.
fn assert_whole(folder: &Path, old: &Files, new: &Files, what: &str) {
    for (name, bytes) in files(folder).into_iter().filter(|(name, _)| !is_partial(name)) {
        let is_one = [old, new].into_iter().any(|files| files.get(&name) == Some(&bytes));
        assert!(is_one, "{what}: {name} is neither the old file nor the new one");
    }
    assert!(old.keys().all(|name| folder.join(name).exists()), "{what}: a file is gone");
}

/// Disturbs the verb at some of its calls, over files of before; how many faults hit it.
fn disturb(arguments: &[&str], at_most: u64, what: &str) -> u64 {
    let guard = tempfile::tempdir().unwrap();
    // Pages and results tell the folder that they are in: all are written into one of the same name.
    let folder = guard.path().join("results");
    let new = written(arguments, &folder);
    // The result says which run it is of: that of another one would be refused.
    let of_before = |(name, bytes): (&String, &Vec<u8>)| {
        (name.clone(), if name == "result.json" { bytes.clone() } else { b"old".to_vec() })
    };
    let old: Files = new.iter().map(of_before).collect();
    let restore = || {
        std::fs::remove_dir_all(&folder).unwrap();
        std::fs::create_dir(&folder).unwrap();
        for (name, bytes) in &old {
            std::fs::write(folder.join(name), bytes).unwrap();
        }
    };
    restore();
    let calls = disk::calls(&mut command(arguments, &folder), &folder);
    let (spacing, mut hits) = ((2 * calls).div_ceil(at_most).max(1), 0);
    for n in (1..=2 * calls).step_by(usize::try_from(spacing).unwrap()) {
        restore();
        let fault = if n % 2 == 0 {
            Fault::Killed { seed: n, at: n / 2 }
        } else {
            Fault::Failing { seed: n, one_in: calls.div_ceil(2) }
        };
        let end = disk::run(&mut command(arguments, &folder), &folder, fault);
        let what = format!("{what}: {fault:?} of {calls} calls, {end:?}");
        assert_whole(&folder, &old, &new, &what);
        disk::assert_names_a_file(&end, &folder, &what);
        if files(&folder).keys().any(|name| is_partial(name)) {
            let left: Vec<_> = written(arguments, &folder).into_keys().collect();
            assert!(left.iter().eq(new.keys()), "{what}: the next run leaves {left:?}");
        }
        hits += u64::from(end != disk::End::Done);
    }
    restore();
    assert_eq!(written(arguments, &folder).keys().collect::<Vec<_>>(), new.keys().collect::<Vec<_>>(), "{what}");
    println!("{what}: {hits} faults at {calls} calls");
    hits
}

#[test]
#[ignore = "slow"]
fn a_fault_in_the_middle_of_any_verb_leaves_each_file_old_or_new() {
    for (name, arguments) in VERBS {
        assert!(disturb(arguments, extent(24, 400), name) > 5, "{name}");
    }
}

#[test]
#[ignore = "slow"]
fn a_fault_in_the_middle_of_reproduce_leaves_each_file_old_or_new() {
    let arguments = ["reproduce", "--quick", "table1", "fig7"];
    assert!(disturb(&arguments, extent(12, 100), "reproduce") > 3);
}

#[test]
fn two_runs_into_one_folder_do_not_mix_their_files() {
    let guard = tempfile::tempdir().unwrap();
    let folder = guard.path().join("results");
    let mut long = command(&["simulate", "--until", "1e5"], &folder).spawn().unwrap();
    while !folder.join("timeseries.csv.part").exists() {
        assert!(long.try_wait().unwrap().is_none(), "it ended early");
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    let output = command(&["simulate", "--until", "1"], &folder).output().unwrap();
    long.kill().unwrap();
    long.wait().unwrap();
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(said.contains("timeseries.csv: another process is writing it"), "{said}");
    assert_eq!(output.status.code(), Some(2));
}
