//! `videg crosscheck`: closed forms, embedded solver and ngspice on one C(t), claim by claim.

use std::path::PathBuf;

use anyhow::Context as _;
use clap::{Args, ValueEnum};
use serde::Serialize;
use videg_circuit::{Release, Settings, Topology, names};

use super::cosim::{label, voltage_warning};
use super::electrical;
use super::options::RunOptions;
use super::progress::{TaskBar, TimeBar};
use super::simulate::{RunOutput, file_list, heading};
use super::{Verdict, crosscheck_files as files, crosscheck_report as page, output, packaging, settings};
use crate::cosim::{Charges, CircuitSummary, Energies};
use crate::crosscheck::{
    Agreement, Bench, Case, Check, Compared, Findings, Pulses, Solver, Sweep, Task, Values, checks, comparison_checks,
    conclusion, export, in_parallel,
};
use crate::fmi::Fmu;
use crate::ngspice::{Elements, Ngspice, NgspiceError, Run, Waveforms};
use crate::scenario::{Scenario, Setting};

/// Arguments of the verb.
#[derive(Args)]
pub struct Arguments {
    #[command(flatten)]
    run: RunOptions,
    /// What releases the charge, as --set release=
    #[arg(long, value_enum)]
    release: Option<ReleaseName>,
    /// How the membranes are connected, as --set topology=
    #[arg(long, value_enum)]
    topology: Option<TopologyName>,
    /// Follow the net gain over the voltage of release and the load resistance, too
    #[arg(long)]
    sweep: bool,
    /// Write the netlists, C(t) and the expected values into a folder that ngspice alone can run
    #[arg(long, value_name = "DIR")]
    export: Option<PathBuf>,
}

#[derive(Clone, Copy, ValueEnum)]
enum ReleaseName {
    /// A Zener diode in series with the load
    Zener,
    /// An ideal switch
    Switch,
    /// A diode into a storage in place of the load
    Storage,
}

#[derive(Clone, Copy, ValueEnum)]
#[value(rename_all = "camelCase")]
enum TopologyName {
    /// Both membranes on one node
    SharedNode,
    /// A diode and a release element for each membrane
    Isolated,
}

impl Arguments {
    /// The options that are settings by another name.
    fn settings(&self) -> Vec<Setting> {
        let release = self.release.and_then(|name| name.to_possible_value()).map(|value| (names::RELEASE, value));
        let topology = self.topology.and_then(|name| name.to_possible_value()).map(|value| (names::TOPOLOGY, value));
        let setting = |(name, value): (&str, clap::builder::PossibleValue)| Setting::new(name, value.get_name());
        release.into_iter().chain(topology).map(setting).collect()
    }
}

/// A finished crosscheck.
pub struct Finished {
    /// What was run.
    pub scenario: Scenario,
    /// The mechanics.
    pub case: Case,
    /// What the circuit asked for is called.
    pub label: String,
    /// The circuit asked for.
    pub settings: Settings,
    /// It by every solver.
    pub runs: Vec<(Solver, Waveforms)>,
    /// The single pulses, in order of their height.
    pub pulses: Option<Pulses>,
    /// Their peaks on an open circuit, by solver.
    pub open: Vec<(Solver, Vec<f64>)>,
    /// The circuit asked for and others.
    pub compared: Vec<Compared>,
    /// Everything checked.
    pub checks: Vec<Check>,
    /// The sweep, if asked for.
    pub sweep: Option<Sweep>,
    /// What it comes to.
    pub conclusion: Vec<String>,
    /// What the user should know before believing the numbers.
    pub warnings: Vec<String>,
}

/// A solver in `--json`.
#[derive(Serialize)]
struct SolverOutput {
    name: &'static str,
    energy: Energies,
    charge: Charges,
    time_points: Option<u64>,
}

#[derive(Serialize)]
struct Output<'a> {
    #[serde(flatten)]
    run: RunOutput<'a>,
    circuit: &'a str,
    /// Which solver `energy` and `charge` are of.
    energy_by: &'static str,
    #[serde(flatten)]
    summary: CircuitSummary,
    solvers: Vec<SolverOutput>,
    passed: bool,
    checks: &'a [Check],
    comparison: &'a [Compared],
    sweep: &'a Option<Sweep>,
    conclusion: &'a [String],
}

/// The solver whose books stand at the top level: its energy balance closes to 1e-9.
const TOP_LEVEL: Solver = Solver::Exponential;

/// Longest run, s: ngspice keeps all its time points in memory, some 6 MB for each second, and two of it run at a time.
const LONGEST: f64 = 300.0;

