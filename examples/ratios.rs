//! Prints the table of ratios in docs/speed.md from the last measurements of the benchmarks:
//! `cargo bench && cargo run --release --example ratios`.
//!
//! Exit code 1 if a row is missing: a benchmark has not run, or ran so long before or after its baseline that the
//! machine may have been another.

use std::path::PathBuf;
use std::process::ExitCode;
use std::time::{Duration, SystemTime};

use anyhow::{Context as _, ensure};
use serde_json::Value;

/// What is asked of a ratio.
enum Asked {
    /// Ours takes at most so many times the time of the baseline.
    AtMost(f64),
    /// Ours is at least so many times as fast.
    Faster(f64),
    /// Nothing.
    Nothing,
}

use Asked::{AtMost, Faster, Nothing};

struct Row {
    what: &'static str,
    /// File of the benchmark, and Criterion's group.
    group: (&'static str, &'static str),
    /// Names in the group.
    ours: &'static str,
    baseline: &'static str,
    asked: Asked,
}

const STEP: (&str, &str) = ("calls", "doStep without impact");
const STEP_3: (&str, &str) = ("calls", "doStep without impact, FMI 3.0");
const EVENTS_3: (&str, &str) = ("calls", "doStep without impact, FMI 3.0 with events");
const STATE: (&str, &str) = ("calls", "get, set and free FMU state");
const ROLLBACK: (&str, &str) = ("calls", "get FMU state, doStep, set, free");
const CALLS: (&str, &str) = ("calls", "100 s of fig14 in calls");
const MOTION: (&str, &str) = ("harvester", "100 s");
const NOISE: (&str, &str) = ("noise", "phase noise, 100 s");
const ENSEMBLE: (&str, &str) = ("noise", "phase noise, 8 runs of 20 s");
const CIRCUIT: (&str, &str) = ("circuit", "10 s of fig14, shared node, series Zener");

const COUPLED: (&str, &str) = ("circuit", "100 s of fig14, isolated, switch");

const BALL: &str = "bouncing ball in C";
const RUNGE_KUTTA: &str = "Runge-Kutta as the paper";
const PAPER: &str = "fig14, Runge-Kutta as the paper";
const STAGES: &str = "fig14, Runge-Kutta stage by stage";

#[rustfmt::skip] // one row each
const ROWS: &[Row] = &[
    row("`fmi2DoStep`, 1 ms without an impact; a bouncing ball in C", STEP, "harvester", BALL, AtMost(1.5)),
    row("`fmi3DoStep`, the same; that ball with the functions of FMI 3.0", STEP_3, "harvester", BALL, AtMost(1.5)),
    row("the same for an importer that handles events and takes steps that end early; that ball, whose steps do not", EVENTS_3, "harvester", BALL, Nothing),
    row("`fmi2GetFMUstate`, `fmi2SetFMUstate`, `fmi2FreeFMUstate`; a bouncing ball in C", STATE, "harvester", BALL, AtMost(1.5)),
    row("the same with a step in between, which is taken back; a bouncing ball in C", ROLLBACK, "harvester", BALL, Nothing),
    row("100 s of Fig. 14 in 100,000 calls of `fmi2DoStep`; the paper's Runge-Kutta at 1e-5 s", CALLS, "doStep, 1 ms", RUNGE_KUTTA, Faster(50.0)),
    row("100 s of Fig. 14 in one go; the paper's Runge-Kutta at 1e-5 s", MOTION, "fig14, event-driven", PAPER, Faster(3000.0)),
    row("the same; the paper's Runge-Kutta stage by stage, as in textbooks", MOTION, "fig14, event-driven", STAGES, Nothing),
    row("100 s of Fig. 17, 1e7 samples of phase noise; a plain program in C, Runge-Kutta sample by sample", NOISE, "in blocks", "C, Runge-Kutta", Faster(20.0)),
    row("the same; a plain program in C, closed form sample by sample", NOISE, "in blocks", "C, closed form", Nothing),
    row("8 runs of 20 s of Fig. 17 on two threads; on one", ENSEMBLE, "threads: 2", "threads: 1", Faster(1.8)),
    row("circuit, 10 s of Fig. 14, ideal diodes; ngspice", CIRCUIT, "embedded, ideal diodes", "ngspice, batch", Nothing),
    row("ngspice live with C(t), a communication step each 1 ms and a ledger of all elements; ngspice", CIRCUIT, "ngspice, live", "ngspice, batch", AtMost(1.5)),
    row("circuit, 10 s of Fig. 14, exponential diodes; ngspice", CIRCUIT, "embedded, exponential diodes", "ngspice, batch", Faster(100.0)),
    row("harvester and circuit in one run, 100 s of Fig. 14, isolated, switch; ngspice on the same C(t)", COUPLED, "harvester and circuit", "ngspice, batch", Faster(5000.0)),
];

