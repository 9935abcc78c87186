//! A run: the harvester of a scenario coupled with a circuit, and with circuits to compare it with.

use std::path::Path;

use fmu_import::Fmu;
use serde::Serialize;
use videg_circuit::{Release, Settings, Topology};

use super::ratios::CapacitanceRatios;
use super::settings::{CircuitRequest, label, split_between, voltage_warning};
use super::{
    CircuitSlave, CircuitSummary, CosimError, Coupling, CouplingSummary, ElementEnergy, EmbeddedCircuit, EnergyBalance,
    Flows, FmuCircuit, ForeignCircuit, HarvesterFmu, Master, MechanicsSummary, NetlistCircuit, NgspiceCircuit,
    Observer, Outcome, Powers, TimeProgress, Trace, best_release_voltage,
};
use crate::ngspice::{self, Elements};
use crate::progress::Progress;
use crate::scenario::Scenario;

/// What to run.
#[derive(Clone, Copy)]
pub struct Options<'a> {
    /// The FMU `VibroImpactHarvester`.
    pub harvester: &'a Fmu,
    /// The case with its settings, those of the circuit included.
    pub scenario: &'a Scenario,
    /// What solves the circuit.
    pub solver: CircuitSolver<'a>,
    /// How harvester and circuit are coupled.
    pub coupling: Coupling,
}

/// What solves the circuit.
#[derive(Clone, Copy)]
pub enum CircuitSolver<'a> {
    /// The exact solver, called directly.
    Embedded,
    /// The shared library of ngspice; the program is the command-line tool `videg`, which runs it.
    Ngspice(&'a Path),
    /// The FMU `HarvestingCircuit`.
    Fmu(&'a Fmu),
    /// A netlist of the user in ngspice; the program as for [`CircuitSolver::Ngspice`].
    Netlist(&'a Path, NetlistCircuit<'a>),
    /// A circuit FMU of the user.
    Foreign(ForeignCircuit<'a>),
}

impl<'a> Options<'a> {
    /// `scenario` with the embedded solver and the default coupling.
    pub fn new(harvester: &'a Fmu, scenario: &'a Scenario) -> Self {
        Self { harvester, scenario, solver: CircuitSolver::Embedded, coupling: Coupling::default() }
    }
}

/// Energies and charges of one circuit of a run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LabelledCircuit {
    /// Name of the circuit.
    pub label: String,
    /// Mean powers over the averaging window.
    #[serde(flatten)]
    pub powers: Powers,
    /// Energies and charges.
    #[serde(flatten)]
    pub summary: CircuitSummary,
}

/// Results of a run.
#[derive(Debug, Clone)]
pub struct Results {
    /// The mechanics.
    pub mechanics: MechanicsSummary,
    /// The circuit asked for, then those to compare it with.
    pub circuits: Vec<LabelledCircuit>,
    /// Whether the circuit asked for is one of the user, not the paper's.
    pub is_foreign: bool,
    /// The elements of a netlist with the energies that they took.
    pub elements: Vec<ElementEnergy>,
    /// The coupling of the harvester with the circuit asked for.
    pub coupling: CouplingSummary,
    /// The energy balance, with electrostatic feedback.
    pub balance: Option<EnergyBalance>,
    /// Mean flows of energy over the averaging window.
    pub flows: Flows,
    /// The circuit asked for with all its parameters, unless it is one of the user.
    pub asked: Option<Settings>,
    /// Sum of `U_in` dC over all impacts, `U_in` that of the supply, C; 0 for a circuit of the user.
    pub cycle_charge: f64,
    /// Warnings about the validity of the numbers.
    pub warnings: Vec<String>,
    /// What a figure shows.
    pub trace: Trace,
}

/// Runs the co-simulation.
///
/// # Errors
/// A setting that neither harvester nor circuit takes; errors of a subsystem.
pub fn run(options: &Options<'_>, progress: &dyn Progress) -> Result<Results, CosimError> {
    Cosimulation::new(options)?.run(&mut (), progress)
}

/// A co-simulation, initialised and ready to run.
pub struct Cosimulation<'a> {
    master: Master,
    scenario: &'a Scenario,
    labels: Vec<String>,
    /// The circuit asked for, unless it is one of the user.
    asked: Option<Settings>,
    bias_voltage: f64,
}

impl<'a> Cosimulation<'a> {
    /// Initialises harvester and circuits, with a run of the mechanics alone ahead.
    pub fn new(options: &Options<'a>) -> Result<Self, CosimError> {
        let &Options { harvester: fmu, scenario, solver, coupling } = options;
        if let CircuitSolver::Foreign(user) = solver {
            return Self::with_foreign(options, &user);
        }
        let (mechanical, request) = CircuitRequest::split(fmu.description(), &scenario.settings)?;
        let harvester = HarvesterFmu::new(fmu, scenario, &mechanical)?;
        let bias_voltage = harvester.bias_voltage();
        let ratios = CapacitanceRatios::of(fmu, scenario, &mechanical)?;
        let capacitance = harvester.sample()?.capacitance();
        let (slaves, asked) = if let CircuitSolver::Netlist(program, user) = solver {
            if let Some(names) = request.names() {
                return Err(CosimError::CircuitSettings { names });
            }
            let run = ngspice::Run::new(scenario.until, ratios.largest);
            let circuit = NgspiceCircuit::of_user(program, &user, capacitance, bias_voltage, &run)?;
            (vec![Box::new(circuit) as Box<dyn CircuitSlave>], None)
        } else {
            let asked = request.resolve(bias_voltage, ratios.best);
            let circuits = compared(&asked, ratios.best);
            let slaves = slaves(solver, &circuits, scenario.until, ratios.largest, capacitance);
            (slaves.map_err(|error| request.located(error, &asked))?, Some(asked))
        };
        let labels = slaves.iter().map(|slave| slave.label().to_owned()).collect();
        let master = Master::new(harvester, slaves, scenario, coupling)?;
        Ok(Self { master, scenario, labels, asked, bias_voltage })
    }

