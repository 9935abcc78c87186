//! One instance of a slave behind the C interface, in safe Rust. The functions of `ffi` translate pointers and
//! call one function here; this module guards panics, keeps the call state and turns errors into statuses.

mod co_simulation;
mod cores;
mod derivatives;
mod events;
mod fmu_state;
mod lifecycle;
mod model_exchange;
mod stepping;
mod values;

use crate::call_state::{CallState, Function, Interface, Legality, Row};
use crate::error::CallError;
use crate::guid::Guid;
use crate::logger::Logger;
use crate::panics::{guard, panic_message};
use crate::slave::{Experiment, Slave};
use crate::standard::Standard;
use co_simulation::LastStep;
use cores::Cores;
use fmu_abi::{fmi2Error, fmi2Fatal, fmi2OK, fmi2Status, fmi2Warning};
use std::ffi::CString;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
pub(crate) use stepping::{Progress, Session, StepOutcome, UnderWay};

/// Outcome of a call.
pub(crate) type Call<T = ()> = Result<T, CallError>;

/// All that an FMU state holds: the model and what the exporter knows about it.
#[allow(clippy::struct_excessive_bools)] // each a fact of its own
pub(crate) struct Core<S> {
    model: S,
    state: CallState,
    /// Model exchange, not co-simulation.
    exchange: bool,
    /// End of the last step, s.
    time: f64,
    experiment: Option<Experiment>,
    /// Something was set since calculated values were brought up to date.
    dirty: bool,
    last_step: LastStep,
    /// Model exchange: when event mode was left last, s.
    event_time: f64,
    /// FMI 3.0: an event has happened at the present time, and output clocks may tick.
    ticking: bool,
    /// FMI 3.0, model exchange: that event has changed continuous states, which nobody has been told yet.
    states_changed: bool,
}

/// An instance of a slave.
pub(crate) struct Instance<S: Slave> {
    core: Cores<S>,
    session: Session,
    logger: Logger,
    guid: Guid,
    /// Folder `resources` of the unpacked FMU.
    resources: Option<PathBuf>,
    /// Results of the last `fmi2GetString`.
    strings: Vec<CString>,
}

impl<S: Slave> Core<S> {
    /// A fresh model with its start values.
    fn new(exchange: bool, resources: Option<&Path>) -> Self {
        let mut model = S::new();
        if let Some(folder) = resources {
            model.set_resources(folder);
        }
        for variable in S::variables() {
            variable.kind().apply_start(&mut model);
        }
        Self {
            model,
            state: CallState::Instantiated,
            exchange,
            time: 0.0,
            experiment: None,
            dirty: true,
            last_step: LastStep::NONE,
            event_time: f64::NEG_INFINITY,
            ticking: false,
            states_changed: false,
        }
    }
}

impl<S: Slave> Instance<S> {
    /// A fresh instance.
    pub(crate) fn new(session: Session, resources: Option<PathBuf>, logger: Logger, guid: Guid) -> Self {
        let core = Cores::new(Core::new(session.exchange, resources.as_deref()));
        Self { core, session, logger, guid, resources, strings: Vec::new() }
    }

    /// How it was made.
    pub(crate) const fn session(&self) -> &Session {
        &self.session
    }

    /// `fmi2FreeInstance`. Each model is dropped behind a guard of its own: a second panic while the first unwinds would
    /// end the process.
    pub(crate) fn free(self) {
        let Self { core, logger, session, .. } = self;
        let name = match session.standard {
            Standard::Fmi2 => Function::FreeInstance.name(),
            Standard::Fmi3 => crate::fmi3::Function::FreeInstance.name(),
        };
        for core in core.into_all() {
            if let Err(payload) = catch_unwind(AssertUnwindSafe(|| drop(core))) {
                let error = CallError::Panic(panic_message(payload));
                logger.status(fmi2Error, format_args!("{name}: {error}"));
            }
        }
    }

    /// Runs one C function: state check and the call itself behind a panic guard, then status, log and new state.
    #[inline]
    pub(crate) fn run(&mut self, function: Row, call: impl FnOnce(&mut Self) -> Call) -> fmi2Status {
        self.guarded(function.name, |i| {
            i.check_state(function)?;
            i.core.model.on_call(function.name);
            call(i)
        })
    }

    /// The same without the state check.
    #[inline]
    pub(crate) fn guarded(&mut self, name: &'static str, call: impl FnOnce(&mut Self) -> Call) -> fmi2Status {
        // A model that panicked may be inconsistent. That is safe: it goes to the error state, in which its
        // values are for debugging only and from which restoring a state or a reset replaces it.
        let result = catch_unwind(AssertUnwindSafe(|| {
            call(self).map_err(Box::new) // so that there is little to hand on
        }));
        match result {
            Ok(Ok(())) if self.logger.take_warned() => fmi2Warning,
            Ok(Ok(())) => fmi2OK,
            Ok(Err(error)) => self.fail(name, &error),
            Err(payload) => self.fail(name, &CallError::Panic(panic_message(payload))),
        }
    }

    #[inline]
    fn check_state(&self, function: Row) -> Call {
        let state = self.core.state;
        let interface = if self.core.exchange { Interface::ModelExchange } else { Interface::CoSimulation };
        match function.legality(interface, state) {
            Legality::Legal => Ok(()),
            Legality::Tolerated => {
                let (name, standard) = (function.name, self.session.standard);
                self.logger.tolerated(format_args!("{name}: {standard} forbids it in state {state}; tolerated"));
                Ok(())
            }
            Legality::Illegal => Err(CallError::IllegalState { state, legal: function.legal_states(interface) }),
        }
    }

    /// Any error leaves the instance in the error state, as FMI 2.0 has it: "the simulation cannot be continued"; in FMI 3.0 it is
    /// terminated. Nothing leads out of the fatal state.
    #[cold]
    fn fail(&mut self, name: &str, error: &CallError) -> fmi2Status {
        let status = if self.core.state == CallState::Fatal { fmi2Fatal } else { error.status() };
        self.logger.take_warned();
        guard((), || self.logger.status(status, format_args!("{name}: {error}")));
        let state = match status {
            fmi2Error if self.session.standard == Standard::Fmi3 => CallState::Terminated,
            fmi2Error => CallState::Error,
            fmi2Fatal => CallState::Fatal,
            _ => return status,
        };
        // A saved state that is the present one and cannot be copied is lost; then nothing is to be copied any more.
        guard((), || self.core.settle());
        self.core.state = state;
        status
    }

    /// Brings calculated values up to date, if something was set and initialisation is still ahead. In model exchange,
    /// values follow time and inputs afterwards, too.
    fn update(&mut self) -> Call {
        if !self.core.dirty {
            return Ok(());
        }
        if self.core.state.is_before_initialization() {
            self.core.model.update();
            self.core.dirty = false;
        } else if self.core.exchange && matches!(self.core.state, CallState::EventMode | CallState::ContinuousTimeMode)
        {
            let time = self.core.time;
            self.core.model.place(time, None)?;
            self.core.dirty = false;
        }
        Ok(())
    }
}
