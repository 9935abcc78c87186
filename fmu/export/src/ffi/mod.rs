//! The bodies of the C functions, generic over the slave. [`export_fmu!`](crate::export_fmu) gives each its
//! exported symbol; nobody else needs this module.
//!
//! Every body has the same shape: the guard checks the component and the state, pointers become slices, and one
//! function of the instance does the work in safe Rust.
//!
//! # Panics and silence
//! No panic leaves a C function: it becomes `fmi2Error` and a log message. Nothing here writes to stdout or stderr.
//! Rust's default panic hook does print one line to stderr before the guard catches the panic. It stays in place,
//! because the hook is global: an FMU has no business replacing what others in its process may rely on, and a
//! panic is a bug whose location should not be lost. An error that a model *returns* prints nothing.
//!
//! # Safety
//! All functions here have the contract of their C namesake: a component is NULL or comes from
//! [`fmi2Instantiate`] with the same `S` and was not freed, and no other thread calls a function of
//! it meanwhile; an array is NULL or holds as many values as the call says; a string is NULL or zero-terminated.
#![allow(clippy::missing_safety_doc)] // The contract is the same for all and stands above.
#![allow(non_snake_case)] // names of the standard

mod functions;
mod instantiate;

pub use functions::*;
pub use instantiate::*;

use crate::call_state::Row;
use crate::check::check_fmu;
use crate::error::CallError;
use crate::guid::Guid;
use crate::instance::{Call, Instance};
use crate::slave::Slave;
use crate::standard::Standard;
use core::cell::UnsafeCell;
use core::ffi::{CStr, c_char};
use core::mem::MaybeUninit;
use core::ptr::without_provenance_mut;
use core::sync::atomic::{AtomicBool, Ordering};
use fmu_abi::{fmi2Component, fmi2Error, fmi2FMUstate, fmi2Status};
use std::path::Path;
use std::sync::OnceLock;

/// What is worked out once per FMU and process: the GUID, once the table is known to be sound. It takes no memory that an
/// unloaded library would leave behind.
#[derive(Debug, Default)]
pub struct Fmu {
    fmi2: OnceLock<Guid>,
    fmi3: OnceLock<Guid>,
}

impl Fmu {
    /// Nothing worked out yet.
    pub const fn new() -> Self {
        Self { fmi2: OnceLock::new(), fmi3: OnceLock::new() }
    }

    /// The GUID, or why there is no FMU.
    pub(crate) fn guid<S: Slave>(&self, standard: Standard, resources: Option<&Path>) -> Result<Guid, String> {
        S::load_variables(resources).map_err(|e| format!("there are no variables: {e}"))?;
        let guid = if standard == Standard::Fmi2 { &self.fmi2 } else { &self.fmi3 };
        if let Some(guid) = guid.get() {
            return Ok(*guid);
        }
        check_fmu::<S>().map_err(|e| format!("the FMU is faulty: {e}"))?;
        Ok(*guid.get_or_init(|| Guid::of::<S>(standard)))
    }
}

/// What a component points to: an instance, and whether a call of it is under way. FMI 2.0 forbids calls from inside a
/// logger callback and from two threads at once. The former are always refused. Calls from a second thread are usually
/// refused; nothing guarantees it, and two that begin together are undefined behaviour.
pub(crate) struct Handle<S: Slave> {
    busy: AtomicBool,
    /// The importer is called within a step: it may read, and must not free.
    shown: AtomicBool,
    instance: UnsafeCell<Instance<S>>,
}

impl<S: Slave> Handle<S> {
    pub(crate) fn new(instance: Instance<S>) -> Self {
        let (busy, shown) = (AtomicBool::new(false), AtomicBool::new(false));
        Self { busy, shown, instance: UnsafeCell::new(instance) }
    }

    /// Runs `body`, which does not panic, on the instance unless it is busy.
    #[inline]
    fn with(&self, body: impl FnOnce(&mut Instance<S>) -> fmi2Status) -> fmi2Status {
        // Not one atomic exchange, which would take as long as a step in which nothing happens.
        if self.busy.load(Ordering::Acquire) {
            return fmi2Error;
        }
        self.busy.store(true, Ordering::Relaxed);
        // SAFETY: by contract no two threads are here at once, and no call from inside another comes this far: this is the
        // only reference.
        let status = body(unsafe { &mut *self.instance.get() });
        self.busy.store(false, Ordering::Release);
        status
    }
}

