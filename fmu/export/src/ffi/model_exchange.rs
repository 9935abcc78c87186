//! Functions of model exchange.

use super::{array, array_out, enter, out};
use crate::call_state::Function;
use crate::instance::{Call, Instance};
use crate::slave::Slave;
use core::mem::MaybeUninit;
use fmu_abi::{fmi2Boolean, fmi2Component, fmi2EventInfo, fmi2False, fmi2Real, fmi2Status};

/// `fmi2EnterEventMode`
pub unsafe fn enter_event_mode<S: Slave>(c: fmi2Component) -> fmi2Status {
    // SAFETY: contract of this module.
    unsafe { enter::<S>(c, Function::EnterEventMode, Instance::enter_event_mode) }
}

/// `fmi2NewDiscreteStates`
pub unsafe fn new_discrete_states<S: Slave>(c: fmi2Component, info: *mut fmi2EventInfo) -> fmi2Status {
    let call = |i: &mut Instance<S>| {
        // SAFETY: contract of this module.
        let info = unsafe { out(info, "eventInfo") }?;
        let outcome = i.new_discrete_states()?;
        info.write(fmi2EventInfo {
            newDiscreteStatesNeeded: fmi2False,
            terminateSimulation: fmi2False,
            nominalsOfContinuousStatesChanged: fmi2False,
            valuesOfContinuousStatesChanged: outcome.states_changed.into(),
            nextEventTimeDefined: outcome.next_event_time.is_some().into(),
            nextEventTime: outcome.next_event_time.unwrap_or_default(),
        });
        Ok(())
    };
    // SAFETY: contract of this module.
    unsafe { enter(c, Function::NewDiscreteStates, call) }
}

/// `fmi2EnterContinuousTimeMode`
pub unsafe fn enter_continuous_time_mode<S: Slave>(c: fmi2Component) -> fmi2Status {
    // SAFETY: contract of this module.
    unsafe { enter::<S>(c, Function::EnterContinuousTimeMode, Instance::enter_continuous_time_mode) }
}

/// `fmi2CompletedIntegratorStep`: nothing to do, and no reason to enter event mode. `modelDescription.xml` says that it
/// need not be called.
pub unsafe fn completed_integrator_step<S: Slave>(
    c: fmi2Component,
    _no_set_fmu_state_prior_to_current_point: fmi2Boolean,
    enter_event_mode: *mut fmi2Boolean,
    terminate_simulation: *mut fmi2Boolean,
) -> fmi2Status {
    let call = |_: &mut Instance<S>| {
        // SAFETY: contract of this module.
        unsafe { out(enter_event_mode, "enterEventMode") }?.write(fmi2False);
        // SAFETY: contract of this module.
        unsafe { out(terminate_simulation, "terminateSimulation") }?.write(fmi2False);
        Ok(())
    };
    // SAFETY: contract of this module.
    unsafe { enter(c, Function::CompletedIntegratorStep, call) }
}

/// `fmi2SetTime`
pub unsafe fn set_time<S: Slave>(c: fmi2Component, time: fmi2Real) -> fmi2Status {
    // SAFETY: contract of this module.
    unsafe { enter::<S>(c, Function::SetTime, |i| i.set_time(time)) }
}

/// `fmi2SetContinuousStates`
pub unsafe fn set_continuous_states<S: Slave>(c: fmi2Component, x: *const fmi2Real, nx: usize) -> fmi2Status {
    let call = |i: &mut Instance<S>| {
        // SAFETY: contract of this module.
        let states = unsafe { array(x, nx, "x") }?;
        i.set_continuous_states(states)
    };
    // SAFETY: contract of this module.
    unsafe { enter(c, Function::SetContinuousStates, call) }
}

/// Fills an array with what `values` gives.
unsafe fn fill<S: Slave>(
    i: &mut Instance<S>,
    (pointer, count, argument): (*mut fmi2Real, usize, &'static str),
    values: impl FnOnce(&mut Instance<S>, usize) -> Call<Vec<f64>>,
) -> Call {
    // SAFETY: contract of this module.
    let places = unsafe { array_out(pointer, count, argument) }?;
    let values = values(i, count)?;
    places.iter_mut().zip(values).for_each(|(place, value): (&mut MaybeUninit<f64>, f64)| {
        place.write(value);
    });
    Ok(())
}

macro_rules! getters {
    ($($name:ident $c_name:literal $function:ident $argument:literal $body:ident;)*) => {$(
        #[doc = concat!("`", $c_name, "`")]
        pub unsafe fn $name<S: Slave>(c: fmi2Component, values: *mut fmi2Real, count: usize) -> fmi2Status {
            // SAFETY: contract of this module.
            let call = |i: &mut Instance<S>| unsafe { fill(i, (values, count, $argument), Instance::$body) };
            // SAFETY: contract of this module.
            unsafe { enter(c, Function::$function, call) }
        }
    )*};
}
getters! {
    get_derivatives "fmi2GetDerivatives" GetDerivatives "derivatives" derivatives;
    get_event_indicators "fmi2GetEventIndicators" GetEventIndicators "eventIndicators" event_indicators;
    get_continuous_states "fmi2GetContinuousStates" GetContinuousStates "x" continuous_states;
    get_nominals "fmi2GetNominalsOfContinuousStates" GetNominals "x_nominal" nominals;
}
