//! `videg sweep`: many runs over parameters and seeds; `videg sweep merge`: shards put together.

use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use clap::{Args, Subcommand};
use serde::Serialize;

use super::interruption::Interruption;
use super::isolation::IsolationOptions;
use super::message::say;
use super::progress::RunBar;
use super::run_output::file_list;
use super::sweep_options::{Execution, What};
use super::{Exit, format, output, sweep_statistics};
use crate::sweep::{self, Design, Engine, Report, Sweep, SweepError};
use fmu_import::Fmu;

/// Arguments of the verb.
#[derive(Args)]
#[command(args_conflicts_with_subcommands = true)]
pub struct Arguments {
    #[command(subcommand)]
    verb: Option<Verb>,
    #[command(flatten)]
    what: What,
    /// Run any FMU for FMI 2.0 co-simulation, in place of the harvester
    #[arg(long, value_name = "FILE")]
    fmu: Option<PathBuf>,
    #[command(flatten)]
    execution: Execution,
    /// Folder for the results; the same command with the same folder resumes [default: out/sweep, or if another sweep is there
    /// out/sweep-CASE-DIGEST]
    #[arg(long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Check the sweep and print its number of points and runs; runs and writes nothing
    #[arg(long)]
    check: bool,
    /// Print one JSON object on stdout instead of the table
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    isolation: IsolationOptions,
}

#[derive(Subcommand)]
enum Verb {
    /// Put shards together: the same bytes as an undivided sweep
    Merge(Merge),
}

#[derive(Args)]
struct Merge {
    /// Folders with shards
    #[arg(value_name = "DIR", required = true)]
    folders: Vec<PathBuf>,
    /// Folder for the results
    #[arg(long, value_name = "DIR")]
    output: PathBuf,
    /// Print one JSON object on stdout instead of the table
    #[arg(long)]
    json: bool,
}

/// Size of a sweep; all of the output of `--check --json`.
#[derive(Serialize)]
struct Counts<'a> {
    case: &'a str,
    design: Design,
    points: u64,
    samples: u64,
    /// Runs of the sweep, or of the shard.
    runs: u64,
    /// Whether the number of samples depends on their results.
    #[serde(skip)]
    is_adaptive: bool,
}

/// Output of `--json`.
#[derive(Serialize)]
struct Output<'a> {
    #[serde(flatten)]
    counts: Counts<'a>,
    failed: u64,
    /// Runs that were there from the beginning.
    resumed_from: u64,
    elapsed_s: f64,
    rate_runs_per_s: f64,
    shard: Option<String>,
    files: &'a [PathBuf],
    #[serde(skip_serializing_if = "Option::is_none")]
    statistics: Option<sweep_statistics::Output<'a>>,
}

/// Output of `merge --json`.
#[derive(Serialize)]
struct Merged<'a> {
    runs: u64,
    failed: u64,
    elapsed_s: f64,
    files: &'a [PathBuf],
    #[serde(skip_serializing_if = "Option::is_none")]
    statistics: Option<sweep_statistics::Output<'a>>,
}

/// Runs the verb.
pub fn run(arguments: &Arguments, interruption: &Interruption) -> anyhow::Result<Exit> {
    match &arguments.verb {
        Some(Verb::Merge(merge)) => run_merge(merge),
        None => run_sweep(arguments, interruption),
    }
}

fn run_merge(merge: &Merge) -> anyhow::Result<Exit> {
    let started = Instant::now();
    let Report { runs, failed, files, statistics, .. } = sweep::merge(&merge.folders, &merge.output)?;
    let elapsed_s = started.elapsed().as_secs_f64();
    let statistics = statistics.as_ref().and_then(sweep_statistics::Output::of);
    let merged = Merged { runs, failed, elapsed_s, files: &files, statistics };
    output::show(merge.json, &merged, || {
        let means = means(merged.statistics.as_ref());
        format!("merged {runs} runs, {failed} of them failed\n\n{means}{}", file_list(&files))
    })?;
    Ok(verdict(runs, failed))
}

/// A sweep has failed if all of its runs have.
fn verdict(runs: u64, failed: u64) -> Exit {
    if runs > 0 && failed == runs { Exit::Failed } else { Exit::Passed }
}

