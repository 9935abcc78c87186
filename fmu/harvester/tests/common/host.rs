//! The FMU driven through its C functions.

use super::row;
use VibroImpactHarvester::Harvester;
use core::ffi::{c_char, c_void};
use core::ptr::{null, null_mut};
use fmu_export::abi::*;
use fmu_export::{Causality, Guid, Kind, Slave, Variability, Variable, value_reference};
use std::ffi::CString;

macro_rules! symbols {
    ($($name:ident($($kind:ty),*) $(-> $result:ty)?;)*) => {
        unsafe extern "C" { $(fn $name($(_: $kind),*) $(-> $result)?;)* }
    };
}
symbols! {
    fmi2Instantiate(fmi2String, fmi2Type, fmi2String, fmi2String, *const fmi2CallbackFunctions, fmi2Boolean, fmi2Boolean)
        -> fmi2Component;
    fmi2FreeInstance(fmi2Component);
    fmi2SetupExperiment(fmi2Component, fmi2Boolean, fmi2Real, fmi2Real, fmi2Boolean, fmi2Real) -> fmi2Status;
    fmi2EnterInitializationMode(fmi2Component) -> fmi2Status;
    fmi2ExitInitializationMode(fmi2Component) -> fmi2Status;
    fmi2GetReal(fmi2Component, *const fmi2ValueReference, usize, *mut fmi2Real) -> fmi2Status;
    fmi2GetInteger(fmi2Component, *const fmi2ValueReference, usize, *mut fmi2Integer) -> fmi2Status;
    fmi2GetBoolean(fmi2Component, *const fmi2ValueReference, usize, *mut fmi2Boolean) -> fmi2Status;
    fmi2SetReal(fmi2Component, *const fmi2ValueReference, usize, *const fmi2Real) -> fmi2Status;
    fmi2SetInteger(fmi2Component, *const fmi2ValueReference, usize, *const fmi2Integer) -> fmi2Status;
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
    fmi2DoStep(fmi2Component, fmi2Real, fmi2Real, fmi2Boolean) -> fmi2Status;
    fmi2Terminate(fmi2Component) -> fmi2Status;
    fmi2NewDiscreteStates(fmi2Component, *mut fmi2EventInfo) -> fmi2Status;
    fmi2EnterEventMode(fmi2Component) -> fmi2Status;
    fmi2EnterContinuousTimeMode(fmi2Component) -> fmi2Status;
    fmi2SetTime(fmi2Component, fmi2Real) -> fmi2Status;
    fmi2SetContinuousStates(fmi2Component, *const fmi2Real, usize) -> fmi2Status;
}

unsafe extern "C" fn silent(
    _: fmi2ComponentEnvironment,
    _: fmi2String,
    _: fmi2Status,
    _: fmi2String,
    _: fmi2String,
    _: *const c_char,
) {
}

/// Names of the Real variables that `is_listed`.
fn reals(is_listed: impl Fn(&Variable<Harvester>) -> bool) -> Vec<&'static str> {
    let rows = Harvester::variables().iter().filter(|v| matches!(v.kind(), Kind::Real(_)) && is_listed(v));
    rows.map(Variable::name).collect()
}

/// The Real outputs and the derivatives of the continuous states.
pub fn unknowns() -> Vec<&'static str> {
    reals(|v| v.causality() == Causality::Output || v.derivative_of().is_some())
}

/// The continuous ones among them.
pub fn continuous_unknowns() -> Vec<&'static str> {
    let is_continuous = |name: &&str| row(name).variability() == Variability::Continuous;
    unknowns().into_iter().filter(is_continuous).collect()
}

/// The calculated parameters besides.
pub fn initial_unknowns() -> Vec<&'static str> {
    [reals(|v| v.causality() == Causality::CalculatedParameter), unknowns()].concat()
}

/// Real parameters and inputs.
pub fn initial_knowns() -> Vec<&'static str> {
    reals(|v| matches!(v.causality(), Causality::Parameter | Causality::Input))
}

