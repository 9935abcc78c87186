//! What a call of an isolated FMU costs beside one in this process, and what an instance costs to start:
//! `cargo run --release --example isolation`.

use std::time::{Duration, Instant};

use anyhow::Context as _;
use fmu_import::{Bounds, Fmu, Instance, Isolation, Kind, Logging};
use videg::package::{Options, build_all};

/// Runs of each measurement, of which the shortest counts.
const RUNS: u32 = 5;

fn main() -> anyhow::Result<()> {
    let folder = tempfile::tempdir()?;
    let paths = build_all(&Options { output: Some(folder.path().to_owned()), ..Options::default() })?;
    let path = paths.first().context("no FMU")?;
    // The verb that serves is one of the command-line tool, which lies one folder up.
    let program = std::env::current_exe()?.ancestors().nth(2).context("no folder")?.join("videg");
    anyhow::ensure!(program.is_file(), "{} is not there: cargo build --release builds it", program.display());
    let here = Fmu::open(path)?;
    let isolated = Fmu::open_isolated(path, &Isolation { program, bounds: Bounds::default() })?;
    println!("{:<36} {:>14} {:>14}", "", "this process", "isolated");
    for (name, measure) in [
        ("fmi2DoStep, 1 ms", step as fn(&Fmu) -> anyhow::Result<Duration>),
        ("fmi2GetReal, 16 values", read),
        ("instance, to its end", start),
    ] {
        println!("{name:<36} {:>14} {:>14}", shown(shortest(measure, &here)?), shown(shortest(measure, &isolated)?));
    }
    Ok(())
}

fn shown(time: Duration) -> String {
    format!("{:.3} us", 1e6 * time.as_secs_f64())
}

fn shortest(measure: fn(&Fmu) -> anyhow::Result<Duration>, fmu: &Fmu) -> anyhow::Result<Duration> {
    let times = (0..RUNS).map(|_| measure(fmu)).collect::<anyhow::Result<Vec<_>>>()?;
    times.into_iter().min().context("no run")
}

fn initialised(fmu: &Fmu) -> anyhow::Result<Instance> {
    let mut instance = fmu.instantiate("harvester", Logging::default())?;
    instance.setup_experiment(0.0, None, None)?;
    instance.enter_initialization_mode()?;
    instance.exit_initialization_mode()?;
    Ok(instance)
}

/// Mean time of a step.
fn step(fmu: &Fmu) -> anyhow::Result<Duration> {
    const STEPS: u32 = 20_000;
    let mut instance = initialised(fmu)?;
    let begun = Instant::now();
    for k in 0..STEPS {
        instance.do_step(1e-3 * f64::from(k), 1e-3)?;
    }
    Ok(begun.elapsed() / STEPS)
}

/// Mean time of reading.
fn read(fmu: &Fmu) -> anyhow::Result<Duration> {
    const READS: u32 = 20_000;
    let outputs: Vec<_> = reals(fmu).take(16).collect();
    let (instance, mut values) = (initialised(fmu)?, vec![0.0; outputs.len()]);
    let begun = Instant::now();
    for _ in 0..READS {
        instance.get_real(&outputs, &mut values)?;
    }
    Ok(begun.elapsed() / READS)
}

/// Value references of the Real outputs.
fn reals(fmu: &Fmu) -> impl Iterator<Item = u32> {
    let reals = fmu.description().output_variables().filter(|it| matches!(it.kind, Kind::Real { .. }));
    reals.map(|it| it.value_reference)
}

/// Mean time to make, initialise and free an instance.
fn start(fmu: &Fmu) -> anyhow::Result<Duration> {
    const INSTANCES: u32 = 20;
    let begun = Instant::now();
    for _ in 0..INSTANCES {
        initialised(fmu)?.free()?;
    }
    Ok(begun.elapsed() / INSTANCES)
}
