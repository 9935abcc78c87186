//! Errors of running, resuming and merging sweeps.

use std::io;
use std::path::{Path, PathBuf};

use thiserror::Error;

use crate::scenario::{Origin, ScenarioError};
use fmu_import::FmiError;

/// Why a sweep could not be run, resumed or merged. Each message names the thing, its value and the bound.
#[derive(Debug, Error)]
#[allow(missing_docs, reason = "the message of each variant names its fields")]
pub enum SweepError {
    /// The case, a setting or a time.
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    /// The FMU.
    #[error(transparent)]
    Fmi(#[from] FmiError),
    /// An option, or the key of the sweep file of the same name, makes no sense.
    #[error("{}: {reason}", place(origin, option, value))]
    Option { origin: Origin, option: &'static str, value: String, reason: String },
    /// The file system refused.
    #[error("cannot {action} {}: {cause}", path.display())]
    File { action: &'static str, path: PathBuf, cause: io::Error },
    /// The sweep ended before it was complete.
    #[error(
        "{cause}; the runs before number {next} are kept in {}, and the same command without --fresh goes on from there",
        path.display()
    )]
    Ended { path: PathBuf, next: u64, cause: Box<SweepError> },
    /// A file does not hold what it should.
    #[error("{}: {reason}", path.display())]
    Content { path: PathBuf, reason: String },
    /// Another process writes the same file.
    #[error("{} is being written by another process: wait for it, or choose another --output", path.display())]
    Locked { path: PathBuf },
    /// Shards that do not make a complete sweep.
    #[error("cannot merge: {reason}")]
    Merge { reason: String },
}

/// The place of an `option` and its `value` in the words of the user.
fn place(origin: &Origin, option: &str, value: &str) -> String {
    match option {
        _ if value.is_empty() => origin.key(option),
        "set" | "vary" => origin.entry(option, value),
        _ => origin.value(option, value),
    }
}

impl SweepError {
    /// An option whose value makes no sense.
    pub(super) fn option(option: &'static str, value: impl Into<String>, reason: impl Into<String>) -> Self {
        Self::Option { origin: Origin::Option, option, value: value.into(), reason: reason.into() }
    }

    /// The same, of what was said where `origin` has it by option and value.
    pub(super) fn said(self, origin: impl FnOnce(&str, &str) -> Origin) -> Self {
        match self {
            Self::Option { option, value, reason, .. } => {
                Self::Option { origin: origin(option, &value), option, value, reason }
            }
            other => other,
        }
    }

    /// For `map_err`: the file system refused to `action` on `path`.
    pub(super) fn file(action: &'static str, path: &Path) -> impl FnOnce(io::Error) -> Self {
        let path = path.to_owned();
        move |cause| Self::File { action, path, cause }
    }

    /// A file does not hold what it should.
    pub(super) fn content(path: &Path, reason: impl Into<String>) -> Self {
        Self::Content { path: path.to_owned(), reason: reason.into() }
    }
}
