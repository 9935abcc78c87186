//! `videg sweep` through the binary: the same bytes however a sweep is interrupted, divided or computed, and what it
//! says to bad input.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a panic is how a test fails")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

use parquet::file::reader::{FileReader as _, SerializedFileReader};
use parquet::record::{Field, RowAccessor as _};
use serde_json::Value;
use tempfile::TempDir;

/// Two seconds, averaged over the second.
const SHORT: [&str; 2] = ["--until", "2"];
const NOISY: [&str; 2] = ["--set", "excitation.phaseNoise=0.5"];

fn videg(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_videg"));
    command.args(arguments);
    command
}

/// A sweep of short runs into a folder.
fn sweep(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = videg(&["sweep"]);
    command.args(SHORT).args(arguments).arg("--output").arg(folder);
    command
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Runs a command that must be done.
fn done(command: &mut Command) -> Output {
    let output = command.output().unwrap();
    assert!(output.status.success(), "{command:?}: {}", stderr(&output));
    output
}

/// The JSON object of a command that must be done.
fn json(command: &mut Command) -> Value {
    serde_json::from_slice(&done(command.arg("--json")).stdout).unwrap()
}

/// What a command that must fail says; its exit code.
fn refused(command: &mut Command) -> (Option<i32>, String) {
    let output = command.output().unwrap();
    assert!(!output.status.success() && output.stdout.is_empty(), "{command:?}");
    let message = stderr(&output);
    assert_eq!(message.lines().count(), 1, "{message}");
    (output.status.code(), message)
}

fn folder() -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("sweep");
    (folder, path)
}

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let mut names: Vec<_> = entries.map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

fn assert_same_results(one: &Path, other: &Path) {
    for name in ["sweep.csv", "sweep.json", "sweep.parquet"] {
        let [a, b] = [one, other].map(|folder| fs::read(folder.join(name)).unwrap());
        assert!(a == b, "{name} of {} and of {} differ", one.display(), other.display());
    }
}

fn rows(folder: &Path) -> Vec<Vec<String>> {
    let mut reader = csv::ReaderBuilder::new().has_headers(false).from_path(folder.join("sweep.csv")).unwrap();
    reader.records().map(|record| record.unwrap().iter().map(str::to_owned).collect()).collect()
}

fn column(folder: &Path, name: &str) -> Vec<String> {
    let rows = rows(folder);
    let index = rows[0].iter().position(|heading| heading == name).unwrap();
    rows[1..].iter().map(|row| row[index].clone()).collect()
}

#[test]
fn a_run_of_a_sweep_is_the_run_that_simulate_makes() {
    let (_guard, folder) = folder();
    json(&mut sweep(&folder, &["--case", "fig15", "--vary", "membrane.restitution=0.3,0.7"]));
    let alone = tempfile::tempdir().unwrap();
    for (index, restitution) in ["0.3", "0.7"].iter().enumerate() {
        let setting = format!("membrane.restitution={restitution}");
        let mut simulate = videg(&["simulate", "--case", "fig15", "--set", &setting, "--output"]);
        let simulated = json(simulate.arg(alone.path()).args(SHORT));
        for name in ["average_voltage_gain", "average_power_eq13"] {
            let swept: f64 = column(&folder, name)[index].parse().unwrap();
            assert_eq!(swept, simulated[name].as_f64().unwrap(), "{name} at r = {restitution}");
        }
    }
}

#[test]
fn the_order_of_rows_is_that_of_runs_and_each_has_its_seed() {
    let (_guard, folder) = folder();
    let vary = ["--vary", "excitation.amplitude=0.3:0.5:3", "--vary", "contact.law=impulsive,compliant"];
    let said = json(sweep(&folder, &vary).args(["--samples", "2", "--seed", "40"]));
    assert_eq!((&said["points"], &said["runs"], &said["failed"]), (&6.into(), &12.into(), &0.into()));
    let first: Vec<_> = rows(&folder).iter().map(|row| row[..6].join(",")).collect();
    assert_eq!(first[0], "run,point,sample,excitation.amplitude,contact.law,excitation.seed");
    assert_eq!(first[1..4], ["0,0,0,0.3,impulsive,40", "1,0,1,0.3,impulsive,41", "2,1,0,0.3,compliant,42"]);
    assert_eq!(first[12], "11,5,1,0.5,compliant,51");
    assert_eq!(rows(&folder)[0][6..], ["average_voltage_gain", "average_power_eq13", "impacts", "error"]);
    let mut common = sweep(&folder, &vary);
    done(common.args(["--samples", "2", "--seed", "40", "--common-seeds", "--fresh"]));
    assert_eq!(column(&folder, "excitation.seed"), ["40", "41"].repeat(6));
}

