//! A host for the exported C functions: they are called as C symbols, through raw pointers.
#![allow(dead_code, non_upper_case_globals)] // Each test binary uses a part; constants as in the standard.

pub mod calls;
pub mod toy;

use core::ffi::{CStr, c_char, c_void};
use core::ptr::{null, null_mut};
use fmu_export::Guid;
use fmu_export::abi::*;
use std::ffi::CString;
use toy::Toy;

macro_rules! symbols {
    ($($name:ident($($kind:ty),*) $(-> $result:ty)?;)*) => {
        unsafe extern "C" { $(pub fn $name($(_: $kind),*) $(-> $result)?;)* }
    };
}
symbols! {
    fmi2GetTypesPlatform() -> *const c_char;
    fmi2GetVersion() -> *const c_char;
    fmi2Instantiate(fmi2String, fmi2Type, fmi2String, fmi2String, *const fmi2CallbackFunctions, fmi2Boolean, fmi2Boolean)
        -> fmi2Component;
    fmi2FreeInstance(fmi2Component);
    fmi2SetDebugLogging(fmi2Component, fmi2Boolean, usize, *const fmi2String) -> fmi2Status;
    fmi2SetupExperiment(fmi2Component, fmi2Boolean, fmi2Real, fmi2Real, fmi2Boolean, fmi2Real) -> fmi2Status;
    fmi2EnterInitializationMode(fmi2Component) -> fmi2Status;
    fmi2ExitInitializationMode(fmi2Component) -> fmi2Status;
    fmi2Terminate(fmi2Component) -> fmi2Status;
    fmi2Reset(fmi2Component) -> fmi2Status;
    fmi2GetReal(fmi2Component, *const fmi2ValueReference, usize, *mut fmi2Real) -> fmi2Status;
    fmi2GetInteger(fmi2Component, *const fmi2ValueReference, usize, *mut fmi2Integer) -> fmi2Status;
    fmi2GetBoolean(fmi2Component, *const fmi2ValueReference, usize, *mut fmi2Boolean) -> fmi2Status;
    fmi2GetString(fmi2Component, *const fmi2ValueReference, usize, *mut fmi2String) -> fmi2Status;
    fmi2SetReal(fmi2Component, *const fmi2ValueReference, usize, *const fmi2Real) -> fmi2Status;
    fmi2SetInteger(fmi2Component, *const fmi2ValueReference, usize, *const fmi2Integer) -> fmi2Status;
    fmi2SetBoolean(fmi2Component, *const fmi2ValueReference, usize, *const fmi2Boolean) -> fmi2Status;
    fmi2SetString(fmi2Component, *const fmi2ValueReference, usize, *const fmi2String) -> fmi2Status;
    fmi2GetFMUstate(fmi2Component, *mut fmi2FMUstate) -> fmi2Status;
    fmi2SetFMUstate(fmi2Component, fmi2FMUstate) -> fmi2Status;
    fmi2FreeFMUstate(fmi2Component, *mut fmi2FMUstate) -> fmi2Status;
    fmi2SerializedFMUstateSize(fmi2Component, fmi2FMUstate, *mut usize) -> fmi2Status;
    fmi2SerializeFMUstate(fmi2Component, fmi2FMUstate, *mut fmi2Byte, usize) -> fmi2Status;
    fmi2DeSerializeFMUstate(fmi2Component, *const fmi2Byte, usize, *mut fmi2FMUstate) -> fmi2Status;
    fmi2GetDirectionalDerivative(fmi2Component, *const fmi2ValueReference, usize, *const fmi2ValueReference, usize,
        *const fmi2Real, *mut fmi2Real) -> fmi2Status;
    fmi2SetRealInputDerivatives(fmi2Component, *const fmi2ValueReference, usize, *const fmi2Integer, *const fmi2Real)
        -> fmi2Status;
    fmi2GetRealOutputDerivatives(fmi2Component, *const fmi2ValueReference, usize, *const fmi2Integer, *mut fmi2Real)
        -> fmi2Status;
    fmi2DoStep(fmi2Component, fmi2Real, fmi2Real, fmi2Boolean) -> fmi2Status;
    fmi2CancelStep(fmi2Component) -> fmi2Status;
    fmi2GetStatus(fmi2Component, fmi2StatusKind, *mut fmi2Status) -> fmi2Status;
    fmi2GetRealStatus(fmi2Component, fmi2StatusKind, *mut fmi2Real) -> fmi2Status;
    fmi2GetIntegerStatus(fmi2Component, fmi2StatusKind, *mut fmi2Integer) -> fmi2Status;
    fmi2GetBooleanStatus(fmi2Component, fmi2StatusKind, *mut fmi2Boolean) -> fmi2Status;
    fmi2GetStringStatus(fmi2Component, fmi2StatusKind, *mut fmi2String) -> fmi2Status;
    fmi2EnterEventMode(fmi2Component) -> fmi2Status;
    fmi2NewDiscreteStates(fmi2Component, *mut fmi2EventInfo) -> fmi2Status;
    fmi2EnterContinuousTimeMode(fmi2Component) -> fmi2Status;
    fmi2CompletedIntegratorStep(fmi2Component, fmi2Boolean, *mut fmi2Boolean, *mut fmi2Boolean) -> fmi2Status;
    fmi2SetTime(fmi2Component, fmi2Real) -> fmi2Status;
    fmi2SetContinuousStates(fmi2Component, *const fmi2Real, usize) -> fmi2Status;
    fmi2GetDerivatives(fmi2Component, *mut fmi2Real, usize) -> fmi2Status;
    fmi2GetEventIndicators(fmi2Component, *mut fmi2Real, usize) -> fmi2Status;
    fmi2GetContinuousStates(fmi2Component, *mut fmi2Real, usize) -> fmi2Status;
    fmi2GetNominalsOfContinuousStates(fmi2Component, *mut fmi2Real, usize) -> fmi2Status;
}

