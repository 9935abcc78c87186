//! The event-driven motion against the paper's stepping, in one run: `cargo bench --bench harvester`.

mod baseline;

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use videg_model::{Case, Harvester, Parameters};

/// Duration of the paper's runs, s.
const UNTIL: f64 = 100.0;
/// Step of the paper's runs, s.
const DT: f64 = 1e-5;

fn parameters(case: &str) -> Parameters {
    Case::find(case).map_or_else(Parameters::default, |case| (case.parameters)())
}

fn event_driven(parameters: &Parameters) -> f64 {
    let mut harvester = Harvester::new(parameters, 0.0).ok();
    let advanced = harvester.as_mut().is_some_and(|harvester| harvester.advance(UNTIL).is_ok());
    harvester.filter(|_| advanced).map_or(f64::NAN, |harvester| harvester.totals().voltage_gain)
}

fn runs_of_100_s(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("100 s");
    for case in ["fig14", "table3-2hz"] {
        let parameters = parameters(case);
        group.bench_function(format!("{case}, event-driven"), |b| b.iter(|| event_driven(black_box(&parameters))));
    }
    let fig14 = parameters("fig14");
    group.sample_size(10);
    group.bench_function("fig14, Runge-Kutta as the paper", |b| {
        b.iter(|| baseline::runge_kutta(black_box(&fig14), DT, UNTIL));
    });
    group.finish();
}

criterion_group!(benches, runs_of_100_s);
criterion_main!(benches);
