//! The toy as an FMU of FMI 3.0: its functions are called as C symbols, through raw pointers.

use super::c;
use super::toy::{self, Toy};
use core::ops::Deref;
use fmu_export::abi::fmi3::*;
use fmu_export::{Guid, Standard};
use fmu_host::fmi3::Fmu;
#[allow(unused_imports)] // each test binary uses a part
pub use fmu_host::fmi3::{Environment, Line, Session, Stepped};

fmu_host::linked_names3!();

/// The toy.
pub fn fmu() -> Fmu {
    let favourites = vec![toy::TROUBLE];
    Fmu { favourites, ..Fmu::of::<Toy>(fmu_host::linked_functions3!()) }
}

pub fn token() -> String {
    Guid::of::<Toy>(Standard::Fmi3).to_string()
}

/// Calls `fmi3InstantiateCoSimulation` or `fmi3InstantiateModelExchange`; the outputs of the toy may be read within steps.
pub fn instantiate(session: Session, name: &str, token: &str, environment: &Environment) -> fmi3Instance {
    let required = [toy::INTEGRAL];
    instantiate_for(session, name, token, environment, if session.looks { &required } else { &[] })
}

/// The same with these variables to be read within steps.
pub fn instantiate_for(
    session: Session,
    name: &str,
    token: &str,
    environment: &Environment,
    required: &[u32],
) -> fmi3Instance {
    session.instantiate(&fmu_host::linked_functions3!(), &c(name), &c(token), environment, required)
}

/// An instance of the toy, with its log.
pub struct Host(fmu_host::fmi3::Host);

impl Deref for Host {
    type Target = fmu_host::fmi3::Host;

    fn deref(&self) -> &fmu_host::fmi3::Host {
        &self.0
    }
}

impl Host {
    /// In state `instantiated`.
    pub fn new(session: Session) -> Self {
        Self::requiring(session, if session.looks { &[toy::INTEGRAL] } else { &[] })
    }

    /// The same with these variables to be read within steps.
    pub fn requiring(session: Session, required: &[u32]) -> Self {
        Self(fmu_host::fmi3::Host::requiring(&fmu(), session, required))
    }

    /// Initialised at 0 s, and past the first event.
    pub fn started(session: Session) -> Self {
        let host = Self::new(session);
        host.start();
        host
    }

    /// Makes a hook of the toy fail, which one and how.
    pub fn trouble(&self, text: &str) {
        let (reference, text) = (toy::TROUBLE, c(text));
        let pointer = text.as_ptr();
        let status = unsafe { fmi3SetString(self.instance, &raw const reference, 1, &raw const pointer, 1) };
        assert_eq!(status, fmi3OK);
    }
}