    /// The same with a circuit FMU of the user.
    fn with_foreign(options: &Options<'a>, user: &ForeignCircuit<'_>) -> Result<Self, CosimError> {
        let &Options { harvester: fmu, scenario, coupling, .. } = options;
        let description = user.fmu.description();
        let [mechanical, electrical] = split_between(fmu.description(), description, &scenario.settings)?;
        let settings = [user.mapping.settings.as_slice(), &electrical].concat();
        let connection = user.mapping.resolve(description, &settings, &coupling, scenario)?;
        let harvester = HarvesterFmu::new(fmu, scenario, &mechanical)?;
        let (bias_voltage, capacitance) = (harvester.bias_voltage(), harvester.sample()?.capacitance());
        let (label, probes, until) = (&description.model_name, user.probes, scenario.until);
        let circuit = FmuCircuit::with(label, user.fmu, connection, probes, &settings, capacitance, until)?;
        let labels = vec![circuit.label().to_owned()];
        let master = Master::new(harvester, vec![Box::new(circuit)], scenario, coupling)?;
        Ok(Self { master, scenario, labels, asked: None, bias_voltage })
    }

    /// Runs to the end and shows each communication point to `recorder`.
    pub fn run(self, recorder: &mut dyn Observer, progress: &dyn Progress) -> Result<Results, CosimError> {
        let Self { master, scenario, labels, asked, bias_voltage } = self;
        let (mut trace, mut time) = (Trace::of(scenario), TimeProgress::new(progress, scenario.until));
        let outcome = master.run(&mut [recorder, &mut trace, &mut time])?;
        let Outcome { mechanics, circuits: samples, elements, powers, coupling, balance, flows, mut warnings } =
            outcome;
        warnings.extend(asked.and_then(|asked| voltage_warning(&asked, bias_voltage)));
        warnings.extend(coupling.warning());
        let labelled = labels.into_iter().zip(&samples).zip(powers).map(|((label, sample), powers)| LabelledCircuit {
            label,
            powers,
            summary: CircuitSummary::new(sample, mechanics.energy_eq13),
        });
        let circuits = labelled.collect();
        // W of Eq. (13) is 1/2 U_b^2 dC, with the bias voltage of the harvester.
        let impact_charge = 2.0 * mechanics.energy_eq13 / bias_voltage.powi(2);
        let cycle_charge = asked.map_or(0.0, |asked| impact_charge * asked.circuit.supply_voltage);
        // Those of our own netlists are no names of the user.
        let elements = if asked.is_some() { Vec::new() } else { elements };
        let is_foreign = asked.is_none();
        Ok(Results {
            mechanics,
            circuits,
            is_foreign,
            elements,
            coupling,
            balance,
            flows,
            asked,
            cycle_charge,
            warnings,
            trace,
        })
    }
}

/// The circuit `asked` for, and three to compare it with: the same with an ideal switch, and two that gain, with isolated
/// membranes and the voltage of release that gains most: a switch, and a storage in place of the load.
fn compared(asked: &Settings, ratio: f64) -> [Settings; 4] {
    let mut switch = Settings { exponential: false, ..*asked };
    switch.circuit.release = Release::Switch;
    let mut better = switch;
    better.circuit.topology = Topology::Isolated;
    better.circuit.zener_voltage = best_release_voltage(&better, ratio);
    let mut storage = better;
    storage.circuit.release = Release::Storage;
    storage.circuit.storage_voltage = better.circuit.zener_voltage;
    [*asked, switch, better, storage]
}

/// The first of `circuits` in `solver`, the others in the embedded one, at `capacitance`, F, which grows by at most `growth`.
fn slaves(
    solver: CircuitSolver<'_>,
    circuits: &[Settings],
    until: f64,
    growth: f64,
    capacitance: [f64; 2],
) -> Result<Vec<Box<dyn CircuitSlave>>, CosimError> {
    let slave = |(index, settings): (usize, &Settings)| -> Result<Box<dyn CircuitSlave>, CosimError> {
        let label = label(settings);
        Ok(match solver {
            CircuitSolver::Ngspice(program) if index == 0 => {
                let elements = Elements::new(&settings.parameters(), growth)?;
                let run = ngspice::Run::new(until, growth);
                Box::new(NgspiceCircuit::new(&label, program, &elements, capacitance, &run)?)
            }
            CircuitSolver::Fmu(fmu) if index == 0 => {
                Box::new(FmuCircuit::new(&label, fmu, &FmuCircuit::settings(settings), capacitance, until)?)
            }
            _ => Box::new(EmbeddedCircuit::new(&label, settings, capacitance)?),
        })
    };
    circuits.iter().enumerate().map(slave).collect()
}
