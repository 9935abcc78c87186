//! Saved FMU states. The importer holds a token, never a pointer to memory: a token that was not given out, or was
//! freed, or belongs to another instance is recognised, and no token is ever given out twice.

use super::co_simulation::LastStep;
use super::{Call, Core, Instance};
use crate::call_state::CallState;
use crate::error::CallError;
use crate::serialize::{StateError, StateReader, StateWriter, seal, unseal};
use crate::slave::{Experiment, Slave};
use core::sync::atomic::{AtomicUsize, Ordering};

/// A token that no state in this process has had. Counting is the only thing that instances share; the address of
/// the counter keeps the tokens of different FMUs in one process apart.
fn fresh_token() -> usize {
    static COUNTER: AtomicUsize = AtomicUsize::new(1);
    const ODD: usize = usize::MAX / 13 * 8 + 1; // Golden ratio, so that near addresses end up far apart.
    let base = (&raw const COUNTER).addr().wrapping_mul(ODD);
    loop {
        let token = base.wrapping_add(COUNTER.fetch_add(1, Ordering::Relaxed));
        // NULL means "no state".
        if token != 0 {
            return token;
        }
    }
}

impl<S: Slave> Instance<S> {
    /// `fmi2GetFMUstate`: a new state if `token` is NULL, else that state is overwritten. Returns its token.
    pub(crate) fn save(&mut self, token: usize) -> Call<usize> {
        if token == 0 {
            return Ok(self.keep(self.core.clone()));
        }
        let slot = self.fmu_states.get_mut(&token);
        *slot.ok_or(CallError::UnknownFmuState(token))? = self.core.clone();
        Ok(token)
    }

    /// `fmi2SetFMUstate`
    pub(crate) fn restore(&mut self, token: usize) -> Call {
        self.core = self.saved(token)?.clone();
        Ok(())
    }

    /// `fmi2FreeFMUstate`. NULL is ignored, as the standard has it.
    pub(crate) fn free_state(&mut self, token: usize) -> Call {
        if token == 0 || self.fmu_states.remove(&token).is_some() {
            return Ok(());
        }
        Err(CallError::UnknownFmuState(token))
    }

    /// `fmi2SerializedFMUstateSize` and `fmi2SerializeFMUstate`
    pub(crate) fn serialize(&self, token: usize) -> Call<Vec<u8>> {
        check_serializable::<S>()?;
        let mut out = StateWriter::new();
        self.saved(token)?.write(&mut out);
        Ok(seal(self.guid, &out.into_bytes()))
    }

    /// `fmi2DeSerializeFMUstate`: into a new state if `token` is NULL, else into that one. Returns its token.
    pub(crate) fn deserialize(&mut self, blob: &[u8], token: usize) -> Call<usize> {
        check_serializable::<S>()?;
        let mut content = StateReader::new(unseal(self.guid, blob)?);
        let core = Core::read(&mut content)?;
        content.finish()?;
        if core.exchange != self.core.exchange {
            return Err(StateError::Invalid("it is of an instance of the other interface type".into()).into());
        }
        if token == 0 {
            return Ok(self.keep(core));
        }
        let slot = self.fmu_states.get_mut(&token);
        *slot.ok_or(CallError::UnknownFmuState(token))? = core;
        Ok(token)
    }

    fn keep(&mut self, core: Core<S>) -> usize {
        let token = fresh_token();
        self.fmu_states.insert(token, core);
        token
    }

    fn saved(&self, token: usize) -> Call<&Core<S>> {
        let saved = self.fmu_states.get(&token);
        saved.ok_or(CallError::UnknownFmuState(token))
    }
}

fn check_serializable<S: Slave>() -> Call {
    if S::INFO.can_serialize { Ok(()) } else { Err(CallError::Unsupported("serialised FMU states")) }
}

impl<S: Slave> Core<S> {
    fn write(&self, out: &mut StateWriter) {
        out.u8(self.state as u8);
        out.bool(self.exchange);
        out.f64(self.time);
        out.bool(self.dirty);
        out.bool(self.experiment.is_some());
        if let Some(experiment) = self.experiment {
            out.f64(experiment.start_time);
            out.option_f64(experiment.stop_time);
            out.option_f64(experiment.tolerance);
        }
        out.i32(self.last_step.status);
        out.option_f64(self.last_step.successful_time);
        out.bool(self.last_step.terminated);
        self.model.write_state(out);
    }

    fn read(from: &mut StateReader<'_>) -> Result<Self, StateError> {
        let number = from.u8()?;
        let state =
            CallState::from_number(number).ok_or_else(|| StateError::Invalid(format!("{number} is no call state")))?;
        Ok(Self {
            state,
            exchange: from.bool()?,
            time: from.f64()?,
            dirty: from.bool()?,
            experiment: if from.bool()? {
                Some(Experiment {
                    start_time: from.f64()?,
                    stop_time: from.option_f64()?,
                    tolerance: from.option_f64()?,
                })
            } else {
                None
            },
            last_step: LastStep { status: from.i32()?, successful_time: from.option_f64()?, terminated: from.bool()? },
            model: S::read_state(from)?,
        })
    }
}
