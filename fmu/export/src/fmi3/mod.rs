//! The bodies of the C functions of FMI 3.0, generic over the slave, as [`ffi`](crate::ffi) has those of FMI 2.0, with the same
//! contract and the same treatment of panics.
#![allow(clippy::missing_safety_doc)] // The contract is the same for all and stands in `ffi`.
#![allow(non_snake_case)] // names of the standard

mod call_table;
mod functions;
mod instantiate;
mod stepping;

pub use call_table::Function;
pub use functions::*;
pub use instantiate::*;
pub use stepping::fmi3DoStep;
