//! One instance of an FMU with its log, and the calls that tests make of it. Each gives the status as it comes.

// A helper fails a test by a panic; states are tokens, which nobody dereferences.
#![allow(clippy::missing_panics_doc, clippy::missing_errors_doc, clippy::not_unsafe_ptr_arg_deref)]

use crate::{Functions, Line, Log};
use core::ffi::CStr;
use core::ptr::{null, null_mut};
use fmu_export::abi::{
    fmi2Boolean, fmi2Byte, fmi2CoSimulation, fmi2Component, fmi2EventInfo, fmi2FMUstate, fmi2False, fmi2OK, fmi2Status,
    fmi2StatusKind, fmi2String, fmi2True, fmi2Type, fmi2Warning,
};
use std::ffi::CString;

/// An instance of an FMU; dropping it frees it.
pub struct Host {
    /// The functions of the FMU.
    pub functions: Functions,
    /// The component.
    pub component: fmi2Component,
    log: *mut Log,
}

impl Drop for Host {
    fn drop(&mut self) {
        // SAFETY: the component is live or NULL, the log came from `Box::into_raw`, and nobody uses them any more.
        unsafe {
            (self.functions.fmi2FreeInstance)(self.component);
            drop(Box::from_raw(self.log));
        }
    }
}

/// That a call worked, with a warning or without.
#[track_caller]
pub fn ok(status: fmi2Status) {
    assert!(status == fmi2OK || status == fmi2Warning, "status {status}");
}

macro_rules! values {
    ($($get:ident $try_get:ident $c_get:ident $set:ident $c_set:ident $kind:ty, $start:expr;)*) => {$(
        /// The value of one variable.
        pub fn $get(&self, reference: u32) -> $kind {
            let (status, value) = self.$try_get(reference);
            ok(status);
            value
        }

        /// The same with the status; where the call fails, what was there before.
        pub fn $try_get(&self, reference: u32) -> (fmi2Status, $kind) {
            let mut value: $kind = $start;
            // SAFETY: one reference, one value.
            let status = unsafe { (self.functions.$c_get)(self.component, &raw const reference, 1, &raw mut value) };
            (status, value)
        }

        /// Sets one variable.
        pub fn $set(&self, reference: u32, value: $kind) -> fmi2Status {
            // SAFETY: one reference, one value.
            unsafe { (self.functions.$c_set)(self.component, &raw const reference, 1, &raw const value) }
        }
    )*};
}

macro_rules! plain {
    ($($name:ident $c_name:ident;)*) => {$(
        #[doc = concat!("`", stringify!($c_name), "`")]
        pub fn $name(&self) -> fmi2Status {
            // SAFETY: the component is live or NULL.
            unsafe { (self.functions.$c_name)(self.component) }
        }
    )*};
}

/// Placed where an FMU is to write, so that it shows if it does not.
pub const UNTOUCHED: f64 = -77.0;

impl Host {
    /// A fresh instance; its component is NULL if the FMU gives none.
    pub fn new(functions: Functions, name: &CStr, guid: &CStr, kind: fmi2Type) -> Self {
        let log = Box::into_raw(Box::<Log>::default());
        // SAFETY: the log lives until the instance is dropped; the strings are zero-terminated.
        let component = unsafe {
            let callbacks = Log::callbacks(log);
            let instantiate = functions.fmi2Instantiate;
            instantiate(name.as_ptr(), kind, guid.as_ptr(), null(), &raw const callbacks, fmi2False, fmi2True)
        };
        Self { functions, component, log }
    }

    /// The same for an FMU with these functions and this GUID.
    pub fn of(functions: Functions, guid: &str, exchange: bool) -> Self {
        let guid = CString::new(guid).unwrap_or_default();
        let host = Self::new(functions, c"toy", &guid, fmi2CoSimulation - fmi2Type::from(exchange));
        assert!(!host.component.is_null(), "{:?}", host.lines());
        host
    }

    /// What the logger writes to, behind the back of the compiler.
    #[allow(clippy::mut_from_ref)]
    pub fn log(&self) -> &mut Log {
        // SAFETY: the log lives as long as the instance, and the FMU is in no call.
        unsafe { &mut *self.log }
    }

    /// The messages since this was last asked.
    pub fn lines(&self) -> Vec<Line> {
        self.log().take()
    }

    plain! {
        enter_initialization fmi2EnterInitializationMode;
        exit_initialization fmi2ExitInitializationMode;
        terminate fmi2Terminate;
        reset fmi2Reset;
    }

