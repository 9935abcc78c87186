//! ngspice as a partner of a co-simulation: its shared library in a worker process, coupled step by step.

mod client;
mod ledger;
mod library;
mod listing;
mod network;
mod protocol;
mod worker;

pub use client::{LiveError, WORKER_VERB, Worker};
pub use ledger::{Group, Membranes};
pub use library::LIBRARY_VARIABLE;
pub(crate) use listing::number;
pub use network::Account;
pub(crate) use network::SOURCES;
pub use protocol::{Circuit, Job, Ramp, Reply, Request, State, Wanted};
pub use worker::serve;
