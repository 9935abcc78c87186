//! The event-driven motion against the paper's stepping, in one run: `cargo bench --bench harvester`.

mod baseline;
mod mounts;

use std::hint::black_box;

use std::f64::consts::TAU;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use mounts::UNTIL;
use videg_model::{Case, ExcitationKind, Harvester, ModelError, Parameters, Recording, Setup};

/// Step of the paper's runs, s.
const DT: f64 = 1e-5;
/// Communication step of a coupled run, s.
const COMMUNICATION_STEP: f64 = 1e-3;

fn parameters(case: &str) -> Parameters {
    Case::find(case).map_or_else(Parameters::default, |case| (case.parameters)())
}

/// Sum of `U_DE4` - `U_in`, V, of a run in this number of steps.
fn event_driven<'a>(setup: impl Into<Setup<'a>>, steps: u32) -> Result<f64, ModelError> {
    let mut harvester = Harvester::new(setup, 0.0)?;
    for k in 1..=steps {
        harvester.advance(UNTIL * f64::from(k) / f64::from(steps))?;
    }
    Ok(harvester.totals().voltage_gain)
}

fn other_mounts(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("100 s of fig14, another mount");
    for mounted in mounts::mounts() {
        group.bench_function(mounted.name, |b| b.iter(|| mounts::run(black_box(&mounted.parameters))));
    }
    group.finish();
}

/// A force like that of Fig. 14, with noise in it, in 1e5 samples.
fn recording() -> Option<Recording> {
    const SAMPLES: u32 = 100_000;
    const SPACING: f64 = 1e-3;
    let (mut state, mut slow) = (1_u64, 0.0);
    let mut noise = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        #[allow(clippy::cast_precision_loss)] // 32 bits
        let white = (state >> 32) as f64 / f64::from(u32::MAX) - 0.5;
        slow += 0.2 * (white - slow);
        0.5 * slow
    };
    let times: Vec<f64> = (0..=SAMPLES).map(|k| SPACING * f64::from(k)).collect();
    let values = times.iter().map(|time| 0.45 * (TAU * 2.0 * time).cos() + noise()).collect();
    Recording::new(ExcitationKind::Force, times, values).ok()
}

/// The capsule of Fig. 14 under a recording; time per sample is that of the run over 1e5.
fn recordings(criterion: &mut Criterion) {
    let Some(recording) = recording() else { return };
    let harmonic = parameters("fig14");
    let alone = Parameters { amplitude: 0.0, ..harmonic };
    let mut group = criterion.benchmark_group("100 s of a recording at 1 kHz");
    group.throughput(Throughput::Elements(recording.times().len() as u64)).sample_size(20);
    for (name, p) in [
        ("alone", alone),
        ("repeated each 100 s", Parameters { file_repeat: true, ..alone }),
        ("and a harmonic force", harmonic),
        ("inclined", Parameters { inclination: 0.02, ..alone }),
        ("with friction", Parameters { friction: 0.02, ..alone }),
        ("keeping the momentum", Parameters { reaction: true, ..alone }),
        ("suspended", Parameters { suspension_stiffness: 5.0, suspension_damping: 0.02, ..alone }),
    ] {
        group.bench_function(name, |b| b.iter(|| event_driven(black_box(&p).with_recording(Some(&recording)), 1)));
    }
    group.finish();
}

fn runs_of_100_s(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("100 s");
    for case in ["fig14", "table3-2hz"] {
        let parameters = parameters(case);
        group.bench_function(format!("{case}, event-driven"), |b| b.iter(|| event_driven(black_box(&parameters), 1)));
    }
    let fig14 = parameters("fig14");
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // a positive number of steps
    let steps = (UNTIL / COMMUNICATION_STEP).round() as u32;
    group.bench_function("fig14, event-driven in steps of 1 ms", |b| {
        b.iter(|| event_driven(black_box(&fig14), steps));
    });
    group.sample_size(10);
    group.bench_function("fig14, Runge-Kutta as the paper", |b| {
        b.iter(|| baseline::runge_kutta(black_box(&fig14), DT, UNTIL));
    });
    group.bench_function("fig14, Runge-Kutta stage by stage", |b| {
        b.iter(|| baseline::runge_kutta_by_stages(black_box(&fig14), DT, UNTIL));
    });
    group.finish();
}

criterion_group!(benches, runs_of_100_s, other_mounts, recordings);
criterion_main!(benches);
