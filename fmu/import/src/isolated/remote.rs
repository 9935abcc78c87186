//! An isolated instance: each function is a message to its worker. What becomes of the worker is an error of the call.

use std::cell::RefCell;
use std::collections::HashMap;
use std::ffi::{CStr, CString};
use std::path::{Path, PathBuf};
use std::ptr;
use std::sync::Arc;

use fmu_abi::{fmi2Boolean, fmi2FMUstate, fmi2Fatal, fmi2Status, fmi2StatusKind};

use super::bounds::Bounds;
use super::ending::{Ending, How};
use super::process::Process;
use super::protocol::{Given, Request};
use crate::logging::{Environment, LogRecord};
use crate::slave::{Arguments, Loss, Plain, Slave, is_done};

/// An instance in a worker.
pub(super) struct Remote(RefCell<State>);

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
    pub fn new(
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
        let (_, given) = remote.call("fmi2Instantiate", &request);
        match remote.loss() {
            Some(Loss::Ended(ending)) => Err(ending),
            _ => Ok((given == Given::Number(1)).then_some(remote)),
        }
    }

    /// Passes a call on; the status, and what the function gave.
    fn call(&self, function: &str, request: &Request) -> (fmi2Status, Given) {
        self.0.borrow_mut().call(function, request)
    }

    /// Passes on a call that gives a status only.
    fn done(&self, function: &str, request: &Request) -> fmi2Status {
        self.call(function, request).0
    }

    /// Passes on a call that gives values: `read` reads them, and they are as many as `into` has.
    fn fill<T>(
        &self,
        function: &str,
        request: &Request,
        into: &mut [T],
        read: impl FnOnce(Given) -> Option<Vec<T>>,
    ) -> fmi2Status {
        let (status, given) = self.call(function, request);
        if !is_done(status) {
            return status;
        }
        match read(given) {
            Some(values) if values.len() == into.len() => {
                into.iter_mut().zip(values).for_each(|(place, value)| *place = value);
                status
            }
            _ => {
                let found = format!("something else than {} values", into.len());
                self.0.borrow_mut().end(function, How::Garbled(found))
            }
        }
    }

    /// As [`Remote::fill`], for one number that counts or names something.
    fn number(&self, function: &str, request: &Request, into: &mut u64) -> fmi2Status {
        let read = |given| if let Given::Number(number) = given { Some(vec![number]) } else { None };
        self.fill(function, request, std::slice::from_mut(into), read)
    }

    /// As [`Remote::number`], for the number of a state.
    fn state(&self, function: &str, request: &Request, state: &mut fmi2FMUstate) -> fmi2Status {
        let mut number = number_of(*state);
        let status = self.number(function, request, &mut number);
        *state = ptr::without_provenance_mut(usize::try_from(number).unwrap_or_default());
        status
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

    fn call(&mut self, function: &str, request: &Request) -> (fmi2Status, Given) {
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
            Err(how) => (self.end(function, how), Given::Nothing),
        }
    }

    /// Keeps in mind where the instance is after a call.
    fn follow(&mut self, request: &Request, given: &Given) {
        match (request, given) {
            (Request::SetupExperiment { start, .. }, _) => self.time = Some(*start),
            (Request::DoStep { time, step }, _) => self.time = Some(time + step),
            (Request::Plain(Plain::Reset), _) => self.time = None,
            (Request::GetState { .. }, Given::Number(state)) => drop(self.times.insert(*state, self.time)),
            (Request::DeserializeState { .. }, Given::Number(state)) => drop(self.times.insert(*state, None)),
            (Request::SetState { state }, _) => self.time = self.times.get(state).copied().flatten(),
            (Request::FreeState { state }, _) => drop(self.times.remove(state)),
            _ => {}
        }
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
}

impl Slave for Remote {
    fn loss(&self) -> Option<Loss> {
        let state = self.0.borrow();
        match &state.fate {
            Fate::Ended(ending) => Some(Loss::Ended(ending.clone())),
            Fate::Over if state.is_refused => Some(Loss::Over),
            _ => None,
        }
    }

    fn free(&self) -> Result<(), Box<Ending>> {
        if self.0.borrow().is_alive() {
            self.done("fmi2FreeInstance", &Request::Free);
            self.done("unloading the library", &Request::Unload);
        }
        let mut state = self.0.borrow_mut();
        if let Fate::Ended(ending) = &state.fate {
            return Err(ending.clone());
        }
        state.fate = Fate::Over;
        Ok(())
    }

    fn plain(&self, function: Plain) -> fmi2Status {
        self.done(function.name(), &Request::Plain(function))
    }

    fn set_debug_logging(&self, on: bool, categories: &[&CStr]) -> fmi2Status {
        let categories = categories.iter().map(|&name| name.to_owned()).collect();
        self.done("fmi2SetDebugLogging", &Request::SetDebugLogging { on, categories })
    }

    fn setup_experiment(&self, tolerance: Option<f64>, start: f64, stop: Option<f64>) -> fmi2Status {
        self.done("fmi2SetupExperiment", &Request::SetupExperiment { tolerance, start, stop })
    }

