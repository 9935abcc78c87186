//! The functions that take an instance and return a status, one row each: the pointers become slices, and one function of the
//! instance does the work.

use super::Function;
use crate::error::CallError;
use crate::ffi::{array, array_out, check_array, enter, give, replace, text};
use crate::instance::{Call, Instance};
use crate::slave::{EventOutcome, Experiment, Slave};
use crate::variable::{
    AsBoolean, AsFloat32, AsFloat64, AsInt8, AsInt16, AsInt32, AsInt64, AsString, AsUInt8, AsUInt16, AsUInt32, AsUInt64,
};
use fmu_abi::fmi3::{
    fmi3Binary, fmi3Boolean, fmi3Byte, fmi3Clock, fmi3DependencyKind, fmi3FMUState, fmi3False, fmi3Float32,
    fmi3Float64, fmi3Instance, fmi3Int8, fmi3Int16, fmi3Int32, fmi3Int64, fmi3IntervalQualifier, fmi3Status,
    fmi3String, fmi3UInt8, fmi3UInt16, fmi3UInt32, fmi3UInt64, fmi3ValueReference,
};

type References = *const fmi3ValueReference;

macro_rules! functions {
    ($($name:ident $function:ident($($argument:ident: $kind:ty),*) |$i:ident| $body:expr;)*) => {$(
        #[doc = concat!("`", stringify!($name), "`")]
        #[allow(clippy::too_many_arguments)] // those of the C function
        pub unsafe fn $name<S: Slave>(instance: fmi3Instance $(, $argument: $kind)*) -> fmi3Status {
            // SAFETY: contract of this module.
            unsafe { enter(instance, Function::$function.row(), |$i: &mut Instance<S>| $body) }
        }
    )*};
}

/// The count of values beside that of the references: there are no arrays, so it is the same.
fn same(count: usize, references: usize) -> Call {
    if count == references {
        return Ok(());
    }
    let bound = format!("{references} value references have as many values, no variable is an array");
    Err(CallError::BadArgument { argument: "nValues", value: count.to_string(), bound })
}

/// What an FMU without this capability says.
fn unsupported<T>(what: &'static str) -> Call<T> {
    Err(CallError::Unsupported(what))
}

/// There are no such variables, so every reference is a wrong one.
fn none<S: Slave>(i: &Instance<S>, references: &[u32], wanted: &'static str) -> Call {
    references.first().map_or(Ok(()), |reference| Err(i.wrong_type(*reference, wanted)))
}

// Life cycle and logging.
functions! {
    fmi3SetDebugLogging SetDebugLogging(on: fmi3Boolean, count: usize, categories: *const fmi3String) |i| {
        let names: Result<Vec<_>, _> = array(categories, count, "categories")?.iter().map(|name| text(*name)).collect();
        let names = names.map_err(|reason| CallError::BadArray { argument: "categories", count, reason })?;
        i.set_debug_logging(on != fmi3False, &names);
        Ok(())
    };
    fmi3EnterInitializationMode EnterInitializationMode(
        tolerance_defined: fmi3Boolean, tolerance: fmi3Float64, start_time: fmi3Float64, stop_time_defined: fmi3Boolean,
        stop_time: fmi3Float64
    ) |i| {
        i.setup_experiment(Experiment {
            start_time,
            stop_time: (stop_time_defined != fmi3False).then_some(stop_time),
            tolerance: (tolerance_defined != fmi3False).then_some(tolerance),
        })?;
        i.enter_initialization_mode()
    };
    fmi3ExitInitializationMode ExitInitializationMode() |i| i.exit_initialization_mode();
    fmi3Terminate Terminate() |i| i.terminate();
    fmi3Reset Reset() |i| {
        i.reset();
        Ok(())
    };
    fmi3EnterConfigurationMode EnterConfigurationMode() |_i| unsupported("structural parameters");
    fmi3ExitConfigurationMode ExitConfigurationMode() |_i| unsupported("structural parameters");
}

