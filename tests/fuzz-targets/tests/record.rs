//! The table of docs/fuzzing.md is what `fuzz/record.csv` adds up to. `UPDATE_FUZZ_TABLE=1` writes it.
#![allow(clippy::panic, clippy::unwrap_used, reason = "a panic is how a test fails")]

use std::collections::BTreeMap;
use std::fs;

use videg_golden::Golden;

const GOLDEN: Golden = Golden::new("UPDATE_FUZZ_TABLE", "cargo test -p videg-fuzz-targets --test record");

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
        let [minutes, cpu_minutes] = [self.seconds, self.cpu_seconds].map(|seconds| seconds as f64 / 60.0);
        let edges = if *edges > 0 { edges.to_string() } else { String::new() };
        format!("| {name} | {runs} | {minutes:.1} | {cpu_minutes:.1} | {executions} | {edges} | {findings} |\n")
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
    let mut text =
        "| target | runs | minutes | minutes of the processor | executions | edges reached | findings |\n".to_owned();
    text += "|---|---|---|---|---|---|---|\n";
    for (name, sum) in &sums {
        total.add(sum);
        text += &sum.row(&format!("`{name}`"));
    }
    text + &total.row("all")
}

#[test]
fn the_table_of_the_document_is_what_the_record_adds_up_to() {
    let record = fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../../fuzz/record.csv")).unwrap();
    GOLDEN.section(concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/fuzzing.md"), "record", &table(&record));
}
