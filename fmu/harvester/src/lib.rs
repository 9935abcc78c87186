//! The FMU `VibroImpactHarvester`: the mechanical model of the paper behind the interfaces of FMI 2.0 and 3.0
//! for co-simulation and model exchange.
//!
//! Only glue lives here: [`Harvester`] keeps what the importer sets and hands it to [`videg_model`]; the variables are
//! in `variables.rs`, the parameters among them in the model's own table.
#![allow(non_snake_case)] // the library is named after the model identifier

mod file;
mod harvester;
mod limits;
mod sensitivity;
mod slave;
mod state;
mod step_length;
mod variables;

pub use harvester::Harvester;

fmu_export::export_fmu!(Harvester, model_exchange);
