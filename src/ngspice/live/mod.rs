//! ngspice as a partner of a co-simulation: its shared library in a worker process, coupled step by step.

mod client;
mod library;
mod protocol;
mod worker;

pub use client::{LiveError, WORKER_VERB, Worker};
pub use library::LIBRARY_VARIABLE;
pub use protocol::{Job, Ramp};
pub(crate) use worker::serve;
