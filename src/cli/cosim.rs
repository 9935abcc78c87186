//! `videg cosim`: the harvester FMU coupled with a harvesting circuit.

use std::path::{Path, PathBuf};

use anyhow::{Context as _, anyhow};
use clap::{Args, ValueEnum};
use serde::Serialize;
use videg_circuit::{Choice, Release, Settings, Topology, names};

use super::isolation::IsolationOptions;
use super::options::RunOptions;
use super::progress::TimeBar;
use super::simulate::{RunOutput, file_list, heading, text_table};
use super::{Verdict, cosim_report, electrical, output, picture, settings, time_series};
use crate::cosim::{
    CircuitSlave, CircuitSummary, Coupling, CouplingSummary, CsvRecorder, EmbeddedCircuit, EnergyBalance, FmuCircuit,
    HarvesterFmu, Master, MechanicsSummary, Method, NgspiceCircuit, Outcome, Trace,
};
use crate::ngspice::{self, Elements};
use crate::scenario::Scenario;
use fmu_import::Fmu;
use videg_report::Drawing;
use videg_system::atomic_file;

/// What the circuit is at where nothing is set: not the start values of its FMU.
const DEFAULTS: &str = "Unless set: supply.voltage is biasVoltage, zener.voltage is supply.voltage (both as in the paper), \
    storage.voltage is what gains most over the impacts of a run of the mechanics ahead. The FMU HarvestingCircuit alone \
    starts at fixed values.";

/// Arguments of the verb.
#[derive(Args)]
#[command(after_help = DEFAULTS)]
pub struct Arguments {
    #[command(flatten)]
    run: RunOptions,
    /// Which circuit the harvester is coupled with
    #[arg(long, value_enum, default_value_t = Backend::Embedded)]
    circuit: Backend,
    /// What harvester and circuit know of each other during a communication step
    #[arg(long, value_enum, default_value_t = Order::GaussSeidel)]
    master: Order,
    /// Adapt the communication step (--step is the first one) so that no signal within it is off by more than this part of
    /// its value, e.g. 1e-4; undoes steps, which ngspice cannot
    #[arg(long, value_name = "TOLERANCE", allow_negative_numbers = true)]
    adaptive: Option<f64>,
    #[command(flatten)]
    isolation: IsolationOptions,
}

/// The method of the master, as it is asked for.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Order {
    /// The harvester steps first, then the circuit with C(t) linear between its ends: second order
    GaussSeidel,
    /// Both step at once, with C(t) extrapolated at dC/dt: second order
    Jacobi,
    /// Both step at once on a regular grid and get values only, as from a tool that knows no more of FMI: first order
    Plain,
}

impl From<Order> for Method {
    fn from(order: Order) -> Self {
        match order {
            Order::GaussSeidel => Self::GaussSeidel,
            Order::Jacobi => Self::Jacobi,
            Order::Plain => Self::Plain,
        }
    }
}

/// What solves the circuit.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Backend {
    /// The exact solver, called directly
    Embedded,
    /// ngspice's shared library, in step with the harvester
    Ngspice,
    /// The FMU HarvestingCircuit
    Fmu,
}

/// A circuit and what it comes to.
#[derive(Serialize)]
pub struct Compared {
    /// What the circuit is.
    pub label: String,
    /// Energies and charges.
    #[serde(flatten)]
    pub summary: CircuitSummary,
}

#[derive(Serialize)]
struct Output<'a> {
    #[serde(flatten)]
    run: RunOutput<'a>,
    circuit: &'a str,
    #[serde(flatten)]
    summary: &'a CircuitSummary,
    coupling: CouplingSummary,
    #[serde(skip_serializing_if = "Option::is_none")]
    balance: Option<EnergyBalance>,
    comparison: &'a [Compared],
}

/// A finished run.
pub struct Finished {
    /// What was run.
    pub scenario: Scenario,
    /// The mechanics.
    pub mechanics: MechanicsSummary,
    /// The circuit asked for, then those to compare it with.
    pub circuits: Vec<Compared>,
    /// The coupling of the harvester with the circuit asked for.
    pub coupling: CouplingSummary,
    /// The energy balance, with electrostatic feedback.
    pub balance: Option<EnergyBalance>,
    /// Sum of `U_in` dC over all impacts, `U_in` that of the supply, C.
    pub cycle_charge: f64,
    /// What the user should know before believing the numbers.
    pub warnings: Vec<String>,
    /// The figure.
    pub drawing: Drawing,
}

