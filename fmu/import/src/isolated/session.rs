//! The one instance of a worker, and the calls on it.

use std::collections::HashMap;
use std::ffi::CString;
use std::ptr;
use std::sync::Arc;

use fmu_abi::{fmi2Error, fmi2FMUstate, fmi2False, fmi2OK, fmi2Status};

use super::protocol::{Given, LONGEST_STATE, Request};
use crate::library::Functions;
use crate::logging::Environment;
use crate::slave::{Arguments, Component, Slave as _, is_done};

/// The result of a call: its status, and what else it gave.
type Answer = (fmi2Status, Given);

const ERROR: Answer = (fmi2Error, Given::Nothing);

/// The functions of the library, and the instance once it is made.
pub(super) struct Session {
    functions: Functions,
    environment: Arc<Environment>,
    component: Option<Component>,
    states: HashMap<u64, fmi2FMUstate>,
    last_state: u64,
}

impl Session {
    pub fn new(functions: &Functions, environment: Arc<Environment>) -> Self {
        Self { functions: *functions, environment, component: None, states: HashMap::new(), last_state: 0 }
    }

    /// Carries out a call. Without an instance, and with a state that there is not, it is an error.
    pub fn answer(&mut self, request: Request) -> Answer {
        if let Request::Instantiate { name, guid, resources, debug } = &request {
            let arguments = Arguments { name, guid, resources, debug: *debug };
            self.component = Component::new(&self.functions, &arguments, &self.environment);
            return (fmi2OK, Given::Number(self.component.is_some().into()));
        }
        let Some(component) = &self.component else { return ERROR };
        let plain = |status| (status, Given::Nothing);
        match request {
            Request::Free => {
                self.component = None;
                plain(fmi2OK)
            }
            Request::Plain(function) => plain(component.plain(function)),
            Request::SetDebugLogging { on, categories } => {
                plain(component.set_debug_logging(on, &categories.iter().map(CString::as_c_str).collect::<Vec<_>>()))
            }
            Request::SetupExperiment { tolerance, start, stop } => {
                plain(component.setup_experiment(tolerance, start, stop))
            }
            Request::DoStep { time, step } => plain(component.do_step(time, step)),
            Request::SetReal { references, values } => plain(component.set_real(&references, &values)),
            Request::SetInteger { references, values } => plain(component.set_integer(&references, &values)),
            Request::SetBoolean { references, values } => plain(component.set_boolean(&references, &values)),
            Request::SetString { references, values } => plain(component.set_string(&references, &values)),
            Request::SetInputDerivatives { references, orders, values } => {
                plain(component.set_input_derivatives(&references, &orders, &values))
            }
            Request::GetReal { references } => {
                given(vec![0.0; references.len()], Given::Reals, |to| component.get_real(&references, to))
            }
            Request::GetInteger { references } => {
                given(vec![0; references.len()], Given::integers, |to| component.get_integer(&references, to))
            }
            Request::GetBoolean { references } => {
                given(vec![0; references.len()], Given::integers, |to| component.get_boolean(&references, to))
            }
            Request::GetString { references } => {
                given(vec![CString::default(); references.len()], Given::texts, |to| {
                    component.get_string(&references, to)
                })
            }
            Request::GetOutputDerivatives { references, orders } => {
                given(vec![0.0; references.len()], Given::Reals, |to| {
                    component.get_output_derivatives(&references, &orders, to)
                })
            }
            Request::DirectionalDerivative { unknowns, knowns, seed } => {
                given(vec![0.0; unknowns.len()], Given::Reals, |to| {
                    component.directional_derivative(&unknowns, &knowns, &seed, to)
                })
            }
            Request::RealStatus { kind } => {
                given(0.0, |it| Given::Reals(vec![it]), |to| component.real_status(kind, to))
            }
            Request::BooleanStatus { kind } => {
                given(fmi2False, |it| Given::integers(vec![it]), |to| component.boolean_status(kind, to))
            }
            Request::GetState { state } => {
                let Some(mut pointer) = self.pointer(state) else { return ERROR };
                (component.get_state(&mut pointer), self.keep(state, pointer))
            }
            Request::DeserializeState { bytes } => {
                let mut pointer = ptr::null_mut();
                (component.deserialize_state(&bytes, &mut pointer), self.keep(0, pointer))
            }
            Request::SetState { state } => self.pointer(state).map_or(ERROR, |it| plain(component.set_state(it))),
            Request::FreeState { state } => {
                self.states.remove(&state).map_or(ERROR, |mut pointer| plain(component.free_state(&mut pointer)))
            }
            Request::StateSize { state } => {
                let (Some(pointer), mut size) = (self.pointer(state), 0) else { return ERROR };
                (component.state_size(pointer, &mut size), Given::Number(size as u64))
            }
            Request::SerializeState { state, size } => {
                let size = usize::try_from(size).ok().filter(|&size| size <= LONGEST_STATE);
                let (Some(pointer), Some(size)) = (self.pointer(state), size) else { return ERROR };
                given(vec![0; size], Given::Bytes, |to| component.serialize_state(pointer, to))
            }
            Request::Instantiate { .. } | Request::Unload => ERROR,
        }
    }

    /// The state of a number; NULL for none.
    fn pointer(&self, state: u64) -> Option<fmi2FMUstate> {
        if state == 0 { Some(ptr::null_mut()) } else { self.states.get(&state).copied() }
    }

    /// Keeps a state under its number, or under a new one.
    fn keep(&mut self, state: u64, pointer: fmi2FMUstate) -> Given {
        if pointer.is_null() {
            return Given::Number(0);
        }
        let number = if state == 0 { self.last_state + 1 } else { state };
        self.last_state = self.last_state.max(number);
        self.states.insert(number, pointer);
        Given::Number(number)
    }
}

/// Has `call` fill in values; what it gives, if it is done.
fn given<T>(mut values: T, of: impl FnOnce(T) -> Given, call: impl FnOnce(&mut T) -> fmi2Status) -> Answer {
    let status = call(&mut values);
    (status, if is_done(status) { of(values) } else { Given::Nothing })
}
