//! Why a file holds nothing that a harvester takes.

use videg_input::columns::{ColumnsError, Lines};
use videg_model::{ModelError, PointFault};

/// Why a file holds nothing that a harvester takes. The line is counted from 1.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the message of each variant names its fields")]
pub enum DataError {
    /// It is no table of numbers with one of the headings.
    #[error("{0}")]
    Columns(#[from] ColumnsError),
    /// A row of it is not what the model takes.
    #[error("line {line}: {fault}")]
    Row { line: u64, fault: PointFault },
    /// All of it is not.
    #[error("{0}")]
    Whole(Box<ModelError>),
}

impl DataError {
    /// Why the model does not take the rows that stand on these `lines`.
    pub(crate) fn new(lines: &Lines, error: ModelError) -> Self {
        match error {
            ModelError::Point { index, fault, .. } => Self::Row { line: lines.of(index), fault },
            _ => Self::Whole(Box::new(error)),
        }
    }
}
