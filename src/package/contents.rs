//! The contents of one archive, and writing them so that equal contents give equal bytes.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, System, ZipWriter};

use super::error::{PackageError, Result};
use super::platform::Platform;
use crate::fmi::ModelDescription;

/// What goes into an archive: names with forward slashes, sorted, and the files behind them.
#[derive(Debug, Clone)]
pub struct Contents {
    identifier: String,
    files: BTreeMap<String, PathBuf>,
}

impl Contents {
    /// Begins with the model description at `description`, after reading it.
    ///
    /// # Errors
    /// When it cannot be used, or belongs to another model than `identifier`.
    pub fn new(identifier: &str, description: &Path) -> Result<Self> {
        let text = fs::read(description).map_err(PackageError::io("read", description))?;
        let parsed = ModelDescription::parse(&text, &description.display().to_string())?;
        let found = parsed.co_simulation.model_identifier;
        if found != identifier {
            let (path, allowed) = (description.to_path_buf(), identifier.to_owned());
            return Err(PackageError::Identifier { path, found, allowed });
        }
        let files = BTreeMap::from([("modelDescription.xml".to_owned(), description.to_path_buf())]);
        Ok(Self { identifier: identifier.to_owned(), files })
    }

    /// Adds the library of a platform, under the name that FMI wants.
    pub fn add_library(&mut self, platform: Platform, library: &Path) {
        self.files.insert(platform.entry(&self.identifier), library.to_path_buf());
    }

    /// Adds a file under a name with forward slashes.
    pub fn add_file(&mut self, name: &str, file: &Path) {
        self.files.insert(name.to_owned(), file.to_path_buf());
    }

    /// Adds the files of a folder and its folders under `prefix`. A folder that does not exist counts as empty.
    ///
    /// # Errors
    /// When the folder cannot be read.
    pub fn add_folder(&mut self, prefix: &str, folder: &Path) -> Result<()> {
        if !folder.is_dir() {
            return Ok(());
        }
        for entry in fs::read_dir(folder).map_err(PackageError::io("read", folder))? {
            let path = entry.map_err(PackageError::io("read", folder))?.path();
            let Some(name) = path.file_name() else { continue };
            let name = format!("{prefix}/{}", name.to_string_lossy());
            if path.is_dir() {
                self.add_folder(&name, &path)?;
            } else {
                self.files.insert(name, path);
            }
        }
        Ok(())
    }

    /// Adds `LICENSE*` of the source tree, where FMI 2.0.4 wants licenses.
    pub(super) fn add_licenses(&mut self, workspace: &Path) -> Result<()> {
        for entry in fs::read_dir(workspace).map_err(PackageError::io("read", workspace))? {
            let path = entry.map_err(PackageError::io("read", workspace))?.path();
            let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
            if name.starts_with("LICENSE") && path.is_file() {
                self.files.insert(format!("documentation/licenses/{name}"), path);
            }
        }
        Ok(())
    }

    /// Names in the archive, in order.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.files.keys().map(String::as_str)
    }

    /// Writes the archive beside its place and moves it there, so that nobody ever sees half of it.
    ///
    /// # Errors
    /// When a file cannot be read or the archive not written.
    pub fn write(&self, archive: &Path) -> Result<()> {
        let folder = archive.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
        fs::create_dir_all(folder).map_err(PackageError::io("create", folder))?;
        let mut temporary = new_file(folder).map_err(PackageError::io("write into", folder))?;
        self.write_to(temporary.as_file_mut(), archive)?;
        temporary.persist(archive).map_err(|error| PackageError::io("write", archive)(error.error))?;
        Ok(())
    }

    fn write_to(&self, file: &mut File, archive: &Path) -> Result<()> {
        let failed = |cause| PackageError::Zip { path: archive.to_path_buf(), cause };
        let mut writer = ZipWriter::new(file);
        for (name, path) in &self.files {
            writer.start_file(name.as_str(), options(name)).map_err(failed)?;
            let mut input = File::open(path).map_err(PackageError::io("read", path))?;
            io::copy(&mut input, &mut writer).map_err(PackageError::io("pack", path))?;
        }
        writer.finish().map_err(failed)?;
        Ok(())
    }
}

/// The same on every machine and day.
fn options(name: &str) -> SimpleFileOptions {
    SimpleFileOptions::default()
        .compression_method(CompressionMethod::Deflated)
        .compression_level(Some(6))
        .last_modified_time(DateTime::default())
        .system(System::Unix)
        .unix_permissions(if name.starts_with("binaries/") { 0o755 } else { 0o644 })
}

/// A temporary file with the permissions of any new file, not the private ones that are usual for temporary files.
fn new_file(folder: &Path) -> io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".videg-").suffix(".fmu.part");
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder.tempfile_in(folder)
}
