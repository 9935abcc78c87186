//! An instance of an FMU in this process, and the calls of its C functions.

use std::ffi::{CStr, CString, c_char};
use std::ptr;
use std::sync::Arc;

use fmu_abi::{
    fmi2Boolean, fmi2CallbackFunctions, fmi2CoSimulation, fmi2Component, fmi2Error, fmi2FMUstate, fmi2False,
    fmi2LastSuccessfulTime, fmi2Status, fmi2Terminated,
};

use super::library::Functions;
use super::logging::Environment;
use super::request::{Request, Results};

/// The arguments of `fmi2Instantiate`.
pub(super) struct Arguments<'a> {
    pub name: &'a CStr,
    pub guid: &'a CStr,
    pub resources: &'a CStr,
    pub debug: bool,
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
        let (instantiate, debug) = (functions.fmi2Instantiate, fmi2Boolean::from(arguments.debug));
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

    /// Calls a function. Arrays that belong together but differ in length, and results of another kind, are an error.
    // Inlined, so that a caller's constant function needs no choice at run time.
    #[inline(always)]
    #[allow(clippy::inline_always, clippy::too_many_lines, reason = "a table: one entry for each function")]
    pub fn call(&self, request: &Request<'_>, results: Results<'_>) -> fmi2Status {
        let (f, c) = (&self.functions, self.handle);
        // SAFETY of all calls: the component is live, arrays are as long as is said, and states are those of this component.
        #[allow(clippy::undocumented_unsafe_blocks, reason = "documented above")]
        match (request, results) {
            (Request::SetDebugLogging { on, categories }, _) => {
                let names: Vec<_> = categories.iter().map(|name| name.as_ptr()).collect();
                unsafe { (f.fmi2SetDebugLogging)(c, (*on).into(), names.len(), names.as_ptr()) }
            }
            (&Request::SetupExperiment { tolerance, start, stop }, _) => {
                let (has_tolerance, has_stop) = (tolerance.is_some().into(), stop.is_some().into());
                let (tolerance, stop) = (tolerance.unwrap_or(0.0), stop.unwrap_or(0.0));
                unsafe { (f.fmi2SetupExperiment)(c, has_tolerance, tolerance, start, has_stop, stop) }
            }
            (Request::EnterInitializationMode, _) => unsafe { (f.fmi2EnterInitializationMode)(c) },
            (Request::ExitInitializationMode, _) => unsafe { (f.fmi2ExitInitializationMode)(c) },
            (Request::Terminate, _) => unsafe { (f.fmi2Terminate)(c) },
            (Request::Reset, _) => unsafe { (f.fmi2Reset)(c) },
            // The last argument promises nothing: a master may go back to earlier states.
            (Request::DoStep { time, step }, _) => unsafe { (f.fmi2DoStep)(c, *time, *step, fmi2False) },
            (Request::GetReal { references: of }, Results::Reals(to)) if of.len() == to.len() => unsafe {
                (f.fmi2GetReal)(c, of.as_ptr(), of.len(), to.as_mut_ptr())
            },
            (Request::GetInteger { references: of }, Results::Integers(to)) if of.len() == to.len() => unsafe {
                (f.fmi2GetInteger)(c, of.as_ptr(), of.len(), to.as_mut_ptr())
            },
            (Request::GetBoolean { references: of }, Results::Integers(to)) if of.len() == to.len() => unsafe {
                (f.fmi2GetBoolean)(c, of.as_ptr(), of.len(), to.as_mut_ptr())
            },
            (Request::GetString { references: of }, Results::Texts(to)) if of.len() == to.len() => {
                self.get_string(of, to)
            }
            (Request::SetReal { references: of, values }, _) if of.len() == values.len() => unsafe {
                (f.fmi2SetReal)(c, of.as_ptr(), of.len(), values.as_ptr())
            },
            (Request::SetInteger { references: of, values }, _) if of.len() == values.len() => unsafe {
                (f.fmi2SetInteger)(c, of.as_ptr(), of.len(), values.as_ptr())
            },
            (Request::SetBoolean { references: of, values }, _) if of.len() == values.len() => unsafe {
                (f.fmi2SetBoolean)(c, of.as_ptr(), of.len(), values.as_ptr())
            },
            (Request::SetString { references: of, values }, _) if of.len() == values.len() => {
                let texts: Vec<_> = values.iter().map(|text| text.as_ptr()).collect();
                unsafe { (f.fmi2SetString)(c, of.as_ptr(), of.len(), texts.as_ptr()) }
            }
            (Request::SetInputDerivatives { references: of, orders, values }, _)
                if [orders.len(), values.len()] == [of.len(); 2] =>
            unsafe { (f.fmi2SetRealInputDerivatives)(c, of.as_ptr(), of.len(), orders.as_ptr(), values.as_ptr()) },
            (Request::GetOutputDerivatives { references: of, orders }, Results::Reals(to))
                if [orders.len(), to.len()] == [of.len(); 2] =>
            unsafe { (f.fmi2GetRealOutputDerivatives)(c, of.as_ptr(), of.len(), orders.as_ptr(), to.as_mut_ptr()) },
            (Request::DirectionalDerivative { unknowns: of, knowns: by, seed }, Results::Reals(to))
                if (of.len(), by.len()) == (to.len(), seed.len()) =>
            unsafe {
                let derivative = f.fmi2GetDirectionalDerivative;
                derivative(c, of.as_ptr(), of.len(), by.as_ptr(), by.len(), seed.as_ptr(), to.as_mut_ptr())
            },
            (Request::GetState { state }, Results::Number(to)) => {
                let mut state = pointer(*state);
                let status = unsafe { (f.fmi2GetFMUstate)(c, &raw mut state) };
                *to = state.expose_provenance() as u64;
                status
            }
            (Request::SetState { state }, _) => unsafe { (f.fmi2SetFMUstate)(c, pointer(*state)) },
            (Request::FreeState { state }, _) => unsafe { (f.fmi2FreeFMUstate)(c, &mut pointer(*state)) },
            (Request::StateSize { state }, Results::Number(to)) => {
                let mut size = 0;
                let status = unsafe { (f.fmi2SerializedFMUstateSize)(c, pointer(*state), &raw mut size) };
                *to = size as u64;
                status
            }
            (Request::SerializeState { state, .. }, Results::Bytes(to)) => unsafe {
                (f.fmi2SerializeFMUstate)(c, pointer(*state), to.as_mut_ptr().cast::<c_char>(), to.len())
            },
            (Request::DeserializeState { bytes }, Results::Number(to)) => {
                let mut state = ptr::null_mut();
                let from = bytes.as_ptr().cast::<c_char>();
                let status = unsafe { (f.fmi2DeSerializeFMUstate)(c, from, bytes.len(), &raw mut state) };
                *to = state.expose_provenance() as u64;
                status
            }
            (Request::LastSuccessfulTime, Results::Reals([to])) => unsafe {
                (f.fmi2GetRealStatus)(c, fmi2LastSuccessfulTime, to)
            },
            (Request::Terminated, Results::Integers([to])) => unsafe {
                (f.fmi2GetBooleanStatus)(c, fmi2Terminated, to)
            },
            _ => fmi2Error,
        }
    }

    fn get_string(&self, references: &[u32], values: &mut [CString]) -> fmi2Status {
        let mut texts = vec![ptr::null(); values.len()];
        let (get, to) = (self.functions.fmi2GetString, texts.as_mut_ptr());
        // SAFETY: the component is live, and the arrays have one length.
        let status = unsafe { get(self.handle, references.as_ptr(), references.len(), to) };
        for (value, text) in values.iter_mut().zip(texts).filter(|(_, text)| is_done(status) && !text.is_null()) {
            // SAFETY: a zero-terminated string, which lives until the next call.
            unsafe { CStr::from_ptr(text) }.clone_into(value);
        }
        status
    }
}

impl Drop for Component {
    fn drop(&mut self) {
        // SAFETY: the component is live, and nothing uses it afterwards.
        unsafe { (self.functions.fmi2FreeInstance)(self.handle) };
    }
}

/// The state at an address that an FMU has given; NULL for 0.
fn pointer(state: u64) -> fmi2FMUstate {
    ptr::with_exposed_provenance_mut(usize::try_from(state).unwrap_or_default())
}

/// Whether a call was carried out.
pub(super) fn is_done(status: fmi2Status) -> bool {
    status == fmu_abi::fmi2OK || status == fmu_abi::fmi2Warning
}
