//! Engines compute runs: the model itself, or an FMU.

use videg_model::{Harvester, ModelError, Parameters};

use super::instance::run_fmu;
use super::plan::{Results, Run};
use super::setter::Setter;
use super::system::System;
use super::times::Driven;
use super::{Sweep, SweepError};
use crate::cosim::Gains;
use fmu_import::{FmiError, Fmu, Status, Value, Variable};

/// Computes runs.
pub enum Engine {
    /// The model behind the harvester FMU, without the FMU: the same numbers to the last bit.
    BuiltIn(Box<BuiltIn>),
    /// The same with the embedded circuit.
    System(Box<System>),
    /// An FMU; a run is an instance.
    Fmu(Fmu),
}

/// The model with the settings that all runs share.
pub struct BuiltIn {
    parameters: Parameters,
}

impl Engine {
    /// What computes the runs of a `sweep` of the harvester, with a circuit if it needs one: the model itself, unless it has no such
    /// variables or `fmu_alone`; then the FMU, which `open` opens.
    ///
    /// # Errors
    /// As [`System::new`]; those of `open`.
    pub fn of_harvester<E: From<SweepError>>(
        sweep: &Sweep,
        fmu_alone: bool,
        open: impl FnOnce() -> Result<Fmu, E>,
    ) -> Result<Self, E> {
        if sweep.is_coupled() {
            return Ok(Self::System(Box::new(System::new(sweep, open)?)));
        }
        // The FMU has variables that the model does not offer; the numbers are the same.
        match BuiltIn::new(sweep).filter(|_| !fmu_alone) {
            Some(built_in) => Ok(Self::BuiltIn(Box::new(built_in))),
            None => Ok(Self::Fmu(open()?)),
        }
    }

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
                Ok(simulate(sweep, &built_in.parameters(sweep, run)).map_err(|error| error.to_string()))
            }
            Self::System(system) => Ok(system.run(sweep, run)),
            Self::Fmu(fmu) => match run_fmu(fmu, sweep, run, &sweep.record) {
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
        let is_built_in = sweep.record.is_empty() && sweep.variables().all(|variable| Setter::of(variable).is_some());
        let mut parameters = Parameters::default();
        set(&mut parameters, sweep.settings.iter().map(|(variable, value)| (variable, value)));
        is_built_in.then_some(Self { parameters })
    }

    /// The parameters of run number `number` of its `sweep`.
    pub(crate) fn parameters_of(&self, sweep: &Sweep, number: u64) -> Parameters {
        self.parameters(sweep, &sweep.run(number))
    }

    /// The parameters of `run`.
    fn parameters(&self, sweep: &Sweep, run: &Run) -> Parameters {
        let mut parameters = self.parameters;
        set(&mut parameters, sweep.assigned(run));
        parameters
    }
}

/// Sets those of `values` that are parameters.
fn set<'a>(parameters: &mut Parameters, values: impl Iterator<Item = (&'a Variable, &'a Value)>) {
    for (variable, value) in values {
        if let Some(setter) = Setter::of(variable) {
            setter.set(parameters, value);
        }
    }
}

fn simulate(sweep: &Sweep, parameters: &Parameters) -> Result<Results, ModelError> {
    let mut harvester = Harvester::new(parameters, 0.0)?;
    let averages = sweep.times.drive(&mut harvester, sweep.times.window[1])?;
    Ok(Results { averages, recorded: Vec::new() })
}

impl Driven for Harvester {
    type Error = ModelError;

    fn step(&mut self, time: f64, step: f64) -> Result<(), ModelError> {
        self.advance(time + step)
    }

    fn gains(&self) -> Result<Gains, ModelError> {
        Ok(Gains::from(self.totals()))
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
