//! The entries of an archive. Equal entries give equal bytes.

use std::collections::BTreeMap;
use std::io::{Cursor, Read as _, Write as _};
use std::path::Path;

use zip::result::ZipError;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, System, ZipArchive, ZipWriter};

use super::error::{PackageError, Result};
use super::shared_file::write_shared;

/// The entries of an archive: bytes by sorted names with forward slashes.
#[derive(Debug, Default)]
pub struct Entries(BTreeMap<String, Vec<u8>>);

impl Entries {
    /// Reads an archive that this program wrote. Foreign archives need bounds, see [`fmu_import::Archive`].
    ///
    /// # Errors
    /// When it is broken.
    pub fn read(archive: &[u8]) -> std::result::Result<Self, ZipError> {
        let mut zip = ZipArchive::new(Cursor::new(archive))?;
        let mut entries = Self::default();
        for index in 0..zip.len() {
            let mut entry = zip.by_index(index)?;
            let name = entry.name()?.into_owned();
            let mut bytes = Vec::new();
            entry.read_to_end(&mut bytes)?;
            entries.add(&name, bytes);
        }
        Ok(entries)
    }

    /// The bytes of an entry.
    pub fn bytes(&self, name: &str) -> Option<&[u8]> {
        self.0.get(name).map(Vec::as_slice)
    }

    /// Adds or replaces an entry.
    pub fn add(&mut self, name: &str, bytes: impl Into<Vec<u8>>) {
        self.0.insert(name.to_owned(), bytes.into());
    }

    /// Adds an entry unless there is one of this name, in whatever case.
    pub fn add_new(&mut self, name: &str, bytes: impl Into<Vec<u8>>) {
        if self.names().all(|other| other.to_lowercase() != name.to_lowercase()) {
            self.add(name, bytes);
        }
    }

    /// The same with the bytes of a file.
    ///
    /// # Errors
    /// When it cannot be read.
    pub fn add_file(&mut self, name: &str, file: &Path) -> Result<()> {
        self.add(name, std::fs::read(file).map_err(PackageError::io("read", file))?);
        Ok(())
    }

    /// Names in the archive, in order.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.0.keys().map(String::as_str)
    }

    /// Writes the archive, atomically.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn write(&self, archive: &Path) -> Result<()> {
        write_shared(archive, &self.packed(archive)?)
    }

    /// The bytes of the archive; errors name it.
    ///
    /// # Errors
    /// When two names are one on some system, or the entries cannot be packed.
    pub fn packed(&self, archive: &Path) -> Result<Vec<u8>> {
        let names = fmu_import::check_names(self.names());
        names.map_err(|reason| PackageError::Names { archive: archive.to_owned(), reason })?;
        let packed = || {
            let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
            for (name, bytes) in &self.0 {
                writer.start_file(name.as_str(), options(name))?;
                writer.write_all(bytes)?;
            }
            Ok(writer.finish()?.into_inner())
        };
        packed().map_err(|cause: ZipError| PackageError::io("write", archive)(cause.into()))
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
