//! An FMU in this program, for tests: it keeps five reals and three integers, and does on command what real ones do
//! on bad days.
#![allow(non_snake_case)] // names of the standard

use std::ffi::{CStr, CString, c_char};

use fmu_abi::*;

use super::library::{Functions, functions_in_scope};
use super::{Fmu, ModelDescription};

/// A step of this size makes the FMU return the status of the same number.
pub(super) const TROUBLE: f64 = 1000.0;

struct Component {
    callbacks: *const fmi2CallbackFunctions,
    name: CString,
    reals: [f64; 5],
    integers: [i32; 3],
    booleans: [fmi2Boolean; 2],
    text: CString,
    /// States that are not freed yet; a component must outlive them.
    states: u32,
    dead: bool,
}

pub(super) fn fmu() -> Fmu {
    let description = ModelDescription::parse(include_bytes!("testdata/good.xml"), "test").unwrap();
    Fmu::of(&FUNCTIONS, description)
}

/// An FMU that is compiled for another guid.
pub(super) fn stranger() -> Fmu {
    let text = include_str!("testdata/good.xml").replace("{guid}", "{other}");
    Fmu::of(&FUNCTIONS, ModelDescription::parse(text.as_bytes(), "test").unwrap())
}

unsafe fn of<'a>(component: fmi2Component) -> &'a mut Component {
    unsafe { &mut *component.cast() }
}

unsafe fn say(callbacks: *const fmi2CallbackFunctions, name: *const c_char, status: fmi2Status, text: &CStr) {
    unsafe {
        let environment = (*callbacks).componentEnvironment;
        let logger = (*callbacks).logger.unwrap();
        logger(environment, name, status, c"logStatusError".as_ptr(), c"%s".as_ptr(), text.as_ptr());
    }
}

unsafe extern "C" fn version() -> *const c_char {
    c"2.0".as_ptr()
}

unsafe extern "C" fn fmi2Instantiate(
    name: fmi2String,
    _: fmi2Type,
    guid: fmi2String,
    _: fmi2String,
    callbacks: *const fmi2CallbackFunctions,
    _: fmi2Boolean,
    _: fmi2Boolean,
) -> fmi2Component {
    unsafe {
        if CStr::from_ptr(guid) != c"{guid}" {
            say(callbacks, name, fmi2Error, c"wrong guid");
            return std::ptr::null_mut();
        }
        let memory = ((*callbacks).allocateMemory.unwrap())(4, 8);
        assert!(!memory.is_null());
        ((*callbacks).freeMemory.unwrap())(memory);
        let name = CStr::from_ptr(name).to_owned();
        let (reals, integers, booleans) = ([0.0; 5], [7, 1, 0], [1, 0]);
        let component =
            Component { callbacks, name, reals, integers, booleans, text: c"a & b".to_owned(), states: 0, dead: false };
        Box::into_raw(Box::new(component)).cast()
    }
}

unsafe extern "C" fn fmi2FreeInstance(component: fmi2Component) {
    let component = unsafe { Box::from_raw(component.cast::<Component>()) };
    if component.dead || component.states != 0 {
        std::process::abort();
    }
}

unsafe extern "C" fn fmi2DoStep(component: fmi2Component, time: f64, step: f64, _: fmi2Boolean) -> fmi2Status {
    unsafe {
        let component = of(component);
        if step >= TROUBLE {
            #[allow(clippy::cast_possible_truncation)]
            let status = (step - TROUBLE) as fmi2Status;
            say(component.callbacks, component.name.as_ptr(), status, c"trouble in the step");
            component.dead = status == fmi2Fatal;
            return status;
        }
        component.reals[1] = time + step;
        fmi2OK
    }
}

macro_rules! access {
    ($get:ident, $set:ident, $type:ty, $field:ident) => {
        unsafe extern "C" fn $get(c: fmi2Component, refs: *const u32, n: usize, out: *mut $type) -> fmi2Status {
            for i in 0..n {
                unsafe { *out.add(i) = of(c).$field[*refs.add(i) as usize] };
            }
            fmi2OK
        }
        unsafe extern "C" fn $set(c: fmi2Component, refs: *const u32, n: usize, values: *const $type) -> fmi2Status {
            for i in 0..n {
                unsafe { of(c).$field[*refs.add(i) as usize] = *values.add(i) };
            }
            fmi2Warning
        }
    };
}
access!(fmi2GetReal, fmi2SetReal, f64, reals);
access!(fmi2GetInteger, fmi2SetInteger, i32, integers);
access!(fmi2GetBoolean, fmi2SetBoolean, fmi2Boolean, booleans);

unsafe extern "C" fn fmi2GetString(c: fmi2Component, _: *const u32, n: usize, out: *mut fmi2String) -> fmi2Status {
    for i in 0..n {
        unsafe { *out.add(i) = of(c).text.as_ptr() };
    }
    fmi2OK
}

