//! Runs of the harvester with the embedded circuit, in one process.

use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

use fmu_import::{Fmu, Value, Variable};
use videg_circuit::{Release, Settings, formulas, names};
use videg_model::{Event, ForceTable, Harvester, Parameters, Recording, Setup};

use super::electrical::POWERS;
use super::instance::run_fmu;
use super::plan::{Results, Run};
use super::setter::Setter;
use super::{Sweep, SweepError};
use crate::cosim::{CircuitRequest, CircuitSample};
use crate::coupled::{self, TOLERANCE, Times};

/// How a variable is set.
#[derive(Clone, Copy)]
enum SystemSetter {
    Mechanical(Setter),
    Quantity(&'static str, fn(&mut Settings, f64)),
    Choice(fn(&mut Settings, i32)),
    Recording,
    Table,
}

/// What a run records.
enum Recorded {
    Power(usize),
    Circuit(usize),
    /// A variable of the harvester, which its FMU tells.
    Mechanical,
}

/// Runs of harvester and circuit.
pub struct System {
    base: Inputs,
    record: Vec<Recorded>,
    files: Files,
    /// The FMU and the recorded variables that it has, if there are any.
    harvester: Option<(Fmu, Vec<Variable>)>,
}

/// What a run is made from.
#[derive(Clone)]
struct Inputs {
    parameters: Parameters,
    circuit: Settings,
    /// Quantities of the circuit that were asked for.
    given: Vec<&'static str>,
    recording: Option<Arc<Recording>>,
    table: Option<Arc<ForceTable>>,
}

/// Files by the names that the user gave.
#[derive(Default)]
struct Files {
    recordings: HashMap<String, Arc<Recording>>,
    tables: HashMap<String, Arc<ForceTable>>,
}

impl System {
    /// The engine of `sweep`, whose variables are those of `system_description`. `harvester` opens its FMU, if variables of it are
    /// recorded.
    ///
    /// # Errors
    /// A file that is none; a variable that cannot be set; the error of `harvester`.
    pub fn new<E: From<SweepError>>(sweep: &Sweep, harvester: impl FnOnce() -> Result<Fmu, E>) -> Result<Self, E> {
        if let Some(variable) = sweep.variables().find(|variable| SystemSetter::of(variable).is_none()) {
            let reason = "a sweep with a circuit cannot set it";
            return Err(SweepError::option("set", &variable.name, reason).into());
        }
        let mut files = Files::default();
        let mut base = Inputs {
            parameters: Parameters::default(),
            circuit: Settings::default(),
            given: Vec::new(),
            recording: None,
            table: None,
        };
        sweep.written().try_for_each(|(variable, value)| files.read(variable, sweep, value))?;
        base.set(sweep.settings.iter().map(|(variable, value)| (variable, value)), &files);
        let record: Vec<_> = sweep.record.iter().map(Recorded::of).collect();
        let mechanical = record.iter().zip(&sweep.record).filter(|(it, _)| matches!(it, Recorded::Mechanical));
        let mechanical: Vec<_> = mechanical.map(|(_, variable)| variable.clone()).collect();
        let harvester = if mechanical.is_empty() { None } else { Some((harvester()?, mechanical)) };
        Ok(Self { base, record, files, harvester })
    }

