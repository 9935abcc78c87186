//! Sweeps that are interrupted, disturbed or started again.

use std::fs;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use crate::command::{NOISY, assert_same_results, cut_after, done, folder, json, names, refused, size, stderr, sweep};
use crate::signals::with_default_signals;

/// A sweep far too long to be over before it is met at work: of 1e6 runs, one after the other.
fn endless(folder: &Path) -> Command {
    let what = ["--vary", "membrane.restitution=0.2:0.9:1000000", "--jobs", "1"];
    sweep(folder, &[&what[..], &NOISY].concat())
}

/// A sweep that takes a second or more, and whose runs differ in length.
const LONG: [&str; 8] =
    ["--design", "lhs", "--points", "400", "--samples", "3", "--vary", "membrane.restitution=0.2:0.9"];

/// A sweep of four runs.
const FOUR: [&str; 2] = ["--vary", "membrane.restitution=0.2:0.9:4"];

fn long(folder: &Path) -> Command {
    sweep(folder, &[&LONG[..], &NOISY].concat())
}

/// Lines of results that are being written.
fn lines_written(folder: &Path) -> usize {
    lines(&folder.join("sweep.csv.part"))
}

fn lines(results: &Path) -> usize {
    fs::read_to_string(results).map_or(0, |text| text.lines().count())
}

/// Starts a command and waits until it has written some lines, or is done.
fn started(mut command: Command, folder: &Path, lines: usize) -> Child {
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    let begun = Instant::now();
    while lines_written(folder) < lines && child.try_wait().unwrap().is_none() {
        assert!(begun.elapsed() < Duration::from_secs(120), "no line after two minutes");
        std::thread::sleep(Duration::from_millis(5));
    }
    child
}

#[test]
fn results_cut_or_spoilt_anywhere_are_completed_to_the_same_bytes() {
    let (_guard, folder) = folder();
    let [whole, cut] = ["whole", "cut"].map(|name| folder.join(name));
    let what = ["--vary", "membrane.restitution=0.2:0.9:40"];
    done(&mut sweep(&whole, &what));
    let mut random = fastrand::Rng::with_seed(2);
    for round in 0..12 {
        let length = random.usize(0..size(&whole));
        let more: &[u8] = if round % 3 == 0 { &[0; 5000] } else { b"" }; // what a power cut may leave
        let complete = cut_after(length, &whole, &cut, more);
        assert_eq!(json(&mut sweep(&cut, &what))["resumed_from"], complete, "cut at {length}");
        assert_same_results(&whole, &cut);
    }
}

#[test]
#[cfg(unix)]
fn an_interrupted_sweep_ends_in_order_and_says_how_to_go_on() {
    for (signal, code) in [("INT", 130), ("TERM", 143)] {
        let (_guard, folder) = folder();
        let mut command = with_default_signals(&endless(&folder));
        let mut child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
        while lines_written(&folder) < 2 && child.try_wait().unwrap().is_none() {
            std::thread::sleep(Duration::from_millis(5));
        }
        done(Command::new("kill").args([&format!("-{signal}"), &child.id().to_string()]));
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(code), "{}", stderr(&output));
        assert_eq!(names(&folder), ["sweep.csv.unfinished", "sweep.json"]);
        let kept = folder.join("sweep.csv.unfinished");
        let written = lines(&kept) - 1;
        assert!(written > 0);
        let expected = format!(
            "videg: interrupted after {written} of 1000000 runs, which are in {}; the same command without --fresh goes on \
             from there\n",
            kept.display()
        );
        assert_eq!(stderr(&output), expected);
    }
}

/// Files of a complete sweep with several samples.
#[cfg(unix)]
const COMPLETE: [&str; 5] = ["statistics.csv", "statistics.svg", "sweep.csv", "sweep.json", "sweep.parquet"];

#[test]
#[cfg(unix)]
#[ignore = "slow"]
fn a_sweep_interrupted_at_any_moment_leaves_nothing_half_written_and_ends_in_the_same_bytes() {
    let (_guard, folder) = folder();
    let [whole, broken] = ["whole", "broken"].map(|name| folder.join(name));
    done(&mut long(&whole));
    let mut random = fastrand::Rng::with_seed(3);
    for _ in 0..12 {
        let mut command = with_default_signals(&long(&broken));
        let mut child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        std::thread::sleep(Duration::from_millis(random.u64(20..500)));
        // It may have come to its end.
        let _ = Command::new("kill").args(["-INT", &child.id().to_string()]).stderr(Stdio::null()).status().unwrap();
        let code = child.wait().unwrap().code();
        // Without a code, it was met before it could watch for signals.
        assert!(matches!(code, None | Some(0 | 130)), "{code:?}");
        let there = if broken.exists() { names(&broken) } else { Vec::new() };
        let may_stay = |name: &String| COMPLETE.contains(&name.as_str()) || name == "sweep.csv.unfinished";
        assert!(there.iter().all(may_stay), "{there:?}");
        if code == Some(0) {
            fs::remove_dir_all(&broken).unwrap();
        }
    }
    done(&mut long(&broken));
    assert_same_results(&whole, &broken);
    assert_eq!(names(&broken), COMPLETE);
}

