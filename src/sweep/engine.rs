//! Engines compute runs: the model itself, or an FMU.

use videg_model::{Harvester, ModelError, Parameters};

use super::plan::{GAINS, Results, Run};
use super::times::Driven;
use super::{Sweep, SweepError};
use crate::cosim::Gains;
use fmu_import::{FmiError, Fmu, Instance, Kind, Logging, Status, Value, Variable};

/// Computes runs.
pub enum Engine {
    /// The model behind the harvester FMU, without the FMU: the same numbers to the last bit.
    BuiltIn(Box<BuiltIn>),
    /// An FMU; a run is an instance.
    Fmu(Fmu),
}

/// The model with the settings that all runs share.
pub struct BuiltIn {
    parameters: Parameters,
    /// How the varied parameters are set, in their order, and the seed.
    setters: Vec<Setter>,
}

/// How a parameter of the model is set.
#[derive(Clone, Copy)]
enum Setter {
    Quantity(fn(&mut Parameters, f64)),
    Choice(fn(&mut Parameters, i32)),
}

impl Engine {
    /// How many runs may go on at once.
    pub(super) fn at_once(&self, jobs: usize) -> usize {
        match self {
            // Isolated instances have a process each.
            Self::Fmu(fmu) if !fmu.is_isolated() && is_single(fmu) => 1,
            _ => jobs,
        }
    }

    /// Whether the outcome of a run depends on the machine, by limits of time and memory.
    pub(super) fn is_isolated(&self) -> bool {
        matches!(self, Self::Fmu(fmu) if fmu.is_isolated())
    }

    /// Outcome of `run`; the inner error says why it failed, the outer one why no run can be computed any more.
    pub(super) fn run(&self, sweep: &Sweep, run: &Run) -> Result<Result<Results, String>, SweepError> {
        if let Err(error) = sweep.check(run) {
            return Ok(Err(error.to_string()));
        }
        match self {
            Self::BuiltIn(built_in) => {
                Ok(simulate(sweep, &built_in.parameters(run)).map_err(|error| error.to_string()))
            }
            Self::Fmu(fmu) => match run_fmu(fmu, sweep, run) {
                Ok(results) => Ok(Ok(results)),
                Err(error) if is_final(&error, fmu) => Err(error.into()),
                Err(error) => Ok(Err(error.to_string())),
            },
        }
    }
}

fn is_single(fmu: &Fmu) -> bool {
    fmu.description().co_simulation.can_be_instantiated_only_once_per_process
}

/// Whether no instance of the FMU can go on. An isolated instance does not affect others.
fn is_final(error: &FmiError, fmu: &Fmu) -> bool {
    match error {
        FmiError::Dead { .. } | FmiError::Call { status: Status::Fatal, .. } => !fmu.is_isolated(),
        FmiError::Worker { .. } => true,
        _ => false,
    }
}

impl BuiltIn {
    /// The model, if all that `sweep` sets are parameters and it records nothing.
    pub fn new(sweep: &Sweep) -> Option<Self> {
        let settings = sweep.settings.iter().map(|(variable, _)| variable);
        let varied = sweep.points.axes().iter().map(|axis| &axis.variable);
        let varied = varied.chain(sweep.seeds.as_ref().map(|seeds| &seeds.variable));
        let [set, setters] = [settings.map(Setter::of).collect(), varied.map(Setter::of).collect::<Option<Vec<_>>>()];
        let (set, setters) = set.zip(setters).filter(|_| sweep.record.is_empty())?;
        let mut parameters = Parameters::default();
        for (setter, (_, value)) in set.iter().zip(&sweep.settings) {
            setter.set(&mut parameters, value);
        }
        Some(Self { parameters, setters })
    }

    /// The parameters of run number `number` of its `sweep`.
    pub(crate) fn parameters_of(&self, sweep: &Sweep, number: u64) -> Parameters {
        self.parameters(&sweep.run(number))
    }

    /// The parameters of `run`.
    fn parameters(&self, run: &Run) -> Parameters {
        let mut parameters = self.parameters;
        let seed = run.seed.map(Value::Integer);
        for (setter, value) in self.setters.iter().zip(run.values.iter().chain(&seed)) {
            setter.set(&mut parameters, value);
        }
        parameters
    }
}

fn simulate(sweep: &Sweep, parameters: &Parameters) -> Result<Results, ModelError> {
    let mut harvester = Harvester::new(parameters, 0.0)?;
    let averages = sweep.times.drive(&mut harvester, sweep.times.window[1])?;
    Ok(Results { averages, recorded: Vec::new() })
}

