//! Functions of co-simulation.

use super::{array, array_out, enter, out};
use crate::call_state::Function;
use crate::error::CallError;
use crate::instance::Instance;
use crate::slave::Slave;
use fmu_abi::{
    fmi2Boolean, fmi2Component, fmi2Integer, fmi2Real, fmi2Status, fmi2StatusKind, fmi2String, fmi2ValueReference,
};

/// `fmi2SetRealInputDerivatives`
pub unsafe fn set_real_input_derivatives<S: Slave>(
    c: fmi2Component,
    references: *const fmi2ValueReference,
    count: usize,
    orders: *const fmi2Integer,
    values: *const fmi2Real,
) -> fmi2Status {
    let call = |i: &mut Instance<S>| {
        // SAFETY: contract of this module.
        let references = unsafe { array(references, count, "vr") }?;
        // SAFETY: contract of this module.
        let orders = unsafe { array(orders, count, "order") }?;
        // SAFETY: contract of this module.
        let values = unsafe { array(values, count, "value") }?;
        i.set_input_derivatives(references, orders, values)
    };
    // SAFETY: contract of this module.
    unsafe { enter(c, Function::SetRealInputDerivatives, call) }
}

/// `fmi2GetRealOutputDerivatives`
pub unsafe fn get_real_output_derivatives<S: Slave>(
    c: fmi2Component,
    references: *const fmi2ValueReference,
    count: usize,
    orders: *const fmi2Integer,
    values: *mut fmi2Real,
) -> fmi2Status {
    let call = |i: &mut Instance<S>| {
        // SAFETY: contract of this module.
        let references = unsafe { array(references, count, "vr") }?;
        // SAFETY: contract of this module.
        let orders = unsafe { array(orders, count, "order") }?;
        // SAFETY: contract of this module.
        let values = unsafe { array_out(values, count, "value") }?;
        i.get_output_derivatives(references, orders, |k, value| {
            values[k].write(value);
        })
    };
    // SAFETY: contract of this module.
    unsafe { enter(c, Function::GetRealOutputDerivatives, call) }
}

/// `fmi2DoStep`. The last argument is a hint that this exporter has no use for.
pub unsafe fn do_step<S: Slave>(
    c: fmi2Component,
    current_communication_point: fmi2Real,
    communication_step_size: fmi2Real,
    _no_set_fmu_state_prior_to_current_point: fmi2Boolean,
) -> fmi2Status {
    let (t, h) = (current_communication_point, communication_step_size);
    // SAFETY: contract of this module.
    unsafe { enter::<S>(c, Function::DoStep, |i| i.do_step(t, h)) }
}

/// `fmi2CancelStep`: no step is ever under way, so it is always illegal.
pub unsafe fn cancel_step<S: Slave>(c: fmi2Component) -> fmi2Status {
    let call = |_: &mut Instance<S>| Err(CallError::Unsupported("asynchronous steps"));
    // SAFETY: contract of this module.
    unsafe { enter(c, Function::CancelStep, call) }
}

macro_rules! status_functions {
    ($($name:ident $c_name:literal $function:ident $value:ty, |$i:ident, $kind:ident| $get:expr;)*) => {$(
        #[doc = concat!("`", $c_name, "`")]
        pub unsafe fn $name<S: Slave>(
            c: fmi2Component,
            $kind: fmi2StatusKind,
            value: *mut $value,
        ) -> fmi2Status {
            let call = |$i: &mut Instance<S>| {
                // SAFETY: contract of this module.
                let value = unsafe { out(value, "value") }?;
                value.write($get?);
                Ok(())
            };
            // SAFETY: contract of this module.
            unsafe { enter(c, Function::$function, call) }
        }
    )*};
}
status_functions! {
    get_status "fmi2GetStatus" GetStatus fmi2Status, |i, kind| i.step_status(kind);
    get_real_status "fmi2GetRealStatus" GetRealStatus fmi2Real, |i, kind| i.real_status(kind);
    get_integer_status "fmi2GetIntegerStatus" GetIntegerStatus fmi2Integer,
        |_i, kind| Err(CallError::NoStatus(kind));
    get_boolean_status "fmi2GetBooleanStatus" GetBooleanStatus fmi2Boolean,
        |i, kind| i.boolean_status(kind).map(fmi2Boolean::from);
    get_string_status "fmi2GetStringStatus" GetStringStatus fmi2String,
        |_i, kind| Err(CallError::NoStatus(kind));
}
