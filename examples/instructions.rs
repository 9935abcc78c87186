//! Instructions that an event costs, by mount of the capsule, as one Markdown table: `cargo run --release --example instructions`.
//!
//! Valgrind counts them, so that the figures depend on the build alone, and not on the machine's load. Ends with 1 if an event costs
//! more than it may.

#[path = "../benches/mounts/mod.rs"]
mod mounts;

use std::hint::black_box;
use std::process::{Command, ExitCode};

use anyhow::{Context, Result, ensure};
use mounts::{Mounted, mounts};

/// Runs that are counted, besides the first.
const RUNS: u32 = 10;

fn main() -> Result<ExitCode> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if let [number, runs] = arguments.as_slice() {
        let mounted = &mounts()[number.parse::<usize>()?];
        for _ in 0..runs.parse()? {
            black_box(mounts::run(black_box(&mounted.parameters))?);
        }
        return Ok(ExitCode::SUCCESS);
    }
    println!(
        "| capsule of Fig. 14, 100 s | events | instructions per event | of the level one | at most |\n|---|---|---|---|---|"
    );
    let (mut level, mut is_within) = (None, true);
    for (number, Mounted { name, parameters, allowed }) in mounts().iter().enumerate() {
        let events = mounts::run(parameters)?.events();
        let [one, all] = [1, 1 + RUNS].map(|runs| counted(number, runs));
        let each = (all? - one?) as f64 / f64::from(RUNS) / events as f64;
        let ratio = each / *level.get_or_insert(each);
        is_within &= allowed.is_none_or(|allowed| each <= allowed);
        let allowed = allowed.map_or_else(String::new, |allowed| format!("{allowed:.0}"));
        println!("| {name} | {events} | {each:.0} | {ratio:.2} | {allowed} |");
    }
    Ok(if is_within { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

/// Instructions of this program while it makes so many runs of capsule `number`.
fn counted(number: usize, runs: u32) -> Result<u64> {
    let mut command = Command::new("valgrind");
    command.args(["--tool=callgrind", "--callgrind-out-file=/dev/null"]).arg(std::env::current_exe()?);
    let output = command.args([number.to_string(), runs.to_string()]).output().context("valgrind")?;
    let text = String::from_utf8_lossy(&output.stderr);
    ensure!(output.status.success(), "valgrind: {text}");
    let count =
        text.lines().find_map(|line| line.rsplit_once("Collected : ")).context("valgrind does not say a count")?;
    Ok(count.1.trim().parse()?)
}
