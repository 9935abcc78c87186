//! Both FMUs as they are packaged.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a panic is how a test fails")]

mod exports;
#[path = "../support/instance.rs"]
mod instance;
mod instances;
mod page;
mod same_as_model;

use std::path::PathBuf;

use fmu_import::Fmu;
use videg::package::{Options, build_all};

/// The archives of harvester and circuit.
fn archives() -> Vec<PathBuf> {
    build_all(&Options::default()).unwrap()
}

fn fmus() -> [Fmu; 2] {
    let paths = archives();
    [0, 1].map(|index| Fmu::open(&paths[index]).unwrap())
}