fn references(names: &[&str]) -> Vec<u32> {
    names.iter().map(|name| value_reference(Harvester::variables(), name).expect(name)).collect()
}

/// An instance; it must answer each call with `fmi2OK` or `fmi2Warning`.
pub struct Host {
    component: fmi2Component,
}

impl Drop for Host {
    fn drop(&mut self) {
        unsafe { fmi2FreeInstance(self.component) }
    }
}

fn ok(status: fmi2Status) {
    assert!(status == fmi2OK || status == fmi2Warning, "status {status}");
}

impl Host {
    /// In initialization mode, with these Reals set.
    pub fn initializing(kind: fmi2Type, start: f64, settings: &[(&str, f64)]) -> Self {
        let guid = CString::new(Guid::of::<Harvester>().to_string()).expect("no NUL");
        let plain: unsafe extern "C" fn(_, _, _, _, _, *const c_char) = silent;
        // A function with a fixed argument instead of variadic ones; it reads none.
        let logger = unsafe { core::mem::transmute::<*const c_void, fmi2CallbackLogger>(plain as *const c_void) };
        let functions = fmi2CallbackFunctions {
            logger: Some(logger),
            allocateMemory: None,
            freeMemory: None,
            stepFinished: None,
            componentEnvironment: null_mut(),
        };
        let name = c"harvester".as_ptr();
        let component = unsafe { fmi2Instantiate(name, kind, guid.as_ptr(), null(), &raw const functions, 0, 0) };
        assert!(!component.is_null());
        let host = Self { component };
        for (name, value) in settings {
            host.set(name, *value);
        }
        ok(unsafe { fmi2SetupExperiment(component, 0, 0.0, start, 0, 0.0) });
        ok(unsafe { fmi2EnterInitializationMode(component) });
        host
    }

    /// Co-simulation, ready for the first step at 0 s.
    pub fn stepping(settings: &[(&str, f64)]) -> Self {
        let host = Self::initializing(fmi2CoSimulation, 0.0, settings);
        host.exit_initialization();
        host
    }

    /// Model exchange, in event mode at 0 s.
    pub fn exchanging(settings: &[(&str, f64)]) -> Self {
        let host = Self::initializing(fmi2ModelExchange, 0.0, settings);
        host.exit_initialization();
        host
    }

    pub fn exit_initialization(&self) {
        self.initialization_warns();
    }

    /// Whether the end of the initialisation warns.
    pub fn initialization_warns(&self) -> bool {
        let status = unsafe { fmi2ExitInitializationMode(self.component) };
        ok(status);
        status == fmi2Warning
    }

    pub fn set(&self, name: &str, value: f64) {
        let reference = references(&[name]);
        ok(unsafe { fmi2SetReal(self.component, reference.as_ptr(), 1, &raw const value) });
    }

    pub fn set_rate(&self, name: &str, rate: f64) {
        let reference = references(&[name]);
        let order = 1;
        let component = self.component;
        ok(unsafe { fmi2SetRealInputDerivatives(component, reference.as_ptr(), 1, &raw const order, &raw const rate) });
    }

    pub fn get_all(&self, names: &[&str]) -> Vec<f64> {
        let mut values = vec![f64::NAN; names.len()];
        let references = references(names);
        ok(unsafe { fmi2GetReal(self.component, references.as_ptr(), names.len(), values.as_mut_ptr()) });
        values
    }

    pub fn get(&self, name: &str) -> f64 {
        self.get_all(&[name])[0]
    }

    pub fn count(&self, name: &str) -> i32 {
        let (reference, mut value) = (references(&[name]), -1);
        ok(unsafe { fmi2GetInteger(self.component, reference.as_ptr(), 1, &raw mut value) });
        value
    }

    pub fn rests(&self) -> bool {
        let (reference, mut value) = (references(&["contact.resting"]), -1);
        ok(unsafe { fmi2GetBoolean(self.component, reference.as_ptr(), 1, &raw mut value) });
        value == 1
    }

