//! What stands behind the component of an isolated instance: its worker, and what has become of it.

use std::collections::HashMap;
use std::ffi::c_char;
use std::path::{Path, PathBuf};
use std::ptr;
use std::sync::Arc;

use fmu_abi::{fmi2Component, fmi2Fatal, fmi2OK, fmi2Status, fmi2Warning};

use super::Bounds;
use super::ending::{Ending, How};
use super::process::Process;
use super::protocol::{Given, Plain, Request, Texts};
use crate::logging::{Environment, LogRecord};

/// An instance in a worker.
pub(super) struct Remote {
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
    /// The Strings that the last call gave.
    texts: Texts,
}

/// What has become of an instance.
enum Fate {
    Alive,
    /// It has reported a fatal error, or is freed: no function may be called.
    Over,
    Ended(Box<Ending>),
}

/// Why a call came back with `fmi2Fatal` though the FMU did not say so.
pub(crate) enum Verdict {
    /// Its worker ended, in this call or an earlier one.
    Ended(Box<Ending>),
    /// It was not called: it had reported a fatal error before.
    Over,
}

/// The verdict on the last call of an isolated instance, if there is one.
///
/// # Safety
/// `component` is that of a living isolated instance.
pub(crate) unsafe fn verdict(component: fmi2Component) -> Option<Verdict> {
    // SAFETY: as the caller promises.
    let remote = unsafe { of(component) };
    match &remote.fate {
        Fate::Ended(ending) => Some(Verdict::Ended(ending.clone())),
        Fate::Over if remote.is_refused => Some(Verdict::Over),
        _ => None,
    }
}

impl Remote {
    pub fn new(process: Process, path: &Path, bounds: Bounds, name: String, environment: Arc<Environment>) -> Self {
        let (path, time, times, texts) = (path.to_owned(), None, HashMap::new(), Texts::default());
        Self { process, path, bounds, name, environment, time, times, fate: Fate::Alive, is_refused: false, texts }
    }

    /// The component, or NULL where the FMU refuses.
    pub fn instantiate(mut self, request: &Request) -> Result<fmi2Component, Box<Ending>> {
        let (_, given) = self.call("fmi2Instantiate", request);
        match self.fate {
            Fate::Ended(ending) => Err(ending),
            _ if given == Given::Number(1) => Ok(Box::into_raw(Box::new(self)).cast()),
            _ => Ok(ptr::null_mut()),
        }
    }

    /// Passes a call on; the status, and what the function gave.
    pub fn call(&mut self, function: &str, request: &Request) -> (fmi2Status, Given) {
        self.is_refused = !matches!(self.fate, Fate::Alive);
        if self.is_refused {
            return (fmi2Fatal, Given::Nothing);
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
            Err(how) => (self.end(function, how), Given::Nothing),
        }
    }

    /// Keeps in mind where the instance is after a call.
    fn follow(&mut self, request: &Request, given: &Given) {
        match (request, given) {
            (Request::SetupExperiment { start, .. }, _) => self.time = Some(*start),
            (Request::DoStep { time, step, .. }, _) => self.time = Some(time + step),
            (Request::Plain(Plain::Reset), _) => self.time = None,
            (Request::GetState { .. }, Given::Number(state)) => drop(self.times.insert(*state, self.time)),
            (Request::DeserializeState { .. }, Given::Number(state)) => drop(self.times.insert(*state, None)),
            (Request::SetState { state }, _) => self.time = self.times.get(state).copied().flatten(),
            (Request::FreeState { state }, _) => drop(self.times.remove(state)),
            _ => {}
        }
    }

    /// As [`Remote::call`] for functions that give a status only.
    pub fn plain(&mut self, function: &str, request: &Request) -> fmi2Status {
        self.call(function, request).0
    }

    #[cold]
    fn end(&mut self, function: &str, how: How) -> fmi2Status {
        let at = self.time.map_or_else(String::new, |time| format!(" at t = {time} s"));
        self.fate = Fate::Ended(Box::new(Ending {
            path: self.path.clone(),
            call: format!("{function} of '{}'{at}", self.name),
            how,
            bounds: self.bounds,
            messages: self.environment.last(0),
            printed: self.process.printed(),
        }));
        fmi2Fatal
    }

    /// Puts what a call gave where the caller wants it.
    pub fn fill<T: Number>(
        &mut self,
        function: &str,
        (status, given): (fmi2Status, Given),
        into: &mut [T],
    ) -> fmi2Status {
        if !is_done(status) {
            return status;
        }
        match T::of(given) {
            Some(values) if values.len() == into.len() => {
                into.copy_from_slice(&values);
                status
            }
            _ => self.end(function, How::Garbled(format!("something else than {} values", into.len()))),
        }
    }

    /// As [`Remote::fill`] for one number that counts or names something.
    pub fn number(&mut self, function: &str, (status, given): (fmi2Status, Given)) -> (fmi2Status, u64) {
        match given {
            Given::Number(number) => (status, number),
            _ if !is_done(status) => (status, 0),
            _ => (self.end(function, How::Garbled("something else than a number".to_owned())), 0),
        }
    }

    /// Steps from `time` by `step`, s.
    pub fn step(&mut self, time: f64, step: f64, keeps_no_state: i32) -> fmi2Status {
        if matches!(self.fate, Fate::Alive) {
            self.time = Some(time);
        }
        self.plain("fmi2DoStep", &Request::DoStep { time, step, keeps_no_state })
    }

    /// Keeps texts until the next ones; pointers to them.
    pub fn keep(&mut self, texts: Texts) -> impl Iterator<Item = *const c_char> {
        self.texts = texts;
        self.texts.pointers()
    }

    /// Ends a worker that has sent `what`.
    pub fn garbled(&mut self, function: &str, what: &str) -> fmi2Status {
        self.end(function, How::Garbled(what.to_owned()))
    }

    /// Frees the instance and unloads the library.
    pub fn free(&mut self) {
        if !matches!(self.fate, Fate::Alive) {
            return;
        }
        self.plain("fmi2FreeInstance", &Request::Free);
        self.plain("unloading the library", &Request::Unload);
        if matches!(self.fate, Fate::Alive) {
            self.fate = Fate::Over;
        }
    }
}

fn is_done(status: fmi2Status) -> bool {
    status == fmi2OK || status == fmi2Warning
}

/// Numbers that getters give.
pub(super) trait Number: Copy {
    fn of(given: Given) -> Option<Vec<Self>>;
}

impl Number for f64 {
    fn of(given: Given) -> Option<Vec<Self>> {
        if let Given::Reals(values) = given { Some(values) } else { None }
    }
}

impl Number for i32 {
    fn of(given: Given) -> Option<Vec<Self>> {
        let Given::Integers(values) = given else { return None };
        Some(values.into_iter().map(i32::from_le_bytes).collect())
    }
}

/// Frees an instance ahead of its component, so that it can be seen whether that does harm.
///
/// # Safety
/// `component` is that of a living isolated instance.
pub(crate) unsafe fn free(component: fmi2Component) -> Option<Verdict> {
    // SAFETY: as the caller promises.
    let remote = unsafe { of(component) };
    remote.free();
    // SAFETY: as above.
    unsafe { verdict(component) }.filter(|verdict| matches!(verdict, Verdict::Ended(_)))
}

/// # Safety
/// `component` is that of a living isolated instance, which no other thread uses.
pub(super) unsafe fn of<'a>(component: fmi2Component) -> &'a mut Remote {
    // SAFETY: as the caller promises; `Remote::instantiate` has made it.
    unsafe { &mut *component.cast::<Remote>() }
}