/// Runs the verb.
pub fn run(arguments: &Arguments) -> anyhow::Result<Verdict> {
    let options = &arguments.run;
    let scenario = options.scenario()?;
    let coupling = Coupling { method: arguments.master.into(), tolerance: arguments.adaptive };
    coupling.check()?;
    let fmu = arguments.isolation.open_own("VibroImpactHarvester")?;
    let folder = output::folder(options.output.as_deref(), "cosim", &scenario)?;
    let csv = folder.join("timeseries.csv");
    let finished = couple((arguments.circuit, &arguments.isolation), coupling, &fmu, scenario, (&csv, Rest::Kept))?;
    let files = write_files(&folder, &csv, &finished)?;
    let json = serde_json::to_string_pretty(&json(&finished, &files)?)?;
    output::write(&folder.join("result.json"), &json)?;
    if options.json {
        output::print_json(&json)?;
    } else {
        output::print(&text(&finished, &files))?;
    }
    output::warn(&finished.warnings);
    Ok(Verdict::Passed)
}

/// What becomes of the time series of a run that fails.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Rest {
    /// It stays under its other name, and the error says so.
    Kept,
    /// It goes.
    Removed,
}

/// Runs the co-simulation with a circuit, which as an FMU may be isolated, and writes the time series to `csv`.
pub fn couple(
    backend: (Backend, &IsolationOptions),
    coupling: Coupling,
    fmu: &Fmu,
    scenario: Scenario,
    (csv, rest): (&Path, Rest),
) -> anyhow::Result<Finished> {
    let (mechanical, of_circuit) = settings::split(fmu.description(), &scenario)?;
    let harvester = HarvesterFmu::new(fmu, &scenario, &mechanical)?;
    let ratios = electrical::capacitance_ratios(fmu, &scenario, &mechanical)?;
    let settings = electrical::resolve(&of_circuit, harvester.bias_voltage(), ratios.best)?;
    let bias = harvester.bias_voltage();
    let voltage_warning = voltage_warning(&settings, bias);
    let circuits = circuits(backend, &scenario, &settings, ratios, &harvester);
    let circuits = circuits.map_err(|error| settings::placed(&of_circuit, error))?;
    let labels: Vec<_> = circuits.iter().map(|circuit| circuit.label().to_owned()).collect();
    let master = Master::new(harvester, circuits, &scenario, coupling)?;
    // How many points an adaptive step takes is seen at the end.
    let warning = coupling.tolerance.is_none().then(|| time_series::warning(&scenario, true)).flatten();
    output::warn(warning.as_slice());
    let mut recorder = CsvRecorder::create(csv, true)?;
    let mut trace = Trace::new(scenario.until, picture::DETAIL.min(scenario.until));
    let mut bar = TimeBar::new(scenario.name.clone(), scenario.until);
    let outcome = master.run(&mut [&mut recorder, &mut trace, &mut bar]);
    bar.finish();
    let outcome = match outcome {
        Ok(outcome) => outcome,
        Err(error) if rest == Rest::Removed => {
            recorder.discard();
            return Err(error.into());
        }
        Err(error) => {
            recorder.leave()?;
            return Err(anyhow!("{error}; the time series up to there is in {}", atomic_file::partial(csv).display()));
        }
    };
    recorder.finish()?;
    let Outcome { mechanics, circuits: samples, coupling, balance, mut warnings } = outcome;
    warnings.extend(voltage_warning);
    warnings.extend(coupling_warning(&coupling));
    let summaries = samples.iter().map(|sample| CircuitSummary::new(sample, mechanics.energy_eq13));
    let circuits = labels.into_iter().zip(summaries).map(|(label, summary)| Compared { label, summary }).collect();
    let drawing = picture::cosim(&trace, &scenario)?;
    // W of Eq. (13) is 1/2 U_b^2 dC, with the bias voltage of the harvester.
    let cycle_charge = 2.0 * mechanics.energy_eq13 / bias.powi(2) * settings.circuit.supply_voltage;
    Ok(Finished { scenario, mechanics, circuits, coupling, balance, cycle_charge, warnings, drawing })
}

