//! An instance, and what the host knows about it.

use crate::{Fmu, Host, Log};
use core::ffi::CStr;
use core::marker::PhantomData;
use core::ops::{Deref, DerefMut};
use core::ptr::null;
use fmu_export::abi::{fmi2CoSimulation, fmi2FMUstate, fmi2False, fmi2ModelExchange};
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
    host: Host,
    fmu: PhantomData<&'a Fmu>,
    pub(crate) interface: Interface,
    pub(crate) known: Known,
    /// Whether all that is logged reaches the log.
    pub(crate) logs_all: bool,
    /// FMU states that it holds.
    pub(crate) saved: Vec<(fmi2FMUstate, Known)>,
    /// FMU states that it has freed.
    pub(crate) freed: Vec<fmi2FMUstate>,
}

impl Deref for Instance<'_> {
    type Target = Host;

    fn deref(&self) -> &Host {
        &self.host
    }
}

impl DerefMut for Instance<'_> {
    fn deref_mut(&mut self) -> &mut Host {
        &mut self.host
    }
}

impl<'a> Instance<'a> {
    /// A fresh instance.
    ///
    /// # Errors
    /// What the FMU logged if it gave none.
    pub fn new(fmu: &'a Fmu, interface: Interface) -> Result<Self, String> {
        let kind = if interface == Interface::ModelExchange { fmi2ModelExchange } else { fmi2CoSimulation };
        let host = Host::new(fmu.functions, c"host", &fmu.guid, kind);
        if host.component.is_null() {
            return Err(format!("no instance: {:?}", host.lines()));
        }
        let known = Known { state: CallState::Instantiated, time: 0.0 };
        let (saved, freed) = (Vec::new(), Vec::new());
        Ok(Self { host, fmu: PhantomData, interface, known, logs_all: true, saved, freed })
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
    let functions = Log::callbacks(&raw mut log);
    let (name, guid) = (name.map_or(null(), CStr::as_ptr), if with_guid { fmu.guid.as_ptr() } else { null() });
    // SAFETY: the log outlives the call; strings are NULL or zero-terminated.
    let component = unsafe {
        (fmu.functions.fmi2Instantiate)(name, kind, guid, null(), &raw const functions, fmi2False, fmi2False)
    };
    component.is_null() && log.lines.len() == 1
}
