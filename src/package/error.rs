//! What can go wrong while packaging; as in the importer, every message is one line (and Cargo's own words).

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
pub enum PackageError {
    /// The file system refused.
    #[error("cannot {action} {}: {cause}", path.display())]
    Io {
        /// What was tried.
        action: &'static str,
        /// On which file.
        path: PathBuf,
        /// What the system said.
        cause: io::Error,
    },
    /// The archive could not be written.
    #[error("cannot write {}: {cause}", path.display())]
    Zip {
        /// The archive.
        path: PathBuf,
        /// What the writer said.
        cause: zip::result::ZipError,
    },
    /// Cargo could not be started.
    #[error("cannot run {}: {cause}", program.display())]
    Cargo {
        /// The program.
        program: PathBuf,
        /// What the system said.
        cause: io::Error,
    },
    /// Cargo failed.
    #[error("{command} failed ({status}):\n{tail}")]
    Build {
        /// The command line.
        command: String,
        /// Exit status.
        status: String,
        /// The last lines that it printed.
        tail: String,
    },
    /// Cargo was content, but made no library.
    #[error("{command} made no shared library of {identifier}")]
    NotBuilt {
        /// The command line.
        command: String,
        /// Model identifier.
        identifier: &'static str,
    },
    /// A library was not found.
    #[error("cannot find the library of {identifier} ({why}); looked for: {}", list(looked))]
    NoLibrary {
        /// Model identifier.
        identifier: &'static str,
        /// Why it was not built.
        why: String,
        /// Files looked for.
        looked: Vec<PathBuf>,
    },
    /// A model description was not found.
    #[error("cannot find the model description of {identifier}; looked for: {}", list(looked))]
    NoDescription {
        /// Model identifier.
        identifier: &'static str,
        /// Files looked for.
        looked: Vec<PathBuf>,
    },
    /// Archives can be written neither where users know them nor into a cache.
    #[error(
        "{refused}, and {}; set XDG_CACHE_HOME to a folder that can be written",
        cached.as_ref().map_or_else(|| "there is no folder of caches".to_owned(), ToString::to_string)
    )]
    NoPlace {
        /// Why not the one.
        refused: Box<PackageError>,
        /// Why not the other, if there is one.
        cached: Option<Box<PackageError>>,
    },
    /// An archive inside the program cannot be used.
    #[error("the {identifier}.fmu inside videg {why}")]
    Embedded {
        /// Model identifier.
        identifier: &'static str,
        /// What is wrong.
        why: String,
    },
    /// A model description cannot be used.
    #[error(transparent)]
    Description(#[from] FmiError),
    /// A model description belongs to another model.
    #[error("{}: modelIdentifier is \"{found}\", allowed is \"{allowed}\"", path.display())]
    Identifier {
        /// The file.
        path: PathBuf,
        /// The identifier found.
        found: String,
        /// The model that is packaged.
        allowed: String,
    },
    /// The picture of a model cannot be drawn.
    #[error(
        "cannot draw the model: the start value of {variable} is {}, allowed is a positive number",
        found.map_or_else(|| "missing".to_owned(), |found| found.to_string())
    )]
    Picture {
        /// The variable.
        variable: &'static str,
        /// Its start value, if it has one.
        found: Option<f64>,
    },
    /// The documentation cannot be written.
    #[error("cannot write the documentation of {identifier}: {cause}")]
    Documentation {
        /// Model identifier.
        identifier: String,
        /// What the template engine said.
        cause: askama::Error,
    },
    /// A document cannot be written as XML.
    #[error("cannot write {document}: {cause}")]
    Xml {
        /// The document.
        document: &'static str,
        /// What the writer said.
        cause: quick_xml::SeError,
    },
    /// FMI 2.0 has no name for a platform.
    #[error(
        "no FMI 2.0 platform for the target {triple}; allowed are linux64, win64, darwin64 and Rust triples of Linux, \
         Windows and macOS"
    )]
    Platform {
        /// The target triple.
        triple: String,
    },
    /// Only a Mac can link for macOS.
    #[error(
        "cannot build for {target} on this machine, since Apple's linker runs on a Mac only; build there and merge the \
         libraries with --add-binary {}=FILE", platform.folder
    )]
    NeedsMac {
        /// As asked for.
        target: String,
        /// The platform.
        platform: Platform,
    },
    /// A tool for building is not installed.
    #[error("cannot build for {target}: {tool} is missing; install it with `{install}`")]
    MissingTool {
        /// The tool.
        tool: String,
        /// What was to be built.
        target: String,
        /// The command that installs it.
        install: String,
    },
    /// No platform has this name.
    #[error("no platform of FMI 2.0 is called \"{found}\"; allowed are {allowed}")]
    PlatformName {
        /// The name.
        found: String,
        /// All names.
        allowed: String,
    },
    /// A library to add is not given as it should be.
    #[error("--add-binary wants PLATFORM=FILE, found \"{found}\"")]
    AddedForm {
        /// What was given.
        found: String,
    },
    /// The name of a library to add does not tell its FMU.
    #[error("{} is named after no FMU; allowed are {}", path.display(), FMUS.map(|fmu| fmu.identifier).join(" and "))]
    AddedName {
        /// The library.
        path: PathBuf,
    },
    /// A library to add is for something else.
    #[error("{} holds {found}, wanted is a {} library", path.display(), platform.folder)]
    AddedLibrary {
        /// The library.
        path: PathBuf,
        /// What it really is.
        found: String,
        /// What it was said to be for.
        platform: Platform,
    },
    /// A library to add is no FMU's.
    #[error("{} does not export {symbol}", path.display())]
    AddedExport {
        /// The library.
        path: PathBuf,
        /// What it lacks.
        symbol: &'static str,
    },
    /// An archive would get two libraries for one platform.
    #[error("two libraries of {identifier} for {}: {} and {other}", platform.folder, path.display())]
    AddedTwice {
        /// Model identifier.
        identifier: &'static str,
        /// The platform.
        platform: Platform,
        /// The library to add.
        path: PathBuf,
        /// What is there already.
        other: String,
    },
    /// Two targets would share a folder of the archive.
    #[error("two targets for the platform {}: {first} and {second}; an FMU holds one", platform.folder)]
    SamePlatform {
        /// The platform.
        platform: Platform,
        /// One target.
        first: String,
        /// The other.
        second: String,
    },
}

impl PackageError {
    pub(super) fn io(action: &'static str, path: &Path) -> impl FnOnce(io::Error) -> Self {
        move |cause| Self::Io { action, path: path.to_path_buf(), cause }
    }
}

fn list(paths: &[PathBuf]) -> String {
    let names: Vec<_> = paths.iter().map(|path| path.display().to_string()).collect();
    names.join(", ")
}
