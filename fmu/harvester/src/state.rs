//! The state of the slave as bytes. The envelope around them (version, GUID, checksum) is the exporter's.

use fmu_export::{Slave, StateError, StateReader, StateWriter};
use videg_model::{Harvester as Model, Snapshot};

use crate::harvester::Harvester;

/// External force and its rate, voltages and their rates, and the start time.
type Inputs = ([f64; 2], [f64; 2], [f64; 2], f64);

impl Harvester {
    /// Parameters, inputs and, once it has a state of its own, the model.
    pub(crate) fn write(&self, out: &mut StateWriter) -> Result<(), StateError> {
        let force = [self.external_force, self.external_force_rate];
        let inputs: Inputs = (force, self.voltages, self.voltage_rates, self.start_time);
        // Otherwise it follows from the parameters; if they have changed since it was made, it is made anew anyway.
        let model = self.model().filter(|model| *model.parameters() == self.parameters);
        out.write_parameters(self)?;
        out.write(&(inputs, self.placed, model.map(Model::snapshot)))
    }

    /// What [`Harvester::write`] wrote.
    pub(crate) fn read_from(from: &mut StateReader<'_>) -> Result<Self, StateError> {
        let mut slave = Self::new();
        from.read_parameters(&mut slave)?;
        let (inputs, placed, snapshot): (Inputs, bool, Option<Snapshot>) = from.take()?;
        let (force, voltages, voltage_rates, start_time) = inputs;
        // No Set lets these become infinite or NaN.
        let mut values = [force, voltages, voltage_rates].into_iter().flatten().chain([start_time]);
        if let Some(value) = values.find(|value| !value.is_finite()) {
            return Err(StateError::Invalid(format!("an input or the start time is {value}")));
        }
        [slave.external_force, slave.external_force_rate] = force;
        (slave.voltages, slave.voltage_rates, slave.start_time) = (voltages, voltage_rates, start_time);
        slave.placed = placed;
        slave.model = if let Some(snapshot) = snapshot {
            let p = &slave.parameters;
            let restored = if placed { Model::restore_placed(p, &snapshot) } else { Model::restore(p, &snapshot) };
            Ok(restored.map_err(|error| StateError::Invalid(error.to_string()))?)
        } else {
            slave.at_start()
        };
        Ok(slave)
    }
}
