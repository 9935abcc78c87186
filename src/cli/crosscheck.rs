//! `videg crosscheck`: closed forms, embedded solver and ngspice on one C(t), claim by claim.

use std::path::PathBuf;

use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser};
use serde::Serialize;
use videg_circuit::names;

use super::interruption::Interruption;
use super::options::RunOptions;
use super::progress::TaskBar;
use super::results::{Identity, Results, flag};
use super::run_output::{self, RunOutput, file_list, heading};
use super::{Exit, crosscheck_report as page, output, packaging};
use crate::cosim::{Charges, CircuitSample, CircuitSummary, Device, Energies};
use crate::crosscheck::{
    self, ComparedCircuit, Crosscheck, Options, QuantityCheck, ReleaseSweep, Repeat, Solver, Stop, export, files,
};
use crate::ngspice::{Ngspice, Waveforms};
use crate::scenario::Setting;

/// Arguments of the verb.
#[derive(Args)]
pub struct Arguments {
    #[command(flatten)]
    run: RunOptions,
    /// Release element, as --set release=
    #[arg(long, value_parser = items(RELEASES))]
    release: Option<String>,
    /// Connection of the membranes, as --set topology=
    #[arg(long, value_parser = items(TOPOLOGIES))]
    topology: Option<String>,
    /// Also compute the net gain over the voltage of release and the load resistance
    #[arg(long)]
    sweep: bool,
    /// Write netlists, C(t) and expected values into a folder for ngspice alone
    #[arg(long, value_name = "DIR")]
    export: Option<PathBuf>,
}

/// Names of values with their help.
type Items = &'static [(&'static str, &'static str)];

const RELEASES: Items = &[
    ("zener", "A Zener diode in series with the load"),
    ("switch", "An ideal switch"),
    ("storage", "A diode into a storage in place of the load"),
];
const TOPOLOGIES: Items =
    &[("sharedNode", "Both membranes on one node"), ("isolated", "A diode and a release element for each membrane")];

fn items(items: Items) -> PossibleValuesParser {
    items.iter().map(|(name, help)| PossibleValue::new(*name).help(*help)).collect::<Vec<_>>().into()
}

impl Arguments {
    /// The options that are settings by another name.
    fn settings(&self) -> Vec<Setting> {
        let options = [(names::RELEASE, &self.release), (names::TOPOLOGY, &self.topology)];
        options.into_iter().filter_map(|(name, value)| Some(Setting::new(name, value.as_ref()?))).collect()
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
    checks: &'a [QuantityCheck],
    comparison: &'a [ComparedCircuit],
    sweep: &'a Option<ReleaseSweep>,
    stopped: &'a [Stop],
    repeated: &'a [Repeat],
    conclusion: &'a [String],
}

/// The solver of the energies at the top level: its energy balance closes to 1e-9.
const TOP_LEVEL: Solver = Solver::Exponential;

/// Runs the verb.
pub fn run(arguments: &Arguments, interruption: &Interruption) -> anyhow::Result<Exit> {
    let options = &arguments.run;
    let scenario = options.scenario_with(arguments.settings())?;
    if let Some(folder) = &arguments.export {
        export::check(folder)?;
    }
    let ngspice = Ngspice::find(None)?;
    let fmu = packaging::open("VibroImpactHarvester")?;
    let swept = flag(arguments.sweep);
    let identity = Identity::of("crosscheck", &scenario, [("sweep", swept)])?;
    let claimed = Results::claim(&options.output, identity, interruption)?;
    let folder = &claimed.folder;
    let (program, sweep) = (packaging::program()?, arguments.sweep);
    let inputs = Options { harvester: &fmu, scenario: &scenario, ngspice: &ngspice, program: &program, sweep };
    let found = crosscheck::run(&inputs, &TaskBar::new(&scenario.name))?;
    let (mut written, figures) = files::write(folder, &found)?;
    let html = folder.join("report.html");
    output::write(&html, page::html(&found, &Device::of(&fmu, &scenario)?, figures)?)?;
    written.extend([html, folder.join("result.json")]);
    if let Some(folder) = &arguments.export {
        written.extend(export::write(folder, &found)?);
    }
    let result = run_output::json(&json(&claimed.identity, &found, &written))?;
    run_output::conclude(claimed, options.json, &result, &text(&found, &written), &found.warnings)?;
    Ok(if found.passed() { Exit::Passed } else { Exit::Failed })
}

fn json<'a>(identity: &'a Identity, found: &'a Crosscheck, files: &'a [PathBuf]) -> Output<'a> {
    let eq13 = found.mechanics.summary.energy_eq13;
    let solver = |(solver, run): &(Solver, Waveforms)| {
        let CircuitSummary { energy, charge } = run.summary(eq13);
        let reached = run.time.last().copied().unwrap_or_default();
        SolverOutput { name: solver.key(), energy, charge, time_points: run.points, reached }
    };
    let top_level = found.run(TOP_LEVEL).map_or_else(CircuitSample::default, Waveforms::last);
    Output {
        run: RunOutput::new(identity, &found.scenario, found.mechanics.summary, &found.warnings, files),
        circuit: &found.label,
        energy_by: TOP_LEVEL.key(),
        summary: CircuitSummary::new(&top_level, eq13),
        solvers: found.runs.iter().map(solver).collect(),
        passed: found.passed(),
        checks: &found.checks,
        comparison: &found.compared,
        sweep: &found.sweep,
        stopped: &found.stops,
        repeated: &found.repeats,
        conclusion: &found.conclusion,
    }
}

fn text(found: &Crosscheck, files: &[PathBuf]) -> Vec<String> {
    let mut parts = vec![
        format!("{}\ncircuit: {}", heading("crosscheck", &found.scenario), found.label),
        page::check_table(found),
        page::pair_table(found),
        page::claim_table(found),
        page::comparison(found).text(),
    ];
    parts.extend(page::sweep(found).map(|sheet| sheet.text()));
    parts.push(found.conclusion.join("\n\n"));
    parts.push(file_list(files));
    parts
}