/// Get and Set of one type.
macro_rules! values {
    ($($get:ident $get_function:ident $set:ident $set_function:ident $kind:ty, $transfer:ty;)*) => {$(
        functions! {
            $get $get_function(vr: References, nvr: usize, values: *mut $kind, count: usize) |i| {
                same(count, nvr)?;
                i.get::<$transfer>(array(vr, nvr, "valueReferences")?, array_out(values, nvr, "values")?)
            };
            $set $set_function(vr: References, nvr: usize, values: *const $kind, count: usize) |i| {
                same(count, nvr)?;
                i.set::<$transfer, _>(array(vr, nvr, "valueReferences")?, array(values, nvr, "values")?, |value| value)
            };
        }
    )*};
}
values! {
    fmi3GetFloat32 GetFloat32 fmi3SetFloat32 SetFloat32 fmi3Float32, AsFloat32;
    fmi3GetInt8 GetInt8 fmi3SetInt8 SetInt8 fmi3Int8, AsInt8;
    fmi3GetUInt8 GetUInt8 fmi3SetUInt8 SetUInt8 fmi3UInt8, AsUInt8;
    fmi3GetInt16 GetInt16 fmi3SetInt16 SetInt16 fmi3Int16, AsInt16;
    fmi3GetUInt16 GetUInt16 fmi3SetUInt16 SetUInt16 fmi3UInt16, AsUInt16;
    fmi3GetInt32 GetInt32 fmi3SetInt32 SetInt32 fmi3Int32, AsInt32;
    fmi3GetUInt32 GetUInt32 fmi3SetUInt32 SetUInt32 fmi3UInt32, AsUInt32;
    fmi3GetInt64 GetInt64 fmi3SetInt64 SetInt64 fmi3Int64, AsInt64;
    fmi3GetUInt64 GetUInt64 fmi3SetUInt64 SetUInt64 fmi3UInt64, AsUInt64;
}

functions! {
    fmi3GetFloat64 GetFloat64(vr: References, nvr: usize, values: *mut fmi3Float64, count: usize) |i| {
        same(count, nvr)?;
        i.get_floats::<AsFloat64>(array(vr, nvr, "valueReferences")?, array_out(values, nvr, "values")?)
    };
    fmi3SetFloat64 SetFloat64(vr: References, nvr: usize, values: *const fmi3Float64, count: usize) |i| {
        same(count, nvr)?;
        i.set_reals::<AsFloat64>(array(vr, nvr, "valueReferences")?, array(values, nvr, "values")?)
    };
    fmi3GetBoolean GetBoolean(vr: References, nvr: usize, values: *mut fmi3Boolean, count: usize) |i| {
        same(count, nvr)?;
        let mut write = array_out(values, nvr, "values")?;
        i.get::<AsBoolean>(array(vr, nvr, "valueReferences")?, |k, value| write(k, (value != 0).into()))
    };
    fmi3SetBoolean SetBoolean(vr: References, nvr: usize, values: *const fmi3Boolean, count: usize) |i| {
        same(count, nvr)?;
        let values = array(values, nvr, "values")?;
        i.set::<AsBoolean, _>(array(vr, nvr, "valueReferences")?, values, |value| value != fmi3False)
    };
    fmi3GetString GetString(vr: References, nvr: usize, values: *mut fmi3String, count: usize) |i| {
        same(count, nvr)?;
        i.get_strings(array(vr, nvr, "valueReferences")?, array_out(values, nvr, "values")?)
    };
    fmi3SetString SetString(vr: References, nvr: usize, values: *const fmi3String, count: usize) |i| {
        same(count, nvr)?;
        let values = array(values, nvr, "values")?;
        i.set::<AsString, _>(array(vr, nvr, "valueReferences")?, values, |value| text(value))
    };
    fmi3GetBinary GetBinary(
        vr: References, nvr: usize, _sizes: *mut usize, _values: *mut fmi3Binary, count: usize
    ) |i| {
        same(count, nvr)?;
        none(i, array(vr, nvr, "valueReferences")?, "Binary")
    };
    fmi3SetBinary SetBinary(
        vr: References, nvr: usize, _sizes: *const usize, _values: *const fmi3Binary, count: usize
    ) |i| {
        same(count, nvr)?;
        none(i, array(vr, nvr, "valueReferences")?, "Binary")
    };
}

