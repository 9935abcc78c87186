//! Errors of the files of a crosscheck.

use std::path::{Path, PathBuf};

use thiserror::Error;
use videg_report::ReportError;

use crate::ngspice::NgspiceError;

/// Why a file cannot be written.
#[derive(Debug, Error)]
pub enum FileError {
    /// The file is not of an earlier export.
    #[error("--export: {} is there already and is not of an earlier export; name another folder", .0.display())]
    Foreign(PathBuf),
    /// The system refuses.
    #[error("cannot write {}: {cause}", path.display())]
    Write {
        /// The file or folder.
        path: PathBuf,
        /// What the system said.
        cause: std::io::Error,
    },
    /// A netlist cannot be made.
    #[error(transparent)]
    Ngspice(#[from] NgspiceError),
    /// A figure cannot be drawn.
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
