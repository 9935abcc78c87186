//! ngspice as a circuit that the master can step: the shared library, in a process of its own.

use std::path::Path;
use std::time::Duration;

use fmu_import::nearest_name;
use videg_circuit::{Ledger, Release};

use super::{CircuitSample, CircuitSlave, CosimError, ElementEnergy};
use crate::ngspice::live::{Account, Circuit, Job, Ramp, State, Wanted, Worker};
use crate::ngspice::{CapacitanceSource, Elements, NgspiceError, PICO, Role, Run, UserNetlist};

/// Real time that ngspice may take from one communication point to the next. It takes some 10 us for a time step of its
/// own; a step of this length hangs.
const PATIENCE: Duration = Duration::from_secs(60);

/// A circuit of the user, and what of it counts.
#[derive(Debug, Clone, Copy)]
pub struct NetlistCircuit<'a> {
    /// The netlist.
    pub netlist: &'a UserNetlist,
    /// Elements whose energy is a gain; none: all resistors, capacitors and inductors.
    pub gain: &'a [String],
    /// Elements whose energy is a cost; none: all sources.
    pub cost: &'a [String],
    /// Nodes, and `i(source)`, whose waveforms are wanted.
    pub probes: &'a [String],
}

/// The circuit in ngspice, which takes its own time steps between the communication points.
pub struct NgspiceCircuit {
    label: String,
    worker: Worker,
    state: State,
    /// Resistance of a load that is no node of its own, Ohm.
    hidden_load: Option<f64>,
    elements: Vec<ElementEnergy>,
    probes: Vec<String>,
    notes: Vec<String>,
    /// What may help a netlist of the user where ngspice gives up.
    hint: &'static str,
}

/// Our own netlists have these already.
const HINT: &str = "; this may help: .ic for every node at another voltage than 0 at the start, looser tolerances \
                    (.options reltol=1e-6 abstol=1e-9), a resistor from each floating node to ground";

impl NgspiceCircuit {
    /// A circuit of `elements` for the time from 0 to `run.until`, s, both membranes charged, at `capacitance` (left,
    /// right), F. `program` is the command-line tool `videg`, which runs the shared library of ngspice.
    ///
    /// # Errors
    /// A number that cannot be put into a netlist, or a program that cannot be started.
    pub fn new(
        label: &str,
        program: &Path,
        elements: &Elements,
        capacitance: [f64; 2],
        run: &Run,
    ) -> Result<Self, CosimError> {
        let fail = |cause| failed(label, cause);
        let netlist = elements.netlist(CapacitanceSource::External, capacitance, run).map_err(fail)?;
        let job = Job::of_netlist(netlist.text(), run);
        let circuit = Loaded::new(label, program, &job)?;
        let roles = circuit.description.elements.iter().map(|element| Elements::role(&element.name)).collect();
        let is_switch = elements.circuit().release == Release::Switch;
        let hidden_load = is_switch.then(|| elements.resistance());
        Ok(Self { hidden_load, ..circuit.begin(label, roles, &[], capacitance, str::to_owned)? })
    }

    /// The circuit of the user, for a harvester of `bias_voltage`, V; the rest as in [`NgspiceCircuit::new`].
    ///
    /// # Errors
    /// A netlist that ngspice does not take; a name that it does not have.
    pub fn of_user(
        program: &Path,
        user: &NetlistCircuit<'_>,
        capacitance: [f64; 2],
        bias_voltage: f64,
        run: &Run,
    ) -> Result<Self, CosimError> {
        let label = user.netlist.name();
        let job = user.netlist.job(run, bias_voltage, capacitance).map_err(|cause| failed(&label, cause))?;
        let circuit = Loaded::new(&label, program, &job)?;
        let elements = &circuit.description.elements;
        let roles = user.roles(elements)?;
        let probes = user.probes.iter().map(|probe| circuit.vector(probe)).collect::<Result<Vec<_>, _>>()?;
        let mut notes = user.netlist.notes().to_vec();
        notes.extend(circuit.description.unread.iter().map(|&element| {
            let name = user.netlist.spelled(&elements[element].name);
            format!("{name}: ngspice does not tell its currents, so its energy is missing in the ledger")
        }));
        let begun = circuit.begin(&label, roles, &probes, capacitance, |name| user.netlist.spelled(name))?;
        Ok(Self { probes: user.probes.to_vec(), notes, hint: HINT, ..begun })
    }
}

