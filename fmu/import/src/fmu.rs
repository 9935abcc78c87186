//! A loaded FMU, from which instances are made.

use std::fmt;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use percent_encoding::{AsciiSet, NON_ALPHANUMERIC, percent_encode};

use super::archive::Archive;
use super::description::ModelDescription;
use super::error::{FmiError, Result};
use super::instance::Instance;
use super::isolated::{Isolation, Pool};
use super::library::{self, HOST_PLATFORM};
use super::loaded::{Code, Loaded, c_string};
use super::logging::Logging;

/// A co-simulation FMU, unpacked and loaded. Clones share it; it is unloaded and its folder removed with the last
/// clone and the last instance.
#[derive(Clone)]
pub struct Fmu {
    loaded: Arc<Loaded>,
}

impl Fmu {
    /// Opens an FMU: reads it, unpacks it into a temporary folder and loads its library.
    /// Loading runs code of the FMU.
    ///
    /// # Errors
    /// When the archive is broken or unsafe, the description unusable, or the library missing or of another interface.
    pub fn open(path: impl AsRef<Path>) -> Result<Self> {
        Self::load(path.as_ref(), |_, _| None)
    }

    /// As [`Fmu::open`], but each instance runs in a process of its own.
    ///
    /// # Errors
    /// As [`Fmu::open`], and when the process cannot be started, or ends.
    pub fn open_isolated(path: impl AsRef<Path>, isolation: &Isolation) -> Result<Self> {
        Self::open_isolated_unless(path, isolation, |_, _| false)
    }

    /// As [`Fmu::open_isolated`], unless `is_trusted` says of model identifier and unpacked library that the library may be
    /// loaded into this process.
    ///
    /// # Errors
    /// As [`Fmu::open_isolated`].
    pub fn open_isolated_unless(
        path: impl AsRef<Path>,
        isolation: &Isolation,
        is_trusted: impl FnOnce(&str, &Path) -> bool,
    ) -> Result<Self> {
        let decide = |identifier: &str, library: &Path| (!is_trusted(identifier, library)).then(|| isolation.clone());
        Self::load(path.as_ref(), decide)
    }

    fn load(path: &Path, decide: impl FnOnce(&str, &Path) -> Option<Isolation>) -> Result<Self> {
        let mut archive = Archive::open(path)?;
        let description = archive.description()?;
        if description.is_fmi_3() {
            return Err(FmiError::Version { found: description.fmi_version });
        }
        let identifier = &description.co_simulation.model_identifier;
        let entry = library::entry_name(HOST_PLATFORM, identifier);
        if !archive.contains(&entry) {
            return Err(FmiError::NoBinary { path: path.into(), wanted: entry, found: archive.platforms() });
        }
        let folder = archive.unpack()?;
        let resources = folder.path().join("resources");
        std::fs::create_dir_all(&resources).map_err(FmiError::io("create", &resources))?;
        let (guid, resources) =
            (c_string("guid", &description.guid)?, c_string("resource location", &file_uri(&resources))?);
        let library = folder.path().join(&entry);
        let code = if let Some(isolation) = decide(identifier, &library) {
            Code::Isolated(Box::new(Pool::new(isolation, path, folder.path(), &entry)?))
        } else {
            let (library, functions) = library::load(&library, &path.join(&entry))?;
            Code::Here { functions: Box::new(functions), library: Some(library) }
        };
        let (path, fatal) = (path.into(), AtomicBool::new(false));
        let loaded = Loaded { path, description, guid, resources, fatal, code, folder: Some(folder) };
        Ok(Self { loaded: Arc::new(loaded) })
    }

    /// An FMU whose functions live in this program.
    #[cfg(test)]
    pub(super) fn of(functions: &library::Functions, description: ModelDescription) -> Self {
        let loaded = Loaded {
            path: "memory".into(),
            guid: c_string("guid", &description.guid).unwrap(),
            resources: c"file:///nowhere".into(),
            description,
            fatal: AtomicBool::new(false),
            code: Code::Here { functions: Box::new(*functions), library: None },
            folder: None,
        };
        Self { loaded: Arc::new(loaded) }
    }

    /// The model description.
    pub fn description(&self) -> &ModelDescription {
        &self.loaded.description
    }

    /// The archive that this was opened from.
    pub fn path(&self) -> &Path {
        &self.loaded.path
    }

    /// Whether its instances run in processes of their own.
    pub fn is_isolated(&self) -> bool {
        matches!(self.loaded.code, Code::Isolated(_))
    }

    /// Makes an instance. Instances are independent, and may live on different threads.
    ///
    /// # Errors
    /// When the name is empty or the FMU refuses; what it logged is part of the error.
    pub fn instantiate(&self, name: &str, logging: Logging) -> Result<Instance> {
        Instance::new(Arc::clone(&self.loaded), name, logging)
    }
}

impl fmt::Debug for Fmu {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.debug_struct("Fmu").field("path", &self.loaded.path).finish_non_exhaustive()
    }
}

/// `file:///folder/file`, percent-encoded.
fn file_uri(path: &Path) -> String {
    const KEPT: &AsciiSet =
        &NON_ALPHANUMERIC.remove(b'/').remove(b'-').remove(b'.').remove(b'_').remove(b'~').remove(b':');
    let bytes = path.as_os_str().as_encoded_bytes();
    if cfg!(windows) {
        let forward: Vec<u8> = bytes.iter().map(|&byte| if byte == b'\\' { b'/' } else { byte }).collect();
        format!("file:///{}", percent_encode(&forward, KEPT))
    } else {
        format!("file://{}", percent_encode(bytes, KEPT))
    }
}

#[cfg(test)]
mod tests {
    #[test]
    #[cfg(unix)]
    fn resource_locations_are_uris() {
        let uri = super::file_uri(std::path::Path::new("/tmp/a b%c/\u{e9}/resources"));
        assert_eq!(uri, "file:///tmp/a%20b%25c/%C3%A9/resources");
    }
}
