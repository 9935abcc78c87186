//! The one instance of a worker, and the calls on it.

use std::collections::HashMap;
use std::ffi::{CStr, CString, c_char};
use std::ptr;
use std::sync::Arc;

use fmu_abi::{
    fmi2Boolean, fmi2CallbackFunctions, fmi2CoSimulation, fmi2Component, fmi2Error, fmi2FMUstate, fmi2False, fmi2OK,
    fmi2Status, fmi2Warning,
};

use super::protocol::{Given, LONGEST_STATE, Plain, Request};
use crate::library::Functions;
use crate::logging::Environment;

/// What a call came to: its status, and what else it gave.
type Answer = (fmi2Status, Given);

/// The functions of the library, and the instance once it is made.
pub(super) struct Session {
    functions: Functions,
    component: fmi2Component,
    // The FMU keeps pointers to these.
    _environment: Arc<Environment>,
    callbacks: Box<fmi2CallbackFunctions>,
    name: CString,
    states: HashMap<u64, fmi2FMUstate>,
    last_state: u64,
}

impl Session {
    pub fn new(functions: &Functions, environment: Arc<Environment>) -> Self {
        let callbacks = Box::new(environment.callbacks());
        let (component, states) = (ptr::null_mut(), HashMap::new());
        Self {
            functions: *functions,
            component,
            _environment: environment,
            callbacks,
            name: CString::default(),
            states,
            last_state: 0,
        }
    }

    /// Carries out a call. Without an instance, and with a state that there is not, it is an error.
    pub fn answer(&mut self, request: Request) -> Answer {
        match request {
            Request::Instantiate { name, guid, resources, debug } => self.instantiate(name, &guid, &resources, debug),
            _ if self.component.is_null() => (fmi2Error, Given::Nothing),
            Request::Free => self.free(),
            Request::Unload => (fmi2Error, Given::Nothing),
            Request::GetState { .. }
            | Request::SetState { .. }
            | Request::FreeState { .. }
            | Request::StateSize { .. }
            | Request::SerializeState { .. }
            | Request::DeserializeState { .. } => self.state(request),
            Request::GetReal { .. }
            | Request::GetInteger { .. }
            | Request::GetBoolean { .. }
            | Request::GetString { .. }
            | Request::GetOutputDerivatives { .. }
            | Request::DirectionalDerivative { .. }
            | Request::RealStatus { .. }
            | Request::BooleanStatus { .. } => self.get(&request),
            _ => (self.set(&request), Given::Nothing),
        }
    }

    fn instantiate(&mut self, name: CString, guid: &CStr, resources: &CStr, debug: bool) -> Answer {
        self.name = name;
        let (name, callbacks) = (self.name.as_ptr(), ptr::from_ref(&*self.callbacks));
        let debug = fmi2Boolean::from(debug);
        // SAFETY: name and callbacks live as long as the component.
        self.component = unsafe {
            let instantiate = self.functions.instantiate;
            instantiate(name, fmi2CoSimulation, guid.as_ptr(), resources.as_ptr(), callbacks, fmi2False, debug)
        };
        (fmi2OK, Given::Number(u64::from(!self.component.is_null())))
    }

    fn free(&mut self) -> Answer {
        // SAFETY: the component is live, and nothing uses it afterwards.
        unsafe { (self.functions.free_instance)(self.component) };
        self.component = ptr::null_mut();
        (fmi2OK, Given::Nothing)
    }

    /// Calls that give a status only.
    fn set(&self, request: &Request) -> fmi2Status {
        let (f, c) = (&self.functions, self.component);
        // SAFETY: the component is live. Arrays are as long as is said: `is_even` has compared those that go together.
        unsafe {
            match request {
                request if !is_even(request) => fmi2Error,
                Request::SetDebugLogging { on, categories } => {
                    let pointers = pointers(categories);
                    (f.set_debug_logging)(c, *on, pointers.len(), pointers.as_ptr())
                }
                Request::SetupExperiment { tolerance, start, stop } => {
                    let (with_tolerance, with_stop) = (tolerance.is_some().into(), stop.is_some().into());
                    let (tolerance, stop) = (tolerance.unwrap_or(0.0), stop.unwrap_or(0.0));
                    (f.setup_experiment)(c, with_tolerance, tolerance, *start, with_stop, stop)
                }
                Request::Plain(Plain::EnterInitializationMode) => (f.enter_initialization_mode)(c),
                Request::Plain(Plain::ExitInitializationMode) => (f.exit_initialization_mode)(c),
                Request::Plain(Plain::Terminate) => (f.terminate)(c),
                Request::Plain(Plain::Reset) => (f.reset)(c),
                Request::DoStep { time, step, keeps_no_state } => (f.do_step)(c, *time, *step, *keeps_no_state),
                Request::SetReal { references: vr, values } => (f.set_real)(c, vr.as_ptr(), vr.len(), values.as_ptr()),
                Request::SetInteger { references: vr, values } => {
                    (f.set_integer)(c, vr.as_ptr(), vr.len(), values.as_ptr())
                }
                Request::SetBoolean { references: vr, values } => {
                    (f.set_boolean)(c, vr.as_ptr(), vr.len(), values.as_ptr())
                }
                Request::SetString { references: vr, values } => {
                    (f.set_string)(c, vr.as_ptr(), vr.len(), pointers(values).as_ptr())
                }
                Request::SetInputDerivatives { references: vr, orders, values } => {
                    (f.set_real_input_derivatives)(c, vr.as_ptr(), vr.len(), orders.as_ptr(), values.as_ptr())
                }
                _ => fmi2Error,
            }
        }
    }

