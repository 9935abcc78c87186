//! Runs the circuit of a crosscheck in every solver, and puts together what they find.

use anyhow::Context as _;
use videg_circuit::{Release, Settings, Topology};

use super::crosscheck::{Finished, capacitances};
use super::progress::{TaskBar, TimeBar};
use crate::cosim::{CircuitRequest, CircuitSummary, TimeProgress, best_release_voltage, label, voltage_warning};
use crate::crosscheck::{
    Agreement, Bench, Case, Check, Compared, Findings, Pulses, Repeat, Solver, Stop, Sweep, Task, Values, checks,
    common, comparison_checks, conclusion, export, limited, pulse_checks,
};
use crate::ngspice::{Elements, Ngspice, NgspiceError, Outcome, Waveforms};
use crate::scenario::Scenario;
use crate::threads;
use fmu_import::Fmu;

/// Runs the mechanics of `scenario`, and its circuit in every solver.
pub fn follow(fmu: &Fmu, scenario: Scenario, ngspice: &Ngspice, sweep: bool) -> anyhow::Result<Finished> {
    let (mechanical, request) = CircuitRequest::split(fmu.description(), &scenario.settings)?;
    let bar = TimeBar::new(format!("{}: mechanics", scenario.name));
    let case = Case::new(fmu, &scenario, &mechanical, &mut TimeProgress::new(&bar, scenario.until))?;
    bar.finish();
    let circuit = request.resolve(case.bias_voltage, case.best_ratio());
    let elements = Elements::new(&Settings { exponential: true, ..circuit }.parameters(), case.table.growth());
    elements.map_err(|error| request.located(error, &circuit))?;
    solve(scenario, case, circuit, ngspice, sweep)
}

fn solve(
    scenario: Scenario,
    case: Case,
    settings: Settings,
    ngspice: &Ngspice,
    sweep: bool,
) -> anyhow::Result<Finished> {
    let program = std::env::current_exe().context("cannot find this program's own file")?;
    let bench = Bench { table: &case.table, ngspice, program: &program };
    let others = others(&settings, case.best_ratio());
    let mut pulses = Pulses::new(&case, settings.circuit.topology)?;
    let bar = TaskBar::new(scenario.name.clone());
    let told = threads::run(&tasks(&bench, &case, &settings, &others, pulses.as_ref()), &bar)?;
    let mut found = Gathered::new(told, others.len());
    let sweep = if sweep { Some(Sweep::new(&bench, &case, &settings, &bar)?) } else { None };
    bar.finish();
    pulses = found.shorten(pulses);
    let mut all = found.main_checks(&case, &settings, pulses.as_ref());
    let compared = found.compared(&bench, &case, &settings, &others, &mut all)?;
    let Gathered { runs, open, capacitor, mut stops, mut repeats, .. } = found;
    all.extend(capacitor);
    if let Some(sweep) = &sweep {
        all.extend(sweep.checks());
        stops.extend_from_slice(&sweep.stops);
        repeats.extend_from_slice(&sweep.repeats);
    }
    let mut warnings = case.warnings.clone();
    warnings.extend(voltage_warning(&settings, case.bias_voltage));
    warnings.extend(stops.iter().map(Stop::sentence));
    let conclusion = conclusion(&all, &compared, &stops, &repeats);
    Ok(Finished {
        scenario,
        label: label(&settings),
        settings,
        runs,
        pulses,
        open,
        compared,
        checks: all,
        sweep,
        stops,
        repeats,
        conclusion,
        warnings,
        case,
    })
}

/// What one task finds out.
enum Found {
    Run(Solver, Waveforms),
    Open(Solver, Vec<f64>),
    /// Another circuit by its place, whether by ngspice, and how many rows of it there are.
    Other(usize, bool, CircuitSummary, usize),
    Capacitor(Option<Check>),
}

/// What a task finds, and how ngspice got there.
struct Told {
    found: Found,
    stop: Option<Stop>,
    repeats: Vec<Repeat>,
}

impl Told {
    /// What `task` makes of `outcome`; where that stopped, `open` is what cannot be judged from there on.
    fn new(
        task: &str,
        outcome: Outcome,
        until: f64,
        open: Vec<String>,
        found: impl FnOnce(Waveforms) -> Found,
    ) -> Self {
        let stop = Stop::of(task, &outcome, until, open);
        let repeats = Repeat::of(task, &outcome).collect();
        Self { found: found(outcome.waveforms), stop, repeats }
    }
}

/// What all tasks find.
#[derive(Default)]
struct Gathered {
    runs: Vec<(Solver, Waveforms)>,
    open: Vec<(Solver, Vec<f64>)>,
    /// The other circuits by the embedded solver and by ngspice, each with the rows that there are.
    others: Vec<[Option<(CircuitSummary, usize)>; 2]>,
    capacitor: Vec<Check>,
    stops: Vec<Stop>,
    repeats: Vec<Repeat>,
}