    values! {
        real try_real fmi2GetReal set_real fmi2SetReal f64, UNTOUCHED;
        integer try_integer fmi2GetInteger set_integer fmi2SetInteger i32, -77;
        boolean try_boolean fmi2GetBoolean set_boolean fmi2SetBoolean fmi2Boolean, -77;
        pointer try_pointer fmi2GetString set_pointer fmi2SetString fmi2String, null();
    }

    /// A String.
    pub fn string(&self, reference: u32) -> String {
        // SAFETY: the FMU gave a zero-terminated text that lives until the next call.
        unsafe { CStr::from_ptr(self.pointer(reference)) }.to_string_lossy().into_owned()
    }

    /// Sets a String.
    pub fn set_string(&self, reference: u32, value: &str) -> fmi2Status {
        let value = CString::new(value).unwrap_or_default();
        self.set_pointer(reference, value.as_ptr())
    }

    /// Several Reals at once.
    pub fn reals(&self, references: &[u32]) -> Vec<f64> {
        let mut values = vec![f64::NAN; references.len()];
        let get = self.functions.fmi2GetReal;
        // SAFETY: as many values as references.
        ok(unsafe { get(self.component, references.as_ptr(), references.len(), values.as_mut_ptr()) });
        values
    }

    /// Sets several Reals at once.
    pub fn set_reals(&self, references: &[u32], values: &[f64]) -> fmi2Status {
        assert_eq!(references.len(), values.len());
        let set = self.functions.fmi2SetReal;
        // SAFETY: as many values as references.
        unsafe { set(self.component, references.as_ptr(), references.len(), values.as_ptr()) }
    }

    /// `fmi2SetupExperiment` without a tolerance.
    pub fn setup(&self, start: f64, stop: Option<f64>) -> fmi2Status {
        let (defined, stop) = (stop.is_some().into(), stop.unwrap_or(f64::NAN));
        // SAFETY: the component is live or NULL.
        unsafe { (self.functions.fmi2SetupExperiment)(self.component, fmi2False, f64::NAN, start, defined, stop) }
    }

    /// Through initialization mode.
    pub fn initialize(&self) -> fmi2Status {
        match self.enter_initialization() {
            fmi2OK => self.exit_initialization(),
            other => other,
        }
    }

    /// `fmi2DoStep`
    pub fn step(&self, t: f64, h: f64) -> fmi2Status {
        // SAFETY: the component is live or NULL.
        unsafe { (self.functions.fmi2DoStep)(self.component, t, h, fmi2True) }
    }

    /// Sets the derivative of this order of an input.
    pub fn set_derivative(&self, reference: u32, order: i32, value: f64) -> fmi2Status {
        let (vr, order, value) = (&raw const reference, &raw const order, &raw const value);
        // SAFETY: one reference, one order, one value.
        unsafe { (self.functions.fmi2SetRealInputDerivatives)(self.component, vr, 1, order, value) }
    }

    /// The derivative of this order of an output.
    pub fn output_derivative(&self, reference: u32, order: i32) -> (fmi2Status, f64) {
        let (mut value, vr, order) = (UNTOUCHED, &raw const reference, &raw const order);
        let get = self.functions.fmi2GetRealOutputDerivatives;
        // SAFETY: one reference, one order, one value.
        let status = unsafe { get(self.component, vr, 1, order, &raw mut value) };
        (status, value)
    }

    /// `fmi2GetDirectionalDerivative`
    pub fn directional_derivative(
        &self,
        unknowns: &[u32],
        knowns: &[u32],
        seeds: &[f64],
    ) -> Result<Vec<f64>, fmi2Status> {
        assert_eq!(knowns.len(), seeds.len());
        let mut values = vec![UNTOUCHED; unknowns.len()];
        let (unknown, known, count) = (unknowns.as_ptr(), knowns.as_ptr(), knowns.len());
        let derivative = self.functions.fmi2GetDirectionalDerivative;
        // SAFETY: as many seeds as knowns, as many values as unknowns.
        let status = unsafe {
            let (seeds, values) = (seeds.as_ptr(), values.as_mut_ptr());
            derivative(self.component, unknown, unknowns.len(), known, count, seeds, values)
        };
        if status == fmi2OK { Ok(values) } else { Err(status) }
    }

    /// A new FMU state.
    pub fn save(&self) -> fmi2FMUstate {
        let mut state = null_mut();
        ok(self.save_in(&mut state));
        assert!(!state.is_null());
        state
    }

