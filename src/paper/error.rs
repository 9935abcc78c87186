//! Errors of making an item.

use crate::cosim::CosimError;
use crate::dynamics::DynamicsError;
use crate::map::MapError;
use crate::scenario::ScenarioError;
use fmu_import::FmiError;
use videg_report::ReportError;

/// Why an item could not be made.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the message of each variant names its fields")]
pub enum PaperError {
    #[error("cannot make {name}: {cause}")]
    Item { name: &'static str, cause: Box<PaperError> },
    #[error(transparent)]
    Fmi(#[from] FmiError),
    #[error(transparent)]
    Cosim(#[from] CosimError),
    #[error(transparent)]
    Dynamics(#[from] DynamicsError),
    #[error(transparent)]
    Report(#[from] ReportError),
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    #[error(transparent)]
    Map(#[from] MapError),
    #[error("cannot make a temporary folder: {0}")]
    Folder(std::io::Error),
    #[error("stopped before it was complete")]
    Stopped,
    /// An impact is not followed by another one, so that there is no cycle to be drawn.
    #[error("{case}: the impact at {time} s has no rest before it, or no next one, within {within} s")]
    NoCycle { case: &'static str, time: f64, within: f64 },
}