impl Gathered {
    fn new(told: Vec<Told>, others: usize) -> Self {
        let mut all = Self { others: vec![[None, None]; others], ..Self::default() };
        for Told { found, stop, repeats } in told {
            all.stops.extend(stop);
            all.repeats.extend(repeats);
            match found {
                Found::Run(solver, waveforms) => all.runs.push((solver, waveforms)),
                Found::Open(solver, peaks) => all.open.push((solver, peaks)),
                Found::Other(index, by_ngspice, summary, rows) => {
                    all.others[index][usize::from(by_ngspice)] = Some((summary, rows));
                }
                Found::Capacitor(check) => all.capacitor.extend(check),
            }
        }
        all.runs.sort_by_key(|(solver, _)| Solver::ALL.iter().position(|other| other == solver));
        all
    }

    /// The pulses that every solver has to the end; `None` without any.
    fn shorten(&mut self, pulses: Option<Pulses>) -> Option<Pulses> {
        let count = self.open.iter().map(|(_, peaks)| peaks.len()).min()?;
        self.open.iter_mut().for_each(|(_, peaks)| peaks.truncate(count));
        let mut pulses = pulses.filter(|_| count > 0)?;
        pulses.truncate(count);
        Some(pulses)
    }

    /// The checks of the circuit asked for, up to where all solvers got, after those of the single pulses.
    fn main_checks(&mut self, case: &Case, settings: &Settings, pulses: Option<&Pulses>) -> Vec<Check> {
        let open = &self.open;
        let whole = Findings { case, settings, runs: &self.runs, pulses, open };
        let mut all = pulse_checks(&whole);
        let Some((cut, runs)) = common(case, &self.runs) else {
            all.extend(checks(&whole));
            return all;
        };
        let found = checks(&Findings { case: &cut, runs: &runs, ..whole });
        let claims = |check: &Check| check.claim.as_ref().map(|claim| claim.says.clone());
        let mut claims: Vec<_> = found.iter().filter_map(claims).collect();
        if claims.is_empty() {
            claims = found.iter().map(|check| check.name.clone()).collect();
        }
        // Claims are about ngspice in batch; the other way to run it is a witness of that.
        for stop in self.stops.iter_mut().filter(|stop| stop.task == Solver::Batch.name()) {
            stop.open.clone_from(&claims);
        }
        all.extend(if cut.table.len() < case.table.len() { limited(found, cut.table.until()) } else { found });
        all
    }

    /// The circuit asked for and the others, by both solvers as far as both got; what is checked of them goes to `checks`.
    fn compared(
        &self,
        bench: &Bench<'_>,
        case: &Case,
        asked: &Settings,
        others: &[Settings],
        checks: &mut Vec<Check>,
    ) -> Result<Vec<Compared>, NgspiceError> {
        let eq13 = case.mechanics.energy_eq13;
        let run = |solver| {
            let (_, run) = self.runs.iter().find(|(other, _)| *other == solver)?;
            Some((run.summary(eq13), run.samples.len()))
        };
        let first = (asked, [run(Solver::Exponential), run(Solver::Batch)]);
        let mut all = Vec::new();
        for (settings, pair) in std::iter::once(first).chain(others.iter().zip(self.others.iter().cloned())) {
            let [Some((mut embedded, _)), Some((ngspice, rows))] = pair else { continue };
            if rows == case.table.len() {
                let compared = Compared::new(label(settings), case, settings, embedded, ngspice);
                checks.extend(comparison_checks(&compared));
                all.push(compared);
            } else if rows > 1 {
                let case = case.cut(rows);
                let bench = Bench { table: &case.table, ..*bench };
                embedded = bench.run(Solver::Exponential, settings, &|_| ())?.waveforms.summary(eq13);
                let compared = Compared::new(label(settings), &case, settings, embedded, ngspice);
                checks.extend(limited(comparison_checks(&compared).to_vec(), case.table.until()));
                all.push(compared);
            }
        }
        Ok(all)
    }
}

/// Everything to run, the longest first.
fn tasks<'a>(
    bench: &'a Bench<'a>,
    case: &'a Case,
    settings: &'a Settings,
    others: &'a [Settings],
    pulses: Option<&'a Pulses>,
) -> Vec<Task<'a, Told>> {
    let until = case.table.until();
    let main = |solver: Solver| {
        Task::new(solver.name(), move |progress| {
            let outcome = bench.run(solver, settings, progress)?;
            let open = vec!["whether both ways to run ngspice agree".to_owned()];
            Ok(Told::new(solver.name(), outcome, until, open, |run| Found::Run(solver, run)))
        })
    };
    let mut tasks = vec![main(Solver::Live), main(Solver::Batch)];
    let opened = pulses.map(|pulses| Opened::new(bench, case, settings, pulses));
    let open = |solver| opened.clone().map(|opened| opened.task(solver));
    tasks.extend(open(Solver::Batch));
    tasks.extend(others.iter().enumerate().flat_map(|(index, settings)| {
        [Solver::Exponential, Solver::Batch].map(|solver| other(bench, case, settings, index, solver))
    }));
    tasks.extend([main(Solver::Exponential), main(Solver::Ideal)]);
    tasks.extend([Solver::Exponential, Solver::Ideal].into_iter().filter_map(open));
    tasks.extend([0, 1, 2].map(|index| capacitor(bench.ngspice, settings.circuit.supply_voltage, case, index)));
    tasks
}

