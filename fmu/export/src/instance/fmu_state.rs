//! Saving, restoring and serialising FMU states.

use super::co_simulation::LastStep;
use super::lifecycle::fault;
use super::{Call, Core, Instance, Session};
use crate::call_state::CallState;
use crate::error::CallError;
use crate::serialize::{StateError, StateReader, StateWriter, seal, unseal};
use crate::slave::{Experiment, Slave};
use fmu_abi::{fmi2OK, fmi2Pending};

impl<S: Slave> Instance<S> {
    /// `fmi2GetFMUstate`: a new state if `token` is NULL, else that state is overwritten. Returns its token.
    pub(crate) fn save(&mut self, token: usize) -> Call<usize> {
        self.core.save(token)
    }

    /// `fmi2SetFMUstate`
    pub(crate) fn restore(&mut self, token: usize) -> Call {
        self.core.restore(token)
    }

    /// `fmi2FreeFMUstate`. NULL is ignored, as the standard has it.
    pub(crate) fn free_state(&mut self, token: usize) -> Call {
        if token == 0 { Ok(()) } else { self.core.free(token) }
    }

    /// `fmi2SerializedFMUstateSize` and `fmi2SerializeFMUstate`
    pub(crate) fn serialize(&self, token: usize) -> Call<Vec<u8>> {
        check_serializable::<S>()?;
        let mut out = StateWriter::default();
        self.core.saved(token)?.write(&mut out)?;
        Ok(seal(self.guid, &out.into_bytes()))
    }

    /// The same into room for `size` bytes, which `place` makes a place of.
    pub(crate) fn serialize_into<W: FnMut(usize, u8)>(
        &self,
        token: usize,
        size: usize,
        place: impl FnOnce(usize) -> Call<W>,
    ) -> Call {
        let blob = self.serialize(token)?;
        if size < blob.len() {
            let bound = format!("the state takes {} bytes", blob.len());
            return Err(CallError::BadArgument { argument: "size", value: size.to_string(), bound });
        }
        let mut write = place(blob.len())?;
        blob.into_iter().enumerate().for_each(|(k, byte)| write(k, byte));
        Ok(())
    }

    /// `fmi2DeSerializeFMUstate`: into a new state if `token` is NULL, else into that one. Returns its token.
    pub(crate) fn deserialize(&mut self, blob: &[u8], token: usize) -> Call<usize> {
        check_serializable::<S>()?;
        let mut content = StateReader::new(unseal(self.guid, blob)?);
        let core = Core::read(&mut content, &self.core.model, &self.session)?;
        content.finish()?;
        self.core.add(token, core)
    }
}

fn check_serializable<S: Slave>() -> Call {
    if S::INFO.can_serialize { Ok(()) } else { Err(CallError::Unsupported("serialised FMU states")) }
}

impl<S: Slave> Clone for Core<S> {
    fn clone(&self) -> Self {
        Self { model: self.model.clone(), ..*self }
    }

    fn clone_from(&mut self, source: &Self) {
        let Self { ref model, state, exchange, time, experiment, dirty, .. } = *source;
        let Self { last_step, event_time, ticking, states_changed, .. } = *source;
        self.model.clone_from(model);
        (self.state, self.exchange, self.time) = (state, exchange, time);
        (self.experiment, self.dirty, self.last_step) = (experiment, dirty, last_step);
        self.event_time = event_time;
        (self.ticking, self.states_changed) = (ticking, states_changed);
    }
}

/// What the exporter knows about a model, as it is serialised: all of [`Core`] but the model.
type Record = (CallState, bool, [f64; 2], bool, Option<Experiment>, LastStep, [bool; 2]);

impl<S: Slave> Core<S> {
    fn write(&self, out: &mut StateWriter) -> Result<(), StateError> {
        let Self { ref model, state, exchange, time, event_time, experiment, dirty, last_step, .. } = *self;
        let flags = [self.ticking, self.states_changed];
        let record: Record = (state, exchange, [time, event_time], dirty, experiment, last_step, flags);
        out.write(&record)?;
        model.write_state(out)
    }

    fn read(from: &mut StateReader<'_>, present: &S, session: &Session) -> Result<Self, StateError> {
        let (state, exchange, [time, event_time], dirty, experiment, last_step, flags): Record = from.take()?;
        let [ticking, states_changed] = flags;
        let model = S::read_state(from, present)?;
        let core =
            Self { model, state, exchange, time, experiment, dirty, last_step, event_time, ticking, states_changed };
        core.check(session)?;
        Ok(core)
    }

    /// What no call can lead to is refused: a time that is no number compares with none, and so would switch checks of later
    /// calls off.
    fn check(&self, session: &Session) -> Result<(), StateError> {
        let invalid = |text: String| Err(StateError::Invalid(text));
        if self.exchange != session.exchange {
            return invalid("it is of an instance of the other interface type".to_owned());
        }
        if !session.may_be_saved_in(self.state) {
            return invalid(format!("no state that is saved is in state {}", self.state));
        }
        if !self.time.is_finite() {
            return invalid(format!("time = {} s: it must be finite", self.time));
        }
        if self.event_time.is_nan() || self.event_time == f64::INFINITY {
            return invalid(format!("the last event was at {} s: it must be finite", self.event_time));
        }
        if let Some((argument, value, bound)) = self.experiment.as_ref().and_then(fault) {
            return invalid(format!("{argument} = {value}: {bound}"));
        }
        let LastStep { status, successful_time, .. } = self.last_step;
        if let Some(time) = successful_time.filter(|time| !time.is_finite()) {
            return invalid(format!("last successful time = {time} s: it must be finite"));
        }
        if !(fmi2OK..=fmi2Pending).contains(&status) {
            return invalid(format!("{status} is no status of a step"));
        }
        Ok(())
    }
}
