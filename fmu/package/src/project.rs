//! A Cargo package whose library exports a model with `fmu-export`, as an FMU.

use std::path::{Path, PathBuf};

use super::binary::AddedBinary;
use super::cargo::{self, Build, Messages};
use super::describe::Descriptions;
use super::documentation::page;
use super::error::{PackageError, Result};
use super::fmu::{Fmu, picture};
use super::licenses;
use super::metadata::Metadata;
use super::platform::Platform;
use super::resources::add_folder;
use super::target::{Target, targets};
use super::version::FmiVersion;

/// The package with the exporter, and its feature with which a library describes itself.
const EXPORTER: &str = "fmu-export";
const FEATURE: &str = "model-description";

/// Folders beside the sources that are in the FMU as they are.
const FOLDERS: [&str; 3] = ["documentation", "extra", "resources"];

/// What to package, and how. The default is FMI 2.0 of the package in the working folder for this machine.
#[derive(Debug, Clone, Default)]
pub struct Request {
    /// Manifest of the package or its workspace; without one, that around the working folder.
    pub manifest: Option<PathBuf>,
    /// Name of the package; without one, that around the folder.
    pub package: Option<String>,
    /// One of its examples in place of its library.
    pub example: Option<String>,
    /// Version of FMI.
    pub fmi: FmiVersion,
    /// Platforms (`linux64`, `win64`, `darwin64`) or Rust triples; none means this machine, for itself.
    pub targets: Vec<String>,
    /// Libraries that were built elsewhere.
    pub added: Vec<AddedBinary>,
    /// Folder of the archive: without one, `fmu` in the folder in which Cargo builds, for FMI 3.0 `fmu/fmi3`.
    pub output: Option<PathBuf>,
    /// Further arguments of Cargo, for all libraries that it builds: features, profiles.
    pub cargo: Vec<String>,
    /// What becomes of Cargo's messages.
    pub messages: Messages,
}

/// A package that becomes an FMU.
#[derive(Debug)]
pub struct Project {
    request: Request,
    package: String,
    /// Name of the library, as Cargo has it.
    library: String,
    /// Folder of the manifest.
    folder: PathBuf,
    /// Folder of the files for the FMU, if there is one.
    files: Option<PathBuf>,
    workspace: PathBuf,
    target_folder: PathBuf,
    license: Option<String>,
    license_file: Option<PathBuf>,
    targets: Vec<Target>,
}

impl Project {
    /// Finds the package.
    ///
    /// # Errors
    /// When there is none, it has no shared library, or a target cannot be built for.
    pub fn find(request: &Request) -> Result<Self> {
        let targets = targets(&request.targets, request.fmi)?;
        let here = std::path::absolute(".").map_err(PackageError::io("read", Path::new(".")))?;
        let manifest = request.manifest.as_deref();
        let metadata = Metadata::of(&here, manifest)?;
        let folder = match manifest.map(std::fs::canonicalize) {
            Some(Ok(manifest)) => manifest.parent().map(Path::to_owned).unwrap_or_default(),
            _ => std::fs::canonicalize(&here).unwrap_or(here),
        };
        let package = metadata.package(request.package.as_deref(), &folder)?;
        let library = package.library(request.example.as_deref())?;
        let folder = package.folder().to_owned();
        let files = match request.example {
            None => Some(folder.clone()),
            // An example has files of its own if it has a folder.
            Some(_) => library.src_path.parent().filter(|_| library.src_path.ends_with("main.rs")).map(Path::to_owned),
        };
        Ok(Self {
            request: request.clone(),
            package: package.name.clone(),
            library: library.name.clone(),
            license: package.license.clone(),
            license_file: package.license_file.as_ref().map(|file| folder.join(file)),
            files,
            folder,
            workspace: metadata.workspace_root.clone(),
            target_folder: metadata.target_directory.clone(),
            targets,
        })
    }

    /// Builds libraries and archive, and returns its path.
    ///
    /// # Errors
    /// When Cargo fails, the model has no description, or a file cannot be read or written.
    pub fn build(&self) -> Result<PathBuf> {
        let fmu = self.fmu()?;
        let default = || match self.request.fmi {
            FmiVersion::Fmi2 => self.target_folder.join("fmu"),
            FmiVersion::Fmi3 => self.target_folder.join("fmu").join("fmi3"),
        };
        fmu.write(&self.request.output.clone().unwrap_or_else(default))
    }

