//! Event mode: of model exchange, and in FMI 3.0 of co-simulation, with its clocks.

use super::values::variable;
use super::{Call, Instance};
use crate::call_state::CallState;
use crate::error::CallError;
use crate::slave::{EventOutcome, Slave};
use crate::standard::Standard;
use crate::variable::{Causality, ClockInterval, ClockSpec, Kind, Variable};

impl<S: Slave> Instance<S> {
    /// `fmi2EnterEventMode`, `fmi3EnterEventMode`. What model exchange of FMI 3.0 reads in event mode is what comes after the
    /// event, the clocks among it; FMI 2.0 has that from `fmi2NewDiscreteStates` on.
    pub(crate) fn enter_event_mode(&mut self) -> Call {
        if !self.core.exchange && !self.session.event_mode {
            return Err(CallError::Unsupported(
                "event mode in an instance that was made with eventModeUsed = fmi3False",
            ));
        }
        self.update()?;
        self.core.state = CallState::EventMode;
        if self.core.exchange && self.session.standard == Standard::Fmi3 {
            self.core.ticking = true;
            self.core.states_changed |= self.core.model.handle_events(&self.logger)?.states_changed;
        }
        Ok(())
    }

    /// `fmi2NewDiscreteStates`, `fmi3UpdateDiscreteStates`
    pub(crate) fn new_discrete_states(&mut self) -> Call<EventOutcome> {
        self.update()?;
        let mut outcome = self.core.model.handle_events(&self.logger)?;
        outcome.states_changed |= core::mem::take(&mut self.core.states_changed);
        self.stop_clocks();
        Ok(outcome)
    }

    /// `fmi3EnterStepMode`
    pub(crate) fn enter_step_mode(&mut self) {
        self.leave_event(CallState::StepMode);
    }

    pub(super) fn leave_event(&mut self, state: CallState) {
        self.stop_clocks();
        self.core.state = state;
    }

    /// No clock ticks any more.
    fn stop_clocks(&mut self) {
        if self.session.standard == Standard::Fmi2 {
            return;
        }
        self.core.ticking = false;
        for variable in S::variables() {
            if let Kind::Clock(ClockSpec { set: Some(set), .. }) = variable.kind() {
                set.set(&mut self.core.model, false);
            }
        }
    }

    /// `fmi3GetClock`
    pub(crate) fn get_clocks(&mut self, references: &[u32], mut write: impl FnMut(usize, bool)) -> Call {
        self.update()?;
        for (k, &reference) in references.iter().enumerate() {
            let (variable, clock) = self.clock(reference)?;
            let may_tick = self.core.ticking || variable.causality() == Causality::Input;
            write(k, may_tick && clock.get.get(&self.core.model));
        }
        Ok(())
    }

    /// `fmi3SetClock`, all or nothing. An input clock that ticks cannot be taken back: no description says `canBeDeactivated`.
    pub(crate) fn set_clocks(&mut self, references: &[u32], values: &[bool]) -> Call {
        let mut checked = Vec::with_capacity(references.len());
        for (&reference, &ticks) in references.iter().zip(values) {
            let (variable, clock) = self.clock(reference)?;
            let refuse = |bound: &str| CallError::BadValue {
                name: variable.name(),
                value: if ticks { "active" } else { "inactive" }.to_owned(),
                bound: bound.to_owned(),
            };
            let set = clock.set.ok_or_else(|| refuse("an output clock ticks by itself"))?;
            if !ticks && clock.get.get(&self.core.model) {
                return Err(refuse("it ticks, and cannot be deactivated before the event is over"));
            }
            checked.push((set, ticks));
        }
        for (set, ticks) in checked {
            set.set(&mut self.core.model, ticks);
        }
        Ok(())
    }

    /// `fmi3GetIntervalDecimal` and `fmi3GetShiftDecimal`: interval and shift of a periodic clock, s.
    pub(crate) fn get_intervals(&self, references: &[u32], mut write: impl FnMut(usize, [f64; 2])) -> Call {
        for (k, &reference) in references.iter().enumerate() {
            let (variable, clock) = self.clock(reference)?;
            let ClockInterval::Periodic { interval, shift } = clock.interval else {
                return Err(CallError::BadValue {
                    name: variable.name(),
                    value: "interval and shift".to_owned(),
                    bound: "this clock is triggered and has neither".to_owned(),
                });
            };
            write(k, [interval, shift]);
        }
        Ok(())
    }

    fn clock(&self, reference: u32) -> Call<(&'static Variable<S>, &'static ClockSpec<S>)> {
        let variable = variable::<S>(reference)?;
        match variable.kind() {
            Kind::Clock(spec) => Ok((variable, spec)),
            _ => Err(self.wrong_type(reference, "Clock")),
        }
    }
}