/// One of the other circuits in a solver.
fn other<'a>(
    bench: &'a Bench<'a>,
    case: &'a Case,
    settings: &'a Settings,
    index: usize,
    solver: Solver,
) -> Task<'a, Told> {
    let name = format!("{} in {}", label(settings), solver.name());
    Task::new(name.clone(), move |progress| {
        let outcome = bench.run(solver, settings, progress)?;
        let open = vec![format!("{}: load energy and surplus", label(settings))];
        let found = |run: Waveforms| {
            let summary = run.summary(case.mechanics.energy_eq13);
            Found::Other(index, solver == Solver::Batch, summary, run.samples.len())
        };
        Ok(Told::new(&name, outcome, bench.table.until(), open, found))
    })
}

/// The single pulses on the circuit with its release out of reach.
#[derive(Clone)]
struct Opened<'a> {
    bench: Bench<'a>,
    settings: Settings,
    pulses: &'a Pulses,
}

impl<'a> Opened<'a> {
    fn new(bench: &Bench<'a>, case: &Case, settings: &Settings, pulses: &'a Pulses) -> Self {
        let mut open = *settings;
        let highest = pulses.expected(case, Topology::Isolated, 1.0).into_iter().fold(1.0, f64::max);
        open.circuit.release = Release::Zener;
        // Twice the highest `U_DE4`.
        open.circuit.zener_voltage = 2.0 * open.circuit.supply_voltage * highest;
        Self { bench: Bench { table: &pulses.table, ..*bench }, settings: open, pulses }
    }

    fn task(self, solver: Solver) -> Task<'a, Told> {
        let name = format!("open circuit in {}", solver.name());
        Task::new(name.clone(), move |progress| {
            let outcome = self.bench.run(solver, &self.settings, progress)?;
            let open = vec!["U_DE4 of the pulses from there on, which are the higher ones".to_owned()];
            let peaks = |run: Waveforms| Found::Open(solver, self.pulses.peaks(&run));
            Ok(Told::new(&name, outcome, self.bench.table.until(), open, peaks))
        })
    }
}

/// The paper's circuit, the same with an ideal switch, and a storage behind isolated membranes; those that are not the
/// one asked for.
fn others(asked: &Settings, ratio: f64) -> Vec<Settings> {
    let mut paper = *asked;
    paper.circuit.topology = Topology::SharedNode;
    paper.circuit.release = Release::Zener;
    paper.circuit.zener_voltage = paper.circuit.supply_voltage;
    let mut switch = paper;
    switch.circuit.release = Release::Switch;
    let mut storage = paper;
    storage.circuit.topology = Topology::Isolated;
    storage.circuit.release = Release::Storage;
    storage.circuit.storage_voltage = best_release_voltage(&storage, ratio);
    let same = |other: &Settings| {
        let [a, b] = [other, asked].map(|settings| settings.circuit);
        (a.topology, a.release, a.release_voltage()) == (b.topology, b.release, b.release_voltage())
    };
    [paper, switch, storage].into_iter().filter(|other| !same(other)).collect()
}

/// ngspice's own capacitor against a closed form.
fn capacitor<'a>(ngspice: &'a Ngspice, voltage: f64, case: &'a Case, index: usize) -> Task<'a, Told> {
    const NAME: &str = "closed forms of the capacitor";
    Task::new(NAME, move |_| {
        let [c2, c3] = capacitances(case);
        let form = &export::closed_forms(voltage, c2, c3)[index];
        let (check, outcome) = match capacitor_check(ngspice, voltage, [c2, c3], form) {
            Ok(check) => (Some(check), Outcome::from(Waveforms::default())),
            Err(error) if error.is_stop() => {
                (None, Outcome { stop: Some(error), ..Outcome::from(Waveforms::default()) })
            }
            Err(error) => return Err(error),
        };
        let until = export::growing_capacitor(c2, c3)?.until();
        Ok(Told::new(NAME, outcome, until, vec![form.about.to_owned()], |_| Found::Capacitor(check)))
    })
}

fn capacitor_check(
    ngspice: &Ngspice,
    voltage: f64,
    [c2, c3]: [f64; 2],
    form: &export::ClosedForm,
) -> Result<Check, NgspiceError> {
    /// Both sides are good to some 1e-8; a capacitor that loses V dC/dt is off by tens of percent.
    const TOLERANCE: f64 = 1e-6;
    let table = export::growing_capacitor(c2, c3)?;
    let found = form.check.run(ngspice, voltage, &table, &export::capacitor_run(&table))?;
    let between = format!("closed form and {}", Solver::Batch.name());
    Ok(Check {
        name: form.about.to_owned(),
        unit: form.expected.unit,
        analytic: Some(found.expected),
        values: Values { ngspice_batch: Some(found.found), ..Values::default() },
        agreement: Some(Agreement::new(between, found.largest, TOLERANCE)),
        claim: None,
    })
}
