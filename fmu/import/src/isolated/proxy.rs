//! The functions of an isolated FMU: the same table as those of a library, each a message to the worker.

use std::ffi::{CStr, CString, c_char};
use std::ptr;

use fmu_abi::{
    fmi2Boolean, fmi2Byte, fmi2CallbackFunctions, fmi2Component, fmi2Discard, fmi2Error, fmi2FMUstate, fmi2False,
    fmi2OK, fmi2Status, fmi2StatusKind, fmi2String, fmi2Type, fmi2Warning,
};

use super::protocol::{Given, Plain, Request};
use super::remote::{Remote, of};
use crate::library::{Functions, functions_in_scope};

/// # Safety
/// `items` points to `count` items.
unsafe fn copied<T: Copy>(items: *const T, count: usize) -> Vec<T> {
    // SAFETY: as the caller promises.
    unsafe { of_length(items.cast_mut(), count) }.to_vec()
}

/// # Safety
/// `items` points to `count` items, which nothing else uses meanwhile.
unsafe fn of_length<'a, T>(items: *mut T, count: usize) -> &'a mut [T] {
    if count == 0 {
        return &mut [];
    }
    // SAFETY: as the caller promises.
    unsafe { std::slice::from_raw_parts_mut(items, count) }
}

/// # Safety
/// `texts` points to `count` zero-terminated strings.
unsafe fn copied_texts(texts: *const fmi2String, count: usize) -> Vec<CString> {
    // SAFETY: as the caller promises.
    unsafe { copied(texts, count).into_iter().map(|text| CStr::from_ptr(text).to_owned()).collect() }
}

macro_rules! access {
    ($($get:ident, $set:ident, $type:ty, $Get:ident = $get_name:literal, $Set:ident = $set_name:literal;)*) => { $(
        unsafe extern "C" fn $get(c: fmi2Component, vr: *const u32, n: usize, values: *mut $type) -> fmi2Status {
            // SAFETY: the importer passes a living component and arrays of this length.
            let (remote, references, values) = unsafe { (of(c), copied(vr, n), of_length(values, n)) };
            let answer = remote.call($get_name, &Request::$Get { references });
            remote.fill($get_name, answer, values)
        }

        unsafe extern "C" fn $set(c: fmi2Component, vr: *const u32, n: usize, values: *const $type) -> fmi2Status {
            // SAFETY: as above.
            let (remote, references, values) = unsafe { (of(c), copied(vr, n), copied(values, n)) };
            remote.plain($set_name, &Request::$Set { references, values })
        }
    )* };
}

access! {
    get_real, set_real, f64, GetReal = "fmi2GetReal", SetReal = "fmi2SetReal";
    get_integer, set_integer, i32, GetInteger = "fmi2GetInteger", SetInteger = "fmi2SetInteger";
    get_boolean, set_boolean, i32, GetBoolean = "fmi2GetBoolean", SetBoolean = "fmi2SetBoolean";
}

unsafe extern "C" fn get_string(c: fmi2Component, vr: *const u32, n: usize, values: *mut fmi2String) -> fmi2Status {
    let name = "fmi2GetString";
    // SAFETY: the importer passes a living component and arrays of this length.
    let (remote, references, values) = unsafe { (of(c), copied(vr, n), of_length(values, n)) };
    let (status, given) = remote.call(name, &Request::GetString { references });
    match given {
        Given::Texts(texts) if texts.are(n) => {
            for (value, text) in values.iter_mut().zip(remote.keep(texts)) {
                *value = text;
            }
            status
        }
        _ if status != fmi2OK && status != fmi2Warning => status,
        _ => remote.garbled(name, &format!("something else than {n} texts")),
    }
}

unsafe extern "C" fn set_string(c: fmi2Component, vr: *const u32, n: usize, values: *const fmi2String) -> fmi2Status {
    // SAFETY: the importer passes a living component and arrays of this length.
    let (remote, references, values) = unsafe { (of(c), copied(vr, n), copied_texts(values, n)) };
    remote.plain("fmi2SetString", &Request::SetString { references, values })
}

unsafe extern "C" fn set_debug_logging(
    c: fmi2Component,
    on: fmi2Boolean,
    n: usize,
    categories: *const fmi2String,
) -> fmi2Status {
    // SAFETY: as above.
    let (remote, categories) = unsafe { (of(c), copied_texts(categories, n)) };
    remote.plain("fmi2SetDebugLogging", &Request::SetDebugLogging { on, categories })
}