#[test]
fn the_model_itself_and_its_fmu_give_the_same_bytes() {
    done(&mut videg(&["fmu", "build"]));
    let archive = Path::new(env!("CARGO_MANIFEST_DIR")).join("target/fmu/VibroImpactHarvester.fmu");
    let (_guard, folder) = folder();
    let [built_in, fmu] = ["a", "b"].map(|name| folder.join(name));
    let what =
        ["--vary", "membrane.restitution=0.2:1:5", "--vary", "contact.law=impulsive,compliant", "--samples", "2"];
    let what = [&what[..], &NOISY, &["--window", "0.3,1.7"]].concat();
    done(&mut sweep(&built_in, &what));
    done(sweep(&fmu, &what).arg("--fmu").arg(archive));
    let [a, b] = [&built_in, &fmu].map(|folder| fs::read_to_string(folder.join("sweep.csv")).unwrap());
    assert_eq!(a, b);
    // What the model itself does not offer is recorded through its FMU: the rest stays as it is.
    let recorded = folder.join("c");
    done(sweep(&recorded, &what).args(["--record", "impact.count", "--record", "contact.resting"]));
    for name in ["average_voltage_gain", "average_power_eq13", "impacts"] {
        assert_eq!(column(&built_in, name), column(&recorded, name));
    }
    assert!(column(&recorded, "impact.count").iter().all(|count| count.parse::<i32>().unwrap() > 3));
    assert!(column(&recorded, "contact.resting").iter().all(|resting| resting == "false"));
}

#[test]
fn any_fmu_is_swept_once_it_is_said_what_to_record() {
    done(&mut videg(&["fmu", "build"]));
    let archive = Path::new(env!("CARGO_MANIFEST_DIR")).join("target/fmu/HarvestingCircuit.fmu");
    let archive = archive.to_str().unwrap();
    let (_guard, folder) = folder();
    let what = ["--fmu", archive, "--vary", "load.resistance=log:1e8:1e10:3"];
    let recorded = [&what[..], &["--record", "load.voltage", "--record", "supply.energy", "--step", "0.1"]].concat();
    assert_eq!(json(&mut sweep(&folder, &recorded))["case"], "HarvestingCircuit");
    let heading = ["run", "point", "sample", "load.resistance", "load.voltage", "supply.energy", "error"];
    assert_eq!(rows(&folder)[0], heading);
    assert_eq!(column(&folder, "load.resistance"), ["100000000.0", "1000000000.0", "10000000000.0"]);
    assert!(column(&folder, "load.voltage").iter().all(|voltage| voltage.parse::<f64>().unwrap().is_finite()));
    assert_eq!(column(&folder, "error"), [""; 3]);
    for (more, named) in [
        (&[][..], "HarvestingCircuit has no gain.voltage, so say what to record"),
        (
            &["--samples", "2"],
            "--samples 2: HarvestingCircuit has no excitation.seed; name its seed by --seed-variable",
        ),
        (&["--case", "fig14"], "--case: HarvestingCircuit is not the harvester, of which the cases are"),
        (&["--set", "ball.mass=1"], "ball.mass"),
    ] {
        let (code, message) = refused(&mut sweep(&folder, &[&what[..], more].concat()));
        assert!(code == Some(2) && message.contains(named), "{message}");
    }
}

