//! The embedded circuit solver against ngspice on the same C(t), in one run: `cargo bench --bench circuit`.
//!
//! The accuracy of each is printed first: the largest relative deviation of supply and load energy from those with ideal
//! diodes, which is what all of them stand for. ngspice is started anew for each run, as its users do; that takes some 10 ms.

use std::hint::black_box;
use std::path::Path;

use anyhow::Context as _;
use criterion::{Criterion, SamplingMode};
use fmu_import::Fmu;
use videg::cosim::{CircuitSample, CircuitSlave as _, CosimError, HarvesterFmu, NgspiceCircuit};
use videg::coupled::{self, TOLERANCE, Times};
use videg::ngspice::{CapacitanceTable, Elements, Ngspice, Run, Waveforms};
use videg::package::{Options, build_all};
use videg::scenario::Request;
use videg_circuit::{DiodeParameters, Diodes, Ledger, Parameters, Release, Settings, Topology};
use videg_model::Case;

/// Duration, s: some sixty pulses.
const UNTIL: f64 = 10.0;

fn table(until: f64, tolerance: f64) -> anyhow::Result<CapacitanceTable> {
    let folder = tempfile::tempdir()?;
    let paths = build_all(&Options { output: Some(folder.path().to_owned()), ..Options::default() })?;
    let fmu = Fmu::open(paths.first().context("no FMU")?)?;
    let scenario = Request { case: Some("fig14".to_owned()), until: Some(until), ..Request::default() }.resolve()?;
    let mut harvester = HarvesterFmu::new(&fmu, &scenario, &scenario.settings)?;
    Ok(CapacitanceTable::from_harvester(&mut harvester, until, tolerance, &())?)
}

fn deviation(found: &Ledger, exact: &Ledger) -> f64 {
    let relative = |value: fn(&Ledger) -> f64| (value(found) / value(exact) - 1.0).abs();
    relative(|ledger| ledger.supply).max(relative(|ledger| ledger.load))
}

/// The shared library in step with C(t), as a co-simulation has it: on a grid of 1 ms and at the rows of the table, with the
/// energies of all elements.
fn live(elements: &Elements, table: &CapacitanceTable, run: &Run) -> Result<CircuitSample, CosimError> {
    const STEP: f64 = 1e-3;
    let mut circuit =
        NgspiceCircuit::new("live", Path::new(env!("CARGO_BIN_EXE_videg")), elements, table.initial(), run)?;
    for ((from, start), (to, end)) in table.rows().zip(table.rows().skip(1)) {
        let pieces = ((to - from) / STEP).ceil();
        let at = |piece: f64| from + (to - from) * (piece / pieces);
        let capacitance = |piece: f64| [0, 1].map(|j| start[j] + (end[j] - start[j]) * (piece / pieces));
        let mut piece = 0.0;
        while piece < pieces {
            let time = at(piece);
            circuit.step(time, at(piece + 1.0) - time, capacitance(piece), capacitance(piece + 1.0))?;
            piece += 1.0;
        }
    }
    circuit.sample()
}

/// 100 s of mechanics and circuit together, without steps, and ngspice on the same C(t).
fn coupled_runs(criterion: &mut Criterion, ngspice: &Ngspice) -> anyhow::Result<()> {
    const UNTIL: f64 = 100.0;
    let mut settings = Settings::default();
    settings.circuit.topology = Topology::Isolated;
    settings.circuit.release = Release::Switch;
    settings.circuit.zener_voltage = 2450.0;
    let case = (Case::find("fig14").context("no such case")?.parameters)();
    let times = Times { until: UNTIL, window: [50.0, UNTIL], tolerance: TOLERANCE };
    let table = table(UNTIL, TOLERANCE)?;
    let elements = Elements::new(&settings.parameters(), table.growth())?;
    let run = Run::new(table.until(), table.growth());
    let ours = coupled::run(&case, &settings, &times)?.circuit.ledger;
    let fine = self::table(UNTIL, 1e-5)?;
    let exact = Waveforms::embedded(&settings.parameters(), &fine)?.ledger();
    let (count, fine) = (table.len() - 1, fine.len() - 1);
    println!("fig14, {UNTIL} s, isolated, switch; deviation from the circuit alone on {fine} ramps of C(t):");
    println!("  coupled {:.1e}", deviation(&ours, &exact));
    let by_ngspice = ngspice.simulate(&elements, &table, &run)?.ledger();
    println!("  ngspice on {count} ramps {:.1e}", deviation(&by_ngspice, &exact));
    let mut group = criterion.benchmark_group("100 s of fig14, isolated, switch");
    group.bench_function("harvester and circuit", |b| b.iter(|| coupled::run(black_box(&case), &settings, &times)));
    group.sampling_mode(SamplingMode::Flat).sample_size(10);
    group.bench_function("ngspice, batch", |b| b.iter(|| ngspice.simulate(black_box(&elements), &table, &run)));
    group.finish();
    Ok(())
}

fn main() -> anyhow::Result<()> {
    let table = table(UNTIL, 1e-4)?;
    let ideal = Parameters::default();
    let exponential = Parameters { diodes: Diodes::Exponential(DiodeParameters::default()), ..ideal };
    let (ngspice, elements) = (Ngspice::find(None)?, Elements::new(&ideal, table.growth())?);
    let run = Run::new(table.until(), table.growth());
    let exact = Waveforms::embedded(&ideal, &table)?.ledger();
    let by_exponential = Waveforms::embedded(&exponential, &table)?.ledger();
    let by_ngspice = ngspice.simulate(&elements, &table, &run)?.ledger();
    println!("fig14, {UNTIL} s, {} ramps of C(t); deviation from ideal diodes:", table.len() - 1);
    println!("  embedded, exponential diodes {:.1e}", deviation(&by_exponential, &exact));
    println!("  ngspice {:.1e}", deviation(&by_ngspice, &exact));
    let mut criterion = Criterion::default().configure_from_args();
    let mut group = criterion.benchmark_group("10 s of fig14, shared node, series Zener");
    group.sampling_mode(SamplingMode::Flat).sample_size(10);
    group.bench_function("embedded, ideal diodes", |b| b.iter(|| Waveforms::embedded(black_box(&ideal), &table)));
    group.bench_function("embedded, exponential diodes", |b| {
        b.iter(|| Waveforms::embedded(black_box(&exponential), &table));
    });
    group.bench_function("ngspice, batch", |b| b.iter(|| ngspice.simulate(black_box(&elements), &table, &run)));
    group.bench_function("ngspice, live", |b| b.iter(|| live(black_box(&elements), &table, &run)));
    group.finish();
    coupled_runs(&mut criterion, &ngspice)?;
    criterion.final_summary();
    Ok(())
}
