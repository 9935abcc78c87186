//! Steps of FMI 3.0: they may stop at events, and the importer may look at intermediate values.
//!
//! The callback for these is not called here, where the instance is borrowed: a step says that it wants one, and goes on when
//! `ffi` calls again.

use super::{Call, Instance};
use crate::call_state::CallState;
use crate::error::{CallError, Severity, SlaveError};
use crate::slave::{Slave, Stop};
use crate::standard::Standard;
use fmu_abi::fmi3::{fmi3InstanceEnvironment, fmi3IntermediateUpdateCallback};

/// How an instance was made.
#[derive(Debug)]
pub(crate) struct Session {
    pub(crate) standard: Standard,
    /// Model exchange, not co-simulation.
    pub(crate) exchange: bool,
    /// The importer of co-simulation handles events.
    pub(crate) event_mode: bool,
    /// A step may end before its end.
    pub(crate) early_return: bool,
    /// What the importer may read within a step.
    pub(crate) intermediate: Vec<u32>,
    pub(crate) intermediate_update: fmi3IntermediateUpdateCallback,
    pub(crate) environment: fmi3InstanceEnvironment,
}

impl Session {
    /// One without events and intermediate values.
    pub(crate) const fn new(standard: Standard, exchange: bool) -> Self {
        Self {
            standard,
            exchange,
            event_mode: false,
            early_return: false,
            intermediate: Vec::new(),
            intermediate_update: None,
            environment: core::ptr::null_mut(),
        }
    }

    /// The state after initialisation.
    pub(super) const fn first_state(&self) -> CallState {
        match self.standard {
            _ if self.exchange || self.event_mode => CallState::EventMode,
            Standard::Fmi2 => CallState::StepComplete,
            Standard::Fmi3 => CallState::StepMode,
        }
    }

    /// Whether an instance that can be saved is ever in this state.
    pub(super) fn may_be_saved_in(&self, state: CallState) -> bool {
        use CallState as S;
        let of_2 = self.standard == Standard::Fmi2;
        match state {
            S::StepInProgress | S::StepCanceled | S::Fatal | S::IntermediateUpdateMode => false,
            S::StepComplete | S::StepFailed => of_2 && !self.exchange,
            S::StepMode => !of_2 && !self.exchange,
            S::Error => of_2,
            S::EventMode => self.exchange || self.event_mode,
            S::ContinuousTimeMode => self.exchange,
            S::Instantiated | S::InitializationMode | S::Terminated => true,
        }
    }

    pub(super) fn is_intermediate(&self, reference: u32) -> bool {
        self.intermediate.contains(&reference)
    }

    /// Whether steps are to stop at events.
    pub(crate) const fn wants_events(&self) -> bool {
        self.event_mode || self.early_return || self.intermediate_update.is_some()
    }
}

/// A step that is not at its end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct UnderWay {
    start: f64,
    /// Where it is.
    at: f64,
    /// Where it would end.
    end: f64,
    had_event: bool,
    /// The last point is one where it may stop.
    may_stop: bool,
}

impl UnderWay {
    const fn new(start: f64, end: f64) -> Self {
        Self { start, at: start, end, had_event: false, may_stop: false }
    }

    /// Where it is, s.
    pub(crate) const fn time(&self) -> f64 {
        self.at
    }
}

/// What a step has come to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Progress {
    /// The importer may look, where this step is; it is resumed after that.
    Update(UnderWay),
    Ended(StepOutcome),
}

/// How a step ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct StepOutcome {
    pub(crate) event: bool,
    pub(crate) terminate: bool,
    pub(crate) early: bool,
    /// Time that was reached, s.
    pub(crate) time: f64,
}

impl<S: Slave> Instance<S> {
    /// `fmi3DoStep` of an importer that wants no events; `show` takes the outcome.
    #[inline]
    pub(crate) fn step_through(&mut self, t: f64, h: f64, show: impl FnOnce(StepOutcome)) -> Call {
        self.check_step(t, h)?;
        let core = &mut *self.core;
        let outcome = match core.model.do_step(t, h, &self.logger) {
            Ok(()) => {
                core.time = t + h;
                StepOutcome { event: false, terminate: false, early: false, time: t + h }
            }
            Err(error) => self.stopped(&error, UnderWay::new(t, t + h))?,
        };
        show(outcome);
        Ok(())
    }

    /// `fmi3DoStep` of others, up to its end or to the first point where the importer may look.
    #[inline(never)]
    pub(crate) fn begin_step(&mut self, t: f64, h: f64) -> Call<Progress> {
        self.check_step(t, h)?;
        self.go_on(UnderWay::new(t, t + h))
    }

    /// Goes on with `step`, after the importer has looked. One that may end early does so wherever there is something to look at,
    /// whether it is asked to or not.
    pub(crate) fn resume_step(&mut self, step: UnderWay) -> Call<Progress> {
        if self.core.state != CallState::IntermediateUpdateMode {
            return Err(CallError::Unsupported("a step whose instance failed within intermediateUpdate"));
        }
        self.core.state = CallState::StepMode;
        if self.is_over(step) { Ok(Progress::Ended(self.outcome(step))) } else { self.go_on(step) }
    }

    /// From point to point.
    fn go_on(&mut self, mut step: UnderWay) -> Call<Progress> {
        loop {
            let stop = match self.core.model.do_step_to_event(step.at, step.end, &self.logger) {
                Ok(stop) => stop,
                Err(error) => return self.stopped(&error, step).map(Progress::Ended),
            };
            step.at = stop.map_or(step.end, |stop: Stop| stop.time.min(step.end));
            step.had_event |= stop.is_some_and(|stop| stop.is_event);
            step.may_stop = stop.is_some();
            (self.core.time, self.core.ticking) = (step.at, step.had_event);
            if self.session.intermediate_update.is_some() {
                self.core.state = CallState::IntermediateUpdateMode;
                return Ok(Progress::Update(step));
            }
            if self.is_over(step) {
                return Ok(Progress::Ended(self.outcome(step)));
            }
        }
    }

    /// Whether a step ends where it is.
    const fn is_over(&self, step: UnderWay) -> bool {
        step.at >= step.end || step.may_stop && self.session.early_return
    }

    /// Of a step that ends where it is.
    const fn outcome(&self, step: UnderWay) -> StepOutcome {
        let event = step.had_event && self.session.event_mode;
        StepOutcome { event, terminate: false, early: step.at < step.end, time: step.at }
    }

    /// A step that its model ended. It may ask for the end of the simulation, and it may have gone a part of the way; a step that is
    /// discarded as a whole leaves all as it was.
    #[cold]
    fn stopped(&mut self, error: &SlaveError, step: UnderWay) -> Call<StepOutcome> {
        let UnderWay { start, at, end, .. } = step;
        let time = error.last_successful_time().unwrap_or(at).max(at).min(end);
        if error.wants_to_terminate() {
            self.logger.event(error);
            self.core.time = time;
            let early = time < end && self.session.early_return;
            return Ok(StepOutcome { event: false, terminate: true, early, time });
        }
        if error.severity() != Severity::Discard || time == start {
            return Err(CallError::Slave(error.clone()));
        }
        if !self.session.early_return {
            let message =
                format!("{error}; the step was done up to {time} s, and this importer takes no part of a step");
            return Err(SlaveError::error(message).into());
        }
        self.logger.event(error);
        self.core.time = time;
        Ok(self.outcome(UnderWay { at: time, ..step }))
    }
}