impl Setter {
    /// That of `variable`, if it is a parameter whose values are of the parameter's type.
    fn of(variable: &Variable) -> Option<Self> {
        let named = |name: &str| name == variable.name;
        match variable.kind {
            Kind::Real { .. } => Parameters::TABLE.iter().find(|it| named(it.name)).map(|it| Self::Quantity(it.set)),
            Kind::Integer { .. } | Kind::Boolean { .. } | Kind::Enumeration { .. } => {
                Parameters::CHOICES.iter().find(|it| named(it.name)).map(|it| Self::Choice(it.set))
            }
            Kind::String { .. } => None,
        }
    }

    /// Sets a value of the variable's type.
    fn set(self, parameters: &mut Parameters, value: &Value) {
        match (self, value) {
            (Self::Quantity(set), Value::Real(number)) => set(parameters, *number),
            (Self::Choice(set), Value::Integer(number) | Value::Enumeration { value: number, .. }) => {
                set(parameters, *number);
            }
            (Self::Choice(set), Value::Boolean(on)) => set(parameters, i32::from(*on)),
            // No value of a variable is of another type than the variable.
            _ => debug_assert!(false, "{value} is of type {}", value.type_name()),
        }
    }
}

impl Driven for Harvester {
    type Error = ModelError;

    fn step(&mut self, time: f64, step: f64) -> Result<(), ModelError> {
        self.advance(time + step)
    }

    fn gains(&self) -> Result<Gains, ModelError> {
        let totals = self.totals();
        let impacts = i32::try_from(totals.impacts).unwrap_or(i32::MAX);
        Ok(Gains { voltage: totals.voltage_gain, energy: totals.energy, impacts })
    }
}

fn run_fmu(fmu: &Fmu, sweep: &Sweep, run: &Run) -> Result<Results, FmiError> {
    let mut instance = fmu.instantiate("sweep", Logging::default())?;
    let seed = run.seed.map(Value::Integer);
    let settings = sweep.settings.iter().map(|(variable, value)| (variable, value));
    let point = sweep.points.axes().iter().map(|axis| &axis.variable).zip(&run.values);
    let seed = sweep.seeds.iter().map(|seeds| &seeds.variable).zip(&seed);
    let choices: Vec<_> = settings.chain(point).chain(seed).collect();
    instance.begin_initialization(
        0.0,
        None,
        &choices,
        |(variable, _)| variable.is_input(),
        |instance, (variable, value)| instance.set_value(variable.value_reference, &sweep.files.for_fmu(value)),
    )?;
    instance.exit_initialization_mode()?;
    let mut slave = Slave { instance, has_gains: sweep.averages };
    let end = if sweep.record.is_empty() { sweep.times.window[1] } else { sweep.times.until };
    let averages = sweep.times.drive(&mut slave, end)?;
    let recorded = sweep.record.iter().map(|variable| slave.instance.get_by_name(&variable.name));
    let results =
        Results { averages: averages.filter(|_| sweep.averages), recorded: recorded.collect::<Result<_, _>>()? };
    slave.instance.terminate()?;
    slave.instance.free()?;
    Ok(results)
}

struct Slave {
    instance: Instance,
    /// Whether the FMU has the variables [`GAINS`].
    has_gains: bool,
}

impl Driven for Slave {
    type Error = FmiError;

    fn step(&mut self, time: f64, step: f64) -> Result<(), FmiError> {
        self.instance.do_step(time, step)
    }

    fn gains(&self) -> Result<Gains, FmiError> {
        if !self.has_gains {
            return Ok(Gains::default());
        }
        let [voltage, energy, impacts] = GAINS.map(|name| self.instance.get_by_name(name));
        match (voltage?, energy?, impacts?) {
            (Value::Real(voltage), Value::Real(energy), Value::Integer(impacts)) => {
                Ok(Gains { voltage, energy, impacts })
            }
            // The sweep has seen that they are of these types.
            _ => Ok(Gains::default()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_parameter_of_the_model_takes_the_values_of_its_variable() {
        let description = crate::sweep::harvester_description().unwrap();
        let names = Parameters::TABLE.iter().map(|it| it.name).chain(Parameters::CHOICES.iter().map(|it| it.name));
        for name in names {
            assert!(Setter::of(description.variable(name).unwrap()).is_some(), "{name}");
        }
        let mut parameters = Parameters::default();
        for (name, value) in [
            ("membrane.restitution", Value::Real(0.25)),
            ("contact.reaction", Value::Boolean(true)),
            ("excitation.seed", Value::Integer(7)),
        ] {
            Setter::of(description.variable(name).unwrap()).unwrap().set(&mut parameters, &value);
        }
        assert_eq!((parameters.restitution, parameters.reaction, parameters.seed), (0.25, true, 7));
    }
}
