//! How the cost of a run grows with what it consists of, as one Markdown table: `cargo run --release --example growth`.
//!
//! Times are medians of several runs, on the clock of the wall; a load on the machine's other cores makes them longer.

use std::fmt;
use std::num::NonZero;
use std::panic::resume_unwind;
use std::time::Instant;

use videg_model::{Case, Harvester, ModelError, Parameters};

/// Runs of which the median is taken.
const REPETITIONS: usize = 5;

/// A row of the table.
struct Row {
    varied: &'static str,
    value: String,
    count: u64,
    /// What is counted.
    unit: &'static str,
    seconds: f64,
}

impl fmt::Display for Row {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { varied, value, count, unit, seconds } = self;
        let each = 1e9 * seconds / *count as f64;
        write!(f, "| {varied} | {value} | {count} | {:.3} | {each:.2} per {unit} |", 1e3 * seconds)
    }
}

/// Median time, s, of `run`, and what it returned last.
fn timed<T>(mut run: impl FnMut() -> Result<T, ModelError>) -> Result<(f64, T), ModelError> {
    let mut result = run()?; // warms caches up
    let mut times = [0.0; REPETITIONS];
    for time in &mut times {
        let start = Instant::now();
        result = run()?;
        *time = start.elapsed().as_secs_f64();
    }
    times.sort_by(f64::total_cmp);
    Ok((times[REPETITIONS / 2], result))
}

fn case(name: &str) -> Parameters {
    Case::find(name).map_or_else(Parameters::default, |case| (case.parameters)())
}

/// Events in a run of `until`, s.
fn events(parameters: &Parameters, until: f64) -> Result<u64, ModelError> {
    let mut harvester = Harvester::new(parameters, 0.0)?;
    harvester.advance(until)?;
    Ok(harvester.totals().events())
}

fn row_of_events(varied: &'static str, value: String, p: &Parameters, until: f64) -> Result<Row, ModelError> {
    let (seconds, count) = timed(|| events(p, until))?;
    Ok(Row { varied, value, count, unit: "event", seconds })
}

fn over_simulated_time() -> impl Iterator<Item = Result<Row, ModelError>> {
    [1e1, 1e2, 1e3, 1e4, 1e5, 1e6]
        .into_iter()
        .map(|until| row_of_events("simulated time, Fig. 14", format!("{until:e} s"), &case("fig14"), until))
}

/// Fig. 14, faster and faster with the same normalised amplitude, so that the ball meets the membranes in the same
/// rhythm; and a ball that chatters and rests, whose bounces become ever more frequent.
fn over_impact_rate() -> impl Iterator<Item = Result<Row, ModelError>> {
    const UNTIL: f64 = 100.0;
    let base = case("fig14");
    let scaled = [0.2, 0.5, 2.0, 5.0, 20.0, 50.0].into_iter().map(move |frequency| {
        let scale = frequency / base.frequency;
        let p = Parameters {
            frequency,
            amplitude: base.amplitude * scale * scale,
            cylinder_velocity: base.cylinder_velocity * scale,
            ball_velocity: base.ball_velocity * scale,
            ..base
        };
        (format!("Fig. 14 at {frequency} Hz"), p)
    });
    let chattering = ["table3-2hz", "table3-5hz"].into_iter().map(|name| (name.to_owned(), case(name)));
    scaled.chain(chattering).map(|(name, p)| {
        let rate = events(&p, UNTIL)? as f64 / UNTIL;
        row_of_events("impact rate, 100 s", format!("{name}: {rate:.1} events/s"), &p, UNTIL)
    })
}

/// gamma = 5, r = 1, sigma = 1, as in Fig. 17.
fn noisy(seed: i32) -> Parameters {
    let p = Parameters { restitution: 1.0, phase_noise: 1.0, seed, ..Parameters::default() };
    Parameters { amplitude: p.amplitude * 5.0 / p.normalized_amplitude(), ..p }
}

/// Runs with noise of one second each, with different seeds.
fn ensemble(mut seeds: impl Iterator<Item = i32>) -> Result<(), ModelError> {
    seeds.try_for_each(|seed| events(&noisy(seed), 1.0).map(drop))
}

/// The same, dealt out to threads.
fn ensemble_on(threads: usize, runs: i32) -> Result<(), ModelError> {
    let of_thread = |thread: usize| ensemble((0..runs).skip(thread).step_by(threads));
    std::thread::scope(|scope| {
        let others: Vec<_> = (1..threads).map(|thread| scope.spawn(move || of_thread(thread))).collect();
        let mut results = vec![of_thread(0)];
        results.extend(others.into_iter().map(|other| other.join().unwrap_or_else(|panic| resume_unwind(panic))));
        results.into_iter().collect()
    })
}

fn row_of_holds(varied: &'static str, value: String, threads: usize, runs: i32) -> Result<Row, ModelError> {
    let (seconds, ()) = timed(|| ensemble_on(threads, runs))?;
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // a positive number of intervals
    let holds = (f64::from(runs) / noisy(0).noise_hold).round() as u64;
    Ok(Row { varied, value, count: holds, unit: "hold interval", seconds })
}

fn over_ensemble_size() -> impl Iterator<Item = Result<Row, ModelError>> {
    [1, 10, 100, 1000]
        .into_iter()
        .map(|runs| row_of_holds("ensemble with noise", format!("{runs} runs of 1 s"), 1, runs))
}

/// One thread, two, four, ... up to the number of cores.
fn over_cores() -> impl Iterator<Item = Result<Row, ModelError>> {
    let cores = std::thread::available_parallelism().map_or(1, NonZero::get);
    let threads = std::iter::successors(Some(1), move |threads| Some(threads * 2).filter(|next| *next <= cores));
    threads.map(|threads| row_of_holds("threads, 1000 runs with noise", threads.to_string(), threads, 1000))
}

fn main() -> Result<(), ModelError> {
    println!("| varied | value | count | time, ms | ns |\n|---|---|---|---|---|");
    let rows = over_simulated_time().chain(over_impact_rate()).chain(over_ensemble_size()).chain(over_cores());
    for row in rows {
        println!("{}", row?);
    }
    Ok(())
}
