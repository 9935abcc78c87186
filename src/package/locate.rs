//! Finds the source tree, the libraries and the model descriptions.

use std::io;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use fmu_package::cargo::{self, Build};
use fmu_package::{Messages, Platform, Target};

use super::error::{PackageError, Result};
use super::{FMUS, FmuPackage, NO_BUILD, Options, fresh};

/// Reason for users who have the program alone.
const NO_TREE: &str = if cfg!(feature = "embedded-fmus") {
    "there is no source tree to build it from"
} else {
    "there is no source tree to build it from, and this videg was compiled without the feature embedded-fmus"
};

/// The source tree: around the running program, where it was compiled, or around the working folder.
pub(super) fn workspace() -> Option<PathBuf> {
    let compiled = Path::new(env!("CARGO_MANIFEST_DIR"));
    around_program()
        .or_else(|| is_workspace(compiled).then(|| compiled.to_path_buf()))
        .or_else(|| around(&std::env::current_dir().ok()?))
}

/// The source tree that holds the running program, if one does.
pub(super) fn around_program() -> Option<PathBuf> {
    around(&std::env::current_exe().ok()?)
}

fn around(path: &Path) -> Option<PathBuf> {
    path.ancestors().find(|folder| is_workspace(folder)).map(Path::to_path_buf)
}

/// Paths where the library of an FMU that belongs to this program may be: not in a source tree around the working folder.
pub(super) fn own_libraries(fmu: &FmuPackage) -> Vec<PathBuf> {
    let compiled = Path::new(env!("CARGO_MANIFEST_DIR"));
    let program = std::env::current_exe().ok();
    let workspace = own_workspace(program.as_deref(), compiled, cfg!(feature = "embedded-fmus"));
    let name = Platform::HOST.cargo_name(fmu.identifier);
    folders(workspace, None).iter().map(|folder| folder.join(&name)).collect()
}

/// The source tree that belongs to `program`, which was `compiled` in this one. A program with FMUs inside is handed over to others:
/// on their machines the folder in which it was compiled may hold anything.
fn own_workspace<'a>(program: Option<&'a Path>, compiled: &'a Path, has_fmus: bool) -> Option<&'a Path> {
    let around = program.and_then(|path| path.ancestors().find(|folder| is_workspace(folder)));
    around.or_else(|| (!has_fmus && is_workspace(compiled)).then_some(compiled))
}

fn is_workspace(folder: &Path) -> bool {
    FMUS.iter().all(|fmu| folder.join(fmu.folder).join("Cargo.toml").is_file()) && folder.join("Cargo.toml").is_file()
}

/// The libraries for one target, in the order of [`FMUS`]: built, or else found.
pub(super) fn libraries(options: &Options, workspace: Option<&Path>, target: Option<&Target>) -> Result<Vec<PathBuf>> {
    let platform = target.map_or(Platform::HOST, |target| target.platform);
    let beside = beside_program();
    if let (true, None, Some(libraries)) = (options.as_is, target, beside.as_deref().and_then(lying_in)) {
        let built = around_program().and_then(|tree| lying_in(&release_folder(&tree)));
        let newer = built.filter(|built| fresh::modified(&built[0]) > fresh::modified(&libraries[0]));
        return Ok(newer.unwrap_or(libraries));
    }
    if let (None, true, Some(workspace)) = (target, options.build, workspace) {
        // Elsewhere than beside the program, what nobody has noted may be older than its sources.
        let release = Some(release_folder(workspace)).filter(|folder| fresh::asked(folder).is_some());
        for folder in beside.into_iter().chain(release) {
            let (libraries, asked) = (lying_in(&folder), fresh::asked(&folder));
            let is_fresh = |library: &PathBuf| fresh::is_fresh(library, asked, workspace);
            if let Some(libraries) = libraries.filter(|libraries| libraries.iter().all(is_fresh)) {
                return Ok(libraries);
            }
        }
    }
    let why = match workspace {
        None => NO_TREE.to_owned(),
        Some(_) if !options.build => format!("building is switched off, by option or {NO_BUILD}"),
        Some(workspace) => match build(workspace, target, options.progress) {
            // There is no toolchain.
            Err(error) if is_not_found(&error) => error.to_string(),
            // Cargo cannot work in a read-only source tree, whose libraries cannot be out of date either.
            Err(fmu_package::PackageError::Build { .. }) if !can_write(&build_folder(workspace)) => {
                format!("nothing can be built into {}, which cannot be written", build_folder(workspace).display())
            }
            other => return Ok(other?),
        },
    };
    let folders = folders(workspace, target);
    FMUS.iter().map(|fmu| find(fmu, platform, &folders, &why)).collect()
}

