//! Sweeps: many runs of the harvester, or of any FMU, over its parameters, on all cores and on many machines.
//!
//! A [`Sweep`] is everything that decides the results, resolved from a [`Request`]: points of a [`Design`] over what is
//! varied, each with a number of samples. A run follows from its number alone, whoever computes it, so that a sweep can be
//! interrupted and resumed ([`run()`]), divided ([`Shard`]) and put together again ([`merge()`]) with the same bytes. Results
//! go to a CSV file as they come, in order; memory does not grow with them. docs/sweep.md describes the files.

mod axis;
mod column;
mod design;
mod engine;
mod error;
mod file;
mod lines;
mod merge;
mod plan;
mod random;
mod record;
mod run;
mod seeds;
mod shard;
mod table;
mod times;
mod vary;

pub use column::{Column, Type};
pub use design::Design;
pub use engine::{BuiltIn, Engine};
pub use error::SweepError;
pub use file::SweepFile;
pub use merge::merge;
pub use plan::{Request, Sweep};
pub use run::{Job, Report, Watch, run};
pub use seeds::SEED_VARIABLE;
pub use shard::Shard;
pub use times::Times;
pub use vary::{Range, Scale, Spread, Vary};

use std::path::Path;

use serde_json::{Map, Value};
use sha2::{Digest as _, Sha256};

use crate::fmi::{FmiError, ModelDescription};

/// What the harvester FMU says of itself; the model behind it has the same parameters.
///
/// # Errors
/// None: it is part of this program.
pub fn harvester_description() -> Result<ModelDescription, FmiError> {
    let document = include_bytes!("../../modelDescription/VibroImpactHarvester.xml");
    ModelDescription::parse(document, "modelDescription/VibroImpactHarvester.xml")
}

/// SHA-256 of a file, in hexadecimal digits.
///
/// # Errors
/// If it cannot be read.
pub fn fingerprint(path: &Path) -> Result<String, SweepError> {
    let content = std::fs::read(path).map_err(SweepError::file("read", path))?;
    Ok(plan::hex(&Sha256::digest(content)))
}

/// In what two documents differ, for an error message.
fn differences(there: &str, here: &str) -> String {
    /// They follow from the rest.
    const DERIVED: [&str; 4] = ["columns", "points", "runs", "sha256"];
    let read = |text| serde_json::from_str::<Map<String, Value>>(text).ok();
    let (Some(there), Some(here)) = (read(there), read(here)) else {
        return "what is there is no document of a sweep".to_owned();
    };
    let keys = there.keys().chain(here.keys().filter(|key| !there.contains_key(*key)));
    let (derived, differ): (Vec<&String>, Vec<_>) =
        keys.filter(|key| there.get(*key) != here.get(*key)).partition(|key| DERIVED.contains(&key.as_str()));
    let shown = if differ.is_empty() { derived } else { differ };
    let all: Vec<_> = shown
        .iter()
        .map(|key| {
            let (there, here) = (there.get(*key), here.get(*key));
            format!("{key} is {}, not {}", without(there, here), without(here, there))
        })
        .collect();
    all.join("; ")
}

/// A value in few words; of a list, what the other has not.
fn without(value: Option<&Value>, other: Option<&Value>) -> String {
    const LONGEST: usize = 200;
    let text = match (value, other) {
        (None, _) => "nothing".to_owned(),
        (Some(Value::Array(items)), Some(Value::Array(others))) => {
            let own = items.iter().filter(|item| !others.contains(item)).map(Value::to_string);
            format!("[{}]", own.collect::<Vec<_>>().join(", "))
        }
        (Some(value), _) => value.to_string(),
    };
    if text.chars().count() <= LONGEST { text } else { text.chars().take(LONGEST).chain("...".chars()).collect() }
}
