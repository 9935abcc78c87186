//! `videg cosim`: the harvester FMU coupled with a harvesting circuit.

use std::path::PathBuf;

use anyhow::{Context as _, anyhow};
use clap::{Args, ValueEnum};
use indexmap::IndexMap;
use serde::Serialize;

use super::interruption::Interruption;
use super::isolation::IsolationOptions;
use super::options::RunOptions;
use super::picture::{Electrical, Probe};
use super::progress::TimeBar;
use super::results::{Identity, Results as Claimed, chosen, listed};
use super::run_output::{self, RunOutput, file_list, heading, mechanics};
use super::time_series::TimeSeriesOptions;
use super::{Exit, cosim_report, output, packaging, parameter_table, picture, time_series};
use crate::cosim::{
    CircuitSolver, CircuitSummary, Cosimulation, Coupling, CouplingSummary, Device, EnergyBalance, ForeignCircuit,
    LabelledCircuit, Mapping, Method, NetlistCircuit, Options, Powers, Results, SeriesRecorder,
};
use crate::ngspice::UserNetlist;
use crate::scenario::Scenario;
use videg_report::Section;

/// Default values of the circuit. They differ from the start values of its FMU.
const DEFAULTS: &str = "Defaults: supply.voltage is biasVoltage and zener.voltage is supply.voltage, as in the paper; storage.voltage \
    is the voltage with the largest net gain over the impacts, from a run of the mechanics ahead. The FMU HarvestingCircuit \
    alone has fixed start values.";

/// Arguments of the verb.
#[derive(Args)]
#[command(after_help = DEFAULTS)]
pub struct Arguments {
    #[command(flatten)]
    run: RunOptions,
    /// Solver of the circuit
    #[arg(long, value_enum, default_value_t = Backend::Embedded)]
    circuit: Backend,
    #[command(flatten)]
    netlist: NetlistOptions,
    #[command(flatten)]
    foreign: ForeignOptions,
    /// Signals that harvester and circuit exchange for a communication step
    #[arg(long, value_enum, default_value_t)]
    master: Method,
    /// Adapt the communication step, from --step on, so that the error of each signal within it stays below this fraction of
    /// its value, e.g. 1e-4; undoes steps, which ngspice cannot
    #[arg(long, value_name = "TOLERANCE", allow_negative_numbers = true)]
    adaptive: Option<f64>,
    #[command(flatten)]
    series: TimeSeriesOptions,
    #[command(flatten)]
    isolation: IsolationOptions,
}

/// A circuit of the user in ngspice.
#[derive(Args)]
struct NetlistOptions {
    /// Netlist of your own circuit, run by ngspice in step with the harvester; the membranes are in it as subcircuits with
    /// two nodes, `deg_left` and `deg_right`
    #[arg(long, value_name = "FILE.cir", group = "own", conflicts_with = "circuit")]
    netlist: Option<PathBuf>,
    /// Elements of the netlist whose energy is a gain, with commas between them [default: all resistors, capacitors and
    /// inductors]
    #[arg(long, value_name = "NAMES", value_delimiter = ',', requires = "netlist")]
    gain: Vec<String>,
    /// Elements of the netlist whose energy is a cost [default: all sources]
    #[arg(long, value_name = "NAMES", value_delimiter = ',', requires = "netlist")]
    cost: Vec<String>,
    /// Nodes of the netlist, i(source), or Real variables of the circuit FMU, whose waveforms are written and drawn
    #[arg(long, value_name = "NAMES", value_delimiter = ',', requires = "own")]
    probe: Vec<String>,
    /// Trust the netlist: execute its commands, include files from anywhere, allow models that read files
    #[arg(long, requires = "netlist")]
    trust: bool,
}

