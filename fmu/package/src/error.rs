//! Errors of the packager. Every message is one line (and Cargo's own words).

use std::io;
use std::path::{Path, PathBuf};

use fmu_import::FmiError;
use thiserror::Error;

use super::platform::Platform;

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
    #[error("{command} failed ({status}){tail}")]
    Build { command: String, status: String, tail: String },
    /// Cargo was content, but made no library.
    #[error(
        "{command} made no shared library of {identifier} for this machine; does CARGO_BUILD_TARGET or .cargo/config.toml name another \
         target?"
    )]
    NotBuilt { command: String, identifier: String },
    /// What Cargo says about packages cannot be read.
    #[error("cannot read what cargo metadata says: {cause}")]
    Metadata { cause: serde_json::Error },
    /// A package is not there, or none is named.
    #[error("{}: {reason}; its packages are {}", folder.display(), packages.join(", "))]
    Package { folder: PathBuf, reason: String, packages: Vec<String> },
    /// A package has no shared library.
    #[error("{package} has no {wanted} of crate-type cdylib; {} needs {needed}", manifest.display())]
    NoLibraryTarget { package: String, wanted: String, manifest: PathBuf, needed: String },
    /// A library does not describe itself.
    #[error("cannot ask {} for its model description: {cause}; is export_fmu! in it, and fmu-export as new as this program?", library.display())]
    NoDescribe { library: PathBuf, cause: libloading::Error },
    /// A model has no description.
    #[error("{package} has no model description: {reason}")]
    Undescribed { package: String, reason: String },
    /// A model description cannot be used.
    #[error(transparent)]
    Description(#[from] FmiError),
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
    /// A library to add is for something else.
    #[error("{} holds {found}, wanted is a {} library", path.display(), platform.folder)]
    AddedLibrary { path: PathBuf, found: String, platform: Platform },
    /// A library to add is no FMU's.
    #[error("{} does not export {symbol}", path.display())]
    AddedExport { path: PathBuf, symbol: &'static str },
    /// An archive would get two libraries for one platform.
    #[error("two libraries of {identifier} for {}: {} and {other}", platform.folder, path.display())]
    AddedTwice { identifier: String, platform: Platform, path: PathBuf, other: String },
    /// A library is for no machine.
    #[error("the library of {identifier} for {} is broken: {cause}", platform.folder)]
    Machine { identifier: String, platform: Platform, cause: object::read::Error },
    /// A file cannot be in an FMU under its name.
    #[error("file {}: {reason}", path.display())]
    File { path: PathBuf, reason: String },
    /// No system could unpack an archive.
    #[error("{}: {reason}", archive.display())]
    Names { archive: PathBuf, reason: String },
    /// Two targets would share a folder of the archive.
    #[error("two targets for the platform {}: {first} and {second}; an FMU holds one", platform.folder)]
    SamePlatform { platform: Platform, first: String, second: String },
}

impl PackageError {
    /// The error of a file operation.
    pub fn io(action: &'static str, path: &Path) -> impl FnOnce(io::Error) -> Self {
        move |cause| Self::Io { action, path: path.to_path_buf(), cause }
    }
}
