//! The state of an FMU to which the master may go back.

use super::CosimError;
use fmu_import::{FmuState, Instance};

/// Keeps one state of an instance; its memory is used again.
#[derive(Debug, Default)]
pub(super) struct Kept(Option<FmuState>);

impl Kept {
    /// Keeps the present state.
    pub(super) fn save(&mut self, instance: &Instance) -> Result<(), CosimError> {
        match &mut self.0 {
            Some(state) => instance.save_state_into(state)?,
            empty => *empty = Some(instance.save_state()?),
        }
        Ok(())
    }

    /// Goes back to the state kept.
    pub(super) fn restore(&self, instance: &mut Instance) -> Result<(), CosimError> {
        let state = self.0.as_ref().ok_or_else(|| CosimError::NothingKept { instance: instance.name().to_owned() })?;
        Ok(instance.restore_state(state)?)
    }
}
