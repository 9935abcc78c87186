//! The functions that take a component and return a status, one row each: the pointers become slices, and one function of
//! the instance does the work.

use super::{array, array_out, enter, give, replace, text};
use crate::call_state::Function;
use crate::error::CallError;
use crate::instance::Instance;
use crate::slave::{EventOutcome, Experiment, Slave};
use crate::variable::{AsBoolean, AsInteger, AsReal, AsString};
use fmu_abi::{
    fmi2Boolean, fmi2Byte, fmi2Component, fmi2EventInfo, fmi2FMUstate, fmi2False, fmi2Integer, fmi2Real, fmi2Status,
    fmi2StatusKind, fmi2String, fmi2ValueReference,
};

macro_rules! functions {
    ($($name:ident $function:ident($($argument:ident: $kind:ty),*) |$i:ident| $body:expr;)*) => {$(
        #[doc = concat!("`", stringify!($name), "`")]
        pub unsafe fn $name<S: Slave>(c: fmi2Component $(, $argument: $kind)*) -> fmi2Status {
            // SAFETY: contract of this module.
            unsafe { enter(c, Function::$function.row(), |$i: &mut Instance<S>| $body) }
        }
    )*};
}

// Life cycle, logging, Get and Set.
functions! {
    fmi2SetDebugLogging SetDebugLogging(on: fmi2Boolean, count: usize, categories: *const fmi2String) |i| {
        let names: Result<Vec<_>, _> = array(categories, count, "categories")?.iter().map(|name| text(*name)).collect();
        let names = names.map_err(|reason| CallError::BadArray { argument: "categories", count, reason })?;
        i.set_debug_logging(on != fmi2False, &names);
        Ok(())
    };
    fmi2SetupExperiment SetupExperiment(
        tolerance_defined: fmi2Boolean, tolerance: fmi2Real, start_time: fmi2Real, stop_time_defined: fmi2Boolean,
        stop_time: fmi2Real
    ) |i| i.setup_experiment(Experiment {
        start_time,
        stop_time: (stop_time_defined != fmi2False).then_some(stop_time),
        tolerance: (tolerance_defined != fmi2False).then_some(tolerance),
    });
    fmi2EnterInitializationMode EnterInitializationMode() |i| i.enter_initialization_mode();
    fmi2ExitInitializationMode ExitInitializationMode() |i| i.exit_initialization_mode();
    fmi2Terminate Terminate() |i| i.terminate();
    fmi2Reset Reset() |i| {
        i.reset();
        Ok(())
    };
    fmi2GetReal GetReal(vr: *const fmi2ValueReference, nvr: usize, value: *mut fmi2Real)
        |i| i.get::<AsReal>(array(vr, nvr, "vr")?, array_out(value, nvr, "value")?);
    fmi2GetInteger GetInteger(vr: *const fmi2ValueReference, nvr: usize, value: *mut fmi2Integer)
        |i| i.get::<AsInteger>(array(vr, nvr, "vr")?, array_out(value, nvr, "value")?);
    fmi2GetBoolean GetBoolean(vr: *const fmi2ValueReference, nvr: usize, value: *mut fmi2Boolean)
        |i| i.get::<AsBoolean>(array(vr, nvr, "vr")?, array_out(value, nvr, "value")?);
    fmi2GetString GetString(vr: *const fmi2ValueReference, nvr: usize, value: *mut fmi2String)
        |i| i.get_strings(array(vr, nvr, "vr")?, array_out(value, nvr, "value")?);
    fmi2SetReal SetReal(vr: *const fmi2ValueReference, nvr: usize, value: *const fmi2Real)
        |i| i.set_reals::<AsReal>(array(vr, nvr, "vr")?, array(value, nvr, "value")?);
    fmi2SetInteger SetInteger(vr: *const fmi2ValueReference, nvr: usize, value: *const fmi2Integer)
        |i| i.set::<AsInteger, _>(array(vr, nvr, "vr")?, array(value, nvr, "value")?, |value| value);
    fmi2SetBoolean SetBoolean(vr: *const fmi2ValueReference, nvr: usize, value: *const fmi2Boolean)
        |i| i.set::<AsBoolean, _>(array(vr, nvr, "vr")?, array(value, nvr, "value")?, |value| value != fmi2False);
    fmi2SetString SetString(vr: *const fmi2ValueReference, nvr: usize, value: *const fmi2String)
        |i| i.set::<AsString, _>(array(vr, nvr, "vr")?, array(value, nvr, "value")?, |value| text(value));
}

// FMU states and directional derivatives.
functions! {
    fmi2GetFMUstate GetFmuState(state: *mut fmi2FMUstate) |i| replace(state, |token| i.save(token));
    fmi2SetFMUstate SetFmuState(state: fmi2FMUstate) |i| match state.addr() {
        0 => Err(CallError::NullArgument("FMUstate")),
        token => i.restore(token),
    };
    fmi2FreeFMUstate FreeFmuState(state: *mut fmi2FMUstate) |i| if state.is_null() { Ok(()) } else {
        replace(state, |token| i.free_state(token).map(|()| 0))
    };
    fmi2SerializedFMUstateSize SerializedFmuStateSize(state: fmi2FMUstate, size: *mut usize)
        |i| give(size, "size", || Ok(i.serialize(state.addr())?.len()));
    fmi2SerializeFMUstate SerializeFmuState(state: fmi2FMUstate, bytes: *mut fmi2Byte, size: usize)
        |i| i.serialize_into(state.addr(), size, |length| array_out(bytes.cast::<u8>(), length, "serializedState"));
    fmi2DeSerializeFMUstate DeSerializeFmuState(bytes: *const fmi2Byte, size: usize, state: *mut fmi2FMUstate) |i| {
        let blob = array(bytes.cast::<u8>(), size, "serializedState")?;
        replace(state, |token| i.deserialize(blob, token))
    };
    fmi2GetDirectionalDerivative GetDirectionalDerivative(
        unknown: *const fmi2ValueReference, unknown_count: usize, known: *const fmi2ValueReference, known_count: usize,
        known_seed: *const fmi2Real, unknown_sensitivity: *mut fmi2Real
    ) |i| i.directional_derivative(
        array(unknown, unknown_count, "vUnknown_ref")?,
        array(known, known_count, "vKnown_ref")?,
        array(known_seed, known_count, i.seed_argument())?,
        array_out(unknown_sensitivity, unknown_count, "dvUnknown")?,
    );
}

