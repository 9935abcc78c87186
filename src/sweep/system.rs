//! Runs of the harvester with the embedded circuit, in one process.

use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

use fmu_import::{Fmu, Value, Variable};
use videg_circuit::{Choice, Release, Settings, Topology};
use videg_coupled::{CoupledError, Film, Given, Impacts, OVER_LIMITS, TOLERANCE, Times, Watch};
use videg_model::{ContactLaw, ForceTable, Parameters, Recording};

use super::electrical::{CONVERTED, POWERS};
use super::instance::run_fmu;
use super::plan::{Results, Run};
use super::setter::Setter;
use super::tracks::{HarvesterInputs, Tracks};
use super::{Sweep, SweepError};
use crate::cosim::CircuitSample;

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
    /// What the mechanics gave.
    Converted,
    /// A parameter of the circuit.
    Quantity(fn(&Settings) -> f64),
    Choice(&'static Choice),
    /// How much is taken of a limit of the film.
    OverLimit(usize),
    /// A variable of the harvester, which its FMU tells.
    Mechanical,
}

/// Runs of harvester and circuit.
pub struct System {
    base: Inputs,
    record: Vec<Recorded>,
    /// Whether the films are looked at.
    watches: bool,
    files: Files,
    tracks: Tracks,
    /// The FMU and the recorded variables that it has, if there are any.
    harvester: Option<(Fmu, Vec<Variable>)>,
}

/// Impacts of a run, and the circuit that they drive.
#[derive(Debug, Clone)]
pub struct DrivenImpacts {
    /// Of the averaging window.
    pub impacts: Impacts,
    /// How the circuit joins the membranes.
    pub topology: Topology,
}

/// What a run is made from.
#[derive(Clone)]
struct Inputs {
    harvester: HarvesterInputs,
    circuit: Settings,
    /// Voltages of the circuit that were asked for.
    given: Given,
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
            harvester: HarvesterInputs { parameters: Parameters::default(), recording: None, table: None },
            circuit: Settings::default(),
            given: Given::default(),
        };
        sweep.written().try_for_each(|(variable, value)| files.read(variable, sweep, value))?;
        base.set(sweep.settings.iter().map(|(variable, value)| (variable, value)), &files);
        let record: Vec<_> = sweep.record.iter().map(Recorded::of).collect();
        let mechanical = record.iter().zip(&sweep.record).filter(|(it, _)| matches!(it, Recorded::Mechanical));
        let mechanical: Vec<_> = mechanical.map(|(_, variable)| variable.clone()).collect();
        let harvester = if mechanical.is_empty() { None } else { Some((harvester()?, mechanical)) };
        let watches = record.iter().any(|it| matches!(it, Recorded::OverLimit(_)));
        Ok(Self { base, record, watches, files, tracks: Tracks::default(), harvester })
    }

    /// Impacts of sample number `sample` at these `values` of the varied variables, all of them Real; none under the compliant law, which
    /// has no closed forms. An error says why the run failed.
    pub fn impacts_at(&self, sweep: &Sweep, values: &[f64], sample: u64) -> Result<Option<DrivenImpacts>, String> {
        let inputs = self.inputs(sweep, &sweep.run_at(values, sample));
        if inputs.harvester.parameters.contact_law != ContactLaw::Impulsive {
            return Ok(None);
        }
        let impacts = Impacts::of(inputs.harvester.setup(), sweep.times.window).map_err(|error| error.to_string())?;
        Ok(Some(DrivenImpacts { impacts, topology: inputs.circuit.circuit.topology }))
    }

    fn inputs(&self, sweep: &Sweep, run: &Run) -> Inputs {
        let mut inputs = self.base.clone();
        inputs.set(sweep.assigned(run), &self.files);
        inputs
    }

    /// Outcome of `run`; an error says why it failed.
    pub(super) fn run(&self, sweep: &Sweep, run: &Run) -> Result<Results, String> {
        let inputs = self.inputs(sweep, run);
        let times = Times { until: sweep.times.window[1], window: sweep.times.window, tolerance: TOLERANCE };
        let mut film = Film::default();
        let settings = inputs.settings(&times).map_err(|error| error.to_string())?;
        let watch: &mut dyn Watch = if self.watches { &mut film } else { &mut () };
        let outcome = inputs.run(&settings, &times, &self.tracks, watch).map_err(|error| error.to_string())?;
        let over_limits = film.over_limits();
        let mechanical = self.harvester.as_ref().map(|(fmu, record)| run_fmu(fmu, sweep, run, record));
        let mut mechanical =
            mechanical.transpose().map_err(|error| error.to_string())?.map(|results| results.recorded.into_iter());
        let columns = outcome.circuit.columns();
        let powers = [outcome.powers.net_power, outcome.powers.load_power, outcome.powers.supply_power];
        let value = |recorded: &Recorded| match recorded {
            Recorded::Power(index) => Value::Real(powers[*index]),
            Recorded::Circuit(index) => Value::Real(columns[*index]),
            Recorded::Converted => Value::Real(outcome.circuit.ledger.converted()),
            Recorded::Quantity(get) => Value::Real(get(&settings)),
            Recorded::Choice(choice) => item(choice, &settings),
            Recorded::OverLimit(index) => Value::Real(over_limits[*index]),
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
        if let Some(index) = OVER_LIMITS.iter().position(|limit| *limit == name) {
            return Self::OverLimit(index);
        }
        // Beside a circuit, the voltages that the harvester takes are those that the circuit gives.
        let output = CircuitSample::NAMES.iter().position(|output| *output == name).map(Self::Circuit);
        let quantity = || Settings::QUANTITIES.iter().find(|it| it.name == name).map(|it| Self::Quantity(it.get));
        let choice = || Settings::CHOICES.iter().find(|it| it.name == name).map(Self::Choice);
        let converted = || (name == CONVERTED).then_some(Self::Converted);
        output.or_else(converted).or_else(quantity).or_else(choice).unwrap_or(Self::Mechanical)
    }
}