/// A sweep far too long to be over before it is met at work: of 1e6 runs, one after the other.
fn endless(folder: &Path) -> Command {
    let what = ["--vary", "membrane.restitution=0.2:0.9:1000000", "--jobs", "1"];
    sweep(folder, &[&what[..], &NOISY].concat())
}

/// A sweep that takes a second or more, and whose runs differ in length.
const LONG: [&str; 8] =
    ["--design", "lhs", "--points", "400", "--samples", "3", "--vary", "membrane.restitution=0.2:0.9"];

fn long(folder: &Path) -> Command {
    sweep(folder, &[&LONG[..], &NOISY].concat())
}

/// Lines of results that are being written.
fn lines_written(folder: &Path) -> usize {
    fs::read_to_string(folder.join("sweep.csv.part")).map_or(0, |text| text.lines().count())
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
fn a_sweep_that_is_killed_again_and_again_gives_the_same_bytes() {
    let (_guard, folder) = folder();
    let [whole, killed] = ["whole", "killed"].map(|name| folder.join(name));
    done(&mut long(&whole));
    let mut random = fastrand::Rng::with_seed(1);
    for _ in 0..6 {
        let lines = lines_written(&killed) + random.usize(1..150);
        let mut command = long(&killed);
        command.args(["--jobs", "1"]);
        let mut child = started(command, &killed, lines);
        child.kill().unwrap();
        if child.wait().unwrap().success() {
            break; // It came to its end before it was met, on a machine that is in a hurry.
        }
        assert!(!killed.join("sweep.parquet").exists() || killed.join("sweep.csv").exists());
    }
    let kept = lines_written(&killed).saturating_sub(1);
    let said = json(&mut long(&killed));
    // The last line may have been cut; a sweep that came to its end has no such file any more.
    let resumed_from = said["resumed_from"].as_u64().unwrap();
    assert!(resumed_from == 1200 || resumed_from.abs_diff(kept as u64) <= 1, "{said} after {kept}");
    assert_same_results(&whole, &killed);
    assert_eq!(names(&killed), ["sweep.csv", "sweep.json", "sweep.parquet"]);
}

#[test]
fn results_cut_or_spoilt_anywhere_are_completed_to_the_same_bytes() {
    let (_guard, folder) = folder();
    let [whole, cut] = ["whole", "cut"].map(|name| folder.join(name));
    let what = ["--vary", "membrane.restitution=0.2:0.9:40"];
    done(&mut sweep(&whole, &what));
    let bytes = fs::read(whole.join("sweep.csv")).unwrap();
    let mut random = fastrand::Rng::with_seed(2);
    for round in 0..12 {
        fs::remove_dir_all(&cut).ok();
        fs::create_dir(&cut).unwrap();
        fs::copy(whole.join("sweep.json"), cut.join("sweep.json")).unwrap();
        let length = random.usize(0..bytes.len());
        let mut part = bytes[..length].to_vec();
        if round % 3 == 0 {
            part.extend([0; 5000]); // what a power cut may leave
        }
        fs::write(cut.join("sweep.csv.part"), part).unwrap();
        let said = json(&mut sweep(&cut, &what));
        let lines = bytes[..length].split(|byte| *byte == b'\n').count() - 1;
        assert_eq!(said["resumed_from"], lines.saturating_sub(1), "cut at {length}");
        assert_same_results(&whole, &cut);
    }
}

#[test]
#[cfg(unix)]
fn an_interrupted_sweep_ends_in_order_and_says_how_to_go_on() {
    for (signal, code) in [("INT", 130), ("TERM", 143)] {
        let (_guard, folder) = folder();
        let mut command = endless(&folder);
        let mut child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
        while lines_written(&folder) < 2 && child.try_wait().unwrap().is_none() {
            std::thread::sleep(Duration::from_millis(5));
        }
        done(Command::new("kill").args([&format!("-{signal}"), &child.id().to_string()]));
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(code), "{}", stderr(&output));
        let written = lines_written(&folder) - 1;
        assert!(written > 0);
        let expected = format!(
            "videg: interrupted after {written} of 1000000 runs; the same command without --fresh goes on from there\n"
        );
        assert_eq!(stderr(&output), expected);
    }
}

