//! Functions that co-simulation shares with model exchange: life cycle, logging, Get and Set.

use super::{array, array_out, enter, text};
use crate::call_state::Function;
use crate::error::CallError;
use crate::instance::Instance;
use crate::slave::{Experiment, Slave};
use crate::variable::{AsBoolean, AsInteger, AsReal, AsString};
use core::ffi::c_char;
use fmu_abi::{
    fmi2Boolean, fmi2Component, fmi2False, fmi2Integer, fmi2Real, fmi2Status, fmi2String, fmi2ValueReference,
};

/// `fmi2GetTypesPlatform`
pub const fn get_types_platform() -> *const c_char {
    c"default".as_ptr()
}

/// `fmi2GetVersion`
pub const fn get_version() -> *const c_char {
    c"2.0".as_ptr()
}

/// `fmi2SetDebugLogging`
pub unsafe fn set_debug_logging<S: Slave>(
    c: fmi2Component,
    on: fmi2Boolean,
    count: usize,
    categories: *const fmi2String,
) -> fmi2Status {
    let call = |i: &mut Instance<S>| {
        // SAFETY: contract of this module.
        let names = unsafe { array(categories, count, "categories") }?;
        // SAFETY: contract of this module.
        let names = names.iter().map(|&name| unsafe { text(name) });
        let names = names.collect::<Result<Vec<_>, _>>();
        let names = names.map_err(|reason| CallError::BadArray { argument: "categories", count, reason })?;
        i.set_debug_logging(on != fmi2False, &names);
        Ok(())
    };
    // SAFETY: contract of this module.
    unsafe { enter(c, Function::SetDebugLogging, call) }
}

/// `fmi2SetupExperiment`
pub unsafe fn setup_experiment<S: Slave>(
    c: fmi2Component,
    tolerance_defined: fmi2Boolean,
    tolerance: fmi2Real,
    start_time: fmi2Real,
    stop_time_defined: fmi2Boolean,
    stop_time: fmi2Real,
) -> fmi2Status {
    let experiment = Experiment {
        start_time,
        stop_time: (stop_time_defined != fmi2False).then_some(stop_time),
        tolerance: (tolerance_defined != fmi2False).then_some(tolerance),
    };
    // SAFETY: contract of this module.
    unsafe { enter::<S>(c, Function::SetupExperiment, |i| i.setup_experiment(experiment)) }
}

/// `fmi2EnterInitializationMode`
pub unsafe fn enter_initialization_mode<S: Slave>(c: fmi2Component) -> fmi2Status {
    let function = Function::EnterInitializationMode;
    // SAFETY: contract of this module.
    unsafe { enter::<S>(c, function, Instance::enter_initialization_mode) }
}

/// `fmi2ExitInitializationMode`
pub unsafe fn exit_initialization_mode<S: Slave>(c: fmi2Component) -> fmi2Status {
    let function = Function::ExitInitializationMode;
    // SAFETY: contract of this module.
    unsafe { enter::<S>(c, function, Instance::exit_initialization_mode) }
}

/// `fmi2Terminate`
pub unsafe fn terminate<S: Slave>(c: fmi2Component) -> fmi2Status {
    // SAFETY: contract of this module.
    unsafe { enter::<S>(c, Function::Terminate, Instance::terminate) }
}

/// `fmi2Reset`
pub unsafe fn reset<S: Slave>(c: fmi2Component) -> fmi2Status {
    let call = |i: &mut Instance<S>| {
        i.reset();
        Ok(())
    };
    // SAFETY: contract of this module.
    unsafe { enter(c, Function::Reset, call) }
}

macro_rules! getters {
    ($($name:ident $c_name:literal $function:ident $value:ty, |$i:ident, $vr:ident, $put:ident| $get:expr;)*) => {$(
        #[doc = concat!("`", $c_name, "`")]
        pub unsafe fn $name<S: Slave>(
            c: fmi2Component,
            references: *const fmi2ValueReference,
            count: usize,
            values: *mut $value,
        ) -> fmi2Status {
            let call = |$i: &mut Instance<S>| {
                // SAFETY: contract of this module.
                let $vr = unsafe { array(references, count, "vr") }?;
                // SAFETY: contract of this module.
                let values = unsafe { array_out(values, count, "value") }?;
                let $put = |k: usize, value: $value| {
                    values[k].write(value);
                };
                $get
            };
            // SAFETY: contract of this module.
            unsafe { enter(c, Function::$function, call) }
        }
    )*};
}
getters! {
    get_real "fmi2GetReal" GetReal fmi2Real, |i, vr, put| i.get::<AsReal>(vr, put);
    get_integer "fmi2GetInteger" GetInteger fmi2Integer, |i, vr, put| i.get::<AsInteger>(vr, put);
    get_boolean "fmi2GetBoolean" GetBoolean fmi2Boolean, |i, vr, put| i.get::<AsBoolean>(vr, put);
    get_string "fmi2GetString" GetString fmi2String, |i, vr, put| i.get_strings(vr, put);
}

macro_rules! setters {
    ($($name:ident $c_name:literal $function:ident $value:ty, |$i:ident, $vr:ident, $values:ident| $set:expr;)*) => {$(
        #[doc = concat!("`", $c_name, "`")]
        pub unsafe fn $name<S: Slave>(
            c: fmi2Component,
            references: *const fmi2ValueReference,
            count: usize,
            values: *const $value,
        ) -> fmi2Status {
            let call = |$i: &mut Instance<S>| {
                // SAFETY: contract of this module.
                let $vr = unsafe { array(references, count, "vr") }?;
                // SAFETY: contract of this module.
                let $values = unsafe { array(values, count, "value") }?;
                $set
            };
            // SAFETY: contract of this module.
            unsafe { enter(c, Function::$function, call) }
        }
    )*};
}
setters! {
    set_real "fmi2SetReal" SetReal fmi2Real, |i, vr, values| i.set_reals(vr, values);
    set_integer "fmi2SetInteger" SetInteger fmi2Integer, |i, vr, values| i.set::<AsInteger, _>(vr, values, |value| value);
    set_boolean "fmi2SetBoolean" SetBoolean fmi2Boolean,
        |i, vr, values| i.set::<AsBoolean, _>(vr, values, |value| value != fmi2False);
    set_string "fmi2SetString" SetString fmi2String,
        // SAFETY: contract of this module.
        |i, vr, values| i.set::<AsString, _>(vr, values, |value| unsafe { text(value) });
}
