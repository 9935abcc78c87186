//! `videg sweep`: many runs over parameters and seeds; `videg sweep merge`: shards put together.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::Instant;

use anyhow::Context as _;
use clap::{Args, Subcommand};
use serde::Serialize;
use signal_hook::consts::{SIGINT, SIGTERM};

use super::options::{Window, parse_window};
use super::progress::RunBar;
use super::simulate::file_list;
use super::{Verdict, format, output, packaging, settings};
use crate::fmi::{Fmu, ModelDescription};
use crate::scenario::{self, Setting};
use crate::sweep::{self, BuiltIn, Design, Engine, Job, Report, Request, Shard, Sweep, SweepFile, Times, Vary};

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
    /// Run share i of n only, for `sweep merge` to put together
    #[arg(long, value_name = "I/N", value_parser = Shard::parse)]
    shard: Option<Shard>,
    /// Runs that go on at once [default: one on each core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    jobs: Option<u16>,
    /// Folder for the results; the same command with the same folder goes on where it ended
    #[arg(long, value_name = "DIR", default_value = "out/sweep")]
    output: PathBuf,
    /// Begin anew, whatever is in the folder
    #[arg(long)]
    fresh: bool,
    /// Print one JSON object on stdout instead of the table
    #[arg(long)]
    json: bool,
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

/// What is swept. An option wins over the same key of the file.
#[derive(Args)]
struct What {
    /// Sweep file (TOML): a case file that may also have design, points, samples, seed, record and a [vary] table
    #[arg(value_name = "FILE.toml")]
    file: Option<PathBuf>,
    /// Case of the paper: fig9 to fig15, table3-2hz, table3-5hz [default: fig14]
    #[arg(long, value_name = "NAME")]
    case: Option<String>,
    /// Set a parameter or input in all runs; may be repeated
    #[arg(long = "set", value_name = "VARIABLE=VALUE")]
    settings: Vec<String>,
    /// Vary a parameter or input: name=from:to:count for a grid, name=from:to for the other designs, with log: before from
    /// for equal ratios; name=a,b,c for any type; may be repeated
    #[arg(long, value_name = "VARIABLE=VALUES")]
    vary: Vec<String>,
    /// How points are chosen [default: grid]
    #[arg(long, value_enum, value_name = "DESIGN")]
    design: Option<Design>,
    /// Number of points of lhs and random; a grid has as many as it has
    #[arg(long, value_name = "N")]
    points: Option<u64>,
    /// Runs of each point, each with other noise [default: 1]
    #[arg(long, value_name = "N")]
    samples: Option<u64>,
    /// Seed of the design, and of the noise of the first run; each further run has the next [default: 1]
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// Give sample i the same seed in all points (common random numbers)
    #[arg(long)]
    common_seeds: bool,
    /// The variable that takes the seed [default: excitation.seed]
    #[arg(long, value_name = "VARIABLE")]
    seed_variable: Option<String>,
    /// End of a run, s [default: 100]
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    until: Option<f64>,
    /// Communication step, s [default: from edge to edge of the window; of other FMUs their own, or 1/1000 of the run]
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    step: Option<f64>,
    /// Averaging window, s [default: 50,100, or the second half of a shorter run]
    #[arg(long, value_name = "S,S", value_parser = parse_window, allow_hyphen_values = true)]
    window: Option<Window>,
    /// Record a variable at the end of each run; may be repeated
    #[arg(long, value_name = "VARIABLE")]
    record: Vec<String>,
}

/// What `--json` says.
#[derive(Serialize)]
struct Output<'a> {
    case: &'a str,
    design: Design,
    points: u64,
    samples: u64,
    /// Runs of the sweep, or of the shard.
    runs: u64,
    failed: u64,
    /// Runs that were there from the beginning.
    resumed_from: u64,
    elapsed_s: f64,
    rate_runs_per_s: f64,
    shard: Option<String>,
    files: &'a [PathBuf],
}

/// What `--json` says of a merge.
#[derive(Serialize)]
struct Merged<'a> {
    runs: u64,
    failed: u64,
    elapsed_s: f64,
    files: &'a [PathBuf],
}