#[test]
fn shards_in_one_folder_or_many_merge_to_the_bytes_of_the_whole() {
    let (_guard, folder) = folder();
    let [whole, shared, merged, again] = ["whole", "shared", "merged", "again"].map(|name| folder.join(name));
    let what = [&["--vary", "membrane.restitution=0.2:1.1:10", "--samples", "3"][..], &NOISY].concat();
    done(&mut sweep(&whole, &what));
    let apart: Vec<_> = (1..=4).map(|number| folder.join(format!("shard{number}"))).collect();
    for (number, apart) in (1..=4).rev().zip(apart.iter().rev()) {
        for folder in [&shared, apart] {
            let said = json(sweep(folder, &what).args(["--shard", &format!("{number}/4")]));
            assert_eq!(said["shard"], format!("{number}/4"));
            assert!([7, 8].contains(&said["runs"].as_u64().unwrap()));
        }
    }
    let said = json(videg(&["sweep", "merge", "--output"]).arg(&merged).arg(&shared));
    assert_eq!((&said["runs"], &said["failed"]), (&30.into(), &3.into()));
    done(videg(&["sweep", "merge"]).args(&apart).arg("--output").arg(&again));
    assert_same_results(&whole, &merged);
    assert_same_results(&whole, &again);
}

#[test]
fn shards_that_do_not_make_a_whole_are_refused() {
    let (_guard, folder) = folder();
    let part = |name: &str, what: &[&str]| {
        let folder = folder.join(name);
        done(&mut sweep(&folder, what));
        folder
    };
    let vary = ["--vary", "membrane.restitution=0.2:0.9:8"];
    let with = |shard: &'static str| [&vary[..], &["--shard", shard]].concat();
    let [one, two, three] = ["1/3", "2/3", "3/3"].map(|shard| part(&shard.replace('/', "-"), &with(shard)));
    let twice = part("twice", &with("2/3"));
    let other_division = part("halves", &with("2/2"));
    let foreign = part("foreign", &[&with("3/3")[..], &["--seed", "9"]].concat());
    let empty = folder.join("empty");
    fs::create_dir(&empty).unwrap();
    let output = folder.join("merged");
    let refused = |folders: &[&PathBuf]| {
        let (code, message) = refused(videg(&["sweep", "merge", "--output"]).arg(&output).args(folders));
        assert_eq!(code, Some(2));
        assert!(!output.join("sweep.csv").exists());
        message
    };
    let message = refused(&[&one, &three]);
    assert!(message.contains("1 of 3 shards are missing or not complete, the first of them 2/3"), "{message}");
    let message = refused(&[&one, &two, &three, &twice]);
    assert!(message.contains("shard 2/3 is there twice, as "), "{message}");
    let message = refused(&[&one, &other_division]);
    assert!(message.contains("shards, others are of "), "{message}");
    let message = refused(&[&one, &two, &foreign]);
    assert!(message.contains("it belongs to another sweep than ") && message.contains("seed is 1, not 9"), "{message}");
    let message = refused(&[&one, &empty]);
    assert!(message.contains("cannot read") && message.contains("sweep.json"), "{message}");
    let text = fs::read_to_string(two.join("sweep.2-of-3.csv")).unwrap();
    fs::write(two.join("sweep.2-of-3.csv"), text.replace("\n3,", "\n4,")).unwrap();
    let message = refused(&[&one, &two, &three]);
    assert!(message.contains("sweep.2-of-3.csv: line 3 is not run 3 of runs 2 to 4"), "{message}");
}