/// The item that is chosen.
fn item(choice: &Choice, settings: &Settings) -> Value {
    let value = (choice.get)(settings);
    let item = usize::try_from(value - 1).ok().and_then(|index| choice.items.get(index));
    Value::Enumeration { value, name: item.map_or_else(String::new, |(name, _)| (*name).to_owned()) }
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
                (Some(SystemSetter::Mechanical(setter)), value) => setter.set(&mut self.harvester.parameters, value),
                (Some(SystemSetter::Quantity(name, set)), Value::Real(number)) => {
                    set(&mut self.circuit, *number);
                    self.given.add(name);
                }
                (
                    Some(SystemSetter::Choice(set)),
                    Value::Integer(number) | Value::Enumeration { value: number, .. },
                ) => set(&mut self.circuit, *number),
                (Some(SystemSetter::Recording), Value::String(name)) => {
                    self.harvester.recording = files.recordings.get(name).cloned();
                }
                (Some(SystemSetter::Table), Value::String(name)) => {
                    self.harvester.table = files.tables.get(name).cloned();
                }
                // `System::new` has refused others, and no value of a variable is of another type than the variable.
                _ => debug_assert!(false, "{} = {value} of type {}", variable.name, value.type_name()),
            }
        }
    }

    /// Those of the circuit, with what follows from the harvester where nothing else was asked for.
    fn settings(&self, times: &Times) -> Result<Settings, CoupledError> {
        let chooses = self.circuit.circuit.release == Release::Storage && !self.given.storage;
        let ratio = if chooses { Impacts::of(self.harvester.setup(), [0.0, times.until])?.best_ratio() } else { 1.0 };
        Ok(self.given.complete(self.circuit, self.harvester.parameters.bias_voltage, ratio))
    }

    fn run(
        &self,
        settings: &Settings,
        times: &Times,
        tracks: &Tracks,
        watch: &mut dyn Watch,
    ) -> Result<videg_coupled::Results, CoupledError> {
        // If the harvester fails, a run says why, so that the reason is the same in any order of runs.
        match tracks.of(&self.harvester, times) {
            Ok(Some(track)) => track.run(settings, watch),
            Ok(None) | Err(_) => videg_coupled::run_watched(self.harvester.setup(), settings, times, watch),
        }
    }
}