    pub fn step(&self, t: f64, h: f64) {
        self.step_warns(t, h);
    }

    /// Whether a step warns.
    pub fn step_warns(&self, t: f64, h: f64) -> bool {
        let status = unsafe { fmi2DoStep(self.component, t, h, 0) };
        ok(status);
        status == fmi2Warning
    }

    /// Whether the end of the run warns.
    pub fn terminate_warns(&self) -> bool {
        let status = unsafe { fmi2Terminate(self.component) };
        ok(status);
        status == fmi2Warning
    }

    pub fn choose(&self, name: &str, item: i32) {
        let reference = references(&[name]);
        ok(unsafe { fmi2SetInteger(self.component, reference.as_ptr(), 1, &raw const item) });
    }

    /// d unknown / d known, or the status if that is no good.
    pub fn try_derivatives(&self, unknowns: &[&str], known: &str) -> Result<Vec<f64>, fmi2Status> {
        let (unknown, known) = (references(unknowns), references(&[known]));
        let (seed, mut values) = (1.0, vec![f64::NAN; unknowns.len()]);
        let status = unsafe {
            let (known, values) = (known.as_ptr(), values.as_mut_ptr());
            fmi2GetDirectionalDerivative(
                self.component,
                unknown.as_ptr(),
                unknown.len(),
                known,
                1,
                &raw const seed,
                values,
            )
        };
        if status == fmi2OK { Ok(values) } else { Err(status) }
    }

    pub fn derivatives(&self, unknowns: &[&str], known: &str) -> Vec<f64> {
        self.try_derivatives(unknowns, known).expect(known)
    }

    /// A saved state, to be given to [`Host::restore`].
    pub fn save(&self) -> fmi2FMUstate {
        let mut state = null_mut();
        ok(unsafe { fmi2GetFMUstate(self.component, &raw mut state) });
        state
    }

    pub fn restore(&self, state: fmi2FMUstate) {
        ok(unsafe { fmi2SetFMUstate(self.component, state) });
    }

    pub fn free(&self, mut state: fmi2FMUstate) {
        ok(unsafe { fmi2FreeFMUstate(self.component, &raw mut state) });
    }

    pub fn serialize(&self) -> Vec<fmi2Byte> {
        let (state, mut size) = (self.save(), 0);
        ok(unsafe { fmi2SerializedFMUstateSize(self.component, state, &raw mut size) });
        let mut bytes = vec![0; size];
        ok(unsafe { fmi2SerializeFMUstate(self.component, state, bytes.as_mut_ptr(), size) });
        self.free(state);
        bytes
    }

    pub fn deserialize(&self, bytes: &[fmi2Byte]) {
        let mut state = null_mut();
        ok(unsafe { fmi2DeSerializeFMUstate(self.component, bytes.as_ptr(), bytes.len(), &raw mut state) });
        self.restore(state);
        self.free(state);
    }

    pub fn new_discrete_states(&self) {
        let mut info = fmi2EventInfo {
            newDiscreteStatesNeeded: 0,
            terminateSimulation: 0,
            nominalsOfContinuousStatesChanged: 0,
            valuesOfContinuousStatesChanged: 0,
            nextEventTimeDefined: 0,
            nextEventTime: 0.0,
        };
        ok(unsafe { fmi2NewDiscreteStates(self.component, &raw mut info) });
    }

    pub fn enter_event_mode(&self) {
        ok(unsafe { fmi2EnterEventMode(self.component) });
    }

    pub fn enter_continuous_time_mode(&self) {
        ok(unsafe { fmi2EnterContinuousTimeMode(self.component) });
    }

    pub fn place(&self, time: f64, states: [f64; 4]) {
        ok(unsafe { fmi2SetTime(self.component, time) });
        ok(unsafe { fmi2SetContinuousStates(self.component, states.as_ptr(), states.len()) });
    }
}