// Clocks and events. There is nothing to evaluate ahead of fmi3UpdateDiscreteStates, and no interval changes.
functions! {
    fmi3GetClock GetClock(vr: References, nvr: usize, values: *mut fmi3Clock) |i| {
        let mut write = array_out(values, nvr, "values")?;
        i.get_clocks(array(vr, nvr, "valueReferences")?, |k, ticks| write(k, ticks.into()))
    };
    fmi3SetClock SetClock(vr: References, nvr: usize, values: *const fmi3Clock) |i| {
        let values: Vec<_> = array(values, nvr, "values")?.iter().map(|value| *value != fmi3False).collect();
        i.set_clocks(array(vr, nvr, "valueReferences")?, &values)
    };
    fmi3GetIntervalDecimal GetIntervalDecimal(
        vr: References, nvr: usize, intervals: *mut fmi3Float64, qualifiers: *mut fmi3IntervalQualifier
    ) |i| {
        let mut write = array_out(intervals, nvr, "intervals")?;
        let mut qualify = array_out(qualifiers, nvr, "qualifiers")?;
        i.get_intervals(array(vr, nvr, "valueReferences")?, |k, [interval, _]| {
            write(k, interval);
            qualify(k, fmu_abi::fmi3::fmi3IntervalUnchanged);
        })
    };
    fmi3GetShiftDecimal GetShiftDecimal(vr: References, nvr: usize, shifts: *mut fmi3Float64) |i| {
        let mut write = array_out(shifts, nvr, "shifts")?;
        i.get_intervals(array(vr, nvr, "valueReferences")?, |k, [_, shift]| write(k, shift))
    };
    fmi3GetIntervalFraction GetIntervalFraction(
        _vr: References, _nvr: usize, _counters: *mut fmi3UInt64, _resolutions: *mut fmi3UInt64,
        _qualifiers: *mut fmi3IntervalQualifier
    ) |_i| unsupported("intervals of clocks as fractions");
    fmi3GetShiftFraction GetShiftFraction(
        _vr: References, _nvr: usize, _counters: *mut fmi3UInt64, _resolutions: *mut fmi3UInt64
    ) |_i| unsupported("shifts of clocks as fractions");
    fmi3SetIntervalDecimal SetIntervalDecimal(
        _vr: References, _nvr: usize, _intervals: *const fmi3Float64
    ) |_i| unsupported("clocks whose interval can be set");
    fmi3SetIntervalFraction SetIntervalFraction(
        _vr: References, _nvr: usize, _counters: *const fmi3UInt64, _resolutions: *const fmi3UInt64
    ) |_i| unsupported("clocks whose interval can be set");
    fmi3SetShiftDecimal SetShiftDecimal(
        _vr: References, _nvr: usize, _shifts: *const fmi3Float64
    ) |_i| unsupported("clocks whose shift can be set");
    fmi3SetShiftFraction SetShiftFraction(
        _vr: References, _nvr: usize, _counters: *const fmi3UInt64, _resolutions: *const fmi3UInt64
    ) |_i| unsupported("clocks whose shift can be set");
    fmi3EnterEventMode EnterEventMode() |i| i.enter_event_mode();
    fmi3EvaluateDiscreteStates EvaluateDiscreteStates() |_i| unsupported("fmi3EvaluateDiscreteStates");
    fmi3UpdateDiscreteStates UpdateDiscreteStates(
        again: *mut fmi3Boolean, terminate: *mut fmi3Boolean, nominals_changed: *mut fmi3Boolean,
        values_changed: *mut fmi3Boolean, next_defined: *mut fmi3Boolean, next: *mut fmi3Float64
    ) |i| {
        check_array(values_changed, 1, "valuesOfContinuousStatesChanged")?;
        check_array(next_defined, 1, "nextEventTimeDefined")?;
        check_array(next, 1, "nextEventTime")?;
        give(again, "discreteStatesNeedUpdate", || Ok(fmi3False))?;
        give(terminate, "terminateSimulation", || Ok(fmi3False))?;
        give(nominals_changed, "nominalsOfContinuousStatesChanged", || Ok(fmi3False))?;
        let EventOutcome { states_changed, next_event_time } = i.new_discrete_states()?;
        give(values_changed, "valuesOfContinuousStatesChanged", || Ok(states_changed.into()))?;
        give(next_defined, "nextEventTimeDefined", || Ok(next_event_time.is_some().into()))?;
        give(next, "nextEventTime", || Ok(next_event_time.unwrap_or_default()))
    };
}

