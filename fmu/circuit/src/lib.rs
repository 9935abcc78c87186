//! The FMU `HarvestingCircuit`: the circuit of Fig. 8(a) behind the interfaces of FMI 2.0 and 3.0 for co-simulation.
//!
//! Only glue lives here: [`Harvesting`] keeps what the importer sets and hands it to [`videg_circuit`]; the variables
//! are in `variables.rs`, the parameters among them in the circuit's own table.
#![allow(non_snake_case)] // the library is named after the model identifier

mod harvesting;
mod slave;
mod variables;

pub use harvesting::Harvesting;

fmu_export::export_fmu!(Harvesting);