#[test]
fn the_same_command_again_does_nothing_and_another_one_is_refused_with_what_differs() {
    let (_guard, folder) = folder();
    let what = ["--vary", "membrane.restitution=0.2:0.9:4"];
    done(&mut sweep(&folder, &what));
    let before = fs::read(folder.join("sweep.csv")).unwrap();
    fs::remove_file(folder.join("sweep.parquet")).unwrap();
    let said = json(&mut sweep(&folder, &what));
    assert_eq!((&said["resumed_from"], &said["runs"]), (&4.into(), &4.into()));
    assert_eq!(names(&folder), ["sweep.csv", "sweep.json", "sweep.parquet"]);
    for (more, named) in [
        (&["--seed", "2"][..], "seed is 1, not 2"),
        (&["--set", "ball.mass=0.004"], "settings is [], not [{\"name\":\"ball.mass\",\"value\":\"0.004\"}]"),
        (&["--window", "0.5,2"], "window is [1.0], not [0.5]"),
        (&["--samples", "2"], "samples is 1, not 2"),
    ] {
        let (code, message) = refused(&mut sweep(&folder, &[&what[..], more].concat()));
        assert_eq!(code, Some(2));
        assert!(message.contains("it belongs to another sweep") && message.contains(named), "{message}");
    }
    assert_eq!(fs::read(folder.join("sweep.csv")).unwrap(), before);
    done(sweep(&folder, &what).args(["--seed", "2", "--fresh"]));
    done(&mut sweep(&folder, &[&what[..], &["--seed", "2"]].concat()));
}

#[test]
fn results_of_another_build_are_not_gone_on_with() {
    let (_guard, folder) = folder();
    let what = ["--vary", "membrane.restitution=0.2:0.9:4"];
    done(&mut sweep(&folder, &what));
    let text = fs::read_to_string(folder.join("sweep.csv")).unwrap();
    let mut lines: Vec<_> = text.lines().take(3).map(str::to_owned).collect();
    lines[2] = lines[2].replace(",0.000", ",0.001");
    assert_ne!(lines[2], text.lines().nth(2).unwrap());
    fs::remove_file(folder.join("sweep.csv")).unwrap();
    fs::write(folder.join("sweep.csv.part"), lines.join("\n") + "\n").unwrap();
    let (code, message) = refused(&mut sweep(&folder, &what));
    assert_eq!(code, Some(2));
    assert!(message.contains("run 1 comes out otherwise here"), "{message}");
}

#[test]
fn a_complete_file_that_was_changed_is_not_taken_for_complete() {
    let (_guard, folder) = folder();
    let what = ["--vary", "membrane.restitution=0.2:0.9:4"];
    done(&mut sweep(&folder, &what));
    let text = fs::read_to_string(folder.join("sweep.csv")).unwrap();
    fs::write(folder.join("sweep.csv"), text.replace("\n2,2,", "\n9,2,")).unwrap();
    let (code, message) = refused(&mut sweep(&folder, &what));
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
    let said = json(&mut long(&full));
    assert!(said["resumed_from"].as_u64().unwrap() > 20, "{said}");
    assert_same_results(&whole, &full);
}

#[test]
fn runs_that_fail_are_rows_and_fail_a_sweep_only_if_all_do() {
    let (_guard, folder) = folder();
    let [some, all] = ["some", "all"].map(|name| folder.join(name));
    let vary = "membrane.initialRadius=0.001,0.00315,0.005";
    let output = done(sweep(&some, &["--vary", vary]).arg("--json"));
    assert_eq!(stderr(&output), "videg: warning: 1 of 3 runs failed; the column error says why\n");
    assert_eq!(serde_json::from_slice::<Value>(&output.stdout).unwrap()["failed"], 1);
    let errors = column(&some, "error");
    assert_eq!(errors, ["membrane.radius = 0.002 m must be greater than ball.radius = 0.005 m", "", ""]);
    assert_eq!(column(&some, "average_voltage_gain")[0], "");
    assert_eq!(json(&mut sweep(&some, &["--vary", vary]))["failed"], 1, "counted again when there is nothing to do");
    let output = sweep(&all, &["--vary", "membrane.initialRadius=0.001,0.0011"]).output().unwrap();
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
}

