//! `videg crosscheck`: closed forms, embedded solver and ngspice on one C(t), claim by claim.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use serde::Serialize;
use videg_circuit::{Settings, names};

use super::options::RunOptions;
use super::run_output::{RunOutput, file_list, heading};
use super::{Exit, crosscheck_files as files, crosscheck_report as page, crosscheck_solve as solve, output, packaging};
use crate::cosim::{Charges, CircuitSummary, Energies};
use crate::crosscheck::{Case, Check, Compared, Pulses, Repeat, Solver, Stop, Sweep};
use crate::ngspice::{Ngspice, Waveforms};
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
    /// Runs of ngspice that ended too early.
    pub stops: Vec<Stop>,
    /// Runs of ngspice that took changes to get to their end.
    pub repeats: Vec<Repeat>,
    /// What it comes to.
    pub conclusion: Vec<String>,
    /// What the user should know before believing the numbers.
    pub warnings: Vec<String>,
}

impl Finished {
    /// Whether ngspice got to the end everywhere, and all solvers agree.
    pub fn passed(&self) -> bool {
        self.stops.is_empty() && !self.checks.iter().any(Check::failed)
    }
}

/// A solver in `--json`.
#[derive(Serialize)]
struct SolverOutput {
    name: &'static str,
    energy: Energies,
    charge: Charges,
    time_points: Option<u64>,
    reached: f64,
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
    stopped: &'a [Stop],
    repeated: &'a [Repeat],
    conclusion: &'a [String],
}

/// The solver whose books stand at the top level: its energy balance closes to 1e-9.
const TOP_LEVEL: Solver = Solver::Exponential;

/// Runs the verb.
pub fn run(arguments: &Arguments) -> anyhow::Result<Exit> {
    let options = &arguments.run;
    let scenario = options.scenario_with(arguments.settings())?;
    if let Some(folder) = &arguments.export {
        files::check_export(folder)?;
    }
    let ngspice = Ngspice::find(None)?;
    let fmu = packaging::open("VibroImpactHarvester")?;
    let folder = output::folder(options.output.as_deref(), "crosscheck", &scenario)?;
    let finished = solve::follow(&fmu, scenario, &ngspice, arguments.sweep)?;
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
    Ok(if finished.passed() { Exit::Passed } else { Exit::Failed })
}

/// `C_2` of the left membrane and the `C_3` of the largest impact, F; a pulse by a half where there is none.
pub fn capacitances(case: &Case) -> [f64; 2] {
    let ratio = case.impacts.iter().map(|impact| impact.ratio).fold(1.0, f64::max);
    let c2 = case.rest[0];
    [c2, c2 * if ratio > 1.0 { ratio } else { 1.5 }]
}

fn json<'a>(finished: &'a Finished, files: &'a [PathBuf]) -> Output<'a> {
    let eq13 = finished.case.mechanics.energy_eq13;
    let top = finished.runs.iter().find(|(solver, _)| *solver == TOP_LEVEL).map(|(_, run)| run.summary(eq13));
    Output {
        run: RunOutput::new(&finished.scenario, finished.case.mechanics, &finished.warnings, files),
        circuit: &finished.label,
        energy_by: TOP_LEVEL.key(),
        summary: top.unwrap_or_else(|| CircuitSummary::new(&crate::cosim::CircuitSample::default(), eq13)),
        solvers: finished
            .runs
            .iter()
            .map(|(solver, run)| {
                let CircuitSummary { energy, charge } = run.summary(eq13);
                let reached = run.time.last().copied().unwrap_or_default();
                SolverOutput { name: solver.key(), energy, charge, time_points: run.points, reached }
            })
            .collect(),
        passed: finished.passed(),
        checks: &finished.checks,
        comparison: &finished.compared,
        sweep: &finished.sweep,
        stopped: &finished.stops,
        repeated: &finished.repeats,
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
