//! Case files, sweep files, and results of sweeps that somebody else has left.

use super::sandbox::{Input, refused};

fn case(what: &'static str, text: impl Into<Vec<u8>>) -> Input {
    refused(what, &["simulate", "--output", "out", "--case-file", "evil.toml"], vec![("evil.toml", text.into())])
}

fn recording(what: &'static str, text: impl Into<Vec<u8>>) -> Input {
    let command = &["simulate", "--output", "out", "--until", "1", "--set", "excitation.file=evil.csv"];
    refused(what, command, vec![("evil.csv", text.into())])
}

fn membrane(what: &'static str, text: impl Into<Vec<u8>>) -> Input {
    let settings = ["--set", "membrane.law=table", "--set", "membrane.file=evil.csv"];
    let command = [&["simulate", "--output", "out", "--until", "1"][..], &settings].concat();
    refused(what, &command, vec![("evil.csv", text.into())])
}

/// A recording that no file holds.
fn no_recording(what: &'static str, file: &'static str) -> Input {
    let setting: &'static str = match file {
        "out" => "excitation.file=out",
        "/dev/zero" => "excitation.file=/dev/zero",
        _ => "excitation.file=missing.csv",
    };
    refused(what, &["simulate", "--output", "out", "--until", "1", "--set", setting], Vec::new())
}

fn sweep(what: &'static str, text: &str) -> Input {
    refused(what, &["sweep", "evil.toml", "--output", "out/sweep"], vec![("evil.toml", text.into())])
}

/// The document of a sweep of two runs with this seed.
fn document(seed: u32) -> Vec<u8> {
    let version = env!("CARGO_PKG_VERSION");
    let column = r#"{"name": "run", "type": "integer", "optional": false}"#;
    let text = format!(r#"{{"videg": "{version}", "case": "base", "runs": 2, "seed": {seed}, "columns": [{column}]}}"#);
    text.into_bytes()
}

fn merge(what: &'static str, files: Vec<(&'static str, Vec<u8>)>) -> Input {
    refused(what, &["sweep", "merge", "shards", "--output", "out/merged"], files)
}

/// A recording of so many samples.
fn samples(count: u32) -> String {
    let rows: Vec<_> = (0..count).map(|k| format!("{k},0\n")).collect();
    format!("time,force\n{}", rows.concat())
}

/// All of them.
pub fn inputs() -> Vec<Input> {
    let endless =
        refused("a file without end", &["simulate", "--output", "out", "--case-file", "/dev/zero"], Vec::new());
    vec![
        case("no TOML", "case = "),
        case("not UTF-8", b"case = \"\xff\"".as_slice()),
        case("an unknown key", "untill = 3"),
        case("a list in place of a number", "[set]\nball.mass = [1, 2]"),
        case("brackets nested 100,000 deep", format!("case = {}", "[".repeat(100_000))),
        case("tables nested 100,000 deep", format!("[set]\n{} = 1", vec!["a"; 100_000].join("."))),
        case("a setting that commands the terminal", "[set]\n\"\\u001b[2J\" = 1"),
        case("a number out of range", "[set]\nmembrane.restitution = 7"),
        endless,
        recording("no heading in a recording", "0,1\n1,2\n"),
        recording("a recording in milliseconds", "time [ms],acceleration\n0,1\n1,2\n"),
        recording("a hole in a recording", "time,force\n0,1\n1\n2,1\n"),
        recording("an empty line in a recording", "time,force\n0,1\n\n2,1\n"),
        recording("text in a recording", "time,force\n0,1\n1,much\n"),
        recording("NaN in a recording", "time,force\n0,1\n1,NaN\n"),
        recording("an infinite force in a recording", "time,force\n0,1\n1,inf\n"),
        recording("a force beyond all bounds", "time,force\n0,1\n1,1e300\n"),
        recording("a time that goes back", "time,force\n0,1\n2,1\n1,1\n"),
        recording("a time twice", "time,force\n0,1\n0,2\n"),
        recording("a single sample", "time,force\n0,1\n"),
        recording("a recording of the other kind", "time,acceleration\n0,1\n1,1\n"),
        recording("a decimal comma in a recording", "time;force\n0,0;1,5\n"),
        recording("a recording that is not UTF-8", b"time,force\n0,\xff\n".as_slice()),
        recording("a recording of zero bytes", vec![0; 1 << 20]),
        recording("a recording of 1,000,001 samples", samples(1_000_001)),
        recording("a recording that commands the terminal", "time,\u{1b}[2J\n"),
        no_recording("a recording that is not there", "missing.csv"),
        no_recording("a recording without end", "/dev/zero"),
        no_recording("a folder in place of a recording", "out"),
        membrane("a membrane in millimetres", "deflection_mm,force\n0,0\n1,0.1\n2,0.3\n"),
        membrane("a membrane without its first row", "deflection,force\n1e-3,0.1\n2e-3,0.3\n3e-3,0.6\n"),
        membrane("a membrane whose force falls", "deflection,force\n0,0\n1e-3,0.3\n2e-3,0.1\n"),
        membrane("a deflection twice", "deflection,force\n0,0\n1e-3,0.1\n1e-3,0.3\n"),
        membrane(
            "a capacitance that falls",
            "deflection,force,capacitance\n0,0,2e-11\n1e-3,0.1,1e-11\n2e-3,0.3,3e-11\n",
        ),
        membrane("a force that is no number", "deflection,force\n0,0\n1e-3,NaN\n2e-3,0.3\n"),
        membrane("a force beyond all bounds of a membrane", "deflection,force\n0,0\n1e-3,0.1\n2e-3,1e300\n"),
        membrane("two points of a membrane", "deflection,force\n0,0\n1e-3,0.1\n"),
        membrane("a recording in place of a membrane", "time,force\n0,0\n1,1\n2,2\n"),
        sweep("an unknown design", "design = 'square'"),
        sweep("a negative number of points", "points = -1"),
        sweep("values that are none", "[vary]\na.b = 3"),
        sweep("a variable that is none", "[vary]\n\"../../canary\" = { from = 0, to = 1, count = 3 }"),
        sweep("something recorded that is no variable", "record = ['/etc/passwd']"),
        merge("no shard", Vec::new()),
        refused(
            "shards of two sweeps",
            &["sweep", "merge", "shards", "others", "--output", "out/merged"],
            vec![("shards/sweep.json", document(1)), ("others/sweep.json", document(2))],
        ),
        merge("a document without runs", vec![("shards/sweep.json", b"{}".to_vec())]),
        merge("a document that is none", vec![("shards/sweep.json", b"[[[[".to_vec())]),
        refused(
            "results of another sweep in the folder",
            &["sweep", "--vary", "membrane.restitution=0.3:0.9:2", "--until", "1", "--output", "out/results"],
            vec![
                ("out/results/sweep.json", b"{\"videg\":\"0\"}".to_vec()),
                ("out/results/sweep.csv", b"run\n0\n".to_vec()),
            ],
        ),
        refused(
            "a file in the place of the folder for results",
            &["simulate", "--until", "1", "--output", "out/kept.txt"],
            Vec::new(),
        ),
    ]
}