/// The way into every function that acts on an instance.
#[inline]
pub(crate) unsafe fn enter<S: Slave>(
    component: fmi2Component,
    function: Row,
    call: impl FnOnce(&mut Instance<S>) -> Call,
) -> fmi2Status {
    // SAFETY: contract of this module.
    unsafe { with(component, |i| i.run(function, call)) }
}

/// The same without the state check.
#[inline]
pub(crate) unsafe fn with<S: Slave>(
    component: fmi2Component,
    body: impl FnOnce(&mut Instance<S>) -> fmi2Status,
) -> fmi2Status {
    let handle = component.cast::<Handle<S>>();
    if !handle.is_aligned() {
        return fmi2Error;
    }
    // SAFETY: by contract the component is NULL or points to a live handle.
    let Some(handle) = (unsafe { handle.as_ref() }) else {
        return fmi2Error;
    };
    handle.with(body)
}

/// Calls the importer within a step of a component that is live; it does not free it meanwhile.
pub(crate) unsafe fn showing<S: Slave>(component: fmi2Component, show: impl FnOnce()) {
    // SAFETY: by contract the component points to a live handle, and stays so: `fmi2FreeInstance` looks.
    let shown = unsafe { &(*component.cast::<Handle<S>>()).shown };
    let before = shown.swap(true, Ordering::AcqRel);
    show();
    shown.store(before, Ordering::Release);
}

/// Checks a pointer that is to become a slice.
pub(crate) fn check_array<T>(pointer: *const T, count: usize, argument: &'static str) -> Call {
    let reason = if pointer.is_null() {
        return Err(CallError::NullArgument(argument));
    } else if !pointer.is_aligned() {
        "it is not aligned"
    } else if count > isize::MAX as usize / size_of::<T>().max(1) {
        "that is more than memory holds"
    } else {
        return Ok(());
    };
    Err(CallError::BadArray { argument, count, reason })
}

/// An array argument. An empty one may be NULL.
pub(crate) unsafe fn array<'a, T>(pointer: *const T, count: usize, argument: &'static str) -> Call<&'a [T]> {
    if count == 0 {
        return Ok(&[]);
    }
    check_array(pointer, count, argument)?;
    // SAFETY: checked above; by contract it holds `count` values.
    Ok(unsafe { core::slice::from_raw_parts(pointer, count) })
}

/// Writes into an array to be filled, which the importer need not have initialised: takes the position and the value.
pub(crate) unsafe fn array_out<'a, T: 'a>(
    pointer: *mut T,
    count: usize,
    argument: &'static str,
) -> Call<impl FnMut(usize, T) + use<'a, T>> {
    let places: &'a mut [MaybeUninit<T>] = if count == 0 {
        &mut []
    } else {
        check_array(pointer, count, argument)?;
        // SAFETY: checked above; by contract there is room for `count` values, and no one else looks at them now.
        unsafe { core::slice::from_raw_parts_mut(pointer.cast(), count) }
    };
    Ok(move |k: usize, value| {
        places[k].write(value);
    })
}

/// Writes a single value.
pub(crate) unsafe fn give<T>(pointer: *mut T, argument: &'static str, value: impl FnOnce() -> Call<T>) -> Call {
    check_array(pointer, 1, argument)?;
    let value = value()?;
    // SAFETY: checked above; by contract there is room for one value.
    unsafe { pointer.write(value) };
    Ok(())
}

/// Replaces the token of an FMU state by what `call` makes of it; 0 is NULL.
pub(crate) unsafe fn replace(state: *mut fmi2FMUstate, call: impl FnOnce(usize) -> Call<usize>) -> Call {
    check_array(state, 1, "FMUstate")?;
    // SAFETY: checked above; the importer initialised it, to NULL or to a token.
    let state = unsafe { &mut *state };
    *state = without_provenance_mut(call(state.addr())?);
    Ok(())
}

/// A string argument, or why it is none.
pub(crate) unsafe fn text<'a>(pointer: *const c_char) -> Result<&'a str, &'static str> {
    if pointer.is_null() {
        return Err("it is NULL");
    }
    // SAFETY: by contract it is zero-terminated.
    let text = unsafe { CStr::from_ptr(pointer) };
    text.to_str().map_err(|_| "it is not UTF-8")
}