/// A circuit FMU of the user.
#[derive(Args)]
struct ForeignOptions {
    /// FMU of your own circuit (co-simulation, FMI 2.0), in a process of its own
    #[arg(long, value_name = "FILE.fmu", group = "own", conflicts_with = "circuit")]
    circuit_fmu: Option<PathBuf>,
    /// The variable of the circuit FMU that is left.capacitance, right.capacitance (inputs), left.voltage, right.voltage, or another
    /// output of HarvestingCircuit, which may be left out; none: there is none. Same names need no --map, units are converted; the
    /// FMU's variable is FACTOR times the SI value if it has no unit. May be repeated
    #[arg(long, value_name = "NAME=VARIABLE[*FACTOR]", requires = "circuit_fmu")]
    map: Vec<String>,
    /// The same as a TOML file, with a table [map] and start values of the circuit FMU in a table [set]
    #[arg(long, value_name = "FILE.toml", requires = "circuit_fmu")]
    map_file: Option<PathBuf>,
}

/// What solves the circuit.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Backend {
    /// The exact solver, called directly
    Embedded,
    /// ngspice's shared library, in step with the harvester
    Ngspice,
    /// The FMU HarvestingCircuit
    Fmu,
}

#[derive(Serialize)]
struct Output<'a> {
    #[serde(flatten)]
    run: RunOutput<'a>,
    circuit: &'a str,
    #[serde(flatten)]
    powers: &'a Powers,
    #[serde(flatten)]
    summary: &'a CircuitSummary,
    #[serde(skip_serializing_if = "IndexMap::is_empty")]
    elements: IndexMap<&'a str, f64>,
    coupling: CouplingSummary,
    #[serde(skip_serializing_if = "Option::is_none")]
    balance: Option<EnergyBalance>,
    comparison: &'a [LabelledCircuit],
}

