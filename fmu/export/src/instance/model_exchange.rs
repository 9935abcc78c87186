//! Model exchange: modes, continuous states and what follows from them.

use super::co_simulation::time_tolerance;
use super::values::variable;
use super::{Call, Instance};
use crate::call_state::CallState;
use crate::error::CallError;
use crate::slave::Slave;
use crate::standard::Standard;
use crate::variable::{Kind, Transfer, Variable};

/// The continuous states of a table, in the order of the derivatives in it, each with its derivative.
pub(super) fn states_and_derivatives<M>(table: &[Variable<M>]) -> impl Iterator<Item = (&Variable<M>, &Variable<M>)> {
    let state_of = |row| table.iter().find(|state| Some(state.name()) == Variable::derivative_of(row));
    table.iter().filter_map(move |row| state_of(row).map(|state| (state, row)))
}

/// What one of the arrays of model exchange must count.
fn check_count(argument: &'static str, given: usize, wanted: usize) -> Call {
    if given == wanted {
        return Ok(());
    }
    let bound = format!("this FMU has {wanted}");
    Err(CallError::BadArgument { argument, value: given.to_string(), bound })
}

/// The place of a variable among the continuous states.
fn state_index<S: Slave>(reference: u32) -> Option<usize> {
    let name = variable::<S>(reference).ok()?.name();
    states_and_derivatives(S::variables()).position(|(state, _)| state.name() == name)
}

fn check_states<S: Slave>(states: &[f64]) -> Call {
    for ((state, _), value) in states_and_derivatives(S::variables()).zip(states) {
        if !value.is_finite() {
            let bound = "it must be finite".to_owned();
            return Err(CallError::BadValue { name: state.name(), value: value.to_string(), bound });
        }
    }
    Ok(())
}

fn real<M>(variable: &Variable<M>, model: &M) -> f64 {
    if let Kind::Real(spec) = variable.kind() { spec.get.get(model) } else { f64::NAN }
}

impl<S: Slave> Instance<S> {
    /// `fmi2EnterContinuousTimeMode`
    pub(crate) fn enter_continuous_time_mode(&mut self) -> Call {
        self.update()?;
        self.core.event_time = self.core.time;
        self.leave_event(CallState::ContinuousTimeMode);
        Ok(())
    }

    /// `fmi2SetTime`. A time behind the stop time is taken: integrators that choose their own steps go past the end and
    /// interpolate back. One before the last event is not: what the event did was not yet then. Only a restored state leads back.
    pub(crate) fn set_time(&mut self, time: f64) -> Call {
        if !time.is_finite() {
            return Err(CallError::BadArgument {
                argument: "time",
                value: time.to_string(),
                bound: "it must be finite".into(),
            });
        }
        let event = self.core.event_time;
        if time < event - time_tolerance(time, event, f64::INFINITY) {
            return Err(CallError::BadArgument {
                argument: "time",
                value: format!("{time} s"),
                bound: format!("it must not lie before the last event, at {event} s"),
            });
        }
        self.core.time = time.max(event);
        self.core.dirty = true;
        Ok(())
    }

    /// `fmi2SetReal`, `fmi3SetFloat64`: any other Set, and in continuous-time mode one of the continuous states, too; of FMI 3.0 in
    /// event mode, too, if it does not jump there.
    pub(crate) fn set_reals<T>(&mut self, references: &[u32], values: &[f64]) -> Call
    where
        T: for<'a> Transfer<S, Given<'a> = f64>,
    {
        let (mut states, mut others) = (Vec::new(), (Vec::new(), Vec::new()));
        let between_events = self.core.state == CallState::ContinuousTimeMode;
        let at_event =
            self.core.exchange && self.core.state == CallState::EventMode && self.session.standard == Standard::Fmi3;
        let may_be_placed =
            |reference| between_events || at_event && variable::<S>(reference).is_ok_and(|variable| !variable.reinit());
        for (&reference, &value) in references.iter().zip(values) {
            if let Some(index) = state_index::<S>(reference).filter(|_| may_be_placed(reference)) {
                states.push((index, value));
            } else {
                others.0.push(reference);
                others.1.push(value);
            }
        }
        if states.is_empty() {
            return self.set::<T, _>(references, values, |value| value);
        }
        let mut all = vec![0.0; states_and_derivatives(S::variables()).count()];
        self.get_continuous_states(all.len(), |k, value| all[k] = value)?;
        for (index, value) in states {
            all[index] = value;
        }
        check_states::<S>(&all)?;
        self.set::<T, _>(&others.0, &others.1, |value| value)?;
        self.set_continuous_states(&all)
    }

    /// `fmi2SetContinuousStates`
    pub(crate) fn set_continuous_states(&mut self, states: &[f64]) -> Call {
        check_count("nx", states.len(), states_and_derivatives(S::variables()).count())?;
        check_states::<S>(states)?;
        self.core.dirty = false;
        let time = self.core.time;
        Ok(self.core.model.place(time, Some(states))?)
    }

    /// `fmi2GetContinuousStates`
    pub(crate) fn get_continuous_states(&mut self, count: usize, write: impl FnMut(usize, f64)) -> Call {
        self.write_all(count, |(state, _), model| real(state, model), write)
    }

    /// Number of the continuous states.
    pub(crate) fn state_count() -> usize {
        states_and_derivatives(S::variables()).count()
    }

    /// `fmi2GetDerivatives`
    pub(crate) fn derivatives(&mut self, count: usize, write: impl FnMut(usize, f64)) -> Call {
        self.write_all(count, |(_, derivative), model| real(derivative, model), write)
    }

    /// `fmi2GetNominalsOfContinuousStates`
    pub(crate) fn nominals(&mut self, count: usize, write: impl FnMut(usize, f64)) -> Call {
        let nominal = |variable: &Variable<S>| if let Kind::Real(s) = variable.kind() { s.nominal } else { None };
        self.write_all(count, |(state, _), _| nominal(state).unwrap_or(1.0), write)
    }

    /// `fmi2GetEventIndicators`
    pub(crate) fn event_indicators(&mut self, count: usize, mut write: impl FnMut(usize, f64)) -> Call {
        check_count("ni", count, S::INFO.model_exchange.unwrap_or(0))?;
        self.update()?;
        self.core.model.event_indicators().into_iter().take(count).enumerate().for_each(|(k, value)| write(k, value));
        Ok(())
    }

    /// Something of each continuous state and its derivative.
    fn write_all(
        &mut self,
        count: usize,
        value: impl Fn((&Variable<S>, &Variable<S>), &S) -> f64,
        mut write: impl FnMut(usize, f64),
    ) -> Call {
        check_count("nx", count, states_and_derivatives(S::variables()).count())?;
        self.update()?;
        let pairs = states_and_derivatives(S::variables()).enumerate();
        pairs.for_each(|(k, pair)| write(k, value(pair, &self.core.model)));
        Ok(())
    }
}
