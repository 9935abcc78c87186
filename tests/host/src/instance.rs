//! An instance, and what the host knows about it.

use crate::{Fmu, Log};
use core::ffi::CStr;
use core::ptr::null;
use fmu_export::abi::{fmi2CoSimulation, fmi2Component, fmi2FMUstate, fmi2False, fmi2ModelExchange, fmi2True};
use fmu_export::{CallState, Interface};

/// Call state and time, as the host knows them.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Known {
    pub(crate) state: CallState,
    pub(crate) time: f64,
}

/// A serialised state of an instance for this interface; what is damaged must be refused.
pub(crate) struct Blob {
    pub(crate) bytes: Vec<i8>,
    /// As the FMU wrote it.
    written: Vec<i8>,
    pub(crate) known: Known,
    pub(crate) interface: Interface,
}

impl Blob {
    pub(crate) fn new(bytes: Vec<i8>, known: Known, interface: Interface) -> Self {
        Self { written: bytes.clone(), bytes, known, interface }
    }

    /// Damage upon damage can leave what was written.
    pub(crate) fn is_damaged(&self) -> bool {
        self.bytes != self.written
    }
}

/// An instance of an FMU; dropping it frees it.
pub struct Instance<'a> {
    fmu: &'a Fmu,
    /// The component.
    pub component: fmi2Component,
    log: *mut Log,
    pub(crate) interface: Interface,
    pub(crate) known: Known,
    /// Whether all that is logged reaches the log.
    pub(crate) logs_all: bool,
    /// FMU states that it holds.
    pub(crate) saved: Vec<(fmi2FMUstate, Known)>,
    /// FMU states that it has freed.
    pub(crate) freed: Vec<fmi2FMUstate>,
}

impl Drop for Instance<'_> {
    fn drop(&mut self) {
        // SAFETY: the component is live or NULL, the log came from `Box::into_raw`, and nobody uses them any more.
        unsafe {
            (self.fmu.functions.fmi2FreeInstance)(self.component);
            drop(Box::from_raw(self.log));
        }
    }
}

impl<'a> Instance<'a> {
    /// A fresh instance.
    ///
    /// # Errors
    /// What the FMU logged if it gave none.
    pub fn new(fmu: &'a Fmu, interface: Interface) -> Result<Self, String> {
        let kind = if interface == Interface::ModelExchange { fmi2ModelExchange } else { fmi2CoSimulation };
        let log = Box::into_raw(Box::<Log>::default());
        // SAFETY: the log lives until the instance is dropped; the strings are zero-terminated.
        let component = unsafe {
            let functions = (*log).callbacks();
            let (name, guid, instantiate) = (c"host".as_ptr(), fmu.guid.as_ptr(), fmu.functions.fmi2Instantiate);
            instantiate(name, kind, guid, null(), &raw const functions, fmi2False, fmi2True)
        };
        let known = Known { state: CallState::Instantiated, time: 0.0 };
        let (saved, freed) = (Vec::new(), Vec::new());
        let mut new = Self { fmu, component, log, interface, known, logs_all: true, saved, freed };
        if component.is_null() { Err(format!("no instance: {:?}", new.log().take())) } else { Ok(new) }
    }

    /// What it has logged.
    pub fn log(&mut self) -> &mut Log {
        // SAFETY: the log lives as long as the instance, and the FMU is in no call.
        unsafe { &mut *self.log }
    }
}

/// Arguments of `fmi2Instantiate` with which no instance is made: name, kind, GUID given.
const REFUSED: [(Option<&CStr>, i32, bool); 6] = [
    (None, fmi2CoSimulation, true),
    (Some(c" "), fmi2CoSimulation, true),
    (Some(c"\xff"), fmi2CoSimulation, true),
    (Some(c"host"), 7, true),
    (Some(c"host"), -1, true),
    (Some(c"host"), fmi2CoSimulation, false),
];

/// Whether an instantiation with wrong arguments is refused with a word.
pub(crate) fn is_refused(fmu: &Fmu, number: usize) -> bool {
    let (name, kind, with_guid) = REFUSED[number % REFUSED.len()];
    let mut log = Log::default();
    let functions = log.callbacks();
    let (name, guid) = (name.map_or(null(), CStr::as_ptr), if with_guid { fmu.guid.as_ptr() } else { null() });
    // SAFETY: the log outlives the call; strings are NULL or zero-terminated.
    let component = unsafe {
        (fmu.functions.fmi2Instantiate)(name, kind, guid, null(), &raw const functions, fmi2False, fmi2False)
    };
    component.is_null() && (log.0.len() == 1 || !crate::LOGS)
}
