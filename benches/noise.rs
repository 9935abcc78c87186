//! Phase noise as in Fig. 17, 1e7 hold intervals in 100 s, against plain programs in one run: `cargo bench --bench noise`.
//! The throughput counts hold intervals.

#[path = "baseline/noise.rs"]
mod baseline;

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use videg_model::{Harvester, Parameters};

/// Duration of the paper's runs, s.
const UNTIL: f64 = 100.0;

/// gamma = 5, r = 1, sigma = 1.
fn parameters() -> Parameters {
    let p = Parameters { restitution: 1.0, phase_noise: 1.0, ..Parameters::default() };
    Parameters { amplitude: p.amplitude * 5.0 / p.normalized_amplitude(), ..p }
}

/// Voltage gain, V, of a run in steps of `step`, s.
fn in_steps(parameters: &Parameters, step: f64) -> f64 {
    let Ok(mut harvester) = Harvester::new(parameters, 0.0) else { return f64::NAN };
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // a positive number of steps
    let steps = (UNTIL / step).round() as u32;
    let advanced = (1..=steps).all(|k| harvester.advance(f64::from(k) * step).is_ok());
    if advanced { harvester.totals().voltage_gain } else { f64::NAN }
}

fn runs_of_100_s(criterion: &mut Criterion) {
    let p = parameters();
    let mut group = criterion.benchmark_group("phase noise, 100 s");
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // a positive number of intervals
    group.throughput(Throughput::Elements((UNTIL / p.noise_hold).round() as u64)).sample_size(10);
    group.bench_function("in blocks", |b| b.iter(|| in_steps(black_box(&p), UNTIL)));
    group.bench_function("in blocks, steps of 1 ms", |b| b.iter(|| in_steps(black_box(&p), 1e-3)));
    group.bench_function("one by one, closed form", |b| b.iter(|| baseline::closed_form(black_box(&p), UNTIL)));
    group.bench_function("one by one, Runge-Kutta", |b| b.iter(|| baseline::runge_kutta(black_box(&p), UNTIL)));
    group.finish();
}

criterion_group!(benches, runs_of_100_s);
criterion_main!(benches);
