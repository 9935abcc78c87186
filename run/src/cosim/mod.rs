//! Co-simulation of the harvester FMU with harvesting circuits: the master, its subsystems and recorders.
//!
//! [`run()`] couples a scenario with a circuit. [`Method`] is the coupling scheme, [`Coupling`] adds an adaptive step. The voltages
//! of the first circuit go back to the harvester; further circuits get the same C(t) for comparison. A circuit implements
//! [`CircuitSlave`], in a file of its own.

mod adaptive;
mod balance;
mod capacitance;
mod circuit;
mod circuit_fmu;
mod columns;
mod coupling;
mod device;
mod element;
mod embedded;
mod error;
mod excitation;
mod flows;
mod harvester;
mod instance;
mod mapping;
mod master;
mod ngspice;
mod ratios;
mod record;
mod run;
mod schedule;
mod series;
mod settings;
mod signal;
mod spectrum;
mod summary;

pub use balance::EnergyBalance;
pub use circuit::CircuitSlave;
pub use circuit_fmu::{FmuCircuit, ForeignCircuit};
pub use columns::RealColumns;
pub use coupling::{Coupling, CouplingSummary, Method};
pub use device::Device;
pub use element::ElementEnergy;
pub use embedded::EmbeddedCircuit;
pub use error::CosimError;
pub use excitation::Excitation;
pub use flows::Flows;
pub use harvester::instantiate;
pub use harvester::{HarvesterFmu, HarvesterSample, set_voltages};
pub use instance::{read, references};
pub use mapping::Mapping;
pub use master::{Master, Observer, Outcome, Row};
pub use ngspice::{NetlistCircuit, NgspiceCircuit};
pub use ratios::CapacitanceRatios;
pub use record::TimeProgress;
pub use record::{ImpactLog, MembraneImpact, Trace, TracePoint};
pub use run::{CircuitSolver, Cosimulation, LabelledCircuit, Options, Results, run};
pub use schedule::Schedule;
pub use series::{Sample, SeriesColumns, SeriesFormat, SeriesOptions, SeriesRecorder};
pub use settings::{CircuitRequest, label, voltage_warning};
pub use summary::{Charges, CircuitSummary, Energies, MechanicsSummary};
pub use videg_circuit::CircuitSample;
pub use videg_coupled::Powers;
pub use videg_coupled::{Averages, Gains, best_release_voltage};