    /// Calls that give values.
    fn get(&self, request: &Request) -> Answer {
        let (f, c) = (&self.functions, self.component);
        // SAFETY: the component is live, and arrays are as long as is said.
        unsafe {
            match request {
                request if !is_even(request) => (fmi2Error, Given::Nothing),
                Request::GetReal { references: vr } => {
                    given(0.0, vr.len(), Given::Reals, |to| (f.get_real)(c, vr.as_ptr(), vr.len(), to))
                }
                Request::GetInteger { references: vr } => {
                    given(0, vr.len(), Given::integers, |to| (f.get_integer)(c, vr.as_ptr(), vr.len(), to))
                }
                Request::GetBoolean { references: vr } => {
                    given(0, vr.len(), Given::integers, |to| (f.get_boolean)(c, vr.as_ptr(), vr.len(), to))
                }
                Request::GetString { references: vr } => {
                    given(ptr::null(), vr.len(), texts, |to| (f.get_string)(c, vr.as_ptr(), vr.len(), to))
                }
                Request::GetOutputDerivatives { references: vr, orders } => given(0.0, vr.len(), Given::Reals, |to| {
                    (f.get_real_output_derivatives)(c, vr.as_ptr(), vr.len(), orders.as_ptr(), to)
                }),
                Request::DirectionalDerivative { unknowns, knowns, seed } => {
                    given(0.0, unknowns.len(), Given::Reals, |to| {
                        let (unknown_count, known_count) = (unknowns.len(), knowns.len());
                        let (unknowns, knowns) = (unknowns.as_ptr(), knowns.as_ptr());
                        let derivative = f.get_directional_derivative;
                        derivative(c, unknowns, unknown_count, knowns, known_count, seed.as_ptr(), to)
                    })
                }
                Request::RealStatus { kind } => given(0.0, 1, Given::Reals, |to| (f.get_real_status)(c, *kind, to)),
                Request::BooleanStatus { kind } => {
                    given(0, 1, Given::integers, |to| (f.get_boolean_status)(c, *kind, to))
                }
                _ => (fmi2Error, Given::Nothing),
            }
        }
    }

    /// Calls about states.
    fn state(&mut self, request: Request) -> Answer {
        let (f, c) = (self.functions, self.component);
        let none = (fmi2Error, Given::Nothing);
        // SAFETY: the component is live, and the states are its own.
        unsafe {
            match request {
                Request::GetState { state } => {
                    let Some(mut pointer) = self.pointer(state) else { return none };
                    let status = (f.get_state)(c, &raw mut pointer);
                    (status, self.keep(state, pointer))
                }
                Request::DeserializeState { bytes } => {
                    let mut pointer = ptr::null_mut();
                    let status =
                        (f.deserialize_state)(c, bytes.as_ptr().cast::<c_char>(), bytes.len(), &raw mut pointer);
                    (status, self.keep(0, pointer))
                }
                Request::SetState { state } => {
                    let Some(pointer) = self.pointer(state) else { return none };
                    ((f.set_state)(c, pointer), Given::Nothing)
                }
                Request::FreeState { state } => {
                    let Some(mut pointer) = self.states.remove(&state) else { return none };
                    ((f.free_state)(c, &raw mut pointer), Given::Nothing)
                }
                Request::StateSize { state } => {
                    let (Some(pointer), mut size) = (self.pointer(state), 0) else { return none };
                    let status = (f.serialized_state_size)(c, pointer, &raw mut size);
                    (status, Given::Number(size as u64))
                }
                Request::SerializeState { state, size } => {
                    let size = usize::try_from(size).ok().filter(|&size| size <= LONGEST_STATE);
                    let (Some(pointer), Some(size)) = (self.pointer(state), size) else { return none };
                    given(0_u8, size, Given::Bytes, |to| (f.serialize_state)(c, pointer, to.cast::<c_char>(), size))
                }
                _ => none,
            }
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

/// Has `call` fill an array of this length.
fn given<T: Clone>(
    start: T,
    length: usize,
    of: fn(Vec<T>) -> Given,
    call: impl FnOnce(*mut T) -> fmi2Status,
) -> Answer {
    let mut values = vec![start; length];
    let status = call(values.as_mut_ptr());
    if status == fmi2OK || status == fmi2Warning { (status, of(values)) } else { (status, Given::Nothing) }
}

/// Copies strings of the FMU; NULL counts as empty.
fn texts(pointers: Vec<*const c_char>) -> Given {
    // SAFETY: the FMU returns zero-terminated strings that live until the next call.
    let text = |pointer: *const c_char| if pointer.is_null() { c"" } else { unsafe { CStr::from_ptr(pointer) } };
    Given::Texts(pointers.into_iter().map(text).collect())
}

fn pointers(texts: &[CString]) -> Vec<*const c_char> {
    texts.iter().map(|text| text.as_ptr()).collect()
}

/// Whether arrays that go together have one length.
fn is_even(request: &Request) -> bool {
    match request {
        Request::SetReal { references, values } => references.len() == values.len(),
        Request::SetInteger { references, values } | Request::SetBoolean { references, values } => {
            references.len() == values.len()
        }
        Request::SetString { references, values } => references.len() == values.len(),
        Request::SetInputDerivatives { references, orders, values } => {
            references.len() == orders.len() && references.len() == values.len()
        }
        Request::GetOutputDerivatives { references, orders } => references.len() == orders.len(),
        Request::DirectionalDerivative { knowns, seed, .. } => knowns.len() == seed.len(),
        _ => true,
    }
}