/// One call of the logger.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    pub instance: String,
    pub status: fmi2Status,
    pub category: String,
    pub message: String,
}

/// What the environment pointer of a host points to.
#[derive(Default)]
pub struct Log {
    pub lines: Vec<Line>,
    /// Called from inside the logger, if not NULL: a host that breaks the rules.
    pub reenter: fmi2Component,
    pub reentered: Option<fmi2Status>,
}

unsafe fn owned(text: *const c_char) -> String {
    unsafe { CStr::from_ptr(text) }.to_str().expect("UTF-8").to_owned()
}

/// The logger with the one variadic argument that a `"%s"` format promises.
unsafe extern "C" fn log(
    environment: fmi2ComponentEnvironment,
    instance: fmi2String,
    status: fmi2Status,
    category: fmi2String,
    format: fmi2String,
    argument: *const c_char,
) {
    let log = unsafe { &mut *environment.cast::<Log>() };
    assert_eq!(unsafe { owned(format) }, "%s", "the format must be fixed");
    let (instance, category, message) = unsafe { (owned(instance), owned(category), owned(argument)) };
    log.lines.push(Line { instance, status, category, message });
    if !log.reenter.is_null() {
        log.reentered = Some(unsafe { fmi2Reset(log.reenter) });
    }
}

/// Callbacks that write to `log`.
pub fn callbacks(log_to: &mut Log) -> fmi2CallbackFunctions {
    // Stable Rust cannot define a variadic function. A call with one pointer argument passes it as a fixed one on
    // the platforms that run these tests (System V and Windows x64, AArch64 Linux).
    let plain: unsafe extern "C" fn(_, _, _, _, _, *const c_char) = log;
    let variadic = unsafe { core::mem::transmute::<*const c_void, fmi2CallbackLogger>(plain as *const c_void) };
    fmi2CallbackFunctions {
        logger: Some(variadic),
        allocateMemory: None,
        freeMemory: None,
        stepFinished: None,
        componentEnvironment: core::ptr::from_mut(log_to).cast(),
    }
}

pub fn guid() -> String {
    Guid::of::<Toy>().to_string()
}

pub fn c(text: &str) -> CString {
    CString::new(text).expect("no NUL")
}

