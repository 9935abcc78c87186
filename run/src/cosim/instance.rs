//! Access of the master to an instance of an FMU: references to variables, values, and a state to go back to.

use std::borrow::Cow;

use super::CosimError;
use crate::scenario::Setting;
use fmu_import::{Fmu, FmuState, Instance, Logging};

/// An instance of `fmu` in initialization mode, with `settings` for a run from 0 s to `stop`, s; `value` is that of a setting for the FMU.
pub(super) fn begin(
    fmu: &Fmu,
    name: &str,
    stop: Option<f64>,
    settings: &[Setting],
    value: fn(&Setting) -> Cow<'_, str>,
) -> Result<Instance, CosimError> {
    let mut instance = fmu.instantiate(name, Logging::default())?;
    instance.begin_initialization(
        0.0,
        stop,
        settings,
        |it| fmu.description().is_input(&it.name),
        |instance, setting| {
            let set = instance.set_by_name(&setting.name, &value(setting));
            set.map_err(|cause| CosimError::Refused { place: setting.place(), cause: Box::new(cause) })
        },
    )?;
    Ok(instance)
}

/// References to the variables called `names`.
pub fn references<const N: usize>(fmu: &Fmu, names: [&str; N]) -> Result<[u32; N], CosimError> {
    let mut references = [0; N];
    for (reference, name) in references.iter_mut().zip(names) {
        *reference = fmu.description().variable(name)?.value_reference;
    }
    Ok(references)
}

/// Values of real variables.
pub fn read<const N: usize>(instance: &Instance, references: &[u32; N]) -> Result<[f64; N], CosimError> {
    let mut values = [0.0; N];
    instance.get_real(references, &mut values)?;
    Ok(values)
}

/// A state of an instance. Its memory is used again.
#[derive(Debug, Default)]
pub(super) struct SavedState(Option<FmuState>);

impl SavedState {
    /// Saves the present state in place of the one before.
    pub(super) fn save(&mut self, instance: &Instance) -> Result<(), CosimError> {
        match &mut self.0 {
            Some(state) => instance.save_state_into(state)?,
            empty => *empty = Some(instance.save_state()?),
        }
        Ok(())
    }

    /// Goes back to the state saved.
    pub(super) fn restore(&self, instance: &mut Instance) -> Result<(), CosimError> {
        let state = self.0.as_ref().ok_or_else(|| CosimError::NothingSaved { instance: instance.name().to_owned() })?;
        Ok(instance.restore_state(state)?)
    }
}