// FMU states, dependencies and derivatives.
functions! {
    fmi3GetFMUState GetFmuState(state: *mut fmi3FMUState) |i| replace(state, |token| i.save(token));
    fmi3SetFMUState SetFmuState(state: fmi3FMUState) |i| match state.addr() {
        0 => Err(CallError::NullArgument("FMUState")),
        token => i.restore(token),
    };
    fmi3FreeFMUState FreeFmuState(state: *mut fmi3FMUState) |i| if state.is_null() { Ok(()) } else {
        replace(state, |token| i.free_state(token).map(|()| 0))
    };
    fmi3SerializedFMUStateSize SerializedFmuStateSize(state: fmi3FMUState, size: *mut usize)
        |i| give(size, "size", || Ok(i.serialize(state.addr())?.len()));
    fmi3SerializeFMUState SerializeFmuState(state: fmi3FMUState, bytes: *mut fmi3Byte, size: usize)
        |i| i.serialize_into(state.addr(), size, |length| array_out(bytes, length, "serializedState"));
    fmi3DeserializeFMUState DeserializeFmuState(bytes: *const fmi3Byte, size: usize, state: *mut fmi3FMUState) |i| {
        let blob = array(bytes, size, "serializedState")?;
        replace(state, |token| i.deserialize(blob, token))
    };
    fmi3GetNumberOfVariableDependencies GetNumberOfVariableDependencies(
        _vr: fmi3ValueReference, _count: *mut usize
    ) |_i| unsupported("dependencies of single elements");
    fmi3GetVariableDependencies GetVariableDependencies(
        _dependent: fmi3ValueReference, _elements: *mut usize, _independents: *mut fmi3ValueReference,
        _elements_of_independents: *mut usize, _kinds: *mut fmi3DependencyKind, _count: usize
    ) |_i| unsupported("dependencies of single elements");
    fmi3GetDirectionalDerivative GetDirectionalDerivative(
        unknowns: References, unknown_count: usize, knowns: References, known_count: usize, seed: *const fmi3Float64,
        seed_count: usize, sensitivity: *mut fmi3Float64, sensitivity_count: usize
    ) |i| {
        same(seed_count, known_count)?;
        same(sensitivity_count, unknown_count)?;
        i.directional_derivative(
            array(unknowns, unknown_count, "unknowns")?,
            array(knowns, known_count, "knowns")?,
            array(seed, known_count, i.seed_argument())?,
            array_out(sensitivity, unknown_count, "sensitivity")?,
        )
    };
    fmi3GetAdjointDerivative GetAdjointDerivative(
        unknowns: References, unknown_count: usize, knowns: References, known_count: usize, seed: *const fmi3Float64,
        seed_count: usize, sensitivity: *mut fmi3Float64, sensitivity_count: usize
    ) |i| {
        same(seed_count, unknown_count)?;
        same(sensitivity_count, known_count)?;
        i.adjoint_derivative(
            array(unknowns, unknown_count, "unknowns")?,
            array(knowns, known_count, "knowns")?,
            array(seed, unknown_count, i.seed_argument())?,
            array_out(sensitivity, known_count, "sensitivity")?,
        )
    };
}

// Model exchange. The end of an integrator step need not be told; `modelDescription.xml` says so.
functions! {
    fmi3EnterContinuousTimeMode EnterContinuousTimeMode() |i| i.enter_continuous_time_mode();
    fmi3CompletedIntegratorStep CompletedIntegratorStep(
        _no_set_fmu_state_prior_to_current_point: fmi3Boolean, enter_event_mode: *mut fmi3Boolean,
        terminate_simulation: *mut fmi3Boolean
    ) |_i| {
        give(enter_event_mode, "enterEventMode", || Ok(fmi3False))?;
        give(terminate_simulation, "terminateSimulation", || Ok(fmi3False))
    };
    fmi3SetTime SetTime(time: fmi3Float64) |i| i.set_time(time);
    fmi3SetContinuousStates SetContinuousStates(x: *const fmi3Float64, nx: usize)
        |i| i.set_continuous_states(array(x, nx, "continuousStates")?);
    fmi3GetContinuousStateDerivatives GetContinuousStateDerivatives(derivatives: *mut fmi3Float64, nx: usize)
        |i| i.derivatives(nx, array_out(derivatives, nx, "derivatives")?);
    fmi3GetEventIndicators GetEventIndicators(indicators: *mut fmi3Float64, ni: usize)
        |i| i.event_indicators(ni, array_out(indicators, ni, "eventIndicators")?);
    fmi3GetContinuousStates GetContinuousStates(x: *mut fmi3Float64, nx: usize)
        |i| i.get_continuous_states(nx, array_out(x, nx, "continuousStates")?);
    fmi3GetNominalsOfContinuousStates GetNominals(nominals: *mut fmi3Float64, nx: usize)
        |i| i.nominals(nx, array_out(nominals, nx, "nominals")?);
    fmi3GetNumberOfEventIndicators GetNumberOfEventIndicators(count: *mut usize)
        |_i| give(count, "nEventIndicators", || Ok(S::INFO.model_exchange.unwrap_or(0)));
    fmi3GetNumberOfContinuousStates GetNumberOfContinuousStates(count: *mut usize)
        |_i| give(count, "nContinuousStates", || Ok(Instance::<S>::state_count()));
}

// Co-simulation; `fmi3DoStep` is in `stepping.rs`.
functions! {
    fmi3EnterStepMode EnterStepMode() |i| {
        i.enter_step_mode();
        Ok(())
    };
    fmi3GetOutputDerivatives GetOutputDerivatives(
        vr: References, nvr: usize, orders: *const fmi3Int32, values: *mut fmi3Float64, count: usize
    ) |i| {
        same(count, nvr)?;
        i.get_output_derivatives(
            array(vr, nvr, "valueReferences")?,
            array(orders, nvr, "orders")?,
            array_out(values, nvr, "values")?,
        )
    };
    fmi3ActivateModelPartition ActivateModelPartition(
        _clock: fmi3ValueReference, _activation_time: fmi3Float64
    ) |_i| unsupported("scheduled execution");
}
