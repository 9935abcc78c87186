//! Both FMUs as they are packaged.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a panic is how a test fails")]

mod exports;
mod instances;
mod page;
mod same_as_model;

use std::path::PathBuf;

use fmu_import::{Fmu, Instance, Logging};
use videg::package::{Options, build_all};

/// The archives of harvester and circuit.
fn archives() -> Vec<PathBuf> {
    build_all(&Options::default()).unwrap()
}

fn fmus() -> [Fmu; 2] {
    let paths = archives();
    [0, 1].map(|index| Fmu::open(&paths[index]).unwrap())
}

/// An instance with these variables set, initialised.
fn initialised(fmu: &Fmu, logging: Logging, settings: &[(&str, &str)]) -> Instance {
    let mut instance = fmu.instantiate("test", logging).unwrap();
    for (name, value) in settings {
        instance.set_by_name(name, value).unwrap();
    }
    instance.setup_experiment(0.0, None, None).unwrap();
    instance.enter_initialization_mode().unwrap();
    instance.exit_initialization_mode().unwrap();
    instance
}
