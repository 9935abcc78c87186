//! Errors of the files of a crosscheck.

use std::path::{Path, PathBuf};

use thiserror::Error;
use videg_report::ReportError;

use crate::ngspice::NgspiceError;

/// Why a file cannot be written.
#[derive(Debug, Error)]
#[allow(missing_docs, reason = "the message of each variant names its fields")]
pub enum FileError {
    #[error("--export: {} is there already and is not of an earlier export; name another folder", .0.display())]
    Foreign(PathBuf),
    #[error("cannot write {}: {cause}", path.display())]
    Write { path: PathBuf, cause: std::io::Error },
    #[error(transparent)]
    Ngspice(#[from] NgspiceError),
    #[error(transparent)]
    Figure(#[from] ReportError),
}

impl FileError {
    /// For `map_err`: `path` cannot be written.
    pub(super) fn write(path: &Path) -> impl FnOnce(std::io::Error) -> Self {
        let path = path.to_owned();
        move |cause| Self::Write { path, cause }
    }
}
