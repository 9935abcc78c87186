//! What `cargo metadata` says about a workspace.

use std::path::{Path, PathBuf};

use serde::Deserialize;

use super::cargo;
use super::error::{PackageError, Result};

#[derive(Deserialize)]
pub(crate) struct Metadata {
    pub packages: Vec<Package>,
    pub target_directory: PathBuf,
    pub workspace_root: PathBuf,
}

#[derive(Deserialize)]
pub(crate) struct Package {
    pub name: String,
    pub manifest_path: PathBuf,
    pub license: Option<String>,
    pub license_file: Option<PathBuf>,
    pub targets: Vec<Target>,
}

#[derive(Deserialize)]
pub(crate) struct Target {
    pub name: String,
    pub kind: Vec<String>,
    pub crate_types: Vec<String>,
    pub src_path: PathBuf,
}

impl Metadata {
    /// Reads the metadata of the workspace that contains `folder`, or that of a manifest.
    ///
    /// # Errors
    /// When there is none, or Cargo fails.
    pub(crate) fn of(folder: &Path, manifest: Option<&Path>) -> Result<Self> {
        let named = manifest.map(|path| path.display().to_string());
        let mut arguments = vec!["metadata", "--no-deps", "--format-version=1"];
        arguments.extend(named.iter().flat_map(|path| ["--manifest-path", path]));
        let text = cargo::output(folder, &arguments)?;
        serde_json::from_slice(&text).map_err(|cause| PackageError::Metadata { cause })
    }

    /// The package with this name, or else the one around `folder`, or else the only one.
    ///
    /// # Errors
    /// When there is none.
    pub(crate) fn package(&self, name: Option<&str>, folder: &Path) -> Result<&Package> {
        let around = || {
            let inner = self.packages.iter().filter(|package| folder.starts_with(package.folder()));
            inner.max_by_key(|package| package.folder().as_os_str().len())
        };
        let only = || self.packages.first().filter(|_| self.packages.len() == 1);
        let found = match name {
            Some(name) => self.packages.iter().find(|package| package.name == name),
            None => around().or_else(only),
        };
        found.ok_or_else(|| PackageError::Package {
            folder: folder.to_owned(),
            reason: name.map_or_else(
                || "it lies in no package, so name one with --package".to_owned(),
                |name| format!("no package is called {name}"),
            ),
            packages: self.packages.iter().map(|package| package.name.clone()).collect(),
        })
    }
}

impl Package {
    /// The folder of its manifest.
    pub(crate) fn folder(&self) -> &Path {
        self.manifest_path.parent().unwrap_or(&self.manifest_path)
    }

    /// Its library, or an example, which must be shared ones.
    ///
    /// # Errors
    /// When there is none.
    pub(crate) fn library(&self, example: Option<&str>) -> Result<&Target> {
        let is_wanted = |target: &&Target| match example {
            Some(name) => target.kind.iter().any(|kind| kind == "example") && target.name == name,
            None => !target.kind.iter().any(|kind| matches!(kind.as_str(), "bin" | "example" | "test" | "bench")),
        };
        let shared = |target: &&Target| target.crate_types.iter().any(|kind| kind == "cdylib");
        self.targets.iter().find(|target| is_wanted(target) && shared(target)).ok_or_else(|| {
            let crate_type = "crate-type = [\"cdylib\"]";
            PackageError::NoLibraryTarget {
                package: self.name.clone(),
                wanted: example.map_or_else(|| "library".to_owned(), |name| format!("example {name}")),
                manifest: self.manifest_path.clone(),
                needed: example.map_or_else(
                    || format!("[lib] with {crate_type}"),
                    |name| format!("[[example]] with name = \"{name}\" and {crate_type}"),
                ),
            }
        })
    }
}
