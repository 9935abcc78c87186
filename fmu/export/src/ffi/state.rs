//! FMU states and directional derivatives.

use super::{array, array_out, enter, out};
use crate::call_state::Function;
use crate::error::CallError;
use crate::instance::{Call, Instance};
use crate::slave::Slave;
use core::ptr::{null_mut, without_provenance_mut};
use fmu_abi::{fmi2Byte, fmi2Component, fmi2FMUstate, fmi2Real, fmi2Status, fmi2ValueReference};

/// Replaces the token behind `state` by what `call` makes of it.
unsafe fn replace<S: Slave>(
    i: &mut Instance<S>,
    state: *mut fmi2FMUstate,
    call: impl FnOnce(&mut Instance<S>, usize) -> Call<usize>,
) -> Call {
    // SAFETY: contract of this module; the importer initialised it, to NULL or to a token.
    let state = unsafe { out(state, "FMUstate")?.assume_init_mut() };
    *state = without_provenance_mut(call(i, state.addr())?);
    Ok(())
}

/// `fmi2GetFMUstate`
pub unsafe fn get_fmu_state<S: Slave>(c: fmi2Component, state: *mut fmi2FMUstate) -> fmi2Status {
    // SAFETY: contract of this module.
    let call = |i: &mut Instance<S>| unsafe { replace(i, state, Instance::save) };
    // SAFETY: contract of this module.
    unsafe { enter(c, Function::GetFmuState, call) }
}

/// `fmi2SetFMUstate`
pub unsafe fn set_fmu_state<S: Slave>(c: fmi2Component, state: fmi2FMUstate) -> fmi2Status {
    let call = |i: &mut Instance<S>| match state.addr() {
        0 => Err(CallError::NullArgument("FMUstate")),
        token => i.restore(token),
    };
    // SAFETY: contract of this module.
    unsafe { enter(c, Function::SetFmuState, call) }
}

/// `fmi2FreeFMUstate`
pub unsafe fn free_fmu_state<S: Slave>(c: fmi2Component, state: *mut fmi2FMUstate) -> fmi2Status {
    let call = |i: &mut Instance<S>| {
        if state.is_null() {
            return Ok(());
        }
        // SAFETY: contract of this module.
        let state = unsafe { out(state, "FMUstate")?.assume_init_mut() };
        i.free_state(state.addr())?;
        *state = null_mut();
        Ok(())
    };
    // SAFETY: contract of this module.
    unsafe { enter(c, Function::FreeFmuState, call) }
}

/// `fmi2SerializedFMUstateSize`
pub unsafe fn serialized_fmu_state_size<S: Slave>(
    c: fmi2Component,
    state: fmi2FMUstate,
    size: *mut usize,
) -> fmi2Status {
    let call = |i: &mut Instance<S>| {
        // SAFETY: contract of this module.
        let size = unsafe { out(size, "size") }?;
        size.write(i.serialize(state.addr())?.len());
        Ok(())
    };
    // SAFETY: contract of this module.
    unsafe { enter(c, Function::SerializedFmuStateSize, call) }
}

/// `fmi2SerializeFMUstate`
pub unsafe fn serialize_fmu_state<S: Slave>(
    c: fmi2Component,
    state: fmi2FMUstate,
    bytes: *mut fmi2Byte,
    size: usize,
) -> fmi2Status {
    let call = |i: &mut Instance<S>| {
        let blob = i.serialize(state.addr())?;
        if size < blob.len() {
            return Err(CallError::BadArgument {
                argument: "size",
                value: size.to_string(),
                bound: format!("the state takes {} bytes", blob.len()),
            });
        }
        // SAFETY: contract of this module.
        let bytes = unsafe { array_out(bytes.cast::<u8>(), blob.len(), "serializedState") }?;
        bytes.iter_mut().zip(blob).for_each(|(place, byte)| {
            place.write(byte);
        });
        Ok(())
    };
    // SAFETY: contract of this module.
    unsafe { enter(c, Function::SerializeFmuState, call) }
}

/// `fmi2DeSerializeFMUstate`
pub unsafe fn deserialize_fmu_state<S: Slave>(
    c: fmi2Component,
    bytes: *const fmi2Byte,
    size: usize,
    state: *mut fmi2FMUstate,
) -> fmi2Status {
    let call = |i: &mut Instance<S>| {
        // SAFETY: contract of this module.
        let blob = unsafe { array(bytes.cast::<u8>(), size, "serializedState") }?;
        // SAFETY: contract of this module.
        unsafe { replace(i, state, |i, token| i.deserialize(blob, token)) }
    };
    // SAFETY: contract of this module.
    unsafe { enter(c, Function::DeSerializeFmuState, call) }
}

/// `fmi2GetDirectionalDerivative`
pub unsafe fn get_directional_derivative<S: Slave>(
    c: fmi2Component,
    unknown: *const fmi2ValueReference,
    unknown_count: usize,
    known: *const fmi2ValueReference,
    known_count: usize,
    known_seed: *const fmi2Real,
    unknown_sensitivity: *mut fmi2Real,
) -> fmi2Status {
    let call = |i: &mut Instance<S>| {
        // SAFETY: contract of this module.
        let unknown = unsafe { array(unknown, unknown_count, "vUnknown_ref") }?;
        // SAFETY: contract of this module.
        let known = unsafe { array(known, known_count, "vKnown_ref") }?;
        // SAFETY: contract of this module.
        let seeds = unsafe { array(known_seed, known_count, "dvKnown") }?;
        // SAFETY: contract of this module.
        let sensitivity = unsafe { array_out(unknown_sensitivity, unknown_count, "dvUnknown") }?;
        i.directional_derivative(unknown, known, seeds, |k, value| {
            sensitivity[k].write(value);
        })
    };
    // SAFETY: contract of this module.
    unsafe { enter(c, Function::GetDirectionalDerivative, call) }
}