#[test]
fn the_same_command_again_does_nothing_and_another_one_is_refused_with_what_differs() {
    let (_guard, folder) = folder();
    done(&mut sweep(&folder, &FOUR));
    let before = fs::read(folder.join("sweep.csv")).unwrap();
    fs::remove_file(folder.join("sweep.parquet")).unwrap();
    let said = json(&mut sweep(&folder, &FOUR));
    assert_eq!((&said["resumed_from"], &said["runs"]), (&4.into(), &4.into()));
    assert_eq!(names(&folder), ["sweep.csv", "sweep.json", "sweep.parquet"]);
    for (more, named) in [
        (&["--seed", "2"][..], "--seed was 1, is 2"),
        (&["--set", "ball.mass=0.004"], "--set ball.mass was not given, is 0.004"),
        (&["--record", "ball.position"], "the column ball.position was not given, is real"),
    ] {
        let (code, message) = refused(&mut sweep(&folder, &[&FOUR[..], more].concat()));
        assert_eq!(code, Some(2));
        assert!(message.contains(&format!("it belongs to another sweep: {named}")), "{message}");
        let to_type =
            "; type the command with another --output to keep both, or with --fresh to replace what is there\n";
        assert!(message.ends_with(to_type) && !message.contains(['{', '[', '"']), "{message}");
    }
    assert_eq!(fs::read(folder.join("sweep.csv")).unwrap(), before);
    done(sweep(&folder, &FOUR).args(["--seed", "2", "--fresh"]));
    done(&mut sweep(&folder, &[&FOUR[..], &["--seed", "2"]].concat()));
}

/// That sweep, to go on behind `lines` of its results, as if it had been interrupted there.
fn interrupted_after(folder: &Path, lines: &[String]) -> Command {
    fs::remove_file(folder.join("sweep.csv")).unwrap();
    fs::write(folder.join("sweep.csv.part"), lines.join("\n") + "\n").unwrap();
    sweep(folder, &FOUR)
}

#[test]
fn results_of_another_build_are_not_gone_on_with_whatever_rows_failed_behind_them() {
    let (_guard, folder) = folder();
    done(&mut sweep(&folder, &FOUR));
    let text = fs::read_to_string(folder.join("sweep.csv")).unwrap();
    let mut lines: Vec<_> = text.lines().take(4).map(str::to_owned).collect();
    let cells: Vec<_> = lines[3].split(',').collect();
    lines[3] = format!("{},,,,took too long", cells[..4].join(","));
    done(&mut interrupted_after(&folder, &lines));
    let results = fs::read_to_string(folder.join("sweep.csv")).unwrap();
    assert!(results.starts_with(&lines.join("\n")) && results.lines().last() == text.lines().last(), "{results}");
    lines[2] = lines[2].replace(",0.000", ",0.001");
    let (code, message) = refused(&mut interrupted_after(&folder, &lines));
    assert!(code == Some(2) && message.contains("run 1 gives another result here"), "{message}");
}

#[test]
fn a_complete_file_that_was_changed_is_not_taken_for_complete() {
    let (_guard, folder) = folder();
    done(&mut sweep(&folder, &FOUR));
    let text = fs::read_to_string(folder.join("sweep.csv")).unwrap();
    fs::write(folder.join("sweep.csv"), text.replace("\n2,2,", "\n9,2,")).unwrap();
    let (code, message) = refused(&mut sweep(&folder, &FOUR));
    assert_eq!(code, Some(2));
    assert!(message.contains("line 4 is not run 2 of runs 0 to 3; --fresh begins anew"), "{message}");
}

#[test]
fn two_sweeps_do_not_write_one_file() {
    let (_guard, folder) = folder();
    let mut child = started(endless(&folder), &folder, 2);
    let (code, message) = refused(&mut endless(&folder));
    assert_eq!(code, Some(2));
    assert!(message.contains("sweep.csv.part is being written by another process"), "{message}");
    child.kill().unwrap();
    child.wait().unwrap();
}

#[test]
#[cfg(unix)]
#[ignore = "slow"]
fn a_full_disk_is_named_and_what_was_written_is_gone_on_with() {
    let (_guard, folder) = folder();
    let [whole, full] = ["whole", "full"].map(|name| folder.join(name));
    done(&mut long(&whole));
    // A limit on the length of files stands for the disk: 16 blocks of 512 or 1024 bytes.
    let mut limited = Command::new("sh");
    limited.args(["-c", "trap '' XFSZ; ulimit -f 16; exec \"$0\" \"$@\""]).arg(env!("CARGO_BIN_EXE_videg"));
    let (code, message) = refused(limited.args(long(&full).get_args()));
    assert_eq!(code, Some(2));
    assert!(
        message.contains("cannot write") && message.contains("the same command without --fresh goes on from there"),
        "{message}"
    );
    assert_eq!(names(&full), ["sweep.csv.unfinished", "sweep.json"]);
    assert!(message.contains(&*full.join("sweep.csv.unfinished").to_string_lossy()), "{message}");
    let said = json(&mut long(&full));
    assert!(said["resumed_from"].as_u64().unwrap() > 20, "{said}");
    assert_same_results(&whole, &full);
}
