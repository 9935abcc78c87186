//! A slave: one instance of an FMU, in this process ([`Component`]) or in a worker ([`Remote`]).

use fmu_abi::fmi2Status;

use super::component::Component;
use super::isolated::{Ending, Loss, Remote};
use super::request::{Request, Results};

/// An instance, which dropping frees. States are those of this instance, or 0.
pub(super) enum Slave {
    Here(Box<Component>),
    Isolated(Box<Remote>),
}

impl Slave {
    #[inline]
    pub fn call(&self, request: &Request<'_>, results: Results<'_>) -> fmi2Status {
        match self {
            Self::Here(component) => component.call(request, results),
            Self::Isolated(remote) => remote.call(request, results),
        }
    }

    /// Why the last call was not carried out, if that was not up to the FMU.
    pub fn loss(&self) -> Option<Loss> {
        if let Self::Isolated(remote) = self { remote.loss() } else { None }
    }

    /// Frees an isolated instance ahead of its states.
    pub fn free(&self) -> Result<(), Box<Ending>> {
        if let Self::Isolated(remote) = self { remote.free() } else { Ok(()) }
    }
}