#[test]
fn the_parquet_file_holds_the_table_with_types_and_the_document() {
    let (_guard, folder) = folder();
    let vary = ["--vary", "membrane.initialRadius=0.001,0.00315", "--vary", "contact.reaction=false"];
    done(&mut sweep(&folder, &[&vary[..], &["--vary", "contact.law=compliant,1"]].concat()));
    let reader = SerializedFileReader::new(fs::File::open(folder.join("sweep.parquet")).unwrap()).unwrap();
    let metadata = reader.metadata().file_metadata();
    let document = metadata.key_value_metadata().unwrap().iter().find(|pair| pair.key == "videg.sweep").unwrap();
    // The document cannot hold the checksum of the file that it stands in.
    let beside = fs::read_to_string(folder.join("sweep.json")).unwrap();
    let decides = beside.split_once(",\n  \"results\": {").unwrap().0;
    assert_eq!(document.value.as_ref().unwrap(), &format!("{decides}\n}}\n"));
    let table: Vec<_> = reader.get_row_iter(None).unwrap().map(Result::unwrap).collect();
    let csv = rows(&folder);
    assert_eq!(table.len(), csv.len() - 1);
    for (row, cells) in table.iter().zip(&csv[1..]) {
        assert_eq!(row.get_column_iter().map(|(name, _)| name).collect::<Vec<_>>(), csv[0].iter().collect::<Vec<_>>());
        for ((name, field), cell) in row.get_column_iter().zip(cells) {
            match field {
                Field::Long(value) => assert_eq!(value.to_string(), *cell, "{name}"),
                Field::Double(value) => assert_eq!(*value, cell.parse::<f64>().unwrap(), "{name}"),
                Field::Bool(value) => assert_eq!(value.to_string(), *cell, "{name}"),
                Field::Str(value) => assert_eq!(value, cell, "{name}"),
                Field::Null => assert_eq!(cell, "", "{name}"),
                other => panic!("{name} is {other}"),
            }
        }
    }
    assert_eq!((table[0].get_long(0).unwrap(), table[3].get_bool(4).unwrap()), (0, false));
    assert!(table[2].get_double(6).unwrap() > 0.0 && table[0].get_double(6).is_err());
}

#[test]
fn a_sweep_file_says_what_options_say_and_options_win() {
    let (guard, folder) = folder();
    let file = guard.path().join("r.toml");
    let text = "case = 'fig15'\nuntil = 2\nsamples = 2\nseed = 3\n[set]\nexcitation.phaseNoise = 0.5\n[vary]\n\
                membrane.restitution = { from = 0.2, to = 0.6, count = 3 }\nball.mass = [0.003, 0.004]\n";
    fs::write(&file, text).unwrap();
    done(videg(&["sweep"]).arg(&file).args(["--output"]).arg(&folder).args(["--vary", "ball.mass=0.005"]));
    let options = ["--vary", "membrane.restitution=0.2:0.6:3", "--vary", "ball.mass=0.005", "--samples", "2"];
    let options = [&options[..], &NOISY, &["--seed", "3", "--case", "fig15"]].concat();
    let other = guard.path().join("options");
    done(&mut sweep(&other, &options));
    let [a, b] = [&folder, &other].map(|folder| fs::read_to_string(folder.join("sweep.csv")).unwrap());
    assert_eq!(a, b);
}