/// Builds the libraries of all FMUs and returns them in the order of [`FMUS`].
fn build(workspace: &Path, target: Option<&Target>, progress: fn(&str)) -> fmu_package::Result<Vec<PathBuf>> {
    let packages = FMUS.iter().flat_map(|fmu| ["-p", fmu.package]);
    let arguments: Vec<_> = ["--release"].into_iter().chain(packages).map(str::to_owned).collect();
    let (asked, messages) = (SystemTime::now(), Messages::Taken(progress));
    let libraries = cargo::libraries(&Build { folder: workspace, arguments: &arguments, target, messages })?;
    let libraries: Vec<_> =
        FMUS.iter().map(|fmu| libraries.named(fmu.identifier)).collect::<fmu_package::Result<_>>()?;
    if let (None, Some(folder)) = (target, libraries[0].parent()) {
        fresh::note(folder, asked);
    }
    Ok(libraries)
}

/// The folder of the running program, where release libraries may be.
fn beside_program() -> Option<PathBuf> {
    let program = std::env::current_exe().ok()?;
    program.parent().filter(|folder| !folder.ends_with("debug") && !folder.ends_with("deps")).map(Path::to_path_buf)
}

/// The libraries of all FMUs in a folder, if all are there.
fn lying_in(folder: &Path) -> Option<Vec<PathBuf>> {
    let libraries = FMUS.iter().map(|fmu| folder.join(Platform::HOST.cargo_name(fmu.identifier)));
    libraries.map(|library| library.is_file().then_some(library)).collect()
}

fn is_not_found(error: &fmu_package::PackageError) -> bool {
    matches!(error, fmu_package::PackageError::Cargo { cause, .. } if cause.kind() == io::ErrorKind::NotFound)
}

/// Folders in which libraries may be: beside the program (tests run in `deps`), then where Cargo puts them.
fn folders(workspace: Option<&Path>, target: Option<&Target>) -> Vec<PathBuf> {
    let mut folders = Vec::new();
    if target.is_none() {
        let program = std::env::current_exe().ok();
        if let Some(beside) = program.as_deref().and_then(Path::parent) {
            folders.extend([beside.to_path_buf(), beside.join("deps")]);
            if beside.ends_with("deps") || beside.ends_with("examples") {
                folders.extend(beside.parent().map(Path::to_path_buf));
            }
        }
    }
    if let Some(workspace) = workspace {
        let base = build_folder(workspace);
        folders.push(target.map_or_else(|| base.clone(), |target| base.join(&target.triple)).join("release"));
    }
    folders
}

/// The build folder of Cargo.
pub(super) fn build_folder(workspace: &Path) -> PathBuf {
    let folder = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| workspace.join("target"), PathBuf::from);
    std::path::absolute(&folder).unwrap_or(folder)
}

/// Where Cargo puts the libraries of this machine.
fn release_folder(workspace: &Path) -> PathBuf {
    build_folder(workspace).join("release")
}

fn can_write(folder: &Path) -> bool {
    std::fs::create_dir_all(folder).and_then(|()| tempfile::tempfile_in(folder)).is_ok()
}

fn find(fmu: &FmuPackage, platform: Platform, folders: &[PathBuf], why: &str) -> Result<PathBuf> {
    let looked: Vec<_> = folders.iter().map(|folder| folder.join(platform.cargo_name(fmu.identifier))).collect();
    // The newest, of equal ones the first.
    let found = looked.iter().rev().filter(|path| path.is_file()).max_by_key(|path| fresh::modified(path)).cloned();
    found.ok_or_else(|| PackageError::NoLibrary { identifier: fmu.identifier, why: why.to_owned(), looked })
}

/// The model description: of the source tree, or of a folder beside the program.
pub(super) fn description(fmu: &FmuPackage, workspace: Option<&Path>) -> Result<PathBuf> {
    let program = std::env::current_exe().ok();
    let beside = program.as_deref().and_then(Path::parent);
    let name = format!("{}.xml", fmu.identifier);
    let roots = [workspace, beside].into_iter().flatten();
    let looked: Vec<_> = roots.map(|root| root.join("modelDescription").join(&name)).collect();
    let found = looked.iter().find(|path| path.is_file()).cloned();
    found.ok_or(PackageError::NoDescription { identifier: fmu.identifier, looked })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_program_with_fmus_inside_does_not_trust_the_folder_that_it_was_compiled_in() {
        let here = Path::new(env!("CARGO_MANIFEST_DIR"));
        let elsewhere = tempfile::tempdir().unwrap();
        let program = elsewhere.path().join("videg");
        assert_eq!(own_workspace(Some(&program), here, false), Some(here));
        assert_eq!(own_workspace(Some(&program), here, true), None);
        assert_eq!(own_workspace(Some(&here.join("target/release/videg")), here, true), Some(here), "it lies in it");
    }
}
