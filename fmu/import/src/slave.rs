//! A slave: one instance of an FMU and the functions of FMI 2.0 on it, in this process ([`Component`]) or isolated in another.

use std::ffi::{CStr, CString, c_char};
use std::ptr;
use std::sync::Arc;

use fmu_abi::{
    fmi2Boolean, fmi2CallbackFunctions, fmi2CoSimulation, fmi2Component, fmi2Error, fmi2FMUstate, fmi2False,
    fmi2Status, fmi2StatusKind,
};
use serde::{Deserialize, Serialize};

use super::isolated::Ending;
use super::library::Functions;
use super::logging::Environment;

/// The arguments of `fmi2Instantiate`.
pub(super) struct Arguments<'a> {
    pub name: &'a CStr,
    pub guid: &'a CStr,
    pub resources: &'a CStr,
    pub debug: bool,
}

/// Functions that take nothing but the instance.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) enum Plain {
    EnterInitializationMode,
    ExitInitializationMode,
    Terminate,
    Reset,
}

impl Plain {
    /// Name of the function.
    pub fn name(self) -> &'static str {
        match self {
            Self::EnterInitializationMode => "fmi2EnterInitializationMode",
            Self::ExitInitializationMode => "fmi2ExitInitializationMode",
            Self::Terminate => "fmi2Terminate",
            Self::Reset => "fmi2Reset",
        }
    }
}

/// Why a call came back with `fmi2Fatal` though the FMU did not say so.
pub(super) enum Loss {
    /// The process of the instance ended, in this call or an earlier one.
    Ended(Box<Ending>),
    /// It was not called: it had reported a fatal error before.
    Over,
}

/// The functions of an instance, which dropping frees. Arrays that belong together have one length; states are those of this instance, or NULL.
pub(super) trait Slave {
    fn plain(&self, function: Plain) -> fmi2Status;
    fn set_debug_logging(&self, on: bool, categories: &[&CStr]) -> fmi2Status;
    fn setup_experiment(&self, tolerance: Option<f64>, start: f64, stop: Option<f64>) -> fmi2Status;
    fn do_step(&self, time: f64, step: f64) -> fmi2Status;
    fn get_real(&self, references: &[u32], values: &mut [f64]) -> fmi2Status;
    fn set_real(&self, references: &[u32], values: &[f64]) -> fmi2Status;
    fn get_integer(&self, references: &[u32], values: &mut [i32]) -> fmi2Status;
    fn set_integer(&self, references: &[u32], values: &[i32]) -> fmi2Status;
    fn get_boolean(&self, references: &[u32], values: &mut [fmi2Boolean]) -> fmi2Status;
    fn set_boolean(&self, references: &[u32], values: &[fmi2Boolean]) -> fmi2Status;
    fn get_string(&self, references: &[u32], values: &mut [CString]) -> fmi2Status;
    fn set_string(&self, references: &[u32], values: &[CString]) -> fmi2Status;
    fn set_input_derivatives(&self, references: &[u32], orders: &[i32], values: &[f64]) -> fmi2Status;
    fn get_output_derivatives(&self, references: &[u32], orders: &[i32], values: &mut [f64]) -> fmi2Status;
    fn directional_derivative(&self, of: &[u32], by: &[u32], seed: &[f64], result: &mut [f64]) -> fmi2Status;
    fn real_status(&self, kind: fmi2StatusKind, value: &mut f64) -> fmi2Status;
    fn boolean_status(&self, kind: fmi2StatusKind, value: &mut fmi2Boolean) -> fmi2Status;
    fn get_state(&self, state: &mut fmi2FMUstate) -> fmi2Status;
    fn set_state(&self, state: fmi2FMUstate) -> fmi2Status;
    fn free_state(&self, state: &mut fmi2FMUstate) -> fmi2Status;
    fn state_size(&self, state: fmi2FMUstate, size: &mut usize) -> fmi2Status;
    fn serialize_state(&self, state: fmi2FMUstate, bytes: &mut [u8]) -> fmi2Status;
    fn deserialize_state(&self, bytes: &[u8], state: &mut fmi2FMUstate) -> fmi2Status;

