//! The runner against programs that misbehave.

use std::os::unix::fs::PermissionsExt as _;
use std::time::Instant;

use super::*;
use videg_circuit::Parameters;

/// A circuit with 10 ms of C(t).
fn circuit() -> (Elements, CapacitanceTable, Run) {
    let table = CapacitanceTable::new(&[0.0, 0.01], &[15e-12, 16e-12], &[15e-12; 2]).unwrap();
    let elements = Elements::new(&Parameters::default(), table.growth()).unwrap();
    let run = Run::new(table.until(), table.growth());
    (elements, table, run)
}

/// A shell script in the place of ngspice, in a folder with a name that a shell would trip over.
fn fake(script: &str) -> (tempfile::TempDir, Ngspice) {
    let folder = tempfile::Builder::new().prefix("a '$(touch pwned)'; \"b").tempdir().unwrap();
    let program = folder.path().join("ng spice;touch pwned");
    std::fs::write(&program, format!("#!/bin/sh\n{script}\n")).unwrap();
    std::fs::set_permissions(&program, std::fs::Permissions::from_mode(0o755)).unwrap();
    let ngspice = Ngspice::find(Some(&program)).unwrap();
    (folder, ngspice)
}

fn message(script: &str) -> String {
    let (folder, mut ngspice) = fake(script);
    ngspice.time_limit = Duration::from_secs(20);
    let (elements, table, run) = circuit();
    let result = ngspice.simulate(&elements, &table, &run);
    let left: Vec<_> = std::fs::read_dir(folder.path()).unwrap().collect();
    assert_eq!(left.len(), 1, "something was executed: {left:?}");
    result.unwrap_err().to_string()
}

#[test]
fn a_missing_program_is_named_with_how_to_get_it() {
    for path in ["/no/such/ngspice", "/tmp", "$(touch pwned)"] {
        let error = Ngspice::find(Some(Path::new(path))).unwrap_err().to_string();
        assert!(error.contains(path) && error.contains("apt install ngspice"), "{error}");
    }
    let error = Ngspice::on_path(Some(OsStr::new("/no/such/folder:relative"))).unwrap_err().to_string();
    assert!(error.starts_with("ngspice not found: no ngspice on the PATH"), "{error}");
}

#[test]
fn a_failure_and_success_without_a_result_carry_the_lines_of_ngspice() {
    let error = message("echo 'Error: no such node'; exit 3");
    assert_eq!(error, "ngspice failed (exit status: 3)\n  ngspice: Error: no such node");
    let error = message("echo 'doAnalyses: TRAN:  Timestep too small' >&2; echo 'tran simulation(s) aborted'");
    assert!(error.starts_with("ngspice stopped at 0 s, before the end of the run at 0.01 s"), "{error}");
    assert!(error.contains("Timestep too small") && error.contains("aborted"), "{error}");
}

#[test]
fn half_a_result_is_a_failure_that_says_how_far_it_got() {
    let header = "Flags: real\\nNo. Variables: 7\\nNo. Points: 1\\nVariables:\\n0 time t\\n1 v(videg_cl) v\\n2 v(videg_cr) v\\n\
                  3 v(de) v\\n4 v(out) v\\n5 i(vs) i\\n6 i(vr) i\\nBinary:\\n";
    let script = format!("printf '{header}' > harvesting.raw; head -c 56 /dev/zero >> harvesting.raw");
    let error = message(&script);
    assert!(error.starts_with("ngspice stopped at 0 s"), "{error}");
    let error = message(&script.replace("head -c 56", "head -c 55"));
    assert!(error.contains("ends at point 0 of 1"), "{error}");
}

#[test]
fn a_program_that_hangs_is_ended_with_its_children() {
    let (_folder, mut ngspice) = fake("sleep 1000 & echo $! > \"$0.child\"; wait");
    ngspice.time_limit = Duration::from_secs(1);
    let (elements, table, run) = circuit();
    let error = ngspice.simulate(&elements, &table, &run).unwrap_err();
    assert!(matches!(error, NgspiceError::TimeLimit { limit: 1.0, .. }), "{error}");
    let child = ngspice.program().with_file_name("ng spice;touch pwned.child");
    let id: i32 = std::fs::read_to_string(child).unwrap().trim().parse().unwrap();
    // Gone, or a zombie that waits for its new parent; the system takes its time.
    let ended = || {
        let state = std::fs::read_to_string(format!("/proc/{id}/stat")).unwrap_or_default();
        state.is_empty() || state.contains(") Z ")
    };
    let start = Instant::now();
    while !ended() && start.elapsed() < Duration::from_secs(60) {
        std::thread::sleep(Duration::from_millis(5));
    }
    assert!(ended());
}