pub fn voltage_warning(settings: &Settings, bias: f64) -> Option<String> {
    let supply = settings.circuit.supply_voltage;
    let name = names::SUPPLY_VOLTAGE;
    (supply != bias).then(|| {
        format!(
            "{name} = {supply} V differs from biasVoltage = {bias} V: Eqs. (12) to (15) are evaluated at the latter, the \
             circuit runs at the former"
        )
    })
}

/// A coupling that makes or loses more than this part of the energy moved deserves no trust in its surplus.
const LARGEST_RESIDUAL: f64 = 1e-2;

fn coupling_warning(coupling: &CouplingSummary) -> Option<String> {
    let residual = coupling.relative_residual;
    (residual > LARGEST_RESIDUAL).then(|| {
        format!(
            "the coupling makes or loses {:.1} % of the energy moved, more than {:.0} %: a smaller --step, or --adaptive, is \
             needed to believe the energies",
            100.0 * residual,
            100.0 * LARGEST_RESIDUAL
        )
    })
}

/// The circuit asked for, and three to compare it with: the same with an ideal switch, and two that gain, with isolated
/// membranes and the voltage of release that gains most: a switch, and a storage in place of the load.
fn circuits(
    (backend, isolation): (Backend, &IsolationOptions),
    scenario: &Scenario,
    settings: &Settings,
    ratios: electrical::Ratios,
    harvester: &HarvesterFmu,
) -> anyhow::Result<Vec<Box<dyn CircuitSlave>>> {
    let capacitance = harvester.sample()?.capacitance();
    let first: Box<dyn CircuitSlave> = match backend {
        Backend::Embedded => Box::new(EmbeddedCircuit::new(&label(settings), settings, capacitance)?),
        Backend::Ngspice => {
            let elements = Elements::new(&settings.parameters(), ratios.largest)?;
            let program = std::env::current_exe().context("cannot find this program's own file")?;
            let run = ngspice::Run::new(scenario.until, ratios.largest);
            Box::new(NgspiceCircuit::new(&label(settings), &program, &elements, capacitance, &run)?)
        }
        Backend::Fmu => {
            let fmu = isolation.open_own("HarvestingCircuit")?;
            let all = electrical::every_setting(settings);
            Box::new(FmuCircuit::new(&label(settings), &fmu, &all, capacitance, scenario.until)?)
        }
    };
    let mut switch = Settings { exponential: false, ..*settings };
    switch.circuit.release = Release::Switch;
    let mut better = switch;
    better.circuit.topology = Topology::Isolated;
    better.circuit.zener_voltage = electrical::best_release_voltage(&better, ratios.best);
    let mut storage = better;
    storage.circuit.release = Release::Storage;
    storage.circuit.storage_voltage = better.circuit.zener_voltage;
    let mut circuits = vec![first];
    for compared in [switch, better, storage] {
        circuits.push(Box::new(EmbeddedCircuit::new(&label(&compared), &compared, capacitance)?));
    }
    Ok(circuits)
}

/// What a circuit is called in tables.
pub fn label(settings: &Settings) -> String {
    let [topology, release] = [Choice::TOPOLOGY, Choice::RELEASE].map(|choice| choice.chosen(settings));
    format!("{topology}, {release} at {:.0} V", settings.circuit.release_voltage())
}

fn write_files(folder: &Path, csv: &Path, finished: &Finished) -> anyhow::Result<Vec<PathBuf>> {
    let (figure, html) = (folder.join("figure.svg"), folder.join("report.html"));
    output::write(&figure, &finished.drawing.svg)?;
    output::write(&html, &cosim_report::html(finished)?)?;
    Ok(vec![csv.to_owned(), figure, html, folder.join("result.json")])
}

fn json<'a>(finished: &'a Finished, files: &'a [PathBuf]) -> anyhow::Result<Output<'a>> {
    let (first, comparison) = finished.circuits.split_first().context("a co-simulation without a circuit")?;
    let run = RunOutput::new(&finished.scenario, finished.mechanics, &finished.warnings, files);
    Ok(Output {
        run,
        circuit: &first.label,
        summary: &first.summary,
        coupling: finished.coupling,
        balance: finished.balance,
        comparison,
    })
}

fn text(finished: &Finished, files: &[PathBuf]) -> String {
    let parts = [
        heading("cosim", &finished.scenario),
        text_table(&finished.scenario, &finished.mechanics),
        cosim_report::energy_table(finished),
        cosim_report::EXPLANATION.join("\n"),
        cosim_report::coupling_lines(finished),
        file_list(files),
    ];
    parts.join("\n\n")
}