// Co-simulation. No step is ever under way when a function is called: there is none to cancel.
functions! {
    fmi2SetRealInputDerivatives SetRealInputDerivatives(
        vr: *const fmi2ValueReference, nvr: usize, order: *const fmi2Integer, value: *const fmi2Real
    ) |i| i.set_input_derivatives(array(vr, nvr, "vr")?, array(order, nvr, "order")?, array(value, nvr, "value")?);
    fmi2GetRealOutputDerivatives GetRealOutputDerivatives(
        vr: *const fmi2ValueReference, nvr: usize, order: *const fmi2Integer, value: *mut fmi2Real
    ) |i| i.get_output_derivatives(array(vr, nvr, "vr")?, array(order, nvr, "order")?, array_out(value, nvr, "value")?);
    fmi2DoStep DoStep(t: fmi2Real, h: fmi2Real, _no_set_fmu_state_prior_to_current_point: fmi2Boolean) |i| i.do_step(t, h);
    fmi2CancelStep CancelStep() |_i| Err(CallError::Unsupported("asynchronous steps"));
    fmi2GetStatus GetStatus(kind: fmi2StatusKind, value: *mut fmi2Status)
        |i| give(value, "value", || i.step_status(kind));
    fmi2GetRealStatus GetRealStatus(kind: fmi2StatusKind, value: *mut fmi2Real)
        |i| give(value, "value", || i.real_status(kind));
    fmi2GetIntegerStatus GetIntegerStatus(kind: fmi2StatusKind, value: *mut fmi2Integer)
        |_i| give(value, "value", || Err(CallError::NoStatus(kind)));
    fmi2GetBooleanStatus GetBooleanStatus(kind: fmi2StatusKind, value: *mut fmi2Boolean)
        |i| give(value, "value", || i.boolean_status(kind).map(fmi2Boolean::from));
    fmi2GetStringStatus GetStringStatus(kind: fmi2StatusKind, value: *mut fmi2String)
        |_i| give(value, "value", || Err(CallError::NoStatus(kind)));
}

// Model exchange. At the end of an integrator step there is nothing to do, and no reason to enter event mode;
// `modelDescription.xml` says that the function need not be called.
functions! {
    fmi2EnterEventMode EnterEventMode() |i| i.enter_event_mode();
    fmi2NewDiscreteStates NewDiscreteStates(info: *mut fmi2EventInfo)
        |i| give(info, "eventInfo", || i.new_discrete_states().map(event_info));
    fmi2EnterContinuousTimeMode EnterContinuousTimeMode() |i| i.enter_continuous_time_mode();
    fmi2CompletedIntegratorStep CompletedIntegratorStep(
        _no_set_fmu_state_prior_to_current_point: fmi2Boolean, enter_event_mode: *mut fmi2Boolean,
        terminate_simulation: *mut fmi2Boolean
    ) |_i| {
        give(enter_event_mode, "enterEventMode", || Ok(fmi2False))?;
        give(terminate_simulation, "terminateSimulation", || Ok(fmi2False))
    };
    fmi2SetTime SetTime(time: fmi2Real) |i| i.set_time(time);
    fmi2SetContinuousStates SetContinuousStates(x: *const fmi2Real, nx: usize)
        |i| i.set_continuous_states(array(x, nx, "x")?);
    fmi2GetDerivatives GetDerivatives(derivatives: *mut fmi2Real, nx: usize)
        |i| i.derivatives(nx, array_out(derivatives, nx, "derivatives")?);
    fmi2GetEventIndicators GetEventIndicators(indicators: *mut fmi2Real, ni: usize)
        |i| i.event_indicators(ni, array_out(indicators, ni, "eventIndicators")?);
    fmi2GetContinuousStates GetContinuousStates(x: *mut fmi2Real, nx: usize)
        |i| i.get_continuous_states(nx, array_out(x, nx, "x")?);
    fmi2GetNominalsOfContinuousStates GetNominals(nominals: *mut fmi2Real, nx: usize)
        |i| i.nominals(nx, array_out(nominals, nx, "x_nominal")?);
}

fn event_info(outcome: EventOutcome) -> fmi2EventInfo {
    fmi2EventInfo {
        newDiscreteStatesNeeded: fmi2False,
        terminateSimulation: fmi2False,
        nominalsOfContinuousStatesChanged: fmi2False,
        valuesOfContinuousStatesChanged: outcome.states_changed.into(),
        nextEventTimeDefined: outcome.next_event_time.is_some().into(),
        nextEventTime: outcome.next_event_time.unwrap_or_default(),
    }
}