const fn row(
    what: &'static str,
    group: (&'static str, &'static str),
    ours: &'static str,
    baseline: &'static str,
    asked: Asked,
) -> Row {
    Row { what, group, ours, baseline, asked }
}

/// Longest time between two measurements that are compared.
const APART: Duration = Duration::from_secs(3600);

/// Median time of one iteration, s, and when it was measured.
fn measured((bench, group): (&str, &str), name: &str) -> anyhow::Result<(f64, SystemTime)> {
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| PathBuf::from("target"), PathBuf::from);
    let name = name.replace(':', "_"); // as Criterion names its folders
    let path = target.join("criterion").join(group).join(name).join("new/estimates.json");
    let text = std::fs::read_to_string(&path)
        .with_context(|| format!("no {}; run cargo bench --bench {bench}", path.display()))?;
    let modified = std::fs::metadata(&path).and_then(|data| data.modified());
    let modified = modified.with_context(|| path.display().to_string())?;
    let estimates: Value = serde_json::from_str(&text).with_context(|| path.display().to_string())?;
    let median = estimates["median"]["point_estimate"].as_f64();
    Ok((1e-9 * median.with_context(|| format!("{} has no median", path.display()))?, modified))
}

fn show(seconds: f64) -> String {
    let (factor, unit) = match seconds {
        s if s < 1e-6 => (1e9, "ns"),
        s if s < 1e-3 => (1e6, "us"),
        s if s < 1.0 => (1e3, "ms"),
        _ => (1.0, "s"),
    };
    let value = seconds * factor;
    let digits = if value < 10.0 { 2 } else { usize::from(value < 100.0) };
    format!("{value:.digits$} {unit}")
}

fn faster(ratio: f64) -> String {
    let digits = usize::from(ratio < 10.0) + usize::from(ratio < 100.0);
    format!("{ratio:.digits$} times as fast")
}

fn line(row: &Row) -> anyhow::Result<String> {
    let ((ours, at), (baseline, other)) = (measured(row.group, row.ours)?, measured(row.group, row.baseline)?);
    let apart = at.duration_since(other).unwrap_or_else(|earlier| earlier.duration());
    ensure!(
        apart <= APART,
        "{:?} was measured {} s apart from {:?}, which must be at most {} s; run cargo bench --bench {}",
        row.ours,
        apart.as_secs(),
        row.baseline,
        APART.as_secs(),
        row.group.0
    );
    let (ratio, asked) = match row.asked {
        AtMost(bound) => (format!("{:.2} of its time", ours / baseline), format!("at most {bound}")),
        Faster(bound) => (faster(baseline / ours), format!("at least {bound}")),
        Nothing if ours > baseline => (format!("{:.2} of its time", ours / baseline), String::new()),
        Nothing => (faster(baseline / ours), String::new()),
    };
    Ok(format!("| {} | {} | {} | {ratio} | {asked} |", row.what, show(ours), show(baseline)))
}

fn main() -> ExitCode {
    let mut complete = true;
    println!("| benchmark; baseline | videg | baseline | ratio | required |\n|---|---|---|---|---|");
    for entry in ROWS {
        match line(entry) {
            Ok(line) => println!("{line}"),
            Err(error) => {
                complete = false;
                eprintln!("no row \"{}\": {error:#}", entry.what);
            }
        }
    }
    if complete { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
