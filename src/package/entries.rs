//! The entries of an archive. Equal entries give equal bytes.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{self, Cursor, Read as _, Write as _};
use std::path::{Path, PathBuf};

use zip::result::ZipError;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, System, ZipArchive, ZipWriter};

use super::error::{PackageError, Result};
use super::shared_file::write_shared;

/// The entries of an archive: sorted names with forward slashes, each with a file or bytes.
#[derive(Debug, Clone, Default)]
pub struct Entries {
    files: BTreeMap<String, Source>,
}

/// Where the bytes of an entry come from.
#[derive(Debug, Clone)]
enum Source {
    File(PathBuf),
    Bytes(Vec<u8>),
}

impl Entries {
    /// Reads an archive that this program wrote. Foreign archives need bounds, see [`fmu_import::Archive`].
    ///
    /// # Errors
    /// When it is broken.
    pub(super) fn read(archive: &[u8]) -> std::result::Result<Self, ZipError> {
        let mut zip = ZipArchive::new(Cursor::new(archive))?;
        let mut entries = Self::default();
        for index in 0..zip.len() {
            let mut entry = zip.by_index(index)?;
            let name = entry.name()?.into_owned();
            let mut bytes = Vec::new();
            entry.read_to_end(&mut bytes)?;
            entries.add_bytes(&name, bytes);
        }
        Ok(entries)
    }

    /// The bytes of an entry that holds bytes.
    pub(super) fn bytes(&self, name: &str) -> Option<&[u8]> {
        match self.files.get(name) {
            Some(Source::Bytes(bytes)) => Some(bytes),
            _ => None,
        }
    }

    /// Adds a file under a name with forward slashes.
    pub fn add_file(&mut self, name: &str, file: &Path) {
        self.files.insert(name.to_owned(), Source::File(file.to_path_buf()));
    }

    /// Adds bytes under a name with forward slashes.
    pub fn add_bytes(&mut self, name: &str, bytes: Vec<u8>) {
        self.files.insert(name.to_owned(), Source::Bytes(bytes));
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
                self.files.insert(name, Source::File(path));
            }
        }
        Ok(())
    }

    /// Names in the archive, in order.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.files.keys().map(String::as_str)
    }

    /// Writes the archive, atomically.
    ///
    /// # Errors
    /// When a file cannot be read or the archive not written.
    pub fn write(&self, archive: &Path) -> Result<()> {
        write_shared(archive, &self.packed(archive)?)
    }

    /// The bytes of the archive; errors name it.
    ///
    /// # Errors
    /// When a file cannot be read.
    pub(super) fn packed(&self, archive: &Path) -> Result<Vec<u8>> {
        let mut bytes = Cursor::new(Vec::new());
        self.write_to(&mut bytes, archive)?;
        Ok(bytes.into_inner())
    }

    fn write_to(&self, file: &mut Cursor<Vec<u8>>, archive: &Path) -> Result<()> {
        let failed = |cause| PackageError::Zip { path: archive.to_path_buf(), cause };
        let mut writer = ZipWriter::new(file);
        for (name, source) in &self.files {
            writer.start_file(name.as_str(), options(name)).map_err(failed)?;
            match source {
                Source::File(path) => {
                    let mut input = File::open(path).map_err(PackageError::io("read", path))?;
                    io::copy(&mut input, &mut writer).map_err(PackageError::io("pack", path))?;
                }
                Source::Bytes(bytes) => {
                    writer.write_all(bytes).map_err(PackageError::io("write", archive))?;
                }
            }
        }
        writer.finish().map_err(failed)?;
        Ok(())
    }
}

/// Attributes of an entry, which do not depend on machine or date.
fn options(name: &str) -> SimpleFileOptions {
    SimpleFileOptions::default()
        .compression_method(CompressionMethod::Deflated)
        .compression_level(Some(6))
        .last_modified_time(DateTime::default())
        .system(System::Unix)
        .unix_permissions(if name.starts_with("binaries/") { 0o755 } else { 0o644 })
}
