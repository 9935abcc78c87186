//! The .fmu file as an untrusted zip archive: bounds, names that stay inside, and nothing believed that can be measured.

use std::fs::{self, File};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

use zip::ZipArchive;
use zip::read::ZipFile;
use zip::result::ZipError;

use super::description::ModelDescription;
use super::error::{FmiError, Result};
use videg_system::temporary::TemporaryFolder;

mod directory;
mod names;

use names::Names;
pub use names::{check_name, check_names};

const DESCRIPTION: &str = "modelDescription.xml";
/// An entry may always unpack to this size, however well it is compressed.
const FREE_BYTES: u64 = 1 << 20;

/// Bounds on an archive. The default leaves room for large industrial FMUs and stops bombs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Limits {
    /// Size of the file, bytes.
    pub archive_bytes: u64,
    /// Number of entries, and of files and folders that they come to.
    pub entries: usize,
    /// Size of all entries unpacked, bytes.
    pub unpacked_bytes: u64,
    /// Unpacked over packed size of an entry, once it is larger than 1 MiB.
    pub ratio: u64,
    /// Size of the model description, bytes.
    pub description_bytes: u64,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            archive_bytes: 512 << 20,
            entries: 10_000,
            unpacked_bytes: 1 << 30,
            ratio: 100,
            description_bytes: ModelDescription::MAX_BYTES,
        }
    }
}

impl Limits {
    /// Largest size to which an entry of `packed` bytes may unpack.
    fn most_of(&self, packed: u64) -> u64 {
        packed.saturating_mul(self.ratio).max(FREE_BYTES)
    }
}

/// An opened .fmu file. Nothing is unpacked until [`Archive::unpack`].
#[derive(Debug)]
pub struct Archive {
    path: PathBuf,
    zip: ZipArchive<File>,
    limits: Limits,
    names: Vec<String>,
}

impl Archive {
    /// Opens an archive with the default limits and checks the names of its entries.
    ///
    /// # Errors
    /// When the file cannot be read, is no zip archive, passes a bound, or holds an unsafe entry.
    pub fn open(path: impl AsRef<Path>) -> Result<Self> {
        Self::open_with(path, Limits::default())
    }

