//! Phase noise as in Fig. 17, 1e7 hold intervals in 100 s, against a plain program in C, and an ensemble on one thread
//! and on two, in one run: `cargo bench --bench noise`. The throughput counts hold intervals.

#[path = "baseline/noise.rs"]
mod baseline;

use std::hint::black_box;
use std::panic::resume_unwind;
use std::thread::ScopedJoinHandle;

use baseline::Plain;
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use videg_model::{Harvester, Parameters};

/// Duration of the paper's runs, s.
const UNTIL: f64 = 100.0;

/// Runs of the ensemble, and their duration, s.
const RUNS: i32 = 8;
const SHORT: f64 = 20.0;

/// gamma = 5, r = 1, sigma = 1.
fn parameters() -> Parameters {
    let p = Parameters { restitution: 1.0, phase_noise: 1.0, ..Parameters::default() };
    Parameters { amplitude: p.amplitude * 5.0 / p.normalized_amplitude(), ..p }
}

fn holds(until: f64) -> Throughput {
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // a positive number of intervals
    Throughput::Elements((until / parameters().noise_hold).round() as u64)
}

/// Voltage gain, V, of a run of `until`, s, in steps of `step`, s.
fn in_steps(parameters: &Parameters, until: f64, step: f64) -> f64 {
    let Ok(mut harvester) = Harvester::new(parameters, 0.0) else { return f64::NAN };
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // a positive number of steps
    let steps = (until / step).round() as u32;
    let advanced = (1..=steps).all(|k| harvester.advance(f64::from(k) * step).is_ok());
    if advanced { harvester.totals().voltage_gain } else { f64::NAN }
}

/// Voltage gains, V, of runs with different seeds, dealt out to this many threads.
fn ensemble(parameters: &Parameters, threads: usize) -> Vec<f64> {
    let of_thread = |thread: usize| {
        let seeds = (0..RUNS).skip(thread).step_by(threads);
        seeds.map(|seed| in_steps(&Parameters { seed, ..*parameters }, SHORT, SHORT)).collect::<Vec<_>>()
    };
    std::thread::scope(|scope| {
        let others: Vec<_> = (1..threads).map(|thread| scope.spawn(move || of_thread(thread))).collect();
        let mut gains = of_thread(0);
        let join = |other: ScopedJoinHandle<'_, Vec<f64>>| other.join().unwrap_or_else(|panic| resume_unwind(panic));
        gains.extend(others.into_iter().flat_map(join));
        gains
    })
}

fn runs_of_100_s(criterion: &mut Criterion) {
    let p = parameters();
    let mut group = criterion.benchmark_group("phase noise, 100 s");
    group.throughput(holds(UNTIL)).sample_size(10);
    group.bench_function("in blocks", |b| b.iter(|| in_steps(black_box(&p), UNTIL, UNTIL)));
    group.bench_function("in blocks, steps of 1 ms", |b| b.iter(|| in_steps(black_box(&p), UNTIL, 1e-3)));
    match Plain::compile() {
        Ok(plain) => {
            group.bench_function("C, Runge-Kutta", |b| b.iter(|| plain.runge_kutta(black_box(&p), UNTIL)));
            group.bench_function("C, closed form", |b| b.iter(|| plain.closed_form(black_box(&p), UNTIL)));
        }
        Err(error) => eprintln!("without the plain program: {error:#}"),
    }
    group.finish();
}

fn ensembles(criterion: &mut Criterion) {
    let p = parameters();
    let mut group = criterion.benchmark_group("phase noise, 8 runs of 20 s");
    group.throughput(holds(f64::from(RUNS) * SHORT)).sample_size(20);
    for threads in [1, 2] {
        group.bench_function(format!("threads: {threads}"), |b| b.iter(|| ensemble(black_box(&p), threads)));
    }
    group.finish();
}

criterion_group!(benches, runs_of_100_s, ensembles);
criterion_main!(benches);
