//! Packager: from the compiled libraries to `.fmu` archives, and from those to the `.ssp` archive that connects them.
//!
//! An FMU is made of `modelDescription/<Id>.xml` of the source tree, the library of each platform, and
//! documentation: a page and a picture from `fmu/*/documentation`, licenses; and the experiments of `fmu/*/extra`.
//! In a source tree, Cargo builds the libraries first, so that they belong to the sources. Without one, the packager takes the FMUs
//! inside the program (feature `embedded-fmus`), or else the libraries beside it.
//!
//! ```no_run
//! use videg::package::{Options, build_all};
//!
//! # fn main() -> Result<(), videg::package::PackageError> {
//! for path in build_all(&Options { progress: |line| eprintln!("{line}"), ..Options::default() })? {
//!     println!("{}", path.display());
//! }
//! # Ok(())
//! # }
//! ```

mod added;
mod cache;
mod content;
mod embedded;
mod error;
mod explorer;
mod fresh;
mod locate;
mod ssp;

use std::path::{Path, PathBuf};

pub use fmu_package::{FmiVersion, Platform};
use fmu_package::{Fmu, targets};

pub use added::AddedBinary;
pub use cache::Placed;
pub use error::{PackageError, Result};
pub use explorer::explorer;
pub use ssp::{Part, SystemPackage};

/// An FMU of this project.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FmuPackage {
    /// Model identifier: name of the library and of the archive.
    pub identifier: &'static str,
    /// Name of the Cargo package that builds the library.
    pub package: &'static str,
    /// Its folder in the source tree.
    pub folder: &'static str,
}

/// All FMUs of this project.
pub const FMUS: [FmuPackage; 2] = [
    FmuPackage { identifier: "VibroImpactHarvester", package: "videg-fmu-harvester", folder: "fmu/harvester" },
    FmuPackage { identifier: "HarvestingCircuit", package: "videg-fmu-circuit", folder: "fmu/circuit" },
];

/// The FMU that reads files.
const READER: &str = "VibroImpactHarvester";

/// Environment variable that keeps the packager from running Cargo, unless it is empty.
pub const NO_BUILD: &str = "VIDEG_NO_BUILD";

/// How to package. The default is FMI 2.0 for this machine, into `target/fmu` of the source tree (without one: of the working
/// folder; FMI 3.0 into `target/fmu/fmi3`), and builds unless [`NO_BUILD`] is set.
#[derive(Debug, Clone)]
pub struct Options {
    /// Version of FMI.
    pub fmi: FmiVersion,
    /// Folder of the archives.
    pub output: Option<PathBuf>,
    /// Whether Cargo may be run.
    pub build: bool,
    /// Take the libraries beside the running program as they are, if there are any, even if the source tree has changed since.
    pub as_is: bool,
    /// Platforms of the archive: `linux64` (for any Linux of the last ten years), `win64`, `darwin64`
    /// or Rust triples; none means this machine, for itself.
    pub targets: Vec<String>,
    /// Libraries that were built elsewhere. One for this machine takes the place of the one that would be built without
    /// any target.
    pub added: Vec<AddedBinary>,
    /// Files for the folder `resources` of the harvester: recordings of its excitation.
    pub resources: Vec<PathBuf>,
    /// Takes the lines of Cargo's progress.
    pub progress: fn(&str),
}

impl Default for Options {
    fn default() -> Self {
        let build = std::env::var_os(NO_BUILD).is_none_or(|value| value.is_empty());
        Self {
            fmi: FmiVersion::default(),
            output: None,
            build,
            as_is: false,
            targets: Vec::new(),
            added: Vec::new(),
            resources: Vec::new(),
            progress: |_| {},
        }
    }
}

/// Whether `library` is the library of the FMU `identifier` that belongs to this program, by its bytes: the one beside it, in its
/// source tree, or inside it.
pub fn is_own(identifier: &str, library: &Path) -> bool {
    let Some(fmu) = FMUS.iter().find(|fmu| fmu.identifier == identifier) else { return false };
    let Ok(bytes) = std::fs::read(library) else { return false };
    locate::own_libraries(fmu).iter().any(|own| std::fs::read(own).is_ok_and(|own| own == bytes))
        || embedded::has(identifier, &bytes)
}

/// Where FMUs are written by default, for a source tree.
fn default_output(workspace: Option<&Path>) -> PathBuf {
    workspace.unwrap_or_else(|| Path::new(".")).join("target").join("fmu")
}

/// Packages all FMUs of this project and returns the archives, in the order of [`FMUS`].
///
/// # Errors
/// When a library cannot be built or found, a model description is missing or belongs to another model, or a file
/// cannot be read or written.
pub fn build_all(options: &Options) -> Result<Vec<PathBuf>> {
    let (archives, output) = pack(options)?;
    write(&archives, &output)
}