/// Runs the verb.
pub fn run(arguments: &Arguments) -> anyhow::Result<Verdict> {
    match &arguments.verb {
        Some(Verb::Merge(merge)) => put_together(merge),
        None => carry_out(arguments),
    }
}

fn put_together(merge: &Merge) -> anyhow::Result<Verdict> {
    let started = Instant::now();
    let Report { runs, failed, files, .. } = sweep::merge(&merge.folders, &merge.output)?;
    let elapsed_s = started.elapsed().as_secs_f64();
    if merge.json {
        output::print(&serde_json::to_string_pretty(&Merged { runs, failed, elapsed_s, files: &files })?)?;
    } else {
        output::print(&format!("merged {runs} runs, {failed} of them failed\n\n{}", file_list(&files)))?;
    }
    Ok(verdict(runs, failed))
}

/// A sweep none of whose runs came to anything has failed.
fn verdict(runs: u64, failed: u64) -> Verdict {
    if runs > 0 && failed == runs { Verdict::Failed } else { Verdict::Passed }
}

fn carry_out(arguments: &Arguments) -> anyhow::Result<Verdict> {
    let started = Instant::now();
    let file = arguments.what.file.as_deref().map(SweepFile::read).transpose()?.unwrap_or_default();
    let fmu = arguments.fmu.as_deref().map(Fmu::open).transpose()?;
    let own = sweep::harvester_description()?;
    let description = fmu.as_ref().map_or(&own, Fmu::description);
    let fingerprint = arguments.fmu.as_deref().map(sweep::fingerprint).transpose()?;
    let design = arguments.what.design.or(file.design).unwrap_or_default();
    let sweep = Sweep::new(request(&arguments.what, file, description, fingerprint)?)?;
    let engine = match fmu {
        Some(fmu) => Engine::Fmu(fmu),
        // What the model itself does not offer goes through its FMU, with the same numbers.
        None => match BuiltIn::new(&sweep) {
            Some(built_in) => Engine::BuiltIn(built_in),
            None => Engine::Fmu(packaging::open("VibroImpactHarvester")?),
        },
    };
    let (stop, signal) = signals()?;
    let cores = || std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    let job = Job {
        folder: &arguments.output,
        shard: arguments.shard,
        jobs: arguments.jobs.map_or_else(cores, usize::from),
        fresh: arguments.fresh,
        stop: &stop,
    };
    let mut bar = RunBar::new(format!("sweep {}", sweep.name()));
    let report = sweep::run(&sweep, &engine, &job, &mut bar);
    bar.finish();
    let report = report?;
    if !report.is_complete() {
        let (done, runs) = (report.done, report.runs);
        eprintln!("videg: interrupted after {done} of {runs} runs; the same command goes on from there");
        let number = signal.load(Ordering::Relaxed);
        return Ok(Verdict::Stopped(u8::try_from(number).unwrap_or(0)));
    }
    let elapsed = started.elapsed().as_secs_f64();
    show(arguments, &sweep, design, &report, elapsed)
}

fn show(
    arguments: &Arguments,
    sweep: &Sweep,
    design: Design,
    report: &Report,
    elapsed_s: f64,
) -> anyhow::Result<Verdict> {
    let result = Output {
        case: sweep.name(),
        design,
        points: sweep.points(),
        samples: sweep.samples(),
        runs: report.runs,
        failed: report.failed,
        resumed_from: report.resumed_from,
        elapsed_s,
        rate_runs_per_s: (report.runs - report.resumed_from) as f64 / elapsed_s,
        shard: arguments.shard.map(|shard| shard.to_string()),
        files: &report.files,
    };
    if arguments.json {
        output::print(&serde_json::to_string_pretty(&result)?)?;
    } else {
        output::print(&text(&result))?;
    }
    if report.failed > 0 {
        let (failed, runs) = (report.failed, report.runs);
        eprintln!("videg: warning: {failed} of {runs} runs failed; the column error says why");
    }
    Ok(verdict(report.runs, report.failed))
}

