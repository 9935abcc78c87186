//! Long runs: memory stays flat, the books close, and the FMU keeps to the model to the last bit. Alone in its file, and one
//! case after the other: the memory of the process is measured.
//!
//! `VIDEG_SOAK=full` takes the million seconds that `docs/soak.md` tells of; without it they are some thousand at most.
#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

#[path = "support/extent.rs"]
mod extent;

use std::time::Instant;

use extent::extent;

use fmu_import::Fmu;
use videg::cosim::{
    CosimError, Coupling, EmbeddedCircuit, HarvesterFmu, Master, Observer, Row, Sample, SeriesOptions, SeriesRecorder,
    Trace,
};
use videg::package::{Options, build_all};
use videg::scenario::{Request, Scenario};
use videg_circuit::Settings;
use videg_model::{Case, Harvester};

/// Memory of the process, kB: a line of `/proc/self/status`.
fn memory(line: &str) -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap();
    let value = status.lines().find_map(|text| text.strip_prefix(line)).unwrap();
    value.trim_matches([':', '\t', ' ', 'k', 'B']).parse().unwrap()
}

/// Notes the largest memory so far at a tenth, a half and the end of a run.
struct MemoryAt {
    due: Vec<f64>,
    found: Vec<u64>,
}

impl MemoryAt {
    fn of(until: f64) -> Self {
        // Forgets the peak of what was before.
        std::fs::write("/proc/self/clear_refs", "5").unwrap();
        Self { due: [0.1, 0.5, 1.0].map(|part| part * until).to_vec(), found: Vec::new() }
    }

    fn note(&mut self, time: f64) {
        if self.due.get(self.found.len()).is_some_and(|due| time >= *due) {
            self.found.push(memory("VmHWM:"));
        }
    }

    /// That nothing is kept of the run: half a megabyte is what allocator and kernel may round.
    fn assert_flat(&self, what: &str) {
        let [early, _, late] = self.found[..] else { unreachable!("three times of {what}") };
        assert!(late <= early + 512, "{what}: {:?} kB at a tenth, a half and the end", self.found);
    }
}

impl Observer for MemoryAt {
    fn observe(&mut self, row: &Row<'_>) -> Result<(), CosimError> {
        self.note(row.time);
        Ok(())
    }
}

/// How far the books of the ball may be off, relative to the work of the walls. Events are put at doubles, which are 1.2e-10 s apart
/// at 1e6 s: the wall of Table 3 goes on by 5e-8 m/s meanwhile, 64 million times.
fn bound(case: &str) -> f64 {
    if case.starts_with("table3") { 1e-8 } else { 1e-9 }
}

/// The model alone: how far the books of the ball are off, relative to the work of the walls.
fn alone(case: &str, until: f64) -> Harvester {
    let started = Instant::now();
    let parameters = (Case::find(case).unwrap().parameters)();
    let (mut harvester, mut memory) = (Harvester::new(&parameters, 0.0).unwrap(), MemoryAt::of(until));
    for k in 1..=1000 {
        harvester.advance(until * f64::from(k) / 1000.0).unwrap();
        memory.note(harvester.time());
    }
    let (e, impacts) = (harvester.energies(), harvester.totals().impacts);
    let start = 0.5 * parameters.ball_mass * parameters.ball_velocity.powi(2);
    let off = (e.ball + e.elastic + e.impact_loss - start - e.wall - e.electrical).abs() / e.wall.abs();
    memory.assert_flat(case);
    println!(
        "{case} alone, {until} s: {impacts} impacts, {:?} kB, books off by {off:.1e}, {:.0} s",
        memory.found,
        started.elapsed().as_secs_f64()
    );
    assert!(off < bound(case), "{case}: the books of the ball are off by {off} of {} J", e.wall);
    harvester
}

/// The FMU coupled with the circuit, as `videg cosim` does, but for the time series.
fn coupled(fmu: &Fmu, scenario: &Scenario, model: &Harvester) {
    let started = Instant::now();
    let harvester = HarvesterFmu::new(fmu, scenario, &scenario.settings).unwrap();
    let capacitance = harvester.sample().unwrap().capacitance();
    let circuit = EmbeddedCircuit::new("circuit", &Settings::default(), capacitance).unwrap();
    let (mut memory, mut trace) = (MemoryAt::of(scenario.until), Trace::of(scenario));
    let master = Master::new(harvester, vec![Box::new(circuit)], scenario, Coupling::default()).unwrap();
    let outcome = master.run(&mut [&mut memory, &mut trace]).unwrap();
    let ledger = outcome.circuits[0].ledger;
    let moved = ledger.supply.abs() + ledger.load.abs() + ledger.zener.abs();
    let (off, steps) = (ledger.residual().abs() / moved, outcome.coupling.steps);
    println!(
        "{} through the FMU with its circuit, {} s in {steps} steps: {:?} kB, books off by {off:.1e}, {:.0} s",
        scenario.name,
        scenario.until,
        memory.found,
        started.elapsed().as_secs_f64()
    );
    memory.assert_flat(&scenario.name);
    assert!(off < 1e-9, "{}: the books of the circuit are off by {off} of {moved} J", scenario.name);
    assert_eq!(outcome.mechanics.voltage_gain, model.totals().voltage_gain, "{}: FMU and model", scenario.name);
    assert_eq!(u64::try_from(outcome.mechanics.impacts).unwrap(), model.totals().impacts);
}

/// A time series as long as memory would notice.
fn assert_streamed(fmu: &Fmu, scenario: &Scenario) {
    let folder = tempfile::tempdir().unwrap();
    let series = SeriesOptions { sample: Sample::Step, ..SeriesOptions::default() };
    let harvester = HarvesterFmu::new(fmu, scenario, &scenario.settings).unwrap();
    let recorder = SeriesRecorder::create((folder.path(), "timeseries"), &series, scenario, None);
    let (mut memory, mut recorder) = (MemoryAt::of(scenario.until), recorder.unwrap());
    let master = Master::new(harvester, Vec::new(), scenario, Coupling::default()).unwrap();
    master.run(&mut [&mut memory, &mut recorder]).unwrap();
    let path = recorder.finish().unwrap().unwrap();
    let length = path.metadata().unwrap().len();
    println!("a time series of {} MB: {:?} kB", length >> 20, memory.found);
    memory.assert_flat("time series");
    assert!(length > 16 << 20, "{length} bytes are too few to be noticed");
}

#[test]
#[ignore = "slow"]
fn memory_stays_flat_and_the_books_close_over_a_long_run() {
    let full = extent(false, true);
    let folder = tempfile::tempdir().unwrap();
    let files = build_all(&Options { output: Some(folder.path().to_owned()), ..Options::default() }).unwrap();
    let fmu = Fmu::open(&files[0]).unwrap();
    // At 2 Hz, Table 3 chatters: hundreds of overlapping pulses are looked at in each of its many steps.
    let short = [("fig14", 5e3, 5e3), ("table3-2hz", 5e3, 1e2)];
    let long = [("fig14", 1e6, 1e6), ("table3-2hz", 1e6, 5e3)];
    for (case, until, until_coupled) in if full { long } else { short } {
        alone(case, until);
        let request =
            Request { case: Some(case.to_owned()), until: Some(until_coupled), step: Some(0.05), ..Request::default() };
        coupled(&fmu, &request.resolve().unwrap(), &alone(case, until_coupled));
    }
    let request = Request { until: Some(200.0), step: Some(2e-3), ..Request::default() };
    assert_streamed(&fmu, &request.resolve().unwrap());
}