unsafe extern "C" fn fmi2SetString(c: fmi2Component, _: *const u32, _: usize, values: *const fmi2String) -> fmi2Status {
    unsafe { of(c).text = CStr::from_ptr(*values).to_owned() };
    fmi2OK
}

unsafe extern "C" fn fmi2GetFMUstate(c: fmi2Component, state: *mut fmi2FMUstate) -> fmi2Status {
    unsafe {
        if (*state).is_null() {
            of(c).states += 1;
            *state = Box::into_raw(Box::new(of(c).reals)).cast();
        } else {
            *(*state).cast::<[f64; 5]>() = of(c).reals;
        }
    }
    fmi2OK
}

unsafe extern "C" fn fmi2SetFMUstate(c: fmi2Component, state: fmi2FMUstate) -> fmi2Status {
    unsafe { of(c).reals = *state.cast::<[f64; 5]>() };
    fmi2OK
}

unsafe extern "C" fn fmi2FreeFMUstate(c: fmi2Component, state: *mut fmi2FMUstate) -> fmi2Status {
    unsafe {
        if of(c).dead {
            std::process::abort();
        }
        of(c).states -= 1;
        drop(Box::from_raw((*state).cast::<[f64; 5]>()));
        *state = std::ptr::null_mut();
    }
    fmi2OK
}

unsafe extern "C" fn fmi2SerializedFMUstateSize(_: fmi2Component, _: fmi2FMUstate, size: *mut usize) -> fmi2Status {
    unsafe { *size = 40 };
    fmi2OK
}

unsafe extern "C" fn fmi2SerializeFMUstate(
    _: fmi2Component,
    state: fmi2FMUstate,
    to: *mut fmi2Byte,
    size: usize,
) -> fmi2Status {
    unsafe { state.cast::<fmi2Byte>().copy_to(to, size) };
    fmi2OK
}

unsafe extern "C" fn fmi2DeSerializeFMUstate(
    c: fmi2Component,
    from: *const fmi2Byte,
    size: usize,
    state: *mut fmi2FMUstate,
) -> fmi2Status {
    if size != 40 {
        return fmi2Error;
    }
    unsafe {
        fmi2GetFMUstate(c, state);
        from.copy_to((*state).cast(), size);
    }
    fmi2OK
}

unsafe extern "C" fn fmi2SetRealInputDerivatives(
    c: fmi2Component,
    _: *const u32,
    _: usize,
    orders: *const i32,
    values: *const f64,
) -> fmi2Status {
    unsafe { of(c).reals[3] = f64::from(*orders) * *values };
    fmi2OK
}

unsafe extern "C" fn fmi2GetRealOutputDerivatives(
    c: fmi2Component,
    _: *const u32,
    _: usize,
    orders: *const i32,
    values: *mut f64,
) -> fmi2Status {
    unsafe { *values = of(c).reals[3] * f64::from(*orders) };
    fmi2OK
}

unsafe extern "C" fn fmi2GetRealStatus(c: fmi2Component, kind: fmi2StatusKind, value: *mut f64) -> fmi2Status {
    if kind != fmi2LastSuccessfulTime {
        return fmi2Discard;
    }
    unsafe { *value = of(c).reals[1] };
    fmi2OK
}

/// Functions that return a status and do nothing.
macro_rules! only_status {
    ($($name:ident($($argument:ty),*) = $status:expr;)*) => {
        $(unsafe extern "C" fn $name($(_: $argument),*) -> fmi2Status { $status })*
    };
}
only_status! {
    plain(fmi2Component) = fmi2OK;
    fmi2SetupExperiment(fmi2Component, i32, f64, f64, i32, f64) = fmi2OK;
    fmi2GetDirectionalDerivative(fmi2Component, *const u32, usize, *const u32, usize, *const f64, *mut f64) = fmi2Error;
}

unsafe extern "C" fn fmi2Reset(c: fmi2Component) -> fmi2Status {
    unsafe { of(c).reals = [0.0; 5] };
    fmi2OK
}

unsafe extern "C" fn fmi2SetDebugLogging(
    c: fmi2Component,
    on: fmi2Boolean,
    n: usize,
    names: *const fmi2String,
) -> fmi2Status {
    if on == fmi2True && n == 1 {
        unsafe { of(c).text = CStr::from_ptr(*names).to_owned() };
    }
    fmi2OK
}

unsafe extern "C" fn no_status<T>(_: fmi2Component, _: fmi2StatusKind, _: *mut T) -> fmi2Status {
    fmi2Discard
}

use self::{
    no_status as fmi2GetStatus, no_status as fmi2GetIntegerStatus, no_status as fmi2GetBooleanStatus,
    no_status as fmi2GetStringStatus, plain as fmi2EnterInitializationMode, plain as fmi2ExitInitializationMode,
    plain as fmi2Terminate, plain as fmi2CancelStep, version as fmi2GetTypesPlatform, version as fmi2GetVersion,
};

const FUNCTIONS: Functions = functions_in_scope!();