impl NetlistCircuit<'_> {
    /// What each element is for.
    fn roles(&self, elements: &[Account]) -> Result<Vec<Option<Role>>, CosimError> {
        let default = |kind: char| match kind {
            'x' => None,
            'v' | 'i' | 'b' | 'e' | 'f' | 'g' | 'h' => Some(Role::Supply),
            'r' | 'c' | 'l' => Some(Role::Load),
            _ => Some(Role::Diode),
        };
        let mut roles: Vec<_> = elements.iter().map(|element| default(element.kind)).collect();
        for (names, role) in [(self.gain, Role::Load), (self.cost, Role::Supply)] {
            if !names.is_empty() {
                roles.iter_mut().filter(|other| **other == Some(role)).for_each(|other| *other = Some(Role::Diode));
            }
        }
        for (option, names, role) in [("--gain", self.gain, Role::Load), ("--cost", self.cost, Role::Supply)] {
            for name in names {
                let index = find(option, name, elements)?;
                if option == "--cost" && self.gain.iter().any(|gain| gain.eq_ignore_ascii_case(name)) {
                    return Err(refused(option, name, "is a gain, too"));
                }
                roles[index] = Some(role);
            }
        }
        Ok(roles)
    }
}

/// The element called `name`.
fn find(option: &str, name: &str, elements: &[Account]) -> Result<usize, CosimError> {
    let index = elements.iter().position(|element| element.name.eq_ignore_ascii_case(name));
    match index {
        Some(index) if elements[index].kind == 'x' => {
            Err(refused(option, name, "is a membrane: its work is neither gain nor cost"))
        }
        Some(index) => Ok(index),
        None => Err(unknown(option, name, "element", elements.iter().map(|element| element.name.as_str()))),
    }
}

fn refused(option: &str, name: &str, reason: &str) -> CosimError {
    CosimError::Element { option: option.to_owned(), name: name.to_owned(), reason: reason.to_owned() }
}

fn unknown<'a>(option: &str, name: &str, what: &str, names: impl Iterator<Item = &'a str>) -> CosimError {
    let nearest = nearest_name(&name.to_ascii_lowercase(), names);
    let hint = nearest.map_or_else(String::new, |nearest| format!("; did you mean {nearest}?"));
    refused(option, name, &format!("the netlist has no such {what}{hint}"))
}

/// A circuit that ngspice has read.
struct Loaded {
    worker: Worker,
    description: Circuit,
}

impl Loaded {
    fn new(label: &str, program: &Path, job: &Job) -> Result<Self, CosimError> {
        let fail = |cause| failed(label, cause);
        let mut worker = Worker::start(program, job, PATIENCE).map_err(fail)?;
        let description = worker.circuit().map_err(fail)?;
        Ok(Self { worker, description })
    }

    /// The vector that a user calls `node`, `v(node)` or `i(source)`.
    fn vector(&self, probe: &str) -> Result<String, CosimError> {
        let name = probe.to_ascii_lowercase();
        let inside = |prefix| name.strip_prefix(prefix).and_then(|rest| rest.strip_suffix(')'));
        if let Some(source) = inside("i(") {
            let sources = || self.description.elements.iter().filter(|element| element.kind == 'v');
            let found = sources().find(|element| element.name == source);
            let names = sources().map(|element| element.name.as_str());
            return match found {
                Some(_) if source.contains('.') => Ok(format!("v.{source}#branch")),
                Some(_) => Ok(format!("{source}#branch")),
                None => Err(unknown("--probe", probe, "voltage source", names)),
            };
        }
        let node = inside("v(").unwrap_or(&name);
        let nodes = &self.description.nodes;
        match nodes.iter().find(|other| *other == node) {
            Some(node) => Ok(node.clone()),
            None => Err(unknown("--probe", probe, "node", nodes.iter().map(String::as_str))),
        }
    }