#[test]
fn bad_input_is_one_line_with_the_thing_the_value_and_the_bound_before_anything_starts() {
    let (guard, folder) = folder();
    let file = guard.path().join("bad.toml");
    fs::write(&file, "pionts = 3\n").unwrap();
    let bad = file.to_str().unwrap();
    for (arguments, named) in [
        (&["--vary", "membrane.restitutoin=0:1:3"][..], "did you mean \"membrane.restitution\"?"),
        (&["--vary", "membrane.restitution"], "--vary membrane.restitution: allowed is name=from:to:count"),
        (&["--vary", "membrane.restitution=0:1"], "a grid needs a count"),
        (&["--vary", "membrane.restitution=high"], "membrane.restitution = \"high\": allowed is a number"),
        (&["--vary", "membrane.restitution=1.1:2:3"], "membrane.restitution = 1.1 is out of range: allowed is 0 .. 1"),
        (&["--vary", "load.resistance=1,2"], "load.resistance"),
        (&["--set", "membrane.restitution=7"], "membrane.restitution = 7 is out of range: allowed is 0 .. 1"),
        (&["--set", "excitation.seed=7", "--samples", "2"], "--set excitation.seed"),
        (&["--design", "lhs", "--vary", "membrane.restitution=0:1"], "needs the number of points"),
        (&["--samples", "0"], "--samples 0: with 1 points it must lie from 1 to 1000000000000"),
        (&["--samples", "4294967297"], "--samples 4294967297: with 1 points it must lie from 1 to 4294967296"),
        (&["--record", "nope"], "nope"),
        (
            &["--record", "ball.mass", "--record", "ball.mass"],
            "--record ball.mass: the results have a column of that name",
        ),
        (&["--shard", "3/2"], "1 <= i <= n"),
        (&["--jobs", "0"], "0"),
        (&["--window", "3,1"], "--window"),
        (&["--seed-variable", "ball.mass"], "--seed-variable ball.mass: a seed is an Integer"),
        (&[bad], "pionts"),
        (&["missing.toml"], "missing.toml"),
        (&["--fmu", "missing.fmu"], "missing.fmu"),
        (&["--case", "fig8"], "--case fig8"),
    ] {
        let (code, message) = refused(&mut sweep(&folder, arguments));
        assert_eq!(code, Some(2), "{arguments:?}: {message}");
        assert!(message.starts_with("videg: ") && message.contains(named), "{arguments:?}: {message}");
        assert!(!folder.exists(), "{arguments:?}");
    }
}

/// A wrong value is that of the file and the key, or of the option, from which it came.
#[test]
fn an_error_about_a_value_names_the_file_and_key_or_the_option_that_said_it() {
    let (guard, folder) = folder();
    let file = guard.path().join("my.toml");
    let path = file.to_str().unwrap();
    let restitution = "[vary]\nmembrane.restitution = { from = 0.2, to = 0.9 }";
    let none: &[&str] = &[];
    for (text, options, said) in [
        (
            "set.membrane.restitution = 7",
            none,
            "FILE: set.membrane.restitution: membrane.restitution = 7 is out of range",
        ),
        ("set.ball.position = 1", none, "FILE: set.ball.position: it is an output, which cannot be set"),
        ("set.ball.weight = 1", none, "FILE: set.ball.weight: neither the harvester nor the circuit"),
        ("samples = 2\nset.excitation.seed = 1", none, "FILE: set.excitation.seed: the samples give it a value"),
        ("until = -1", none, "FILE: until = -1 s: must lie"),
        ("case = 'fig8'", none, "FILE: case = fig8: no such case"),
        (restitution, none, "FILE: vary.membrane.restitution: a grid needs a count"),
        ("vary.ball.weight = [1]", none, "FILE: vary.ball.weight: "),
        (&format!("design = 'lhs'\npoints = 0\n{restitution}"), none, "FILE: points = 0: must lie from 1 to"),
        ("samples = 0", none, "FILE: samples = 0: with 1 points it must lie"),
        ("record = ['nope']", none, "FILE: record = nope: "),
        ("seed_variable = 'ball.mass'", none, "FILE: seed_variable = ball.mass: a seed is an Integer"),
        ("samples = 1", &["--samples", "0"], "--samples 0: with 1 points"),
        ("record = ['impacts']", &["--record", "nope"], "--record nope: "),
        ("vary.ball.mass = [1]", &["--vary", "ball.mass=x"], "--vary ball.mass: "),
        ("set.ball.mass = 1", &["--set", "ball.mass=x"], "--set ball.mass: "),
    ] {
        fs::write(&file, text).unwrap();
        let (code, message) = refused(videg(&["sweep", path, "--output"]).arg(&folder).args(options));
        assert_eq!(code, Some(2), "{text} {options:?}: {message}");
        assert!(
            message.starts_with(&format!("videg: {}", said.replace("FILE", path))),
            "{text} {options:?}: {message}"
        );
    }
}

