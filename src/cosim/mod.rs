//! Co-simulation of the harvester FMU with harvesting circuits: the master, its subsystems, and what it records.
//!
//! Under the impulsive law the circuit does not act back on the harvester, so a Gauss-Seidel order loses nothing: the
//! harvester steps first, then each circuit with the capacitances known at both ends of the step. Any number of
//! circuits can listen to one harvester, which is how circuits are compared.

mod circuit;
mod error;
mod harvester;
mod master;
mod record;
mod schedule;
mod summary;

pub use circuit::{CircuitSample, CircuitSlave, EmbeddedCircuit, FmuCircuit};
pub use error::CosimError;
pub use harvester::{HarvesterFmu, HarvesterSample};
pub use master::{Master, Observer, Row};
pub use record::{CsvRecorder, Trace, TracePoint};
pub use schedule::Schedule;
pub use summary::{Charges, CircuitSummary, Energies, MechanicsSummary};
