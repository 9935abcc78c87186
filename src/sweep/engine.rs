//! What runs the runs: the model itself, or an FMU.

use videg_model::{Harvester, ModelError, Parameters};

use super::plan::{GAINS, Results, Run};
use super::times::Driven;
use super::{Sweep, SweepError};
use crate::cosim::Gains;
use fmu_import::{FmiError, Fmu, Instance, Logging, Status, Value, Variable};

/// What runs the runs.
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
struct Setter {
    name: &'static str,
    set: Set,
}

#[derive(Clone, Copy)]
enum Set {
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

    /// Whether the outcome of a run hangs on the machine as well: on limits of time and memory.
    pub(super) fn is_isolated(&self) -> bool {
        matches!(self, Self::Fmu(fmu) if fmu.is_isolated())
    }

    /// What `run` comes to; the inner error is why it failed.
    ///
    /// # Errors
    /// If no run can go on.
    pub(super) fn run(&self, sweep: &Sweep, run: &Run) -> Result<Result<Results, String>, SweepError> {
        if let Err(error) = sweep.check(run) {
            return Ok(Err(error.to_string()));
        }
        match self {
            Self::BuiltIn(built_in) => {
                let parameters = built_in.parameters(run)?;
                Ok(simulate(sweep, &parameters).map_err(|error| error.to_string()))
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

/// Whether no instance of the FMU can go on. What becomes of an isolated one concerns no other.
fn is_final(error: &FmiError, fmu: &Fmu) -> bool {
    match error {
        FmiError::Dead { .. } | FmiError::Call { status: Status::Fatal, .. } => !fmu.is_isolated(),
        FmiError::Worker { .. } => true,
        _ => false,
    }
}

impl BuiltIn {
    /// The model, if all that `sweep` sets are parameters and it records nothing.
    ///
    /// # Errors
    /// A parameter that is given a value of another type than the model has it in.
    pub fn new(sweep: &Sweep) -> Result<Option<Self>, SweepError> {
        let settings = sweep.settings.iter().map(|(variable, _)| variable);
        let varied = sweep.points.axes().iter().map(|axis| &axis.variable);
        let varied = varied.chain(sweep.seeds.as_ref().map(|seeds| &seeds.variable));
        let [set, setters] = [settings.map(Setter::of).collect(), varied.map(Setter::of).collect::<Option<Vec<_>>>()];
        let Some((set, setters)) = set.zip(setters).filter(|_| sweep.record.is_empty()) else { return Ok(None) };
        let mut parameters = Parameters::default();
        for (setter, (_, value)) in set.iter().zip(&sweep.settings) {
            setter.set(&mut parameters, value)?;
        }
        Ok(Some(Self { parameters, setters }))
    }

    /// The parameters of `run`.
    fn parameters(&self, run: &Run) -> Result<Parameters, SweepError> {
        let mut parameters = self.parameters;
        let seed = run.seed.map(Value::Integer);
        for (setter, value) in self.setters.iter().zip(run.values.iter().chain(&seed)) {
            setter.set(&mut parameters, value)?;
        }
        Ok(parameters)
    }
}

fn simulate(sweep: &Sweep, parameters: &Parameters) -> Result<Results, ModelError> {
    let mut harvester = Harvester::new(parameters, 0.0)?;
    let averages = sweep.times.drive(&mut harvester, sweep.times.window[1])?;
    Ok(Results { averages, recorded: Vec::new() })
}

impl Setter {
    fn of(variable: &Variable) -> Option<Self> {
        let quantity = Parameters::TABLE.iter().find(|quantity| quantity.name == variable.name);
        let choice = Parameters::CHOICES.iter().find(|choice| choice.name == variable.name);
        let quantity = quantity.map(|quantity| Self { name: quantity.name, set: Set::Quantity(quantity.set) });
        quantity.or(choice.map(|choice| Self { name: choice.name, set: Set::Choice(choice.set) }))
    }

    /// Sets a value of the parameter's type.
    ///
    /// # Errors
    /// A value of another type.
    fn set(self, parameters: &mut Parameters, value: &Value) -> Result<(), SweepError> {
        match (self.set, value) {
            (Set::Quantity(set), Value::Real(number)) => set(parameters, *number),
            (Set::Choice(set), Value::Integer(number) | Value::Enumeration { value: number, .. }) => {
                set(parameters, *number);
            }
            (Set::Choice(set), Value::Boolean(on)) => set(parameters, i32::from(*on)),
            (set, value) => {
                let allowed = match set {
                    Set::Quantity(_) => "Real",
                    Set::Choice(_) => "Integer, Boolean or Enumeration",
                };
                let (name, given) = (self.name, value.type_name());
                return Err(SweepError::Type { name, value: value.to_string(), given, allowed });
            }
        }
        Ok(())
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
        |instance, (variable, value)| instance.set_value(variable.value_reference, value),
    )?;
    instance.exit_initialization_mode()?;
    let gains = if sweep.averages { Some(GainReferences::of(fmu)?) } else { None };
    let mut slave = Slave { instance, gains };
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
    gains: Option<GainReferences>,
}

/// Value references of the sums.
struct GainReferences {
    sums: [u32; 2],
    impacts: u32,
}

impl GainReferences {
    fn of(fmu: &Fmu) -> Result<Self, FmiError> {
        let reference = |name| fmu.description().variable(name).map(|variable| variable.value_reference);
        let [voltage, energy, impacts] = GAINS;
        Ok(Self { sums: [reference(voltage)?, reference(energy)?], impacts: reference(impacts)? })
    }
}

impl Driven for Slave {
    type Error = FmiError;

    fn step(&mut self, time: f64, step: f64) -> Result<(), FmiError> {
        self.instance.do_step(time, step)
    }

    fn gains(&self) -> Result<Gains, FmiError> {
        let Some(GainReferences { sums, impacts }) = &self.gains else { return Ok(Gains::default()) };
        let (mut values, mut count) = ([0.0; 2], [0]);
        self.instance.get_real(sums, &mut values)?;
        self.instance.get_integer(&[*impacts], &mut count)?;
        Ok(Gains { voltage: values[0], energy: values[1], impacts: count[0] })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn set(name: &str, value: &Value) -> Result<Parameters, String> {
        let quantity = Parameters::TABLE.iter().find(|quantity| quantity.name == name);
        let choice = Parameters::CHOICES.iter().find(|choice| choice.name == name);
        let set = quantity.map(|quantity| Set::Quantity(quantity.set)).or(choice.map(|choice| Set::Choice(choice.set)));
        let name = quantity.map(|quantity| quantity.name).or(choice.map(|choice| choice.name)).unwrap();
        let mut parameters = Parameters::default();
        let setter = Setter { name, set: set.unwrap() };
        setter.set(&mut parameters, value).map(|()| parameters).map_err(|error| error.to_string())
    }

    #[test]
    fn a_parameter_takes_values_of_its_own_type_and_refuses_others_by_name() {
        assert_eq!(set("membrane.restitution", &Value::Real(0.25)).unwrap().restitution, 0.25);
        assert!(set("contact.reaction", &Value::Boolean(true)).unwrap().reaction);
        assert_eq!(set("excitation.seed", &Value::Integer(7)).unwrap().seed, 7);
        assert_eq!(
            set("membrane.restitution", &Value::Integer(1)).unwrap_err(),
            "membrane.restitution = 1 is of type Integer; allowed: Real"
        );
        assert_eq!(
            set("excitation.seed", &Value::Real(1.5)).unwrap_err(),
            "excitation.seed = 1.5 is of type Real; allowed: Integer, Boolean or Enumeration"
        );
    }
}