    /// Why the last call was not carried out, if that was not up to the FMU.
    fn loss(&self) -> Option<Loss> {
        None
    }

    /// Frees an isolated instance ahead of its states.
    fn free(&self) -> Result<(), Box<Ending>> {
        Ok(())
    }
}

/// An instance in this process.
pub(super) struct Component {
    functions: Functions,
    handle: fmi2Component,
    // The FMU keeps pointers to these.
    _name: CString,
    _environment: Arc<Environment>,
    _callbacks: Box<fmi2CallbackFunctions>,
}

impl Component {
    /// Makes an instance; none if the FMU refuses.
    pub fn new(functions: &Functions, arguments: &Arguments<'_>, environment: &Arc<Environment>) -> Option<Self> {
        let (name, environment) = (arguments.name.to_owned(), Arc::clone(environment));
        let callbacks = Box::new(environment.callbacks());
        let (guid, resources) = (arguments.guid.as_ptr(), arguments.resources.as_ptr());
        let (instantiate, debug) = (functions.instantiate, fmi2Boolean::from(arguments.debug));
        // SAFETY: name and callbacks live as long as the component.
        let handle = unsafe {
            instantiate(name.as_ptr(), fmi2CoSimulation, guid, resources, &raw const *callbacks, fmi2False, debug)
        };
        if handle.is_null() {
            return None;
        }
        let functions = *functions;
        Some(Self { functions, handle, _name: name, _environment: environment, _callbacks: callbacks })
    }
}

impl Drop for Component {
    fn drop(&mut self) {
        // SAFETY: the component is live, and nothing uses it afterwards.
        unsafe { (self.functions.free_instance)(self.handle) };
    }
}

/// Getters and setters of numbers.
macro_rules! access {
    ($($get:ident, $set:ident: $type:ty;)*) => { $(
        fn $get(&self, references: &[u32], values: &mut [$type]) -> fmi2Status {
            if references.len() != values.len() {
                return fmi2Error;
            }
            // SAFETY: the component is live, and the arrays are as long as is said.
            unsafe { (self.functions.$get)(self.handle, references.as_ptr(), references.len(), values.as_mut_ptr()) }
        }

        fn $set(&self, references: &[u32], values: &[$type]) -> fmi2Status {
            if references.len() != values.len() {
                return fmi2Error;
            }
            // SAFETY: as above.
            unsafe { (self.functions.$set)(self.handle, references.as_ptr(), references.len(), values.as_ptr()) }
        }
    )* };
}

// SAFETY of all calls: the component is live, arrays are as long as is said, and states are those of this component.
#[allow(clippy::undocumented_unsafe_blocks, reason = "documented above")]
impl Slave for Component {
    access! {
        get_real, set_real: f64;
        get_integer, set_integer: i32;
        get_boolean, set_boolean: fmi2Boolean;
    }

    fn plain(&self, function: Plain) -> fmi2Status {
        let function = match function {
            Plain::EnterInitializationMode => self.functions.enter_initialization_mode,
            Plain::ExitInitializationMode => self.functions.exit_initialization_mode,
            Plain::Terminate => self.functions.terminate,
            Plain::Reset => self.functions.reset,
        };
        unsafe { function(self.handle) }
    }

    fn set_debug_logging(&self, on: bool, categories: &[&CStr]) -> fmi2Status {
        let names: Vec<_> = categories.iter().map(|name| name.as_ptr()).collect();
        unsafe { (self.functions.set_debug_logging)(self.handle, on.into(), names.len(), names.as_ptr()) }
    }

    fn setup_experiment(&self, tolerance: Option<f64>, start: f64, stop: Option<f64>) -> fmi2Status {
        let (has_tolerance, has_stop) = (tolerance.is_some().into(), stop.is_some().into());
        let (tolerance, stop) = (tolerance.unwrap_or(0.0), stop.unwrap_or(0.0));
        unsafe { (self.functions.setup_experiment)(self.handle, has_tolerance, tolerance, start, has_stop, stop) }
    }

    fn do_step(&self, time: f64, step: f64) -> fmi2Status {
        // The last argument promises nothing: a master may go back to earlier states.
        unsafe { (self.functions.do_step)(self.handle, time, step, fmi2False) }
    }