/// Runs the verb.
pub fn run(arguments: &Arguments) -> anyhow::Result<Verdict> {
    let options = &arguments.run;
    let scenario = options.scenario_with(arguments.settings())?;
    anyhow::ensure!(
        scenario.until <= LONGEST,
        "{} = {} s: must not be above {LONGEST} s for crosscheck, as ngspice keeps all its time points in memory",
        scenario.until_place,
        scenario.until
    );
    if let Some(folder) = &arguments.export {
        files::check_export(folder)?;
    }
    let ngspice = Ngspice::find(None)?;
    let fmu = packaging::open("VibroImpactHarvester")?;
    let folder = output::folder(options.output.as_deref(), "crosscheck", &scenario)?;
    let finished = follow(&fmu, scenario, &ngspice, arguments.sweep)?;
    let mut written = files::write(&folder, &finished)?;
    if let Some(folder) = &arguments.export {
        written.extend(files::export(folder, &finished)?);
    }
    let json = serde_json::to_string_pretty(&json(&finished, &written))?;
    output::write(&folder.join("result.json"), &json)?;
    if options.json {
        output::print_json(&json)?;
    } else {
        output::print(&text(&finished, &written))?;
    }
    output::warn(&finished.warnings);
    let failed = finished.checks.iter().any(Check::failed);
    Ok(if failed { Verdict::Failed } else { Verdict::Passed })
}

/// Runs the mechanics of `scenario`, and its circuit in every solver.
pub fn follow(fmu: &Fmu, scenario: Scenario, ngspice: &Ngspice, sweep: bool) -> anyhow::Result<Finished> {
    let (mechanical, electrical) = settings::split(fmu.description(), &scenario)?;
    let mut bar = TimeBar::new(format!("{}: mechanics", scenario.name), scenario.until);
    let case = Case::new(fmu, &scenario, &mechanical, &mut bar)?;
    bar.finish();
    let circuit = electrical::resolve(&electrical, case.bias_voltage, case.best_ratio())?;
    let elements = Elements::new(&Settings { exponential: true, ..circuit }.parameters(), case.table.growth());
    elements.map_err(|error| settings::placed(&electrical, error))?;
    solve(scenario, case, circuit, ngspice, sweep)
}

/// What one task finds out.
enum Found {
    Run(Solver, Waveforms),
    Open(Solver, Vec<f64>),
    Other(CircuitSummary),
    Capacitor(Check),
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
    let pulses = Pulses::new(&case, settings.circuit.topology)?;
    let bar = TaskBar::new(scenario.name.clone());
    let found = in_parallel(tasks(&bench, &case, &settings, &others, pulses.as_ref()), &bar)?;
    let sweep = if sweep { Some(Sweep::new(&bench, &case, &settings, &bar)?) } else { None };
    bar.finish();
    let (mut runs, mut open, mut summaries, mut capacitor) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for result in found {
        match result {
            Found::Run(solver, waveforms) => runs.push((solver, waveforms)),
            Found::Open(solver, peaks) => open.push((solver, peaks)),
            Found::Other(summary) => summaries.push(summary),
            Found::Capacitor(check) => capacitor.push(check),
        }
    }
    runs.sort_by_key(|(solver, _)| Solver::ALL.iter().position(|other| other == solver));
    let compared = compared(&case, &settings, &runs, &others, &summaries);
    let mut all =
        checks(&Findings { case: &case, settings: &settings, runs: &runs, pulses: pulses.as_ref(), open: &open });
    all.extend(comparison_checks(&compared));
    all.extend(capacitor);
    all.extend(sweep.iter().flat_map(Sweep::checks));
    let mut warnings = case.warnings.clone();
    warnings.extend(voltage_warning(&settings, case.bias_voltage));
    let conclusion = conclusion(&all, &compared);
    let label = label(&settings);
    Ok(Finished {
        scenario,
        label,
        settings,
        runs,
        pulses,
        open,
        compared,
        checks: all,
        sweep,
        conclusion,
        warnings,
        case,
    })
}

/// Everything to run, the longest first.
fn tasks<'a>(
    bench: &'a Bench<'a>,
    case: &'a Case,
    settings: &'a Settings,
    others: &'a [Settings],
    pulses: Option<&'a Pulses>,
) -> Vec<Task<'a, Found>> {
    let main = |solver: Solver| Task::new(solver.name(), move || Ok(Found::Run(solver, bench.run(solver, settings)?)));
    let opened = pulses.map(|pulses| (pulses, open_circuit(&pulses.expected(case, Topology::Isolated, 1.0), settings)));
    let open = move |solver: Solver| {
        let (pulses, opened) = opened?;
        let bench = Bench { table: &pulses.table, ..*bench };
        let name = format!("open circuit in {}", solver.name());
        Some(Task::new(name, move || Ok(Found::Open(solver, pulses.peaks(case, &bench.run(solver, &opened)?)))))
    };
    let eq13 = case.mechanics.energy_eq13;
    let other = |solver: Solver, settings: &'a Settings| {
        let name = format!("{} in {}", label(settings), solver.name());
        Task::new(name, move || Ok(Found::Other(bench.run(solver, settings)?.summary(eq13))))
    };
    let mut tasks = vec![main(Solver::Live), main(Solver::Batch)];
    tasks.extend(open(Solver::Batch));
    // Pairs, embedded and ngspice, as `compared` takes them.
    tasks.extend(
        others.iter().flat_map(|settings| [other(Solver::Exponential, settings), other(Solver::Batch, settings)]),
    );
    tasks.extend([main(Solver::Exponential), main(Solver::Ideal)]);
    tasks.extend([Solver::Exponential, Solver::Ideal].into_iter().filter_map(open));
    let voltage = settings.circuit.supply_voltage;
    tasks.extend([0, 1, 2].map(|k| {
        Task::new("closed forms of the capacitor", move || {
            Ok(Found::Capacitor(capacitor_check(bench.ngspice, voltage, case, k)?))
        })
    }));
    tasks
}