/// As [`build_all`], for FMUs that are to be run: where their folder cannot be written, they go to a cache folder.
///
/// # Errors
/// As [`build_all`], if that cannot be written, either.
pub fn build_for_use(options: &Options) -> Result<Placed> {
    let (archives, output) = pack(options)?;
    cache::place(&archives, &output, cache::folder())
}

/// The archives, in the order of [`FMUS`], and the folder for them.
fn pack(options: &Options) -> Result<(Vec<Vec<u8>>, PathBuf)> {
    let (archives, output) = pack_2(options)?;
    Ok(match options.fmi {
        FmiVersion::Fmi2 => (archives, output),
        FmiVersion::Fmi3 if options.output.is_some() => (pack_3(&archives)?, output),
        FmiVersion::Fmi3 => (pack_3(&archives)?, output.join("fmi3")),
    })
}

/// Those of FMI 3.0, from those of FMI 2.0.
fn pack_3(archives: &[Vec<u8>]) -> Result<Vec<Vec<u8>>> {
    FMUS.iter().zip(archives).map(|(fmu, archive)| Ok(content::converted(fmu.identifier, archive)?.packed()?)).collect()
}

/// Those of FMI 2.0.
fn pack_2(options: &Options) -> Result<(Vec<Vec<u8>>, PathBuf)> {
    let output = |workspace| options.output.clone().unwrap_or_else(|| default_output(workspace));
    if let Some(archives) = embedded::archives(options) {
        return Ok((embedded::with_added(archives, options)?, output(None)));
    }
    let workspace = locate::workspace();
    let workspace = workspace.as_deref();
    let binaries = binaries(options, workspace)?;
    let mut archives = Vec::new();
    for (index, fmu) in FMUS.iter().enumerate() {
        let mut archive = described(fmu.identifier, &locate::description(fmu, workspace)?)?;
        for (platform, libraries) in &binaries {
            libraries.get(index).map_or(Ok(()), |library| archive.add_library_file(*platform, library))?;
        }
        for binary in added::of(fmu.identifier, &options.added) {
            archive.add_library_file(binary.platform, &binary.path)?;
        }
        content::add(&mut archive)?;
        add_resources(fmu, &options.resources, &mut archive)?;
        archives.push(archive.packed()?);
    }
    Ok((archives, output(workspace)))
}

/// An FMU with the model description at `path`, which must be that of `identifier`.
fn described(identifier: &str, path: &Path) -> Result<Fmu> {
    let text = std::fs::read(path).map_err(PackageError::io("read", path))?;
    let fmu = Fmu::new(text, &path.display().to_string())?;
    let found = fmu.identifier();
    if found != identifier {
        let (path, found, allowed) = (path.to_path_buf(), found.to_owned(), identifier.to_owned());
        return Err(PackageError::Identifier { path, found, allowed });
    }
    Ok(fmu)
}

/// Adds files to the resources of an archive, if it is that of the FMU that reads them.
fn add_resources(fmu: &FmuPackage, files: &[PathBuf], archive: &mut Fmu) -> Result<()> {
    if fmu.identifier == READER {
        fmu_package::add_resources(files, archive.entries_mut())?;
    }
    Ok(())
}

fn file_name(fmu: &FmuPackage) -> PathBuf {
    PathBuf::from(format!("{}.fmu", fmu.identifier))
}

/// Writes archives, in the order of [`FMUS`], into `folder`.
fn write(archives: &[Vec<u8>], folder: &Path) -> Result<Vec<PathBuf>> {
    let paths = FMUS.iter().map(|fmu| folder.join(file_name(fmu)));
    paths
        .zip(archives)
        .map(|(path, archive)| {
            fmu_package::write_shared(&path, archive)?;
            Ok(path)
        })
        .collect()
}

/// The libraries of each platform, in the order of [`FMUS`].
fn binaries(options: &Options, workspace: Option<&Path>) -> Result<Vec<(Platform, Vec<PathBuf>)>> {
    // Checked before the first library is built, which may take minutes.
    // FMUs of FMI 3.0 are made of those of FMI 2.0.
    let targets = targets(&options.targets, FmiVersion::Fmi2)?;
    for fmu in &FMUS {
        fmu_package::AddedBinary::check_all(fmu.identifier, &added::of(fmu.identifier, &options.added), &targets)?;
    }
    if targets.is_empty() {
        let is_added = |fmu: &FmuPackage| {
            added::of(fmu.identifier, &options.added).iter().any(|binary| binary.platform == Platform::HOST)
        };
        if FMUS.iter().all(is_added) {
            return Ok(Vec::new());
        }
        return Ok(vec![(Platform::HOST, locate::libraries(options, workspace, None)?)]);
    }
    targets.iter().map(|target| Ok((target.platform, locate::libraries(options, workspace, Some(target))?))).collect()
}

#[cfg(test)]
mod tests;