/// The two folders of shards, and the whole, of one sweep.
fn whole_and_shards(folder: &Path) -> (PathBuf, [PathBuf; 2]) {
    let what = ["--vary", "membrane.restitution=0.2:0.9:6"];
    let [whole, one, other] = ["whole", "one", "other"].map(|name| folder.join(name));
    done(&mut sweep(&whole, &what));
    done(sweep(&one, &what).args(["--shard", "1/2"]));
    done(sweep(&other, &what).args(["--shard", "2/2"]));
    (whole, [one, other])
}

/// Turns the last bit of a digit in the middle of the file: it is as long as before, and reads as well.
fn flip(path: &Path) {
    let mut bytes = fs::read(path).unwrap();
    let middle = bytes.len() / 2;
    let place = (middle..bytes.len()).find(|place| bytes[*place].is_ascii_digit()).unwrap();
    bytes[place] ^= 1;
    fs::write(path, bytes).unwrap();
}

fn sha256(path: &Path) -> String {
    videg::sweep::fingerprint(path).unwrap()
}

#[test]
fn a_flipped_bit_in_complete_results_is_told_with_file_expected_and_found() {
    let (_guard, folder) = folder();
    let (whole, shards) = whole_and_shards(&folder);
    let document: Value = serde_json::from_slice(&fs::read(whole.join("sweep.json")).unwrap()).unwrap();
    for name in ["sweep.csv", "sweep.parquet"] {
        let (path, said) = (whole.join(name), &document["results"][name]);
        let sound = fs::read(&path).unwrap();
        let expected = sha256(&path);
        assert_eq!((&said["sha256"], &said["bytes"]), (&expected.clone().into(), &sound.len().into()));
        flip(&path);
        let found = sha256(&path);
        let (code, message) = refused(&mut sweep(&whole, &["--vary", "membrane.restitution=0.2:0.9:6"]));
        let named = format!("{name}: its SHA-256 is {found}, and sweep.json expects {expected}");
        assert!(code == Some(2) && message.contains(&named), "{message}");
        fs::write(&path, sound).unwrap();
    }
    done(&mut sweep(&whole, &["--vary", "membrane.restitution=0.2:0.9:6"]));
    let merged = folder.join("merged");
    done(videg(&["sweep", "merge"]).args(&shards).arg("--output").arg(&merged));
    assert_same_results(&whole, &merged);
    flip(&shards[1].join("sweep.2-of-2.csv"));
    let (code, message) = refused(videg(&["sweep", "merge"]).args(&shards).arg("--output").arg(folder.join("again")));
    let named = "sweep.2-of-2.csv: its SHA-256 is ";
    assert!(code == Some(2) && message.contains(named) && message.contains("sweep.json expects"), "{message}");
}

#[test]
fn results_without_checksums_get_them_and_fresh_ones_replace_them() {
    let (_guard, folder) = folder();
    let (whole, _) = whole_and_shards(&folder);
    let path = whole.join("sweep.json");
    let sealed = fs::read_to_string(&path).unwrap();
    let what = ["--vary", "membrane.restitution=0.2:0.9:6"];
    fs::write(&path, sealed.split_once(",\n  \"results\"").unwrap().0.to_owned() + "\n}\n").unwrap();
    done(&mut sweep(&whole, &what));
    assert_eq!(fs::read_to_string(&path).unwrap(), sealed);
    flip(&whole.join("sweep.csv"));
    done(sweep(&whole, &what).arg("--fresh"));
    assert_eq!(fs::read_to_string(&path).unwrap(), sealed);
    done(&mut sweep(&whole, &what));
}

#[test]
fn a_check_counts_and_leaves_nothing_behind() {
    let (_guard, folder) = folder();
    let what = ["--vary", "membrane.restitution=0:1:2000000", "--samples", "3", "--check"];
    let said = json(&mut sweep(&folder, &what));
    assert_eq!((&said["points"], &said["samples"], &said["runs"]), (&2_000_000.into(), &3.into(), &6_000_000.into()));
    let (code, message) = refused(&mut sweep(&folder, &[&what[..], &["--record", "nope"]].concat()));
    assert!(code == Some(2) && message.contains("nope"), "{message}");
    assert!(!folder.exists());
}
