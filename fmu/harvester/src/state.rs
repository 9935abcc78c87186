//! The state of the slave as bytes. The envelope around them (version, GUID, checksum) is the exporter's.

use std::sync::Arc;

use fmu_export::{Slave, StateError, StateReader, StateWriter};
use videg_model::{ForceTable, Harvester as Model, ModelError, Recording, Side, Snapshot};

use crate::file::Loaded;
use crate::harvester::Harvester;

/// External force and its rate, voltages and their rates, and the start time.
type Inputs = ([f64; 2], [f64; 2], [f64; 2], f64);

/// The last impact, whether it was on the right membrane and its speed, and whether it is of the present time.
type Hit = (Option<(bool, f64)>, bool);

impl Harvester {
    /// Parameters, inputs and, once it has a state of its own, the model.
    pub(crate) fn write(&self, out: &mut StateWriter) -> Result<(), StateError> {
        let force = [self.external_force, self.external_force_rate];
        let inputs: Inputs = (force, self.voltages, self.voltage_rates, self.start_time);
        // Otherwise it follows from the parameters; if they have changed since it was made, it is made anew anyway.
        let is_present = |model: &&Model| self.files.are_read() && *model.parameters() == self.parameters;
        let model = self.model().filter(is_present);
        out.write_parameters(self)?;
        let origin = model.and_then(Model::origin).map(Model::snapshot);
        let hit = (self.last_impact.map(|(side, speed)| (side == Side::Right, speed)), self.has_hit);
        out.write(&(inputs, self.placed, hit, model.map(Model::snapshot), origin))
    }

    /// What [`Harvester::write`] wrote, for the instance of `present`.
    pub(crate) fn read_from(from: &mut StateReader<'_>, present: &Self) -> Result<Self, StateError> {
        let mut slave = Self { files: Arc::new(present.files.unnamed()), ..Self::new() };
        from.read_parameters(&mut slave)?;
        let (inputs, placed, hit, snapshot, origin): (Inputs, bool, Hit, Option<Snapshot>, Option<Snapshot>) =
            from.take()?;
        let (force, voltages, voltage_rates, start_time) = inputs;
        // No Set lets these become infinite or NaN.
        let mut values = [force, voltages, voltage_rates].into_iter().flatten().chain([start_time]);
        if let Some(value) = values.find(|value| !value.is_finite()) {
            return Err(StateError::Invalid(format!("an input or the start time is {value}")));
        }
        [slave.external_force, slave.external_force_rate] = force;
        (slave.voltages, slave.voltage_rates, slave.start_time) = (voltages, voltage_rates, start_time);
        slave.placed = placed;
        let side = |right| if right { Side::Right } else { Side::Left };
        (slave.last_impact, slave.has_hit) = (hit.0.map(|(right, speed)| (side(right), speed)), hit.1);
        if let Some((_, speed)) = slave.last_impact.filter(|(_, speed)| !(speed.is_finite() && *speed >= 0.0)) {
            return Err(StateError::Invalid(format!("the speed of the last impact is {speed}")));
        }
        slave.read_files();
        slave.model = match snapshot {
            Some(snapshot) => Ok(slave.restored(&snapshot).map_err(StateError::Invalid)?),
            None => slave.at_start(),
        };
        if let Some(origin) = origin.filter(|_| !placed) {
            let origin = slave.restored(&origin).map_err(StateError::Invalid)?;
            if let Ok(model) = &mut slave.model {
                model.set_origin(origin).map_err(|error| StateError::Invalid(error.to_string()))?;
            }
        }
        Ok(slave)
    }

    /// The model of `snapshot`. The bytes of a state name its files and have nothing of what is in them. If what is in memory is
    /// something else, they are read again.
    fn restored(&mut self, snapshot: &Snapshot) -> Result<Model, String> {
        let mut restored = self.restored_with(snapshot)?;
        if matches!(restored, Err(ModelError::OtherRecording)) {
            Arc::make_mut(&mut self.files).read_recording();
            restored = self.restored_with(snapshot)?;
        }
        if matches!(restored, Err(ModelError::OtherTable)) {
            Arc::make_mut(&mut self.files).read_table();
            restored = self.restored_with(snapshot)?;
        }
        restored.map_err(|error| match error {
            ModelError::OtherRecording => Loaded::<Recording>::named(&self.files.excitation, error),
            ModelError::OtherTable => Loaded::<ForceTable>::named(&self.files.membrane, error),
            _ => error.to_string(),
        })
    }

    /// The same with what is in memory.
    fn restored_with(&self, snapshot: &Snapshot) -> Result<Result<Model, ModelError>, String> {
        let setup = self.setup()?;
        Ok(if self.placed { Model::restore_placed(setup, snapshot) } else { Model::restore(setup, snapshot) })
    }
}
