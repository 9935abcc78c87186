//! A host for the exported C functions: they are called as C symbols, through raw pointers.
#![allow(dead_code, non_upper_case_globals)] // Each test binary uses a part; constants as in the standard.

pub mod calls;
pub mod calls3;
pub mod fmi3;
pub mod toy;

use core::ops::{Deref, DerefMut};
use core::ptr::null;
use fmu_export::abi::*;
use fmu_export::{Guid, Standard};
#[allow(unused_imports)]
pub use fmu_host::{Log, UNTOUCHED};
use std::ffi::CString;
use toy::Toy;

fmu_host::linked_names!();

/// Makes a type a slave that does nothing in a step: what it says of itself, its rows, and further functions.
macro_rules! slave {
    ($name:ty, $info:expr, $table:expr $(, $($more:tt)*)?) => {
        impl ::fmu_export::Slave for $name {
            const INFO: ::fmu_export::ModelInfo = $info;

            fn variables() -> &'static [::fmu_export::Variable<Self>] {
                $table
            }

            fn new() -> Self {
                Self::default()
            }

            fn do_step(&mut self, _: f64, _: f64, _: &::fmu_export::Logger) -> Result<(), ::fmu_export::SlaveError> {
                Ok(())
            }

            $($($more)*)?
        }
    };
}
pub(crate) use slave;

pub fn guid() -> String {
    Guid::of::<Toy>(Standard::Fmi2).to_string()
}

pub fn c(text: &str) -> CString {
    CString::new(text).expect("no NUL")
}

/// Calls `fmi2Instantiate` with every argument at hand.
pub fn instantiate(
    name: Option<&str>,
    kind: fmi2Type,
    guid: Option<&str>,
    resources: Option<&str>,
    functions: *const fmi2CallbackFunctions,
    logging: bool,
) -> fmi2Component {
    let [name, guid, resources] = [name, guid, resources].map(|text| text.map(c));
    let pointer = |text: &Option<CString>| text.as_ref().map_or(null(), |t| t.as_ptr());
    let (name, guid, resources) = (pointer(&name), pointer(&guid), pointer(&resources));
    unsafe { fmi2Instantiate(name, kind, guid, resources, functions, fmi2False, logging.into()) }
}

/// An instance of the toy, with its log.
pub struct Host(fmu_host::Host);

impl Deref for Host {
    type Target = fmu_host::Host;

    fn deref(&self) -> &fmu_host::Host {
        &self.0
    }
}

impl DerefMut for Host {
    fn deref_mut(&mut self) -> &mut fmu_host::Host {
        &mut self.0
    }
}

impl Host {
    /// In state `instantiated`.
    pub fn new() -> Self {
        Self::of_kind(fmi2CoSimulation)
    }

    pub fn of_kind(kind: fmi2Type) -> Self {
        let functions = fmu_host::linked_functions!(model_exchange);
        Self(fmu_host::Host::of(functions, &guid(), kind == fmi2ModelExchange))
    }

    /// In state `initializationMode`.
    pub fn initializing() -> Self {
        Self::initializing_of(fmi2CoSimulation)
    }

    /// The same for this interface.
    pub fn initializing_of(kind: fmi2Type) -> Self {
        let host = Self::of_kind(kind);
        assert_eq!((host.setup(0.0, None), host.enter_initialization()), (fmi2OK, fmi2OK));
        host
    }

    /// From state `instantiated` through initialization mode.
    pub fn start(&self, start: f64, stop: Option<f64>) {
        assert_eq!((self.setup(start, stop), self.initialize()), (fmi2OK, fmi2OK));
    }

    /// In state `stepComplete`, at this time.
    pub fn started(start: f64, stop: Option<f64>) -> Self {
        let host = Self::new();
        host.start(start, stop);
        host
    }

    /// In state `stepComplete`, at 0 s.
    pub fn initialized() -> Self {
        Self::started(0.0, None)
    }

    /// Model exchange, in state `eventMode`, at 0 s.
    pub fn at_event() -> Self {
        let host = Self::initializing_of(fmi2ModelExchange);
        assert_eq!(host.exit_initialization(), fmi2OK);
        host
    }

    /// Model exchange, in state `continuousTimeMode`, at 0 s.
    pub fn exchanging() -> Self {
        let host = Self::at_event();
        assert_eq!((host.new_discrete_states().0, host.enter_continuous_time_mode()), (fmi2OK, fmi2OK));
        host
    }

    /// The last message; it must be an error.
    pub fn error(&self) -> String {
        let line = self.lines().pop().expect("a message");
        assert_eq!((line.status, line.category.as_str()), (fmi2Error, "logStatusError"), "{}", line.message);
        line.message
    }

    /// A call was refused, and the last message says why.
    #[track_caller]
    pub fn refused(&self, status: fmi2Status, reason: &str) {
        assert_eq!(status, fmi2Error, "{reason}");
        let message = self.error();
        assert!(message.contains(reason), "{message}");
    }

    /// Arms one of the failures of the toy.
    pub fn trouble(&self, what: &str) {
        fmu_host::ok(self.set_string(toy::TROUBLE, what));
    }
}