/// Instances are made by the pool of their FMU: this function does not know of which FMU.
unsafe extern "C" fn instantiate(
    _: fmi2String,
    _: fmi2Type,
    _: fmi2String,
    _: fmi2String,
    _: *const fmi2CallbackFunctions,
    _: fmi2Boolean,
    _: fmi2Boolean,
) -> fmi2Component {
    ptr::null_mut()
}

unsafe extern "C" fn free_instance(c: fmi2Component) {
    // SAFETY: `Remote::instantiate` has made it, and the importer frees it once.
    let mut remote = unsafe { Box::from_raw(c.cast::<Remote>()) };
    remote.free();
}

unsafe extern "C" fn setup_experiment(
    c: fmi2Component,
    has_tolerance: fmi2Boolean,
    tolerance: f64,
    start: f64,
    has_stop: fmi2Boolean,
    stop: f64,
) -> fmi2Status {
    let tolerance = (has_tolerance != fmi2False).then_some(tolerance);
    let stop = (has_stop != fmi2False).then_some(stop);
    // SAFETY: the importer passes a living component.
    let remote = unsafe { of(c) };
    remote.plain("fmi2SetupExperiment", &Request::SetupExperiment { tolerance, start, stop })
}

macro_rules! plain {
    ($($function:ident = $Function:ident $name:literal;)*) => { $(
        unsafe extern "C" fn $function(c: fmi2Component) -> fmi2Status {
            // SAFETY: the importer passes a living component.
            unsafe { of(c) }.plain($name, &Request::Plain(Plain::$Function))
        }
    )* };
}

plain! {
    enter_initialization_mode = EnterInitializationMode "fmi2EnterInitializationMode";
    exit_initialization_mode = ExitInitializationMode "fmi2ExitInitializationMode";
    terminate = Terminate "fmi2Terminate";
    reset = Reset "fmi2Reset";
}

unsafe extern "C" fn do_step(c: fmi2Component, time: f64, step: f64, keeps_no_state: fmi2Boolean) -> fmi2Status {
    // SAFETY: the importer passes a living component.
    let remote = unsafe { of(c) };
    remote.step(time, step, keeps_no_state)
}

unsafe extern "C" fn get_state(c: fmi2Component, state: *mut fmi2FMUstate) -> fmi2Status {
    // SAFETY: the importer passes a living component and a place for the state.
    let (remote, state) = unsafe { (of(c), &mut *state) };
    let name = "fmi2GetFMUstate";
    let answer = remote.call(name, &Request::GetState { state: number_of(*state) });
    let (status, number) = remote.number(name, answer);
    keep(state, status, number);
    status
}

unsafe extern "C" fn set_state(c: fmi2Component, state: fmi2FMUstate) -> fmi2Status {
    // SAFETY: the importer passes a living component.
    unsafe { of(c) }.plain("fmi2SetFMUstate", &Request::SetState { state: number_of(state) })
}

unsafe extern "C" fn free_state(c: fmi2Component, state: *mut fmi2FMUstate) -> fmi2Status {
    // SAFETY: the importer passes a living component and the place of a state.
    let (remote, state) = unsafe { (of(c), &mut *state) };
    let status = remote.plain("fmi2FreeFMUstate", &Request::FreeState { state: number_of(*state) });
    *state = ptr::null_mut();
    status
}

unsafe extern "C" fn serialized_state_size(c: fmi2Component, state: fmi2FMUstate, size: *mut usize) -> fmi2Status {
    // SAFETY: the importer passes a living component and a place for the size.
    let (remote, size) = unsafe { (of(c), &mut *size) };
    let name = "fmi2SerializedFMUstateSize";
    let answer = remote.call(name, &Request::StateSize { state: number_of(state) });
    let (status, number) = remote.number(name, answer);
    *size = usize::try_from(number).unwrap_or(usize::MAX);
    status
}

unsafe extern "C" fn serialize_state(
    c: fmi2Component,
    state: fmi2FMUstate,
    bytes: *mut fmi2Byte,
    size: usize,
) -> fmi2Status {
    let name = "fmi2SerializeFMUstate";
    // SAFETY: the importer passes a living component and a buffer of this size.
    let (remote, bytes) = unsafe { (of(c), of_length(bytes.cast::<u8>(), size)) };
    let request = Request::SerializeState { state: number_of(state), size: size as u64 };
    let (status, given) = remote.call(name, &request);
    match given {
        Given::Bytes(found) if found.len() == size => {
            bytes.copy_from_slice(&found);
            status
        }
        _ if status != fmi2OK && status != fmi2Warning => status,
        _ => remote.garbled(name, &format!("something else than {size} bytes")),
    }
}

