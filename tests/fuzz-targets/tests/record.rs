//! The table of docs/fuzzing.md is what `fuzz/record.csv` adds up to. `UPDATE_FUZZ_TABLE=1` writes it.
#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

/// What all runs of a target come to.
#[derive(Default)]
struct Sum {
    runs: u64,
    seconds: u64,
    cpu_seconds: u64,
    executions: u64,
    /// Of the last run.
    edges: u64,
    findings: u64,
}

impl Sum {
    fn row(&self, name: &str) -> String {
        let Self { runs, executions, edges, findings, .. } = self;
        let [hours, cpu_hours] = [self.seconds, self.cpu_seconds].map(|seconds| seconds as f64 / 3600.0);
        let edges = if *edges > 0 { edges.to_string() } else { String::new() };
        format!("| {name} | {runs} | {hours:.2} | {cpu_hours:.2} | {executions} | {edges} | {findings} |\n")
    }

    fn add(&mut self, other: &Self) {
        self.runs += other.runs;
        self.seconds += other.seconds;
        self.cpu_seconds += other.cpu_seconds;
        self.executions += other.executions;
        self.findings += other.findings;
    }
}

fn table(record: &str) -> String {
    let mut sums: BTreeMap<&str, Sum> = BTreeMap::new();
    for line in record.lines().skip(1) {
        let cells: Vec<_> = line.split(',').collect();
        let [_, _, target, numbers @ ..] = cells.as_slice() else { panic!("{line}") };
        let numbers: Vec<u64> = numbers.iter().map(|cell| cell.parse().unwrap()).collect();
        let [seconds, cpu_seconds, executions, edges, _, findings] = numbers[..] else { panic!("{line}") };
        let sum = sums.entry(target).or_default();
        sum.add(&Sum { runs: 1, seconds, cpu_seconds, executions, edges: 0, findings });
        sum.edges = edges;
    }
    let mut total = Sum::default();
    sums.values().for_each(|sum| total.add(sum));
    let mut text = "| target | runs | hours | hours of CPU | executions | edges reached | findings |\n".to_owned();
    text += "|---|---|---|---|---|---|---|\n";
    sums.iter().for_each(|(name, sum)| write!(text, "{}", sum.row(&format!("`{name}`"))).unwrap());
    text + &total.row("all")
}

#[test]
fn the_table_of_the_document_is_what_the_record_adds_up_to() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let table = table(&fs::read_to_string(root.join("fuzz/record.csv")).unwrap());
    let path = root.join("docs/fuzzing.md");
    let text = fs::read_to_string(&path).unwrap();
    let (before, rest) = text.split_once("<!-- record: begin -->\n").unwrap();
    let (found, after) = rest.split_once("<!-- record: end -->").unwrap();
    if std::env::var_os("UPDATE_FUZZ_TABLE").is_some() {
        fs::write(&path, format!("{before}<!-- record: begin -->\n{table}<!-- record: end -->{after}")).unwrap();
        return;
    }
    assert_eq!(found, table, "UPDATE_FUZZ_TABLE=1 cargo test -p videg-fuzz-targets --test record writes it");
}