    fn begin(
        mut self,
        label: &str,
        roles: Vec<Option<Role>>,
        probes: &[String],
        capacitance: [f64; 2],
        spelled: impl Fn(&str) -> String,
    ) -> Result<NgspiceCircuit, CosimError> {
        let of = |role| (0..roles.len()).filter(|&element| roles[element] == Some(role)).collect();
        let groups = Role::ALL.map(of).to_vec();
        let wanted = Wanted { groups, probes: probes.to_vec(), start: capacitance.map(|c| c / PICO).to_vec() };
        let state = self.worker.begin(wanted).map_err(|cause| failed(label, cause))?;
        let named = self.description.elements.iter().zip(roles);
        let elements = named.map(|(element, role)| ElementEnergy { name: spelled(&element.name), role, energy: 0.0 });
        Ok(NgspiceCircuit {
            label: label.to_owned(),
            worker: self.worker,
            state,
            hidden_load: None,
            elements: elements.collect(),
            probes: Vec::new(),
            notes: Vec::new(),
            hint: "",
        })
    }
}

impl Job {
    /// The work of ngspice for a netlist of our own.
    fn of_netlist(netlist: &str, run: &Run) -> Self {
        Self {
            netlist: netlist.lines().map(str::to_owned).collect(),
            sources: crate::ngspice::live::SOURCES.map(str::to_owned).to_vec(),
            commands: Vec::new(),
            longest_step: run.max_step,
            // Not the end of the run: there ngspice would end the analysis without a word.
            stop: 2.0 * run.until,
            from_initial_conditions: true,
            is_trapezoidal: false,
            memory: None,
        }
    }
}

fn failed(label: &str, cause: impl Into<NgspiceError>) -> CosimError {
    CosimError::Ngspice { label: label.to_owned(), cause: Box::new(cause.into()) }
}

impl CircuitSlave for NgspiceCircuit {
    fn label(&self) -> &str {
        &self.label
    }

    fn step(&mut self, time: f64, step: f64, start: [f64; 2], end: [f64; 2]) -> Result<(), CosimError> {
        let pico = |capacitance: [f64; 2]| capacitance.map(|c| c / PICO).to_vec();
        let ramp = Ramp { from: time, to: time + step, start: pico(start), end: pico(end) };
        self.state = self.worker.step(ramp).map_err(|cause| failed(&self.label, cause.with_hint(self.hint)))?;
        Ok(())
    }

    fn sample(&self) -> Result<CircuitSample, CosimError> {
        let State { membranes, groups, .. } = &self.state;
        let of = |role: Role| groups.get(role as usize).copied().unwrap_or_default();
        let [supply, load, zener, diode, leakage] = Role::ALL.map(of);
        Ok(CircuitSample {
            voltage: membranes.voltage,
            load_voltage: self.hidden_load.map_or(load.voltage, |resistance| resistance * load.current),
            load_current: load.current,
            supply_current: 0.0 - supply.current,
            ledger: Ledger {
                supply: 0.0 - supply.energy,
                load: load.energy,
                zener: zener.energy,
                diode: diode.energy,
                leakage: leakage.energy,
                stored: membranes.stored,
                mechanical: membranes.mechanical,
                supply_charge: 0.0 - supply.charge,
                load_charge: load.charge,
            },
        })
    }

    fn probes(&self) -> (&[String], &[f64]) {
        (&self.probes, &self.state.probes)
    }

    fn elements(&mut self) -> Result<Vec<ElementEnergy>, CosimError> {
        let energies = self.worker.energies().map_err(|cause| failed(&self.label, cause))?;
        let named = self.elements.iter().zip(energies);
        Ok(named.map(|(element, energy)| ElementEnergy { energy, ..element.clone() }).collect())
    }

    fn notes(&self) -> &[String] {
        &self.notes
    }
}
