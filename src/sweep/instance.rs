//! A run as an instance of an FMU.

use fmu_import::{FmiError, Fmu, Instance, Logging, Value, Variable};

use super::Sweep;
use super::plan::{GAINS, Results, Run};
use super::times::Driven;
use crate::cosim::{Gains, set_voltages};

/// Runs an instance and reads `record` at its end. What a sweep of harvester and circuit sets in the circuit is left out.
pub(super) fn run_fmu(fmu: &Fmu, sweep: &Sweep, run: &Run, record: &[Variable]) -> Result<Results, FmiError> {
    let mut instance = fmu.instantiate("sweep", Logging::default())?;
    let settings = sweep.settings.iter().map(|(variable, value)| (variable, value));
    let is_there = |variable: &Variable| fmu.description().variable(&variable.name).is_ok();
    let mut choices: Vec<_> = settings.chain(sweep.assigned(run)).filter(|(variable, _)| is_there(variable)).collect();
    let input = |name| fmu.description().variable(name).ok().filter(|variable| variable.is_input());
    let like = |&(_, bias): &(&Variable, _), name| Some((input(name)?, bias));
    set_voltages(&mut choices, |(variable, _)| &variable.name, like);
    instance.begin_initialization(
        0.0,
        None,
        &choices,
        |(variable, _)| variable.is_input(),
        |instance, (variable, value)| instance.set_value(variable.value_reference, &sweep.files.for_fmu(value)),
    )?;
    instance.exit_initialization_mode()?;
    let mut slave = Slave { instance, has_gains: sweep.averages };
    let end = if record.is_empty() { sweep.times.window[1] } else { sweep.times.until };
    let averages = sweep.times.drive(&mut slave, end)?;
    let recorded = record.iter().map(|variable| slave.instance.get_by_name(&variable.name));
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
