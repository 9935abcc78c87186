//! Sweeps: many runs of the harvester, or of any FMU, over its parameters, on all cores and on many machines.
//!
//! A [`Sweep`] is everything that decides the results, resolved from a [`Request`]: points of a [`Design`] over what is
//! varied, each with a number of samples. A run follows from its number alone, whoever computes it, so that a sweep can
//! be interrupted and resumed ([`run()`]), divided ([`Shard`]) and put together again ([`merge()`]) with the same
//! bytes. Results go to a CSV file as they come, in order; memory does not grow with them. docs/sweep.md describes the
//! files.

mod axis;
mod by_point;
mod cases;
mod column;
mod derived;
mod document;
mod electrical;
mod elsewhere;
mod engine;
mod error;
mod figure;
mod file;
mod files;
mod folder;
mod instance;
mod lines;
#[cfg(test)]
mod lines_tests;
mod merge;
mod named_files;
mod order;
mod plan;
mod points;
mod random;
mod record;
mod run;
mod sampling;
mod seeds;
mod setter;
mod setting;
mod shard;
mod statistics;
mod summary;
mod sums;
mod system;
mod table;
mod times;
mod tracks;
mod unfinished;
mod vary;
mod waves;

pub use cases::{AXIS as CASE_AXIS, NamedCase};
pub use column::{Column, Type};
pub use electrical::{POWERS, is_electrical};
pub use elsewhere::Numbers;
pub use engine::{BuiltIn, Engine};
pub use error::SweepError;
pub use file::SweepFile;
pub use folder::free_folder;
pub use merge::merge;
pub use plan::{Request, Sweep};
pub use run::{Options, Report, run};
pub use sampling::{Design, Sampling};
pub use seeds::SEED_VARIABLE;
pub use shard::Shard;
pub use summary::{Point as PointStatistics, Summary};
pub use system::{DrivenImpacts, System};
pub use times::Times;
pub use vary::{Range, Scale, Spread, Vary};

use std::path::Path;

pub use crate::scenario::harvester_description;
use fmu_import::{FmiError, ModelDescription};

/// The model description of the harvester with the variables of the circuit and the mean powers, [`POWERS`]. A name that both have is the harvester's.
///
/// # Errors
/// None: it is part of this program.
pub fn system_description() -> Result<ModelDescription, FmiError> {
    electrical::with_circuit(harvester_description()?)
}

/// SHA-256 of a file, in hexadecimal digits.
///
/// # Errors
/// If it cannot be read.
pub fn fingerprint(path: &Path) -> Result<String, SweepError> {
    let content = std::fs::read(path).map_err(SweepError::file("read", path))?;
    Ok(document::sha256(content))
}
