//! Co-simulation of the harvester FMU with harvesting circuits: the master, its subsystems, and what it records.
//!
//! The order is Gauss-Seidel: the harvester steps first, then each circuit with the capacitances known at both ends of the
//! step. The voltages of the first circuit go back to the harvester; under the impulsive law they do not act on it, so
//! the order loses nothing. Any number of further circuits can listen, which is how circuits are compared.

mod circuit;
mod error;
mod harvester;
mod master;
mod ngspice;
mod record;
mod schedule;
mod summary;

pub use circuit::{CircuitSample, CircuitSlave, EmbeddedCircuit, FmuCircuit};
pub use error::CosimError;
pub use harvester::{HarvesterFmu, HarvesterSample};
pub use master::{Master, Observer, Row};
pub use ngspice::NgspiceCircuit;
pub use record::{CsvRecorder, Trace, TracePoint};
pub use schedule::Schedule;
pub use summary::{Charges, CircuitSummary, Energies, MechanicsSummary};