    /// Outcome of `run`; an error says why it failed.
    pub(super) fn run(&self, sweep: &Sweep, run: &Run) -> Result<Results, String> {
        let mut inputs = self.base.clone();
        inputs.set(sweep.assigned(run), &self.files);
        let times = Times { until: sweep.times.window[1], window: sweep.times.window, tolerance: TOLERANCE };
        let outcome = inputs.run(&times).map_err(|error| error.to_string())?;
        let mechanical = self.harvester.as_ref().map(|(fmu, record)| run_fmu(fmu, sweep, run, record));
        let mut mechanical =
            mechanical.transpose().map_err(|error| error.to_string())?.map(|results| results.recorded.into_iter());
        let columns = outcome.circuit.columns();
        let powers = [outcome.powers.net_power, outcome.powers.load_power, outcome.powers.supply_power];
        let value = |recorded: &Recorded| match recorded {
            Recorded::Power(index) => Value::Real(powers[*index]),
            Recorded::Circuit(index) => Value::Real(columns[*index]),
            Recorded::Mechanical => mechanical.as_mut().and_then(Iterator::next).unwrap_or(Value::Real(f64::NAN)),
        };
        Ok(Results { recorded: self.record.iter().map(value).collect(), averages: Some(outcome.averages) })
    }
}

impl SystemSetter {
    fn of(variable: &Variable) -> Option<Self> {
        if let Some(setter) = Setter::of(variable) {
            return Some(Self::Mechanical(setter));
        }
        let name = variable.name.as_str();
        let quantity = Settings::QUANTITIES.iter().find(|it| it.name == name).map(|it| Self::Quantity(it.name, it.set));
        let choice = || Settings::CHOICES.iter().find(|it| it.name == name).map(|it| Self::Choice(it.set));
        let file = || match name {
            "excitation.file" => Some(Self::Recording),
            "membrane.file" => Some(Self::Table),
            _ => None,
        };
        quantity.or_else(choice).or_else(file)
    }
}

impl Recorded {
    fn of(variable: &Variable) -> Self {
        let name = variable.name.as_str();
        if let Some(index) = POWERS.iter().position(|power| *power == name) {
            return Self::Power(index);
        }
        // Beside a circuit, the voltages that the harvester takes are those that the circuit gives.
        let index = CircuitSample::NAMES.iter().position(|output| *output == name);
        index.map_or(Self::Mechanical, Self::Circuit)
    }
}

impl Files {
    /// Reads the file called `value`, if that is one.
    fn read(&mut self, variable: &Variable, sweep: &Sweep, value: &Value) -> Result<(), SweepError> {
        let (Value::String(name), Value::String(path)) = (value, &*sweep.files.for_fmu(value)) else { return Ok(()) };
        if name.is_empty() {
            return Ok(());
        }
        let path = Path::new(path);
        let bad = |option: &'static str, reason: String| SweepError::option("set", option, reason);
        match SystemSetter::of(variable) {
            Some(SystemSetter::Recording) => {
                let recording = videg_data::recording::read(path);
                let recording = recording.map_err(|error| bad("excitation.file", format!("{name}: {error}")))?;
                self.recordings.insert(name.clone(), Arc::new(recording));
            }
            Some(SystemSetter::Table) => {
                let table = videg_data::membrane::read(path);
                let table = table.map_err(|error| bad("membrane.file", format!("{name}: {error}")))?;
                self.tables.insert(name.clone(), Arc::new(table));
            }
            _ => {}
        }
        Ok(())
    }
}

impl Inputs {
    /// Sets values of the variables' types.
    fn set<'a>(&mut self, values: impl Iterator<Item = (&'a Variable, &'a Value)>, files: &Files) {
        for (variable, value) in values {
            match (SystemSetter::of(variable), value) {
                (Some(SystemSetter::Mechanical(setter)), value) => setter.set(&mut self.parameters, value),
                (Some(SystemSetter::Quantity(name, set)), Value::Real(number)) => {
                    set(&mut self.circuit, *number);
                    self.given.push(name);
                }
                (
                    Some(SystemSetter::Choice(set)),
                    Value::Integer(number) | Value::Enumeration { value: number, .. },
                ) => set(&mut self.circuit, *number),
                (Some(SystemSetter::Recording), Value::String(name)) => {
                    self.recording = files.recordings.get(name).cloned();
                }
                (Some(SystemSetter::Table), Value::String(name)) => self.table = files.tables.get(name).cloned(),
                // `System::new` has refused others, and no value of a variable is of another type than the variable.
                _ => debug_assert!(false, "{} = {value} of type {}", variable.name, value.type_name()),
            }
        }
    }

    fn run(&self, times: &Times) -> Result<coupled::Results, coupled::CoupledError> {
        let setup = self.parameters.with_recording(self.recording.as_deref()).with_table(self.table.as_deref());
        let request = CircuitRequest::of(self.circuit, self.given.iter().copied());
        let chooses = self.circuit.circuit.release == Release::Storage && !self.given.contains(&names::STORAGE_VOLTAGE);
        let ratio = if chooses { best_ratio(setup, times.until)? } else { 1.0 };
        coupled::run(setup, &request.resolve(self.parameters.bias_voltage, ratio), times)
    }
}

/// `C_3` / `C_2` for which a voltage of release is chosen, from the impacts up to `until`, s.
fn best_ratio(setup: Setup<'_>, until: f64) -> Result<f64, coupled::CoupledError> {
    let mut harvester = Harvester::new(setup, 0.0)?;
    let membrane = harvester.membrane().clone();
    let mut ratios = Vec::new();
    harvester.advance_with(until, |event| {
        if let Event::Peak(peak) = event {
            ratios.push(membrane.capacitance(peak.deflection) / membrane.rest_capacitance());
        }
    })?;
    Ok(formulas::best_release_ratio(ratios))
}