    /// `fmi2GetFMUstate`
    pub fn save_in(&self, state: &mut fmi2FMUstate) -> fmi2Status {
        // SAFETY: a place for a state.
        unsafe { (self.functions.fmi2GetFMUstate)(self.component, state) }
    }

    /// `fmi2SetFMUstate`
    pub fn restore(&self, state: fmi2FMUstate) -> fmi2Status {
        // SAFETY: states are tokens.
        unsafe { (self.functions.fmi2SetFMUstate)(self.component, state) }
    }

    /// `fmi2FreeFMUstate`
    pub fn free_state(&self, state: &mut fmi2FMUstate) -> fmi2Status {
        // SAFETY: a place with a state.
        unsafe { (self.functions.fmi2FreeFMUstate)(self.component, state) }
    }

    /// Bytes of a state.
    pub fn try_serialize(&self, state: fmi2FMUstate) -> Result<Vec<fmi2Byte>, fmi2Status> {
        let (mut size, f) = (0, &self.functions);
        let checked = |status| if status > fmi2Warning { Err(status) } else { Ok(()) };
        // SAFETY: a place for the size, then as many bytes.
        unsafe {
            checked((f.fmi2SerializedFMUstateSize)(self.component, state, &raw mut size))?;
            let mut bytes = vec![0; size];
            checked((f.fmi2SerializeFMUstate)(self.component, state, bytes.as_mut_ptr(), size))?;
            Ok(bytes)
        }
    }

    /// The same, which must work.
    pub fn serialize(&self, state: fmi2FMUstate) -> Vec<fmi2Byte> {
        self.try_serialize(state).unwrap_or_else(|status| {
            ok(status);
            Vec::new()
        })
    }

    /// `fmi2DeSerializeFMUstate`
    pub fn deserialize(&self, bytes: &[fmi2Byte], state: &mut fmi2FMUstate) -> fmi2Status {
        // SAFETY: so many bytes, and a place for a state.
        unsafe { (self.functions.fmi2DeSerializeFMUstate)(self.component, bytes.as_ptr(), bytes.len(), state) }
    }

    /// `fmi2GetRealStatus`
    pub fn real_status(&self, kind: fmi2StatusKind) -> (fmi2Status, f64) {
        let mut value = UNTOUCHED;
        // SAFETY: a place for the value.
        let status = unsafe { (self.functions.fmi2GetRealStatus)(self.component, kind, &raw mut value) };
        (status, value)
    }

    /// `fmi2GetBooleanStatus`
    pub fn boolean_status(&self, kind: fmi2StatusKind) -> (fmi2Status, fmi2Boolean) {
        let mut value = -77;
        // SAFETY: a place for the value.
        let status = unsafe { (self.functions.fmi2GetBooleanStatus)(self.component, kind, &raw mut value) };
        (status, value)
    }

    /// `fmi2NewDiscreteStates`
    pub fn new_discrete_states(&self) -> (fmi2Status, fmi2EventInfo) {
        let mut info = fmi2EventInfo {
            newDiscreteStatesNeeded: 7,
            terminateSimulation: 7,
            nominalsOfContinuousStatesChanged: 7,
            valuesOfContinuousStatesChanged: 7,
            nextEventTimeDefined: 7,
            nextEventTime: UNTOUCHED,
        };
        // SAFETY: a place for the event.
        let status = unsafe { (self.exchange().fmi2NewDiscreteStates)(self.component, &raw mut info) };
        (status, info)
    }

    /// `fmi2EnterEventMode`
    pub fn enter_event_mode(&self) -> fmi2Status {
        // SAFETY: the component is live or NULL.
        unsafe { (self.exchange().fmi2EnterEventMode)(self.component) }
    }

    /// `fmi2EnterContinuousTimeMode`
    pub fn enter_continuous_time_mode(&self) -> fmi2Status {
        // SAFETY: the component is live or NULL.
        unsafe { (self.exchange().fmi2EnterContinuousTimeMode)(self.component) }
    }

    /// Goes to a time and continuous states.
    pub fn place(&self, time: f64, states: &[f64]) -> fmi2Status {
        // SAFETY: so many states.
        unsafe {
            ok((self.exchange().fmi2SetTime)(self.component, time));
            (self.exchange().fmi2SetContinuousStates)(self.component, states.as_ptr(), states.len())
        }
    }

    #[allow(clippy::expect_used)] // a helper fails a test, too
    fn exchange(&self) -> &crate::Exchange {
        self.functions.exchange.as_ref().expect("model exchange")
    }
}
