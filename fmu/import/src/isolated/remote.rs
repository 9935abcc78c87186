//! An isolated instance: each function is a message to its worker. What becomes of the worker is an error of the call.

use std::cell::RefCell;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use fmu_abi::{fmi2Fatal, fmi2Status};

use super::bounds::Bounds;
use super::ending::Ending;
use super::process::Process;
use super::protocol::Given;
use crate::component::{Arguments, is_done};
use crate::logging::{Environment, LogRecord};
use crate::request::{Request, Results};
use videg_system::worker::End;

/// Why a call came back with `fmi2Fatal` though the FMU did not say so.
pub(crate) enum Loss {
    /// The process of the instance ended, in this call or an earlier one.
    Ended(Box<Ending>),
    /// It was not called: it had reported a fatal error before.
    Over,
}

/// An instance in a worker.
pub(crate) struct Remote(RefCell<State>);

struct State {
    process: Process,
    path: PathBuf,
    bounds: Bounds,
    name: String,
    environment: Arc<Environment>,
    /// Time that the instance has reached, s.
    time: Option<f64>,
    /// That of its saved states.
    times: HashMap<u64, Option<f64>>,
    fate: Fate,
    /// Whether the last call was not passed on.
    is_refused: bool,
}

/// What has become of an instance.
enum Fate {
    Alive,
    /// It has reported a fatal error, or is freed: no function may be called.
    Over,
    Ended(Box<Ending>),
}

impl Remote {
    /// Makes an instance in a worker; none where the FMU refuses.
    pub(super) fn new(
        process: Process,
        (path, bounds): (&Path, Bounds),
        arguments: &Arguments<'_>,
        environment: &Arc<Environment>,
    ) -> Result<Option<Self>, Box<Ending>> {
        let remote = Self(RefCell::new(State {
            process,
            path: path.to_owned(),
            bounds,
            name: arguments.name.to_string_lossy().into_owned(),
            environment: Arc::clone(environment),
            time: None,
            times: HashMap::new(),
            fate: Fate::Alive,
            is_refused: false,
        }));
        let request = Request::Instantiate {
            name: arguments.name.to_owned(),
            guid: arguments.guid.to_owned(),
            resources: arguments.resources.to_owned(),
            debug: arguments.debug,
        };
        let mut is_made = 0;
        remote.call(&request, Results::Number(&mut is_made));
        match remote.loss() {
            Some(Loss::Ended(ending)) => Err(ending),
            _ => Ok((is_made == 1).then_some(remote)),
        }
    }

    /// Has a call carried out.
    pub fn call(&self, request: &Request<'_>, results: Results<'_>) -> fmi2Status {
        let state = &mut *self.0.borrow_mut();
        let (status, given) = state.call(request);
        if !is_done(status) || given.store(results) {
            return status;
        }
        state.end(request, End::Garbled("something else than the values asked for".to_owned()))
    }

    /// Why the last call was not carried out, if that was not up to the FMU.
    pub fn loss(&self) -> Option<Loss> {
        let state = self.0.borrow();
        match &state.fate {
            Fate::Ended(ending) => Some(Loss::Ended(ending.clone())),
            Fate::Over if state.is_refused => Some(Loss::Over),
            _ => None,
        }
    }

    /// Frees the instance and ends its worker.
    pub fn free(&self) -> Result<(), Box<Ending>> {
        if self.0.borrow().is_alive() {
            self.call(&Request::Free, Results::None);
            self.call(&Request::Unload, Results::None);
        }
        let mut state = self.0.borrow_mut();
        if let Fate::Ended(ending) = &state.fate {
            return Err(ending.clone());
        }
        state.fate = Fate::Over;
        Ok(())
    }
}

impl Drop for Remote {
    fn drop(&mut self) {
        // Nobody is told how it ends.
        let _ = self.free();
    }
}

impl State {
    fn is_alive(&self) -> bool {
        matches!(self.fate, Fate::Alive)
    }

    fn call(&mut self, request: &Request<'_>) -> (fmi2Status, Given) {
        self.is_refused = !self.is_alive();
        if self.is_refused {
            return (fmi2Fatal, Given::Nothing);
        }
        if let Request::DoStep { time, .. } = request {
            self.time = Some(*time);
        }
        let environment = &self.environment;
        let log = |record: LogRecord| environment.take(record.cut());
        match self.process.call(request, self.bounds.time, log) {
            Ok((status, given)) => {
                if status == fmi2Fatal {
                    self.fate = Fate::Over;
                } else if is_done(status) {
                    self.follow(request, &given);
                }
                (status, given)
            }
            Err(how) => (self.end(request, how), Given::Nothing),
        }
    }

    /// Keeps in mind where the instance is after a call.
    fn follow(&mut self, request: &Request<'_>, given: &Given) {
        match (request, given) {
            (Request::SetupExperiment { start, .. }, _) => self.time = Some(*start),
            (Request::DoStep { time, step }, _) => self.time = Some(time + step),
            (Request::Reset, _) => self.time = None,
            (Request::GetState { .. }, Given::Number(state)) => drop(self.times.insert(*state, self.time)),
            (Request::DeserializeState { .. }, Given::Number(state)) => drop(self.times.insert(*state, None)),
            (Request::SetState { state }, _) => self.time = self.times.get(state).copied().flatten(),
            (Request::FreeState { state }, _) => drop(self.times.remove(state)),
            _ => {}
        }
    }

    #[cold]
    fn end(&mut self, request: &Request<'_>, how: End) -> fmi2Status {
        let at = self.time.map_or_else(String::new, |time| format!(" at t = {time} s"));
        self.fate = Fate::Ended(Box::new(Ending {
            path: self.path.clone(),
            call: format!("{} of '{}'{at}", request.function(), self.name),
            how,
            bounds: self.bounds,
            messages: self.environment.last(0),
            printed: self.process.printed(),
        }));
        fmi2Fatal
    }
}
