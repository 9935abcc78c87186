//! Errors of making an item.

use crate::cosim::CosimError;
use crate::scenario::ScenarioError;
use fmu_import::FmiError;
use videg_report::ReportError;

/// Why an item could not be made.
#[derive(Debug, thiserror::Error)]
pub enum PaperError {
    /// An item.
    #[error("cannot make {name}: {cause}")]
    Item {
        /// Its name.
        name: &'static str,
        /// Why.
        cause: Box<PaperError>,
    },
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
    /// An impact is not followed by another one, so that there is no cycle to be drawn.
    #[error("{case}: the impact at {time} s has no rest before it, or no next one, within {within} s")]
    NoCycle {
        /// The case.
        case: &'static str,
        /// Time of the largest deflection, s.
        time: f64,
        /// How far was looked, s.
        within: f64,
    },
    /// The model, where an item asks it for a formula.
    #[error(transparent)]
    Model(#[from] videg_model::ModelError),
}