    fn get_string(&self, references: &[u32], values: &mut [CString]) -> fmi2Status {
        let mut texts = vec![ptr::null(); values.len()];
        if references.len() != texts.len() {
            return fmi2Error;
        }
        let (count, to) = (references.len(), texts.as_mut_ptr());
        let status = unsafe { (self.functions.get_string)(self.handle, references.as_ptr(), count, to) };
        for (value, text) in values.iter_mut().zip(texts).filter(|(_, text)| is_done(status) && !text.is_null()) {
            // SAFETY: a zero-terminated string, which lives until the next call.
            unsafe { CStr::from_ptr(text) }.clone_into(value);
        }
        status
    }

    fn set_string(&self, references: &[u32], values: &[CString]) -> fmi2Status {
        let texts: Vec<_> = values.iter().map(|text| text.as_ptr()).collect();
        if references.len() != texts.len() {
            return fmi2Error;
        }
        unsafe { (self.functions.set_string)(self.handle, references.as_ptr(), references.len(), texts.as_ptr()) }
    }

    fn set_input_derivatives(&self, references: &[u32], orders: &[i32], values: &[f64]) -> fmi2Status {
        let (set, count) = (self.functions.set_real_input_derivatives, references.len());
        if [orders.len(), values.len()] != [count; 2] {
            return fmi2Error;
        }
        unsafe { set(self.handle, references.as_ptr(), count, orders.as_ptr(), values.as_ptr()) }
    }

    fn get_output_derivatives(&self, references: &[u32], orders: &[i32], values: &mut [f64]) -> fmi2Status {
        let (get, count) = (self.functions.get_real_output_derivatives, references.len());
        if [orders.len(), values.len()] != [count; 2] {
            return fmi2Error;
        }
        unsafe { get(self.handle, references.as_ptr(), count, orders.as_ptr(), values.as_mut_ptr()) }
    }

    fn directional_derivative(&self, of: &[u32], by: &[u32], seed: &[f64], result: &mut [f64]) -> fmi2Status {
        let (derivative, c) = (self.functions.get_directional_derivative, self.handle);
        if (of.len(), by.len()) != (result.len(), seed.len()) {
            return fmi2Error;
        }
        unsafe { derivative(c, of.as_ptr(), of.len(), by.as_ptr(), by.len(), seed.as_ptr(), result.as_mut_ptr()) }
    }

    fn real_status(&self, kind: fmi2StatusKind, value: &mut f64) -> fmi2Status {
        unsafe { (self.functions.get_real_status)(self.handle, kind, value) }
    }

    fn boolean_status(&self, kind: fmi2StatusKind, value: &mut fmi2Boolean) -> fmi2Status {
        unsafe { (self.functions.get_boolean_status)(self.handle, kind, value) }
    }

    fn get_state(&self, state: &mut fmi2FMUstate) -> fmi2Status {
        unsafe { (self.functions.get_state)(self.handle, state) }
    }

    fn set_state(&self, state: fmi2FMUstate) -> fmi2Status {
        unsafe { (self.functions.set_state)(self.handle, state) }
    }

    fn free_state(&self, state: &mut fmi2FMUstate) -> fmi2Status {
        unsafe { (self.functions.free_state)(self.handle, state) }
    }

    fn state_size(&self, state: fmi2FMUstate, size: &mut usize) -> fmi2Status {
        unsafe { (self.functions.serialized_state_size)(self.handle, state, size) }
    }

    fn serialize_state(&self, state: fmi2FMUstate, bytes: &mut [u8]) -> fmi2Status {
        let to = bytes.as_mut_ptr().cast::<c_char>();
        unsafe { (self.functions.serialize_state)(self.handle, state, to, bytes.len()) }
    }

    fn deserialize_state(&self, bytes: &[u8], state: &mut fmi2FMUstate) -> fmi2Status {
        let from = bytes.as_ptr().cast::<c_char>();
        unsafe { (self.functions.deserialize_state)(self.handle, from, bytes.len(), state) }
    }
}

/// Whether a call was carried out.
pub(super) fn is_done(status: fmi2Status) -> bool {
    status == fmu_abi::fmi2OK || status == fmu_abi::fmi2Warning
}
