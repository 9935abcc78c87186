//! Errors of the packager. As in the importer, every message is one line (and Cargo's own words).

use std::io;
use std::path::{Path, PathBuf};

use thiserror::Error;

use super::FMUS;
use super::platform::Platform;
use fmu_import::FmiError;

/// Result of the packager.
pub type Result<T> = std::result::Result<T, PackageError>;

/// Why an FMU could not be packaged.
#[derive(Debug, Error)]
#[allow(missing_docs, reason = "the message of each variant names its fields")]
pub enum PackageError {
    /// The file system refused.
    #[error("cannot {action} {}: {cause}", path.display())]
    Io { action: &'static str, path: PathBuf, cause: io::Error },
    /// Cargo could not be started.
    #[error("cannot run {}: {cause}", program.display())]
    Cargo { program: PathBuf, cause: io::Error },
    /// Cargo failed.
    #[error("{command} failed ({status}):\n{tail}")]
    Build { command: String, status: String, tail: String },
    /// Cargo was content, but made no library.
    #[error("{command} made no shared library of {identifier}")]
    NotBuilt { command: String, identifier: &'static str },
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
    /// A model description cannot be used.
    #[error(transparent)]
    Description(#[from] FmiError),
    /// A model description belongs to another model.
    #[error("{}: modelIdentifier is \"{found}\", allowed is \"{allowed}\"", path.display())]
    Identifier { path: PathBuf, found: String, allowed: String },
    /// The picture of a model cannot be drawn.
    #[error("cannot draw the picture of {identifier}: {cause}")]
    Picture { identifier: String, cause: videg_report::ReportError },
    /// A document cannot be written.
    #[error("cannot write {document}: {cause}")]
    Template { document: String, cause: askama::Error },
    /// FMI 2.0 has no name for a platform.
    #[error(
        "no FMI 2.0 platform for the target {triple}; allowed are linux64, win64, darwin64 and Rust triples of Linux, \
         Windows and macOS"
    )]
    Platform { triple: String },
    /// Only a Mac can link for macOS.
    #[error(
        "cannot build for {target} on this machine, since Apple's linker runs on a Mac only; build there and merge the \
         libraries with --add-binary {}=FILE", platform.folder
    )]
    NeedsMac { target: String, platform: Platform },
    /// A tool for building is not installed.
    #[error("cannot build for {target}: {tool} is missing; install it with `{install}`")]
    MissingTool { tool: String, target: String, install: String },
    /// No platform has this name.
    #[error("no platform of FMI 2.0 is called \"{found}\"; allowed are {allowed}")]
    PlatformName { found: String, allowed: String },
    /// A library to add is not given as it should be.
    #[error("--add-binary wants PLATFORM=FILE, found \"{found}\"")]
    AddedForm { found: String },
    /// The name of a library to add does not tell its FMU.
    #[error("{} is named after no FMU; allowed are {}", path.display(), FMUS.map(|fmu| fmu.identifier).join(" and "))]
    AddedName { path: PathBuf },
    /// A library to add is for something else.
    #[error("{} holds {found}, wanted is a {} library", path.display(), platform.folder)]
    AddedLibrary { path: PathBuf, found: String, platform: Platform },
    /// A library to add is no FMU's.
    #[error("{} does not export {symbol}", path.display())]
    AddedExport { path: PathBuf, symbol: &'static str },
    /// An archive would get two libraries for one platform.
    #[error("two libraries of {identifier} for {}: {} and {other}", platform.folder, path.display())]
    AddedTwice { identifier: &'static str, platform: Platform, path: PathBuf, other: String },
    /// A file cannot be a resource under its name.
    #[error("resource {}: {reason}", path.display())]
    Resource { path: PathBuf, reason: String },
    /// Two targets would share a folder of the archive.
    #[error("two targets for the platform {}: {first} and {second}; an FMU holds one", platform.folder)]
    SamePlatform { platform: Platform, first: String, second: String },
}

impl PackageError {
    pub(super) fn io(action: &'static str, path: &Path) -> impl FnOnce(io::Error) -> Self {
        move |cause| Self::Io { action, path: path.to_path_buf(), cause }
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
