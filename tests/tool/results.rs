//! Folders of results: a run with other settings overwrites nothing, the same one does, and one that a signal ends leaves nothing.

use std::path::Path;
use std::process::{Command, Output, Stdio};

use serde_json::Value;

use crate::command::{self, done, names, videg};
use crate::signals;
use crate::waiting::wait_for;

/// Runs the tool where the user stands in `folder`.
fn run(folder: &Path, arguments: &[&str]) -> Output {
    videg(arguments).current_dir(folder).output().unwrap()
}

/// The folders in `out`.
fn folders(folder: &Path) -> Vec<String> {
    names(&folder.join("out"))
}

fn gain(folder: &Path) -> f64 {
    let text = std::fs::read_to_string(folder.join("result.json")).unwrap();
    serde_json::from_str::<Value>(&text).unwrap()["average_voltage_gain"].as_f64().unwrap()
}

#[test]
fn runs_with_other_settings_have_folders_of_their_own() {
    let guard = tempfile::tempdir().unwrap();
    for arguments in [
        &["simulate", "--until", "2"][..],
        &["simulate", "--until", "2", "--set", "membrane.restitution=0.7"],
        &["simulate", "--until", "2.0", "--set", "membrane.restitution=0.70"],
        &["simulate", "--until", "2", "--case", "fig15", "--sample", "step"],
        &["cosim", "--until", "2", "--master", "jacobi"],
        &["dynamics", "--samples", "20", "--transient", "5"],
        &["export", "--until", "2"],
        &["export", "--until", "2", "--format", "ltspice"],
    ] {
        done(videg(arguments).current_dir(guard.path()));
    }
    let expected = [
        "cosim-fig14-until=2-master=jacobi",
        "dynamics-fig14-transient=5-samples=20",
        "export-fig14-until=2-format=ltspice.lib",
        "export-fig14-until=2.lib",
        "export-fig14-until=2.tab",
        "simulate-fig14-membrane.restitution=0.7-until=2",
        "simulate-fig14-until=2",
        "simulate-fig15-until=2-sample=step",
    ];
    assert_eq!(folders(guard.path()), expected);
    let [plain, other] = ["simulate-fig14-until=2", "simulate-fig14-membrane.restitution=0.7-until=2"]
        .map(|name| gain(&guard.path().join("out").join(name)));
    assert_ne!(plain, other);
}

#[test]
fn names_that_no_file_system_takes_are_short_and_differ() {
    let guard = tempfile::tempdir().unwrap();
    let recording = format!("{}/{}.csv", guard.path().display(), "x".repeat(200));
    for number in ["1", "2"] {
        std::fs::write(&recording, "time,force\n0,0\n1,1\n").unwrap();
        let file = format!("excitation.file={recording}");
        let scale = format!("excitation.fileScale={number}");
        done(videg(&["simulate", "--until", "1", "--set", &file, "--set", &scale]).current_dir(guard.path()));
    }
    let found = folders(guard.path());
    assert!(found.len() == 2 && found.iter().all(|name| name.len() <= 130), "{found:?}");
    assert!(found.iter().all(|name| name.starts_with("simulate-fig14-excitation.file=_")), "{found:?}");
}

#[test]
fn a_folder_with_another_run_is_refused_and_replaced_only_afresh() {
    let guard = tempfile::tempdir().unwrap();
    let same = ["simulate", "--until", "2", "--output", "mine"];
    done(videg(&same).current_dir(guard.path()));
    let folder = guard.path().join("mine");
    let first = gain(&folder);
    done(videg(&same).current_dir(guard.path()));
    let other = [&same[..], &["--set", "membrane.restitution=0.7", "--format", "none"]].concat();
    let refused = run(guard.path(), &other);
    assert_eq!(refused.status.code(), Some(2));
    assert_eq!(
        command::stderr(&refused),
        "videg: mine/result.json: it belongs to another run: --set membrane.restitution was not given, is 0.7; --format was not given, \
         is none; type the command with another --output to keep both, or with --fresh to replace what is there\n"
    );
    let refused = run(guard.path(), &["cosim", "--until", "2", "--output", "mine"]);
    assert!(command::stderr(&refused).contains("the verb was simulate, is cosim"), "{}", command::stderr(&refused));
    assert_eq!(gain(&folder), first);
    done(videg(&other).arg("--fresh").current_dir(guard.path()));
    assert_ne!(gain(&folder), first);
    assert_eq!(names(&folder), ["figure.svg", "report.html", "result.json"], "the series of the other run is gone");
}

#[test]
fn two_sweeps_in_a_row_just_work_and_each_is_there_again() {
    let guard = tempfile::tempdir().unwrap();
    let sweep = |values: &str| {
        let vary = format!("membrane.restitution={values}");
        command::json(videg(&["sweep", "--until", "2", "--vary", &vary]).current_dir(guard.path()))
    };
    let (one, other) = (sweep("0.5,0.6"), sweep("0.7,0.8"));
    assert_eq!(one["files"][0], "out/sweep/sweep.csv");
    let place = other["files"][0].as_str().unwrap();
    assert!(place.starts_with("out/sweep-fig14-") && place.ends_with("/sweep.csv"), "{place}");
    for (values, first) in [("0.5,0.6", &one), ("0.7,0.8", &other)] {
        let again = sweep(values);
        assert_eq!((&again["files"], again["resumed_from"].as_u64()), (&first["files"], Some(2)));
    }
}