    /// As [`Archive::open`], with other limits.
    ///
    /// # Errors
    /// As [`Archive::open`].
    pub fn open_with(path: impl AsRef<Path>, limits: Limits) -> Result<Self> {
        let path = path.as_ref();
        let refuse = |reason| FmiError::Refused { path: path.into(), reason };
        let mut file = videg_input::open_regular(path).map_err(FmiError::io("open", path))?;
        let found = file.metadata().map_err(FmiError::io("read", path))?;
        if found.len() > limits.archive_bytes {
            return Err(refuse(format!("the archive has {} bytes, allowed are {}", found.len(), limits.archive_bytes)));
        }
        if directory::is_zip64(&mut file).map_err(FmiError::io("read", path))? {
            return Err(refuse(
                "the archive has a zip64 directory, which only archives beyond 65535 entries or 4 GiB need".to_owned(),
            ));
        }
        let again = file.try_clone().map_err(FmiError::io("read", path))?;
        let broken = |cause| FmiError::NotAnArchive { path: path.into(), cause };
        let mut zip = ZipArchive::new(file).map_err(broken)?;
        if zip.len() > limits.entries {
            return Err(refuse(format!("the archive has {} entries, allowed are {}", zip.len(), limits.entries)));
        }
        let listed = directory::count(&again, zip.central_directory_start(), limits.entries + 1);
        let listed = listed.map_err(FmiError::io("read", path))?;
        if listed != zip.len() {
            return Err(refuse(format!("the archive lists {listed} entries with {} different names", zip.len())));
        }
        if zip.has_overlapping_entries().map_err(broken)? {
            return Err(refuse("the entries overlap: some bytes of the archive belong to two of them".to_owned()));
        }
        let mut archive = Self { path: path.into(), zip, limits, names: Vec::new() };
        archive.vet_entries()?;
        Ok(archive)
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Names of all entries, folders with a slash at the end.
    pub fn entries(&self) -> &[String] {
        &self.names
    }

    /// Whether there is an entry of this name.
    pub fn contains(&self, name: &str) -> bool {
        self.names.iter().any(|entry| entry == name)
    }

    /// Names of the folders in `binaries/`, sorted.
    pub fn platforms(&self) -> Vec<String> {
        let inside = self.names.iter().filter_map(|name| name.strip_prefix("binaries/"));
        let mut platforms: Vec<_> =
            inside.filter_map(|rest| rest.split_once('/')).map(|(first, _)| first.into()).collect();
        platforms.sort();
        platforms.dedup();
        platforms
    }

    /// Reads the model description.
    ///
    /// # Errors
    /// When it is missing, too large, or not usable.
    pub fn description(&mut self) -> Result<ModelDescription> {
        let path = self.path.clone();
        let Some(index) = self.zip.index_for_name(DESCRIPTION) else {
            return Err(FmiError::MissingEntry { path, entry: DESCRIPTION });
        };
        let origin = format!("{}: {DESCRIPTION}", path.display());
        let allowed = self.limits.description_bytes.min(ModelDescription::MAX_BYTES);
        let entry = self.zip.by_index(index).map_err(|cause| FmiError::NotAnArchive { path: path.clone(), cause })?;
        let mut text = Vec::new();
        let packed = entry.compressed_size();
        let allowed_by_ratio = self.limits.most_of(packed);
        // One byte more than allowed tells whether there is more.
        entry
            .take(allowed.min(allowed_by_ratio) + 1)
            .read_to_end(&mut text)
            .map_err(FmiError::io("unpack modelDescription.xml of", &path))?;
        if text.len() as u64 > allowed_by_ratio {
            let reason = inflates(DESCRIPTION, packed, &self.limits);
            return Err(FmiError::Refused { path, reason });
        }
        if text.len() as u64 > allowed {
            let cause = ModelDescription::too_large(text.len() as u64, allowed);
            return Err(FmiError::Description { origin, cause });
        }
        ModelDescription::parse(&text, &origin)
    }

    /// Unpacks everything into a new temporary folder, which is removed with the returned value. Nobody but the user may look
    /// into it.
    ///
    /// # Errors
    /// When a bound is passed, an entry is broken, or the file system refuses.
    pub fn unpack(&mut self) -> Result<TemporaryFolder> {
        let broken = |path: &Path| {
            let path = path.to_path_buf();
            move |cause| FmiError::NotAnArchive { path, cause }
        };
        let temporary = std::env::temp_dir();
        let folder = TemporaryFolder::new("videg-fmu-").map_err(FmiError::io("make a folder in", &temporary))?;
        let mut left = self.limits.unpacked_bytes;
        for index in 0..self.zip.len() {
            let mut entry = self.zip.by_index(index).map_err(broken(&self.path))?;
            let name = entry.name().map_err(broken(&self.path))?.into_owned();
            let target = folder.path().join(&name);
            if entry.is_dir() {
                fs::create_dir_all(&target).map_err(FmiError::io("create", &target))?;
                continue;
            }
            if let Some(parent) = target.parent() {
                fs::create_dir_all(parent).map_err(FmiError::io("create", parent))?;
            }
            // An entry never replaces another, whatever the file system makes of their names.
            let mut file = create(&target).map_err(FmiError::io("create", &target))?;
            unpack_entry(&mut entry, &name, &mut file, &mut left, &self.limits, &self.path)?;
        }
        Ok(folder)
    }

    fn vet_entries(&mut self) -> Result<()> {
        let mut names = Names::new(self.limits.entries);
        for index in 0..self.zip.len() {
            let path = || self.path.clone();
            let broken = |cause| FmiError::NotAnArchive { path: path(), cause };
            let entry = self.zip.by_index_data(index).map_err(broken)?;
            let name = entry.name().map_err(broken)?.into_owned();
            names.add(&name).map_err(|reason| FmiError::Refused { path: path(), reason })?;
            if !is_plain(entry.unix_mode()) {
                let reason = format!("entry \"{}\" is a symbolic link or a special file", name.escape_debug());
                return Err(FmiError::Refused { path: path(), reason });
            }
            self.names.push(name);
        }
        Ok(())
    }
}

fn inflates(entry: &str, packed: u64, limits: &Limits) -> String {
    format!("entry \"{}\" inflates its {packed} bytes more than {} times", entry.escape_debug(), limits.ratio)
}

/// A new file, which the user alone may read.
fn create(path: &Path) -> io::Result<File> {
    let mut options = File::options();
    options.write(true).create_new(true);
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
    options.open(path)
}

/// Copies one entry, counting what really comes out.
fn unpack_entry(
    entry: &mut ZipFile<'_, File>,
    name: &str,
    file: &mut File,
    left: &mut u64,
    limits: &Limits,
    path: &Path,
) -> Result<()> {
    let refuse = |reason| Err(FmiError::Refused { path: path.into(), reason });
    let packed = entry.compressed_size();
    let allowed_by_ratio = limits.most_of(packed);
    let mut written = 0_u64;
    let mut buffer = [0_u8; 1 << 14];
    loop {
        let count = match entry.read(&mut buffer) {
            Ok(0) => return Ok(()),
            Ok(count) => count,
            Err(cause) => return Err(FmiError::NotAnArchive { path: path.into(), cause: ZipError::Io(cause) }),
        };
        written += count as u64;
        if written > allowed_by_ratio {
            return refuse(inflates(name, packed, limits));
        }
        let Some(rest) = left.checked_sub(count as u64) else {
            return refuse(format!(
                "unpacking passed {} bytes at entry \"{}\"",
                limits.unpacked_bytes,
                name.escape_debug()
            ));
        };
        *left = rest;
        file.write_all(buffer.get(..count).unwrap_or(&buffer)).map_err(FmiError::io("unpack", path))?;
    }
}

/// Whether a Unix mode says a regular file or a folder, or nothing.
fn is_plain(mode: Option<u32>) -> bool {
    const TYPE: u32 = 0o170_000;
    const FOLDER: u32 = 0o040_000;
    const REGULAR: u32 = 0o100_000;
    mode.is_none_or(|mode| matches!(mode & TYPE, 0 | FOLDER | REGULAR))
}

#[cfg(test)]
mod tests;