/// Calls `fmi2Instantiate` with every argument at hand.
pub fn instantiate(
    name: Option<&str>,
    kind: fmi2Type,
    guid: Option<&str>,
    resources: Option<&str>,
    functions: *const fmi2CallbackFunctions,
    logging: bool,
) -> fmi2Component {
    let [name, guid, resources] = [name, guid, resources].map(|text| text.map(c));
    let pointer = |text: &Option<CString>| text.as_ref().map_or(null(), |t| t.as_ptr());
    let (name, guid, resources) = (pointer(&name), pointer(&guid), pointer(&resources));
    unsafe { fmi2Instantiate(name, kind, guid, resources, functions, fmi2False, logging.into()) }
}

/// An instance of the toy, with its log.
pub struct Host {
    pub component: fmi2Component,
    log: *mut Log,
}

impl Drop for Host {
    fn drop(&mut self) {
        unsafe {
            fmi2FreeInstance(self.component);
            drop(Box::from_raw(self.log));
        }
    }
}

impl Host {
    /// In state `instantiated`.
    pub fn new() -> Self {
        Self::of_kind(fmi2CoSimulation)
    }

    pub fn of_kind(kind: fmi2Type) -> Self {
        let log = Box::into_raw(Box::<Log>::default());
        let functions = callbacks(unsafe { &mut *log });
        let component = instantiate(Some("toy"), kind, Some(&guid()), None, &raw const functions, true);
        assert!(!component.is_null());
        Self { component, log }
    }

    /// In state `initializationMode`.
    pub fn initializing() -> Self {
        Self::initializing_of(fmi2CoSimulation)
    }

    /// The same for this interface.
    pub fn initializing_of(kind: fmi2Type) -> Self {
        let host = Self::of_kind(kind);
        assert_eq!(host.setup(0.0, None), fmi2OK);
        assert_eq!(unsafe { fmi2EnterInitializationMode(host.component) }, fmi2OK);
        host
    }

    /// In state `stepComplete`, at 0 s.
    pub fn initialized() -> Self {
        let host = Self::initializing();
        assert_eq!(unsafe { fmi2ExitInitializationMode(host.component) }, fmi2OK);
        host
    }

    /// Model exchange, in state `eventMode`, at 0 s.
    pub fn at_event() -> Self {
        let host = Self::of_kind(fmi2ModelExchange);
        assert_eq!(host.setup(0.0, None), fmi2OK);
        assert_eq!(host.initialize(), fmi2OK);
        host
    }

    /// Model exchange, in state `continuousTimeMode`, at 0 s.
    pub fn exchanging() -> Self {
        let host = Self::at_event();
        assert_eq!(host.new_discrete_states().0, fmi2OK);
        assert_eq!(unsafe { fmi2EnterContinuousTimeMode(host.component) }, fmi2OK);
        host
    }

    /// The same with a limit of the integral.
    pub fn of_limit(limit: f64) -> Self {
        let host = Self::of_kind(fmi2ModelExchange);
        assert_eq!(host.set_real(toy::LIMIT, limit), fmi2OK);
        assert_eq!(host.setup(0.0, None), fmi2OK);
        assert_eq!(host.initialize(), fmi2OK);
        assert_eq!(unsafe { fmi2EnterContinuousTimeMode(host.component) }, fmi2OK);
        host
    }

    pub fn new_discrete_states(&self) -> (fmi2Status, fmi2EventInfo) {
        let mut info = fmi2EventInfo {
            newDiscreteStatesNeeded: 7,
            terminateSimulation: 7,
            nominalsOfContinuousStatesChanged: 7,
            valuesOfContinuousStatesChanged: 7,
            nextEventTimeDefined: 7,
            nextEventTime: -77.0,
        };
        let status = unsafe { fmi2NewDiscreteStates(self.component, &raw mut info) };
        (status, info)
    }

    /// What the logger callback writes to, behind the back of the compiler.
    #[allow(clippy::mut_from_ref)]
    pub fn log(&self) -> &mut Log {
        unsafe { &mut *self.log }
    }

    /// The messages since this was last asked.
    pub fn lines(&self) -> Vec<Line> {
        core::mem::take(&mut self.log().lines)
    }

    /// The last message; it must be an error.
    pub fn error(&self) -> String {
        let line = self.lines().pop().expect("a message");
        assert_eq!((line.status, line.category.as_str()), (fmi2Error, "logStatusError"), "{}", line.message);
        line.message
    }

