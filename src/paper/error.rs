//! What keeps an item from being made.

use crate::cosim::CosimError;
use crate::fmi::FmiError;
use crate::report::ReportError;
use crate::scenario::ScenarioError;

/// Why an item could not be made.
#[derive(Debug, thiserror::Error)]
pub enum PaperError {
    /// The FMU.
    #[error(transparent)]
    Fmi(#[from] FmiError),
    /// A coupled run.
    #[error(transparent)]
    Cosim(#[from] CosimError),
    /// A picture.
    #[error(transparent)]
    Report(#[from] ReportError),
    /// A case.
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    /// The model, where an item asks it for a formula.
    #[error(transparent)]
    Model(#[from] videg_model::ModelError),
}