fn text(result: &Output<'_>) -> String {
    let Output { case, design, points, samples, runs, failed, resumed_from, elapsed_s, rate_runs_per_s, .. } = result;
    let share = result.shard.as_ref().map_or_else(String::new, |shard| format!(", shard {shard}"));
    let work = if resumed_from == runs {
        "all of them were there already: nothing to do".to_owned()
    } else {
        let resumed = if *resumed_from > 0 { format!(", after {resumed_from} that were there") } else { String::new() };
        let (rate, seconds) = (format::significant(*rate_runs_per_s, 3), format::significant(*elapsed_s, 3));
        format!("{rate} runs/s, {seconds} s{resumed}")
    };
    format!(
        "sweep {case}: {design} of {points} points, {samples} samples each{share}\n\
         {runs} runs, {failed} of them failed; {work}\n\n{}",
        file_list(result.files)
    )
}

fn request<'a>(
    what: &What,
    file: SweepFile,
    description: &'a ModelDescription,
    fingerprint: Option<String>,
) -> anyhow::Result<Request<'a>> {
    let parsed: Result<Vec<_>, _> = what.settings.iter().map(|text| Setting::parse(text)).collect();
    let is_harvester = description.variable("gain.voltage").is_ok();
    anyhow::ensure!(
        is_harvester || (what.case.is_none() && file.case.case.is_none()),
        "--case: {} is not the harvester, so no case of the paper is one of its own",
        description.model_name
    );
    let step = what.step.or(file.case.step);
    let until = what.until.or(file.case.until);
    let until = if is_harvester { until } else { until.or(description.default_experiment.stop_time) };
    let SweepFile { case, design, points, samples, seed, record, vary } = file;
    let name = case.name.clone();
    let scenario = scenario::Request {
        case: what.case.clone(),
        file: Some(case),
        settings: parsed?,
        until,
        step,
        window: what.window.map(|Window(window)| window),
    }
    .resolve()?;
    let settings = if is_harvester {
        let (mechanical, electrical) = settings::split(description, &scenario)?;
        let circuit: Vec<_> = electrical.iter().map(|setting| setting.name.as_str()).collect();
        if !circuit.is_empty() {
            output::warn(&[format!("{} left out: sweep runs no circuit", circuit.join(", "))]);
        }
        mechanical
    } else {
        scenario.changes().to_vec()
    };
    let own_step = || description.default_experiment.step_size.unwrap_or(scenario.until / 1000.0);
    let step = if is_harvester { step } else { Some(step.unwrap_or_else(own_step)) };
    let asked: Result<Vec<_>, _> = what.vary.iter().map(|text| Vary::parse(text)).collect();
    Ok(Request {
        name: name.unwrap_or_else(|| if is_harvester { scenario.name } else { description.model_name.clone() }),
        description,
        fmu: fingerprint,
        settings,
        times: Times { until: scenario.until, step, window: scenario.window },
        vary: [vary, asked?].concat(),
        design: what.design.or(design).unwrap_or_default(),
        points: what.points.or(points),
        samples: what.samples.or(samples).unwrap_or(1),
        seed: what.seed.or(seed).unwrap_or(1),
        common_seeds: what.common_seeds,
        seed_variable: what.seed_variable.clone(),
        record: if what.record.is_empty() { record } else { what.record.clone() },
    })
}

/// A flag that an interruption sets, and its number. The second one ends the process at once.
fn signals() -> anyhow::Result<(Arc<AtomicBool>, Arc<AtomicUsize>)> {
    let (stop, number) = (Arc::new(AtomicBool::new(false)), Arc::new(AtomicUsize::new(0)));
    for signal in [SIGINT, SIGTERM] {
        let value = usize::try_from(signal).unwrap_or_default();
        signal_hook::flag::register_conditional_shutdown(signal, 128 + signal, Arc::clone(&stop))
            .and_then(|_| signal_hook::flag::register_usize(signal, Arc::clone(&number), value))
            .and_then(|_| signal_hook::flag::register(signal, Arc::clone(&stop)))
            .with_context(|| format!("cannot wait for signal {signal}"))?;
    }
    Ok((stop, number))
}