    pub fn setup(&self, start: f64, stop: Option<f64>) -> fmi2Status {
        let (defined, stop) = (stop.is_some().into(), stop.unwrap_or(f64::NAN));
        unsafe { fmi2SetupExperiment(self.component, fmi2False, f64::NAN, start, defined, stop) }
    }

    pub fn initialize(&self) -> fmi2Status {
        match unsafe { fmi2EnterInitializationMode(self.component) } {
            fmi2OK => unsafe { fmi2ExitInitializationMode(self.component) },
            other => other,
        }
    }

    pub fn step(&self, t: f64, h: f64) -> fmi2Status {
        unsafe { fmi2DoStep(self.component, t, h, fmi2True) }
    }

    pub fn set_real(&self, reference: u32, value: f64) -> fmi2Status {
        unsafe { fmi2SetReal(self.component, &raw const reference, 1, &raw const value) }
    }

    pub fn set_integer(&self, reference: u32, value: i32) -> fmi2Status {
        unsafe { fmi2SetInteger(self.component, &raw const reference, 1, &raw const value) }
    }

    pub fn set_boolean(&self, reference: u32, value: fmi2Boolean) -> fmi2Status {
        unsafe { fmi2SetBoolean(self.component, &raw const reference, 1, &raw const value) }
    }

    pub fn set_string(&self, reference: u32, value: &str) -> fmi2Status {
        let value = c(value);
        let pointer = value.as_ptr();
        unsafe { fmi2SetString(self.component, &raw const reference, 1, &raw const pointer) }
    }

    /// Arms one of the failures of the toy.
    pub fn trouble(&self, what: &str) {
        let status = self.set_string(toy::TROUBLE, what);
        assert!(status <= fmi2Warning, "status {status}");
    }

    pub fn try_real(&self, reference: u32) -> (fmi2Status, f64) {
        let mut value = -77.0;
        let status = unsafe { fmi2GetReal(self.component, &raw const reference, 1, &raw mut value) };
        (status, value)
    }

    pub fn real(&self, reference: u32) -> f64 {
        let (status, value) = self.try_real(reference);
        assert!(status <= fmi2Warning, "status {status}");
        value
    }

    pub fn integer(&self, reference: u32) -> i32 {
        let mut value = -77;
        let status = unsafe { fmi2GetInteger(self.component, &raw const reference, 1, &raw mut value) };
        assert!(status <= fmi2Warning, "status {status}");
        value
    }

    pub fn boolean(&self, reference: u32) -> fmi2Boolean {
        let mut value = -77;
        let status = unsafe { fmi2GetBoolean(self.component, &raw const reference, 1, &raw mut value) };
        assert!(status <= fmi2Warning, "status {status}");
        value
    }

    pub fn string(&self, reference: u32) -> String {
        let mut value: fmi2String = null();
        let status = unsafe { fmi2GetString(self.component, &raw const reference, 1, &raw mut value) };
        assert!(status <= fmi2Warning, "status {status}");
        unsafe { owned(value) }
    }

    pub fn save(&self) -> fmi2FMUstate {
        let mut state = null_mut();
        assert_eq!(unsafe { fmi2GetFMUstate(self.component, &raw mut state) }, fmi2OK);
        assert!(!state.is_null());
        state
    }

    pub fn restore(&self, state: fmi2FMUstate) -> fmi2Status {
        unsafe { fmi2SetFMUstate(self.component, state) }
    }

    pub fn reset(&self) -> fmi2Status {
        unsafe { fmi2Reset(self.component) }
    }

    pub fn terminate(&self) -> fmi2Status {
        unsafe { fmi2Terminate(self.component) }
    }

    pub fn real_status(&self, kind: fmi2StatusKind) -> (fmi2Status, f64) {
        let mut value = -77.0;
        let status = unsafe { fmi2GetRealStatus(self.component, kind, &raw mut value) };
        (status, value)
    }

    pub fn boolean_status(&self, kind: fmi2StatusKind) -> (fmi2Status, fmi2Boolean) {
        let mut value = -77;
        let status = unsafe { fmi2GetBooleanStatus(self.component, kind, &raw mut value) };
        (status, value)
    }
}
