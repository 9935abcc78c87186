//! The state of the slave as bytes. The envelope around them (version, GUID, checksum) is the exporter's.

use fmu_export::{StateError, StateReader, StateWriter};
use videg_model::{Harvester as Model, Parameters, Snapshot};

use crate::harvester::Harvester;

/// Values of the parameters, in the order of the two tables.
type Values = (Vec<f64>, Vec<i32>);

/// External force and its rate, voltages and their rates, and the start time.
type Inputs = ([f64; 2], [f64; 2], [f64; 2], f64);

impl Harvester {
    /// Parameters, inputs and, once it has a state of its own, the model.
    pub(crate) fn write(&self, out: &mut StateWriter) -> Result<(), StateError> {
        let reals = Parameters::TABLE.iter().map(|quantity| (quantity.get)(&self.parameters)).collect();
        let choices = Parameters::CHOICES.iter().map(|choice| (choice.get)(&self.parameters)).collect();
        let values: Values = (reals, choices);
        let force = [self.external_force, self.external_force_rate];
        let inputs: Inputs = (force, self.voltages, self.voltage_rates, self.start_time);
        // Otherwise it follows from the parameters; if they have changed since it was made, it is made anew anyway.
        let model = self.model().filter(|model| *model.parameters() == self.parameters);
        out.put(&(values, inputs, self.placed, model.map(Model::snapshot)))
    }

    /// What [`Harvester::write`] wrote.
    pub(crate) fn read_from(from: &mut StateReader<'_>) -> Result<Self, StateError> {
        let (values, inputs, placed, snapshot): (Values, Inputs, bool, Option<Snapshot>) = from.take()?;
        let parameters = parameters(&values)?;
        let ([external_force, external_force_rate], voltages, voltage_rates, start_time) = finite(inputs)?;
        let mut slave = Self {
            parameters,
            external_force,
            external_force_rate,
            voltages,
            voltage_rates,
            start_time,
            placed,
            checked: [f64::NAN; 2],
            model: Model::new(&Parameters::default(), 0.0),
        };
        slave.model = if let Some(snapshot) = snapshot {
            let restore = if placed { Model::restore_placed } else { Model::restore };
            let restored = restore(&parameters, &snapshot);
            Ok(restored.map_err(|error| StateError::Invalid(error.to_string()))?)
        } else {
            slave.at_start()
        };
        Ok(slave)
    }
}

fn parameters((reals, choices): &Values) -> Result<Parameters, StateError> {
    if (reals.len(), choices.len()) != (Parameters::TABLE.len(), Parameters::CHOICES.len()) {
        return Err(StateError::Invalid("another number of parameters".to_owned()));
    }
    let mut parameters = Parameters::default();
    for (quantity, value) in Parameters::TABLE.iter().zip(reals) {
        (quantity.set)(&mut parameters, *value);
    }
    for (choice, item) in Parameters::CHOICES.iter().zip(choices) {
        (choice.set)(&mut parameters, *item);
        if (choice.get)(&parameters) != *item {
            return Err(StateError::Invalid(format!("{} = {item} is no choice", choice.name)));
        }
    }
    Ok(parameters)
}

/// Values that no Set lets become infinite or NaN.
fn finite(inputs: Inputs) -> Result<Inputs, StateError> {
    let (force, voltages, voltage_rates, start_time) = inputs;
    let mut values = [force, voltages, voltage_rates].into_iter().flatten().chain([start_time]);
    match values.find(|value| !value.is_finite()) {
        Some(value) => Err(StateError::Invalid(format!("an input or the start time is {value}"))),
        None => Ok(inputs),
    }
}