unsafe extern "C" fn deserialize_state(
    c: fmi2Component,
    bytes: *const fmi2Byte,
    size: usize,
    state: *mut fmi2FMUstate,
) -> fmi2Status {
    let name = "fmi2DeSerializeFMUstate";
    // SAFETY: the importer passes a living component, as many bytes, and a place for the state.
    let (remote, bytes, state) = unsafe { (of(c), copied(bytes.cast::<u8>(), size), &mut *state) };
    let answer = remote.call(name, &Request::DeserializeState { bytes });
    let (status, number) = remote.number(name, answer);
    keep(state, status, number);
    status
}

/// The number that a state goes by; the importer takes it for a pointer, which it never follows.
fn number_of(state: fmi2FMUstate) -> u64 {
    state.addr() as u64
}

fn keep(state: &mut fmi2FMUstate, status: fmi2Status, number: u64) {
    if status == fmi2OK || status == fmi2Warning {
        *state = ptr::without_provenance_mut(usize::try_from(number).unwrap_or_default());
    }
}

unsafe extern "C" fn get_directional_derivative(
    c: fmi2Component,
    unknowns: *const u32,
    unknown_count: usize,
    knowns: *const u32,
    known_count: usize,
    seed: *const f64,
    result: *mut f64,
) -> fmi2Status {
    let name = "fmi2GetDirectionalDerivative";
    // SAFETY: the importer passes a living component and arrays of these lengths.
    let (remote, unknowns, knowns, seed, result) = unsafe {
        let (unknowns, knowns) = (copied(unknowns, unknown_count), copied(knowns, known_count));
        (of(c), unknowns, knowns, copied(seed, known_count), of_length(result, unknown_count))
    };
    let answer = remote.call(name, &Request::DirectionalDerivative { unknowns, knowns, seed });
    remote.fill(name, answer, result)
}

unsafe extern "C" fn set_real_input_derivatives(
    c: fmi2Component,
    vr: *const u32,
    n: usize,
    orders: *const i32,
    values: *const f64,
) -> fmi2Status {
    // SAFETY: the importer passes a living component and arrays of this length.
    let (remote, references, orders, values) = unsafe { (of(c), copied(vr, n), copied(orders, n), copied(values, n)) };
    remote.plain("fmi2SetRealInputDerivatives", &Request::SetInputDerivatives { references, orders, values })
}

unsafe extern "C" fn get_real_output_derivatives(
    c: fmi2Component,
    vr: *const u32,
    n: usize,
    orders: *const i32,
    values: *mut f64,
) -> fmi2Status {
    let name = "fmi2GetRealOutputDerivatives";
    // SAFETY: as above.
    let (remote, references, orders, values) =
        unsafe { (of(c), copied(vr, n), copied(orders, n), of_length(values, n)) };
    let answer = remote.call(name, &Request::GetOutputDerivatives { references, orders });
    remote.fill(name, answer, values)
}

unsafe extern "C" fn get_real_status(c: fmi2Component, kind: fmi2StatusKind, value: *mut f64) -> fmi2Status {
    let name = "fmi2GetRealStatus";
    // SAFETY: the importer passes a living component and a place for the value.
    let (remote, value) = unsafe { (of(c), of_length(value, 1)) };
    let answer = remote.call(name, &Request::RealStatus { kind });
    remote.fill(name, answer, value)
}

unsafe extern "C" fn get_boolean_status(c: fmi2Component, kind: fmi2StatusKind, value: *mut i32) -> fmi2Status {
    let name = "fmi2GetBooleanStatus";
    // SAFETY: as above.
    let (remote, value) = unsafe { (of(c), of_length(value, 1)) };
    let answer = remote.call(name, &Request::BooleanStatus { kind });
    remote.fill(name, answer, value)
}

/// The importer asks for no step to be taken asynchronously.
unsafe extern "C" fn never(_: fmi2Component) -> fmi2Status {
    fmi2Error
}

unsafe extern "C" fn no_status<T>(_: fmi2Component, _: fmi2StatusKind, _: *mut T) -> fmi2Status {
    fmi2Discard
}

/// The importer has asked the library itself.
unsafe extern "C" fn no_text() -> *const c_char {
    ptr::null()
}

use self::{
    never as cancel_step, no_status as get_status, no_status as get_integer_status, no_status as get_string_status,
    no_text as get_types_platform, no_text as get_version,
};

/// The table.
pub(crate) const FUNCTIONS: Functions = functions_in_scope!();