    fn do_step(&self, time: f64, step: f64) -> fmi2Status {
        self.done("fmi2DoStep", &Request::DoStep { time, step })
    }

    fn get_real(&self, references: &[u32], values: &mut [f64]) -> fmi2Status {
        self.fill("fmi2GetReal", &Request::GetReal { references: references.into() }, values, Given::into_reals)
    }

    fn set_real(&self, references: &[u32], values: &[f64]) -> fmi2Status {
        self.done("fmi2SetReal", &Request::SetReal { references: references.into(), values: values.into() })
    }

    fn get_integer(&self, references: &[u32], values: &mut [i32]) -> fmi2Status {
        self.fill(
            "fmi2GetInteger",
            &Request::GetInteger { references: references.into() },
            values,
            Given::into_integers,
        )
    }

    fn set_integer(&self, references: &[u32], values: &[i32]) -> fmi2Status {
        self.done("fmi2SetInteger", &Request::SetInteger { references: references.into(), values: values.into() })
    }

    fn get_boolean(&self, references: &[u32], values: &mut [fmi2Boolean]) -> fmi2Status {
        self.fill(
            "fmi2GetBoolean",
            &Request::GetBoolean { references: references.into() },
            values,
            Given::into_integers,
        )
    }

    fn set_boolean(&self, references: &[u32], values: &[fmi2Boolean]) -> fmi2Status {
        self.done("fmi2SetBoolean", &Request::SetBoolean { references: references.into(), values: values.into() })
    }

    fn get_string(&self, references: &[u32], values: &mut [CString]) -> fmi2Status {
        let (request, count) = (Request::GetString { references: references.into() }, values.len());
        self.fill("fmi2GetString", &request, values, |given| given.into_texts(count))
    }

    fn set_string(&self, references: &[u32], values: &[CString]) -> fmi2Status {
        self.done("fmi2SetString", &Request::SetString { references: references.into(), values: values.into() })
    }

    fn set_input_derivatives(&self, references: &[u32], orders: &[i32], values: &[f64]) -> fmi2Status {
        let (references, orders, values) = (references.into(), orders.into(), values.into());
        self.done("fmi2SetRealInputDerivatives", &Request::SetInputDerivatives { references, orders, values })
    }

    fn get_output_derivatives(&self, references: &[u32], orders: &[i32], values: &mut [f64]) -> fmi2Status {
        let request = Request::GetOutputDerivatives { references: references.into(), orders: orders.into() };
        self.fill("fmi2GetRealOutputDerivatives", &request, values, Given::into_reals)
    }

    fn directional_derivative(&self, of: &[u32], by: &[u32], seed: &[f64], result: &mut [f64]) -> fmi2Status {
        let request = Request::DirectionalDerivative { unknowns: of.into(), knowns: by.into(), seed: seed.into() };
        self.fill("fmi2GetDirectionalDerivative", &request, result, Given::into_reals)
    }

    fn real_status(&self, kind: fmi2StatusKind, value: &mut f64) -> fmi2Status {
        let value = std::slice::from_mut(value);
        self.fill("fmi2GetRealStatus", &Request::RealStatus { kind }, value, Given::into_reals)
    }

    fn boolean_status(&self, kind: fmi2StatusKind, value: &mut fmi2Boolean) -> fmi2Status {
        let value = std::slice::from_mut(value);
        self.fill("fmi2GetBooleanStatus", &Request::BooleanStatus { kind }, value, Given::into_integers)
    }

    fn get_state(&self, state: &mut fmi2FMUstate) -> fmi2Status {
        self.state("fmi2GetFMUstate", &Request::GetState { state: number_of(*state) }, state)
    }

    fn set_state(&self, state: fmi2FMUstate) -> fmi2Status {
        self.done("fmi2SetFMUstate", &Request::SetState { state: number_of(state) })
    }

    fn free_state(&self, state: &mut fmi2FMUstate) -> fmi2Status {
        let state = std::mem::replace(state, ptr::null_mut());
        self.done("fmi2FreeFMUstate", &Request::FreeState { state: number_of(state) })
    }

    fn state_size(&self, state: fmi2FMUstate, size: &mut usize) -> fmi2Status {
        let mut number = 0;
        let request = Request::StateSize { state: number_of(state) };
        let status = self.number("fmi2SerializedFMUstateSize", &request, &mut number);
        *size = usize::try_from(number).unwrap_or(usize::MAX);
        status
    }

    fn serialize_state(&self, state: fmi2FMUstate, bytes: &mut [u8]) -> fmi2Status {
        let request = Request::SerializeState { state: number_of(state), size: bytes.len() as u64 };
        self.fill("fmi2SerializeFMUstate", &request, bytes, Given::into_bytes)
    }

    fn deserialize_state(&self, bytes: &[u8], state: &mut fmi2FMUstate) -> fmi2Status {
        self.state("fmi2DeSerializeFMUstate", &Request::DeserializeState { bytes: bytes.into() }, state)
    }
}

/// The number of a state: here the pointer to it is a number, which nobody follows.
fn number_of(state: fmi2FMUstate) -> u64 {
    state.addr() as u64
}