/// Runs the verb.
pub fn run(arguments: &Arguments, interruption: &Interruption) -> anyhow::Result<Exit> {
    let options = &arguments.run;
    let scenario = options.scenario()?;
    let coupling = Coupling { method: arguments.master, tolerance: arguments.adaptive };
    coupling.check()?;
    let (circuit, program, netlist, mapping);
    let (own, foreign) = (&arguments.netlist, &arguments.foreign);
    // Limits bind the FMU of the user.
    let harvester = match foreign.circuit_fmu {
        Some(_) => arguments.isolation.open_beside("VibroImpactHarvester")?,
        None => arguments.isolation.open_own("VibroImpactHarvester")?,
    };
    let claimed = Claimed::claim(&options.output, arguments.identity(&scenario)?, interruption)?;
    let solver = match (&own.netlist, &foreign.circuit_fmu, arguments.circuit) {
        (_, Some(path), _) => {
            mapping = Mapping::read(&foreign.map, foreign.map_file.as_deref())?;
            circuit = arguments.isolation.open(path)?;
            CircuitSolver::Foreign(ForeignCircuit { fmu: &circuit, mapping: &mapping, probes: &own.probe })
        }
        (Some(path), ..) => {
            program = packaging::program()?;
            netlist = UserNetlist::read(path, own.trust)?;
            let (gain, cost, probes) = (&own.gain, &own.cost, &own.probe);
            CircuitSolver::Netlist(&program, NetlistCircuit { netlist: &netlist, gain, cost, probes })
        }
        (None, None, Backend::Embedded) => CircuitSolver::Embedded,
        (None, None, Backend::Ngspice) => {
            program = packaging::program()?;
            CircuitSolver::Ngspice(&program)
        }
        (None, None, Backend::Fmu) => {
            circuit = arguments.isolation.open_own("HarvestingCircuit")?;
            CircuitSolver::Fmu(&circuit)
        }
    };
    let cosimulation = Cosimulation::new(&Options { harvester: &harvester, scenario: &scenario, solver, coupling })?;
    let series = arguments.series.options();
    // The number of points of an adaptive step is known at the end only.
    let warning = coupling.tolerance.is_none().then(|| time_series::warning(&series, &scenario, true)).flatten();
    output::warn(warning.as_slice());
    let recorder = SeriesRecorder::create((&claimed.folder, "timeseries"), &series, &scenario, Some(&own.probe))?;
    let (results, written) = record(cosimulation, &scenario, recorder)?;
    let drawn = match solver {
        CircuitSolver::Netlist(_, user) => {
            Electrical::Netlist(user.probes.iter().map(|it| Probe::of_node(it)).collect())
        }
        CircuitSolver::Foreign(user) => {
            Electrical::Foreign(user.probes.iter().map(|name| Probe::of_variable(name, user.fmu)).collect())
        }
        _ => Electrical::Paper,
    };
    let svg = picture::cosim(&results.trace, &scenario, drawn)?.svg;
    let device = Device::of(&harvester, &scenario)?;
    let of_user = |section: Section| match solver {
        CircuitSolver::Foreign(user) => {
            let set = [&user.mapping.settings[..], scenario.changes()].concat();
            parameter_table::with_fmu(section, user.fmu.description(), &set)
        }
        _ => section,
    };
    let report = cosim_report::report(&scenario, &results, &device, svg.clone(), of_user)?;
    let html = videg_report::render_html(&report)?;
    let files = run_output::write(&claimed.folder, written.as_slice(), &svg, &html)?;
    let (first, comparison) = results.circuits.split_first().context("a co-simulation without a circuit")?;
    let output = Output {
        run: RunOutput::new(&claimed.identity, &scenario, results.mechanics, &results.warnings, &files),
        circuit: &first.label,
        powers: &first.powers,
        summary: &first.summary,
        elements: results.elements.iter().map(|element| (element.name.as_str(), element.energy)).collect(),
        coupling: results.coupling,
        balance: results.balance,
        comparison,
    };
    let text = [
        heading("cosim", &scenario),
        cosim_report::powers(&scenario, &results).narrow(", "),
        mechanics(&scenario, &results.mechanics).text(),
        cosim_report::NO_GAIN.to_owned(),
        cosim_report::tables(&results),
        cosim_report::coupling_lines(&results),
        file_list(&files),
    ];
    let json = run_output::json(&output)?;
    run_output::conclude(claimed, options.json, &json, &text, &results.warnings)?;
    Ok(Exit::Passed)
}

impl Arguments {
    fn identity(&self, scenario: &Scenario) -> anyhow::Result<Identity> {
        let Self { circuit, netlist, foreign, master, adaptive, .. } = self;
        let path = |path: &Option<PathBuf>| path.as_ref().map(|path| path.display().to_string());
        let options = [
            ("circuit", chosen(circuit, &Backend::Embedded)),
            ("netlist", path(&netlist.netlist)),
            ("gain", listed(&netlist.gain)),
            ("cost", listed(&netlist.cost)),
            ("probe", listed(&netlist.probe)),
            ("circuit_fmu", path(&foreign.circuit_fmu)),
            ("map", listed(&foreign.map)),
            ("map_file", path(&foreign.map_file)),
            ("master", chosen(master, &Method::default())),
            ("adaptive", adaptive.map(|tolerance| tolerance.to_string())),
        ];
        Identity::of("cosim", scenario, options.into_iter().chain(self.series.distinct()))
    }
}

/// Runs `cosimulation` with its time series. That of a run that fails stays under another name.
fn record(
    cosimulation: Cosimulation<'_>,
    scenario: &Scenario,
    mut recorder: SeriesRecorder,
) -> anyhow::Result<(Results, Option<PathBuf>)> {
    match cosimulation.run(&mut recorder, &TimeBar::new(&scenario.name)) {
        Ok(results) => Ok((results, recorder.finish()?)),
        Err(error) => Err(match recorder.leave()? {
            Some(left) => anyhow!("{error}; the time series up to there is in {}", left.display()),
            None => error.into(),
        }),
    }
}
