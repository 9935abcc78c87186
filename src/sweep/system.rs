//! Runs of the harvester with the embedded circuit, in one process.

use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

use fmu_import::{Fmu, Value, Variable};
use videg_circuit::{Release, Settings, formulas, names};
use videg_model::{Event, ForceTable, Harvester, Parameters, Recording, Setup};

use super::electrical::{POWERS, outputs};
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
    /// How the varied variables are set, in their order, and the seed.
    setters: Vec<SystemSetter>,
    record: Vec<Recorded>,
    files: Files,
    /// For recorded variables of the harvester.
    harvester: Option<Fmu>,
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
        let setter = |variable: &Variable| {
            let reason = "a sweep with a circuit cannot set it".to_owned();
            SystemSetter::of(variable).ok_or_else(|| SweepError::option("set", &variable.name, reason))
        };
        let varied = sweep.points.axes().iter().map(|axis| &axis.variable);
        let varied = varied.chain(sweep.seeds.as_ref().map(|seeds| &seeds.variable));
        let setters: Vec<_> = varied.map(setter).collect::<Result<_, _>>()?;
        let mut files = Files::default();
        let mut base = Inputs {
            parameters: Parameters::default(),
            circuit: Settings::default(),
            given: Vec::new(),
            recording: None,
            table: None,
        };
        for (variable, value) in &sweep.settings {
            let setter = setter(variable)?;
            files.read(setter, sweep, value)?;
            base.set(setter, value, &files);
        }
        for (axis, setter) in sweep.points.axes().iter().zip(&setters) {
            axis.listed().iter().try_for_each(|value| files.read(*setter, sweep, value))?;
        }
        let record: Vec<_> = sweep.record.iter().map(Recorded::of).collect();
        let asks = record.iter().any(|it| matches!(it, Recorded::Mechanical));
        let harvester = if asks { Some(harvester()?) } else { None };
        Ok(Self { base, setters, record, files, harvester })
    }

    /// Outcome of `run`; an error says why it failed.
    pub(super) fn run(&self, sweep: &Sweep, run: &Run) -> Result<Results, String> {
        let mut inputs = self.base.clone();
        let seed = run.seed.map(Value::Integer);
        for (setter, value) in self.setters.iter().zip(run.values.iter().chain(&seed)) {
            inputs.set(*setter, value, &self.files);
        }
        let times = Times { until: sweep.times.window[1], window: sweep.times.window, tolerance: TOLERANCE };
        let outcome = inputs.run(&times).map_err(|error| error.to_string())?;
        let mechanical = self.harvester.as_ref().map(|fmu| run_fmu(fmu, sweep, run));
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
        let is_output = outputs().any(|output| output == name);
        let index = CircuitSample::NAMES.iter().position(|output| *output == name).filter(|_| is_output);
        index.map_or(Self::Mechanical, Self::Circuit)
    }
}

impl Files {
    /// Reads the file called `value`, if that is one.
    fn read(&mut self, setter: SystemSetter, sweep: &Sweep, value: &Value) -> Result<(), SweepError> {
        let (Value::String(name), Value::String(path)) = (value, &*sweep.files.for_fmu(value)) else { return Ok(()) };
        if name.is_empty() {
            return Ok(());
        }
        let path = Path::new(path);
        let bad = |option: &'static str, reason: String| SweepError::option("set", option, reason);
        match setter {
            SystemSetter::Recording => {
                let recording = videg_data::recording::read(path);
                let recording = recording.map_err(|error| bad("excitation.file", format!("{name}: {error}")))?;
                self.recordings.insert(name.clone(), Arc::new(recording));
            }
            SystemSetter::Table => {
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
    /// Sets a value of the variable's type.
    fn set(&mut self, setter: SystemSetter, value: &Value, files: &Files) {
        match (setter, value) {
            (SystemSetter::Mechanical(setter), value) => setter.set(&mut self.parameters, value),
            (SystemSetter::Quantity(name, set), Value::Real(number)) => {
                set(&mut self.circuit, *number);
                self.given.push(name);
            }
            (SystemSetter::Choice(set), Value::Integer(number) | Value::Enumeration { value: number, .. }) => {
                set(&mut self.circuit, *number);
            }
            (SystemSetter::Recording, Value::String(name)) => self.recording = files.recordings.get(name).cloned(),
            (SystemSetter::Table, Value::String(name)) => self.table = files.tables.get(name).cloned(),
            // No value of a variable is of another type than the variable.
            _ => debug_assert!(false, "{value} is of type {}", value.type_name()),
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
