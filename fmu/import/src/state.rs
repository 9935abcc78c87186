//! Saved states of an instance.

use std::fmt;
use std::rc::Rc;

use super::error::Result;
use super::instance::{Core, Instance};
use super::isolated::LONGEST_STATE;
use super::request::{Request, Results};

/// A saved state, freed on drop. It keeps its instance alive, since only that can free it.
pub struct FmuState {
    core: Rc<Core>,
    /// 0 for none.
    state: u64,
}

impl fmt::Debug for FmuState {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.debug_struct("FmuState").field("instance", &self.core.name()).finish_non_exhaustive()
    }
}

impl Drop for FmuState {
    fn drop(&mut self) {
        if self.state == 0 {
            return;
        }
        // Where the FMU has died, `call` does nothing. A state that cannot be freed is no reason to stop.
        let _ = self.core.done(&Request::FreeState { state: self.state });
    }
}

impl Instance {
    /// Saves the state.
    ///
    /// # Errors
    /// When the FMU does not declare `canGetAndSetFMUstate`, or the call fails.
    pub fn save_state(&self) -> Result<FmuState> {
        let mut state = FmuState { core: Rc::clone(self.core()), state: 0 };
        self.save_state_into(&mut state)?;
        Ok(state)
    }

    /// Saves the state over an older one, whose memory is used again.
    ///
    /// # Errors
    /// As [`Instance::save_state`], and when the older state belongs to another instance.
    pub fn save_state_into(&self, state: &mut FmuState) -> Result<()> {
        let name = "fmi2GetFMUstate";
        self.require_state(name, state)?;
        self.core().call(&Request::GetState { state: state.state }, Results::Number(&mut state.state))
    }

    /// Goes back to a saved state.
    ///
    /// # Errors
    /// As [`Instance::save_state_into`].
    pub fn restore_state(&mut self, state: &FmuState) -> Result<()> {
        let name = "fmi2SetFMUstate";
        self.require_state(name, state)?;
        self.core().done(&Request::SetState { state: state.state })
    }

    /// Turns a saved state into bytes.
    ///
    /// # Errors
    /// When the FMU does not declare `canSerializeFMUstate`, the state is foreign or larger than 256 MiB, or a call
    /// fails.
    pub fn serialize_state(&self, state: &FmuState) -> Result<Vec<u8>> {
        let name = "fmi2SerializeFMUstate";
        self.require_serialization(name)?;
        self.require_own(name, state)?;
        let mut size = 0;
        self.core().call(&Request::StateSize { state: state.state }, Results::Number(&mut size))?;
        let mut bytes = vec![0; self.checked_size(name, size)?];
        self.core().call(&Request::SerializeState { state: state.state, size }, Results::Bytes(&mut bytes))?;
        Ok(bytes)
    }

    /// Makes a saved state from bytes. The bytes are for the FMU to check: pass only what it has serialized.
    ///
    /// # Errors
    /// When the FMU does not declare `canSerializeFMUstate`, there are more than 256 MiB, or it does not take the bytes.
    pub fn deserialize_state(&self, bytes: &[u8]) -> Result<FmuState> {
        let name = "fmi2DeSerializeFMUstate";
        self.require_serialization(name)?;
        self.checked_size(name, bytes.len() as u64)?;
        let mut state = FmuState { core: Rc::clone(self.core()), state: 0 };
        self.core().call(&Request::DeserializeState { bytes: bytes.into() }, Results::Number(&mut state.state))?;
        Ok(state)
    }

    fn require_state(&self, function: &'static str, state: &FmuState) -> Result<()> {
        let supported = self.description().co_simulation.can_get_and_set_fmu_state;
        self.core().require(function, supported, "canGetAndSetFMUstate")?;
        self.require_own(function, state)
    }

    fn require_serialization(&self, function: &'static str) -> Result<()> {
        let supported = self.description().co_simulation.can_serialize_fmu_state;
        self.core().require(function, supported, "canSerializeFMUstate")
    }

    fn checked_size(&self, function: &'static str, size: u64) -> Result<usize> {
        let found = usize::try_from(size).unwrap_or(usize::MAX);
        if found <= LONGEST_STATE {
            return Ok(found);
        }
        Err(self.core().refused(function, format!("a state of {found} bytes, allowed are {LONGEST_STATE}")))
    }

    fn require_own(&self, function: &'static str, state: &FmuState) -> Result<()> {
        if Rc::ptr_eq(self.core(), &state.core) {
            return Ok(());
        }
        let owner = state.core.name();
        Err(self.core().refused(function, format!("the state belongs to another instance, '{owner}'")))
    }
}