#[test]
fn what_a_program_leaves_running_neither_delays_nor_outlives_it() {
    let start = Instant::now();
    let error = message("sleep 100 & echo 'Error: no such node'; exit 3");
    assert!(error.ends_with("\n  ngspice: Error: no such node"), "{error}");
    let error = message("setsid sleep 30 & echo 'Error: no such node'; sleep 1; exit 3");
    assert!(error.ends_with("\n  ngspice: Error: no such node"), "it was sent away: {error}");
    assert!(start.elapsed() < Duration::from_secs(25), "{:?}", start.elapsed());
}

#[test]
fn a_pipe_in_the_place_of_a_result_is_not_waited_for() {
    let error = message("mkfifo harvesting.raw");
    assert!(error.ends_with("harvesting.raw: it is a pipe, not a regular file"), "{error}");
}

#[test]
fn a_flood_of_messages_is_bounded_and_harmless() {
    let error = message("yes 'error: \u{1b}[31mflood' | head -c 50000000; exit 1");
    assert!(error.len() < 3000 && error.contains("flood") && !error.contains('\u{1b}'), "{}", error.len());
}

#[test]
fn the_folder_of_a_run_is_removed_and_an_export_holds_two_files() {
    let Some(ngspice) = Ngspice::for_tests() else { return };
    let (elements, table, run) = circuit();
    let netlist = elements.netlist(CapacitanceSource::Table, table.initial(), &run).unwrap();
    let output = ngspice.run(&netlist, &table).unwrap();
    let folder = output.folder.path().to_owned();
    assert!(output.raw().unwrap().is_some());
    drop(output);
    assert!(!folder.exists());
    let export = tempfile::Builder::new().prefix("$(touch x)\n.control").tempdir().unwrap();
    Ngspice::export(export.path(), &netlist, &table).unwrap();
    let mut files: Vec<_> = std::fs::read_dir(export.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    files.sort();
    assert_eq!(files, ["capacitance.tab", "harvesting.cir"]);
    assert!(!netlist.text().contains("touch"));
}

/// A real ngspice behind a script that stops, with the words of ngspice, where the shell finds `stops` true. `$until` is the
/// length of the piece, `$tries` counts the runs of the one of 4 ms.
fn stopping(real: &Ngspice, stops: &str) -> (tempfile::TempDir, Ngspice) {
    fake(&format!(
        "until=$(sed -n 's/^tran [^ ]* \\([^ ]*\\) .*/\\1/p' harvesting.cir)\n\
         if [ \"$until\" = 4e-3 ]; then echo x >> \"$0.tries\"; tries=$(wc -l < \"$0.tries\"); fi\n\
         if {stops}; then echo 'doAnalyses: TRAN:  Timestep too small' >&2; exit 0; fi\n\
         exec '{}' \"$@\"",
        real.program().display()
    ))
}

/// 10 ms in pieces of 3 ms and 4 ms.
fn in_pieces(stops: &str) -> Option<SolverRun> {
    let real = Ngspice::for_tests()?;
    let (_folder, ngspice) = stopping(&real, stops);
    let time: Vec<f64> = (0..=10).map(|k| f64::from(k) * 1e-3).collect();
    let left: Vec<f64> = (0..=10).map(|k| 15e-12 + f64::from(k) * 1e-13).collect();
    let table = CapacitanceTable::new(&time, &left, &[15e-12; 11]).unwrap();
    let elements = Elements::new(&Parameters::default(), table.growth()).unwrap();
    let run = Run { piece: 3e-3, ..Run::new(table.until(), table.growth()) };
    Some(ngspice.follow(&elements, &table, &run, &|_| ()).unwrap())
}

#[test]
fn a_piece_in_which_ngspice_stops_is_repeated_with_changes_that_are_told() {
    let Some(found) = in_pieces("[ \"$until\" = 4e-3 ] && [ $tries -lt 3 ]") else { return };
    assert!(found.stop.is_none(), "{:?}", found.stop);
    assert_eq!(found.waveforms.samples.len(), 11);
    let [first, second] = &found.repeated[..] else { panic!("{:?}", found.repeated) };
    assert!(first.starts_with("steps of at most 5e-5 s in place of 1e-4 s from 0.006 s to 0.01 s"), "{first}");
    assert!(second.starts_with("steps of at most 2e-5 s"), "{second}");
}

#[test]
fn what_was_found_before_ngspice_gave_up_is_kept() {
    let Some(found) = in_pieces("[ \"$until\" = 4e-3 ]") else { return };
    assert_eq!(found.waveforms.samples.len(), 7, "0 to 6 ms");
    assert!(found.waveforms.ledger().supply > 0.0);
    let error = found.stop.unwrap().to_string();
    assert!(error.starts_with("ngspice stopped at 0.006 s, before the end of the run at 0.01 s"), "{error}");
    assert_eq!(found.repeated.len(), 2);
}