    /// The model description, whose library is built for that.
    ///
    /// # Errors
    /// As [`build`](Self::build).
    pub fn description(&self) -> Result<String> {
        self.description_of(&self.descriptions()?)
    }

    /// The FMU with all that is in it.
    fn fmu(&self) -> Result<Fmu> {
        let descriptions = self.descriptions()?;
        let mut fmu = Fmu::new(self.description_of(&descriptions)?, "modelDescription.xml")?;
        for (name, text) in descriptions.texts(self.request.fmi) {
            fmu.entries_mut().add(name, text);
        }
        self.add_libraries(&mut fmu)?;
        for folder in self.files.iter().flat_map(|files| FOLDERS.map(|folder| (files.join(folder), folder))) {
            add_folder(&folder.0, folder.1, fmu.entries_mut())?;
        }
        let license = self.license.as_deref();
        licenses::add(&[&self.folder, &self.workspace], self.license_file.as_deref(), license, fmu.entries_mut())?;
        if let Some(icon) = self.icon() {
            fmu.entries_mut().add_file(picture(self.request.fmi), &icon)?;
        }
        let page = page(fmu.description(), "")?;
        fmu.entries_mut().add_new("documentation/index.html", page);
        Ok(fmu)
    }

    fn description_of(&self, descriptions: &Descriptions) -> Result<String> {
        let mut texts = descriptions.texts(self.request.fmi);
        texts.find(|(name, _)| *name == "modelDescription.xml").map(|(_, text)| text.to_owned()).ok_or_else(|| {
            let reason = format!("its library gives none of {}", self.request.fmi);
            PackageError::Undescribed { package: self.package.clone(), reason }
        })
    }

    /// What a library says that is built for this machine, with the feature for that. It has a folder of its own, since Cargo tells
    /// libraries of different features apart by their folder only.
    fn descriptions(&self) -> Result<Descriptions> {
        let feature = if self.package == EXPORTER { FEATURE.to_owned() } else { format!("{EXPORTER}/{FEATURE}") };
        let mut arguments = self.selection();
        let folder = self.target_folder.join("fmu").join("description");
        let folder = folder.display().to_string();
        // With the same profile, whatever a model makes of it, but not optimised, since it is asked once: no number depends on that.
        arguments.extend(
            ["--config", "profile.release.opt-level=0", "--features", &feature, "--target-dir", &folder]
                .map(str::to_owned),
        );
        let library = self.built(&arguments, None)?;
        let resources = self.files.as_ref().map(|files| files.join("resources")).filter(|folder| folder.is_dir());
        Descriptions::of(&self.package, &library, resources.as_deref(), self.icon().is_some())
    }

    fn add_libraries(&self, fmu: &mut Fmu) -> Result<()> {
        let added = &self.request.added;
        AddedBinary::check_all(fmu.identifier(), added, &self.targets)?;
        let arguments = self.selection();
        let is_added = added.iter().any(|binary| binary.platform == Platform::HOST);
        if self.targets.is_empty() && !is_added {
            fmu.add_library_file(Platform::HOST, &self.built(&arguments, None)?)?;
        }
        for target in &self.targets {
            fmu.add_library_file(target.platform, &self.built(&arguments, Some(target))?)?;
        }
        added.iter().try_for_each(|binary| fmu.add_library_file(binary.platform, &binary.path))
    }

    /// The library that Cargo makes with these arguments.
    fn built(&self, arguments: &[String], target: Option<&Target>) -> Result<PathBuf> {
        let build = Build { folder: &self.folder, arguments, target, messages: self.request.messages };
        cargo::libraries(&build)?.named(&self.library)
    }

    /// The arguments of Cargo that choose the library.
    fn selection(&self) -> Vec<String> {
        let what = match &self.request.example {
            None => vec!["--lib"],
            Some(example) => vec!["--example", example],
        };
        let arguments = ["--release", "-p", &self.package].into_iter().chain(what).map(str::to_owned);
        arguments.chain(self.request.cargo.clone()).collect()
    }

    /// The picture beside the sources, if there is one.
    fn icon(&self) -> Option<PathBuf> {
        self.files.as_ref().map(|files| files.join("model.png")).filter(|file| file.is_file())
    }
}
