//! Errors of maps.

use std::path::PathBuf;

use thiserror::Error;
use videg_report::ReportError;

use crate::sweep::SweepError;

/// Why a map could not be made. Each message names the thing, its value and the bound.
#[derive(Debug, Error)]
#[allow(missing_docs, reason = "the message of each variant names its fields")]
pub enum MapError {
    /// The sweep over the grid.
    #[error(transparent)]
    Sweep(#[from] SweepError),
    #[error(transparent)]
    Report(#[from] ReportError),
    #[error("axis {axis}: {reason}")]
    Axis { axis: String, reason: String },
    #[error("--of {name}: {reason}")]
    Quantity { name: String, reason: String },
    #[error("all {runs} runs of the map failed; the first one: {reason}")]
    AllFailed { runs: u64, reason: String },
    #[error("{name} is a number at no point of the map")]
    NoNumber { name: String },
    #[error("cannot read {}: {cause}", path.display())]
    Results { path: PathBuf, cause: csv::Error },
    #[error("a run at {place} gives a line of results that cannot be read: {cause}")]
    Line { place: String, cause: csv::Error },
    /// The observer stopped the search; the grid is kept.
    #[error("stopped in the search of the best point; the same command goes on from there")]
    Stopped,
}