/// What a run says that a signal ends while `file` is there.
fn interrupted(folder: &Path, arguments: &[&str], signal: &str, file: &str) -> (Option<i32>, String) {
    let mut program = videg(arguments);
    let mut program = signals::with_default_signals(program.current_dir(folder));
    let mut program = program.current_dir(folder).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    wait_for(|| folder.join(file).exists().then_some(()));
    assert!(Command::new("kill").args([&format!("-{signal}"), &program.id().to_string()]).status().unwrap().success());
    let code = wait_for(|| program.try_wait().unwrap()).code();
    (code, std::io::read_to_string(program.stderr.take().unwrap()).unwrap())
}

#[test]
fn a_cancelled_run_leaves_nothing_and_says_so_in_one_line() {
    for (verb, signal, code) in [("simulate", "INT", 130), ("cosim", "TERM", 143)] {
        let guard = tempfile::tempdir().unwrap();
        let arguments = [verb, "--until", "2e4", "--sample", "step", "--output", "new/run"];
        let (found, said) = interrupted(guard.path(), &arguments, signal, "new/run/timeseries.csv.part");
        assert_eq!(found, Some(code), "{said}");
        let lines: Vec<_> = said.lines().filter(|line| !line.starts_with("videg: warning")).collect();
        let expected = "videg: interrupted; removed new/run/timeseries.csv.part; nothing of this run is left";
        assert_eq!(lines, [expected], "{verb}");
        assert_eq!(names(guard.path()), Vec::<String>::new(), "{verb}");
    }
}

#[test]
fn a_cancelled_run_leaves_the_results_of_the_run_before() {
    let guard = tempfile::tempdir().unwrap();
    let folder = guard.path().join("run");
    done(videg(&["simulate", "--until", "1", "--output", "run"]).current_dir(guard.path()));
    let before = std::fs::read(folder.join("timeseries.csv")).unwrap();
    let again = ["simulate", "--until", "1e5", "--sample", "step", "--fresh", "--output", "run"];
    interrupted(guard.path(), &again, "INT", "run/timeseries.csv.part");
    assert_eq!(names(&folder), ["figure.svg", "report.html", "result.json", "timeseries.csv"]);
    assert_eq!(std::fs::read(folder.join("timeseries.csv")).unwrap(), before);
}

#[test]
fn a_verb_that_cannot_run_leaves_no_folder() {
    let guard = tempfile::tempdir().unwrap();
    let refused = run(guard.path(), &["cosim", "--netlist", "missing.cir"]);
    assert_eq!(refused.status.code(), Some(2));
    assert_eq!(names(guard.path()), Vec::<String>::new());
}

#[test]
fn a_time_series_has_the_rows_columns_and_form_that_are_asked_for() {
    let guard = tempfile::tempdir().unwrap();
    let series = |name: &str, arguments: &[&str]| {
        let arguments = [&["simulate", "--until", "20", "--output", name], arguments].concat();
        done(videg(&arguments).current_dir(guard.path()));
        guard.path().join(name)
    };
    let table = |name: &str, arguments: &[&str]| {
        let text = std::fs::read_to_string(series(name, arguments).join("timeseries.csv")).unwrap();
        text.lines().map(|line| line.split(',').map(str::to_owned).collect::<Vec<_>>()).collect::<Vec<_>>()
    };
    let (overview, all) = (table("overview", &[]), table("all", &["--sample", "step"]));
    // 10,000 of 20,000 on the grid, and three or four for each of some 120 impacts.
    assert!((10_001..10_700).contains(&overview.len()) && all.len() > 20_000, "{} {}", overview.len(), all.len());
    assert!(overview.iter().all(|row| all.binary_search_by(|other| time(other).total_cmp(&time(row))).is_ok()));
    let peak = |rows: &[Vec<String>]| rows[1..].iter().map(|row| row[1].parse::<f64>().unwrap()).fold(0.0, f64::max);
    assert_eq!(peak(&overview), peak(&all), "peaks have rows");
    let few = table("few", &["--sample", "0.5", "--columns", "ball.velocity,left.capacitance"]);
    assert_eq!(few[0], ["time", "ball.velocity", "left.capacitance"]);
    assert!(few.len() < 700, "{}", few.len());
    assert!(few.iter().any(|row| row[0] == "0.5") && few.last().unwrap()[0] == "20.0");
    assert_eq!(names(&series("none", &["--format", "none"])), ["figure.svg", "report.html", "result.json"]);
    let parquet = series("parquet", &["--format", "parquet", "--sample", "step"]).join("timeseries.parquet");
    assert_eq!(rows_of(&parquet), all.len() - 1);
    let refused = run(guard.path(), &["simulate", "--until", "20", "--sample", "21"]);
    assert!(command::stderr(&refused).contains("--sample 21 s: must lie above 0 s and not above 20 s"));
}

fn time(row: &[String]) -> f64 {
    row[0].parse().unwrap_or(-1.0)
}

/// Rows of a Parquet file, by its footer.
fn rows_of(path: &Path) -> usize {
    use parquet::file::reader::{FileReader as _, SerializedFileReader};
    let reader = SerializedFileReader::new(std::fs::File::open(path).unwrap()).unwrap();
    usize::try_from(reader.metadata().file_metadata().num_rows()).unwrap()
}