fn run_sweep(arguments: &Arguments, interruption: &Interruption) -> anyhow::Result<Exit> {
    let started = Instant::now();
    let file = arguments.what.sweep_file()?;
    let design = arguments.what.sampling.design.or(file.sampling.design).unwrap_or_default();
    let fmu = arguments.fmu.as_deref().map(|path| arguments.isolation.open(path)).transpose()?;
    if fmu.is_none() {
        arguments.isolation.check_own()?;
    }
    let own = sweep::system_description()?;
    let description = fmu.as_ref().map_or(&own, Fmu::description);
    let fingerprint = arguments.fmu.as_deref().map(sweep::fingerprint).transpose()?;
    let isolation = arguments.isolation.bounds_of(fmu.as_ref());
    let sweep = Sweep::new(&arguments.what.request(file, description, fingerprint, isolation)?)?;
    if arguments.check {
        return show_counts(arguments, &sweep, design);
    }
    let engine = if let Some(fmu) = fmu {
        Engine::Fmu(fmu)
    } else {
        let isolation = &arguments.isolation;
        Engine::of_harvester(&sweep, isolation.is_forced(), || isolation.open_own("VibroImpactHarvester"))?
    };
    let report = follow(arguments, &sweep, &engine, interruption.defer())?;
    if report.is_complete() {
        return show(arguments, &sweep, design, &report, started.elapsed().as_secs_f64());
    }
    let Report { done, runs, files, .. } = &report;
    let kept = files.first().map(|file| format!(", which are in {}", file.display())).unwrap_or_default();
    say(&format!("interrupted after {done} of {runs} runs{kept}; the same command without --fresh goes on from there"));
    Ok(Exit::Stopped(u8::try_from(interruption.signal())?))
}

impl<'a> Counts<'a> {
    fn new(sweep: &'a Sweep, design: Design, runs: u64) -> Self {
        let (points, samples, is_adaptive) = (sweep.points(), sweep.samples(), sweep.is_adaptive());
        Self { case: sweep.name(), design, points, samples, runs, is_adaptive }
    }

    /// In front of a number of samples.
    fn at_most(&self) -> &'static str {
        if self.is_adaptive { "at most " } else { "" }
    }
}

fn show_counts(arguments: &Arguments, sweep: &Sweep, design: Design) -> anyhow::Result<Exit> {
    let counts = Counts::new(sweep, design, sweep.runs());
    let Counts { case, points, samples, runs, .. } = counts;
    output::show(arguments.json, &counts, || {
        let at_most = counts.at_most();
        format!("sweep {case}: {design} of {points} points, {at_most}{samples} samples each: {at_most}{runs} runs")
    })?;
    Ok(Exit::Passed)
}

/// Runs the sweep, with progress.
fn follow(arguments: &Arguments, sweep: &Sweep, engine: &Engine, stop: &AtomicBool) -> Result<Report, SweepError> {
    let folder = arguments.output.clone().map_or_else(|| sweep::free_folder(sweep, Path::new("out/sweep")), Ok)?;
    sweep::run(
        &arguments.execution.options(sweep, engine, &folder),
        &RunBar::new(&format!("sweep {}", sweep.name()), stop),
    )
}

fn show(arguments: &Arguments, sweep: &Sweep, design: Design, report: &Report, elapsed_s: f64) -> anyhow::Result<Exit> {
    let Report { runs, failed, resumed_from, .. } = *report;
    let result = Output {
        counts: Counts::new(sweep, design, runs),
        failed,
        resumed_from,
        elapsed_s,
        rate_runs_per_s: (runs - resumed_from) as f64 / elapsed_s,
        shard: arguments.execution.shard.map(|shard| shard.to_string()),
        files: &report.files,
        statistics: report.statistics.as_ref().and_then(sweep_statistics::Output::of),
    };
    output::show(arguments.json, &result, || text(&result))?;
    if failed > 0 {
        say(&format!("warning: {failed} of {runs} runs failed; the column error says why"));
    }
    if let Some(unreached) = report.statistics.as_ref().map(|it| it.unreached).filter(|unreached| *unreached > 0) {
        let points = sweep.points();
        say(&format!(
            "warning: {unreached} of {points} points did not become as precise as --until-precision; the column reached of statistics.csv says \
             which"
        ));
    }
    // The merge of the shards finds out whether all runs of the sweep failed.
    Ok(if arguments.execution.shard.is_some() { Exit::Passed } else { verdict(runs, failed) })
}

fn text(result: &Output<'_>) -> String {
    let Output { counts, failed, resumed_from, elapsed_s, rate_runs_per_s, shard, files, statistics } = result;
    let Counts { case, design, points, samples, runs, .. } = counts;
    let at_most = counts.at_most();
    let share = shard.as_ref().map_or_else(String::new, |shard| format!(", shard {shard}"));
    let work = if resumed_from == runs {
        "all of them were there already: nothing to do".to_owned()
    } else {
        let resumed = if *resumed_from > 0 { format!(", after {resumed_from} that were there") } else { String::new() };
        let (rate, seconds) = (format::rate(*rate_runs_per_s), format::significant(*elapsed_s, 3));
        format!("{rate} runs/s, {seconds} s{resumed}")
    };
    format!(
        "sweep {case}: {design} of {points} points, {at_most}{samples} samples each{share}\n\
         {runs} runs, {failed} of them failed; {work}\n\n{}{}",
        means(statistics.as_ref()),
        file_list(files)
    )
}

/// The means of the samples in front of the list of files.
fn means(statistics: Option<&sweep_statistics::Output<'_>>) -> String {
    statistics.map(|statistics| statistics.text() + "\n\n").unwrap_or_default()
}