/// The circuit with its release at twice the highest of these `U_DE4` / `U_in`: out of reach.
fn open_circuit(peaks: &[f64], settings: &Settings) -> Settings {
    let mut open = *settings;
    open.circuit.release = Release::Zener;
    open.circuit.zener_voltage = 2.0 * open.circuit.supply_voltage * peaks.iter().copied().fold(1.0, f64::max);
    open
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
    storage.circuit.storage_voltage = electrical::best_release_voltage(&storage, ratio);
    let same = |other: &Settings| {
        let [a, b] = [other, asked].map(|settings| settings.circuit);
        (a.topology, a.release, a.release_voltage()) == (b.topology, b.release, b.release_voltage())
    };
    [paper, switch, storage].into_iter().filter(|other| !same(other)).collect()
}

fn compared(
    case: &Case,
    asked: &Settings,
    runs: &[(Solver, Waveforms)],
    others: &[Settings],
    summaries: &[CircuitSummary],
) -> Vec<Compared> {
    let eq13 = case.mechanics.energy_eq13;
    let run = |solver| runs.iter().find(|(other, _)| *other == solver).map(|(_, run)| run.summary(eq13));
    let first = run(Solver::Exponential).zip(run(Solver::Batch)).map(|(a, b)| (asked, a, b));
    let rest = others
        .iter()
        .zip(summaries.chunks_exact(2))
        .map(|(settings, pair)| (settings, pair[0].clone(), pair[1].clone()));
    let all = first.into_iter().chain(rest);
    all.map(|(settings, embedded, ngspice)| Compared::new(label(settings), case, settings, embedded, ngspice)).collect()
}

/// ngspice's own capacitor against a closed form.
fn capacitor_check(ngspice: &Ngspice, voltage: f64, case: &Case, index: usize) -> Result<Check, NgspiceError> {
    /// Both sides are good to some 1e-8; a capacitor that loses V dC/dt is off by tens of percent.
    const TOLERANCE: f64 = 1e-6;
    let [c2, c3] = capacitances(case);
    let form = &export::closed_forms(voltage, c2, c3)[index];
    let table = export::growing_capacitor(c2, c3)?;
    let found = form.check.run(ngspice, voltage, &table, &Run::new(table.until(), table.growth()))?;
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

/// `C_2` of the left membrane and the `C_3` of the largest impact, F; a pulse by a half where there is none.
pub fn capacitances(case: &Case) -> [f64; 2] {
    let ratio = case.impacts.iter().map(|impact| impact.ratio).fold(1.0, f64::max);
    let c2 = case.rest[0];
    [c2, c2 * if ratio > 1.0 { ratio } else { 1.5 }]
}

fn json<'a>(finished: &'a Finished, files: &'a [PathBuf]) -> Output<'a> {
    let eq13 = finished.case.mechanics.energy_eq13;
    let summaries: Vec<_> =
        finished.runs.iter().map(|(solver, run)| (*solver, run.summary(eq13), run.points)).collect();
    let top = summaries.iter().find(|(solver, ..)| *solver == TOP_LEVEL).map(|(_, summary, _)| summary.clone());
    Output {
        run: RunOutput::new(&finished.scenario, finished.case.mechanics, &finished.warnings, files),
        circuit: &finished.label,
        energy_by: TOP_LEVEL.key(),
        summary: top.unwrap_or_else(|| CircuitSummary::new(&crate::cosim::CircuitSample::default(), eq13)),
        solvers: summaries
            .into_iter()
            .map(|(solver, summary, time_points)| {
                let CircuitSummary { energy, charge } = summary;
                SolverOutput { name: solver.key(), energy, charge, time_points }
            })
            .collect(),
        passed: !finished.checks.iter().any(Check::failed),
        checks: &finished.checks,
        comparison: &finished.compared,
        sweep: &finished.sweep,
        conclusion: &finished.conclusion,
    }
}

fn text(finished: &Finished, files: &[PathBuf]) -> String {
    let mut parts = vec![
        format!("{}\ncircuit: {}", heading("crosscheck", &finished.scenario), finished.label),
        page::check_table(finished),
        page::pair_table(finished),
        page::claim_table(finished),
        page::comparison_table(finished),
    ];
    parts.extend(page::sweep_table(finished));
    parts.push(finished.conclusion.join("\n\n"));
    parts.push(file_list(files));
    parts.join("\n\n")
}
