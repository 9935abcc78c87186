//! Errors of packaging this project's FMUs. As in the importer, every message is one line (and Cargo's own words).

use std::path::{Path, PathBuf};

use thiserror::Error;

use super::FMUS;
use fmu_import::FmiError;

/// Result of packaging.
pub type Result<T> = std::result::Result<T, PackageError>;

/// Why an FMU could not be packaged.
#[derive(Debug, Error)]
#[allow(missing_docs, reason = "the message of each variant names its fields")]
pub enum PackageError {
    /// The packager failed.
    #[error(transparent)]
    Package(#[from] fmu_package::PackageError),
    /// A library was not found.
    #[error("cannot find the library of {identifier} ({why}); looked for: {}", list(looked))]
    NoLibrary { identifier: &'static str, why: String, looked: Vec<PathBuf> },
    /// The page of the explorer is neither inside the program nor built.
    #[error(
        "cannot find the page of the explorer: this videg was compiled without the feature embedded-explorer, and there is no \
         {}; in a source tree, cargo run --release -p videg-explorer-bundle -- that file makes it", looked.display()
    )]
    NoPage { looked: PathBuf },
    /// A model description was not found.
    #[error("cannot find the model description of {identifier}; looked for: {}", list(looked))]
    NoDescription { identifier: &'static str, looked: Vec<PathBuf> },
    /// Archives can be written neither where users know them nor into a cache.
    #[error(
        "{refused}, and {}; set XDG_CACHE_HOME to a folder that can be written",
        cached.as_ref().map_or_else(|| "there is no folder of caches".to_owned(), ToString::to_string)
    )]
    NoPlace { refused: Box<PackageError>, cached: Option<Box<PackageError>> },
    /// An archive inside the program cannot be used.
    #[error("the {identifier}.fmu inside videg {why}")]
    Embedded { identifier: &'static str, why: String },
    /// A model description belongs to another model.
    #[error("{}: modelIdentifier is \"{found}\", allowed is \"{allowed}\"", path.display())]
    Identifier { path: PathBuf, found: String, allowed: String },
    /// The picture of a model cannot be drawn.
    #[error("cannot draw the picture of {identifier}: {cause}")]
    Picture { identifier: String, cause: videg_report::ReportError },
    /// A document cannot be written.
    #[error("cannot write {document}: {cause}")]
    Template { document: String, cause: askama::Error },
    /// The name of a library to add does not tell its FMU.
    #[error("{} is named after no FMU; allowed are {}", path.display(), FMUS.map(|fmu| fmu.identifier).join(" and "))]
    AddedName { path: PathBuf },
}

impl From<FmiError> for PackageError {
    fn from(error: FmiError) -> Self {
        Self::Package(error.into())
    }
}

impl PackageError {
    pub(super) fn io(action: &'static str, path: &Path) -> impl FnOnce(std::io::Error) -> Self {
        move |cause| fmu_package::PackageError::io(action, path)(cause).into()
    }

    pub(super) fn template(document: impl Into<String>) -> impl FnOnce(askama::Error) -> Self {
        let document = document.into();
        |cause| Self::Template { document, cause }
    }
}

fn list(paths: &[PathBuf]) -> String {
    let names: Vec<_> = paths.iter().map(|path| path.display().to_string()).collect();
    names.join(", ")
}
