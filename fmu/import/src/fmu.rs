//! A loaded FMU, from which instances are made.

use std::ffi::CString;
use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use libloading::Library;
use percent_encoding::{AsciiSet, NON_ALPHANUMERIC, percent_encode};

use super::archive::{Archive, Limits};
use super::description::ModelDescription;
use super::error::{FmiError, Result};
use super::instance::Instance;
use super::isolated::{self, Isolation, Pool};
use super::library::{self, Functions, HOST_PLATFORM};
use super::logging::Logging;
use videg_system::temporary::TemporaryFolder;

/// A co-simulation FMU, unpacked and loaded. Clones share it; it is unloaded and its folder removed with the last
/// clone and the last instance.
#[derive(Clone)]
pub struct Fmu {
    loaded: Arc<Loaded>,
}

/// What the instances share.
pub(super) struct Loaded {
    path: PathBuf,
    pub(super) description: ModelDescription,
    pub(super) functions: Functions,
    guid: CString,
    resources: CString,
    /// Some instance returned Fatal: no function of the library may be called any more.
    fatal: AtomicBool,
    // In the order of dropping: the library, or what has loaded it, goes before the folder that holds it.
    code: Code,
    _folder: Option<TemporaryFolder>,
}

/// Where the library of an FMU is loaded.
pub(super) enum Code {
    /// In this process.
    Here(#[allow(dead_code, reason = "kept until it is dropped")] Library),
    /// In others.
    Isolated(Box<Pool>),
    /// Nowhere: it is part of this program, or must not be touched any more.
    None,
}

impl Fmu {
    /// Opens an FMU with the default limits: reads it, unpacks it into a temporary folder and loads its library.
    /// Loading runs code of the FMU.
    ///
    /// # Errors
    /// When the archive is broken or unsafe, the description unusable, or the library missing or of another interface.
    pub fn open(path: impl AsRef<Path>) -> Result<Self> {
        Self::open_with(path, Limits::default())
    }

    /// As [`Fmu::open`], with other limits.
    ///
    /// # Errors
    /// As [`Fmu::open`].
    pub fn open_with(path: impl AsRef<Path>, limits: Limits) -> Result<Self> {
        Self::load(path.as_ref(), limits, |_, _| None)
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
        Self::load(path.as_ref(), Limits::default(), decide)
    }

    fn load(path: &Path, limits: Limits, decide: impl FnOnce(&str, &Path) -> Option<Isolation>) -> Result<Self> {
        let mut archive = Archive::open_with(path, limits)?;
        let description = archive.description()?;
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
        let (code, functions) = if let Some(isolation) = decide(identifier, &library) {
            let pool = Pool::new(isolation, path, folder.path(), &entry)?;
            (Code::Isolated(Box::new(pool)), isolated::FUNCTIONS)
        } else {
            let (library, functions) = library::load(&library, &path.join(&entry))?;
            (Code::Here(library), functions)
        };
        let (path, fatal) = (path.into(), AtomicBool::new(false));
        let loaded = Loaded { path, description, functions, guid, resources, fatal, code, _folder: Some(folder) };
        Ok(Self { loaded: Arc::new(loaded) })
    }

    /// An FMU whose functions live in this program.
    #[cfg(test)]
    pub(super) fn of(functions: &Functions, description: ModelDescription) -> Self {
        let loaded = Loaded {
            path: "memory".into(),
            guid: c_string("guid", &description.guid).unwrap(),
            resources: c"file:///nowhere".into(),
            description,
            functions: *functions,
            fatal: AtomicBool::new(false),
            code: Code::None,
            _folder: None,
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
        self.loaded.pool().is_some()
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

impl Loaded {
    pub(super) fn guid(&self) -> &CString {
        &self.guid
    }

    pub(super) fn resources(&self) -> &CString {
        &self.resources
    }

    /// What runs the instances in processes of their own, if they do not run in this one.
    pub(super) fn pool(&self) -> Option<&Pool> {
        if let Code::Isolated(pool) = &self.code { Some(pool) } else { None }
    }

    pub(super) fn is_dead(&self) -> bool {
        self.fatal.load(Ordering::Relaxed)
    }

    pub(super) fn kill(&self) {
        self.fatal.store(true, Ordering::Relaxed);
    }
}

impl Drop for Loaded {
    fn drop(&mut self) {
        if self.is_dead() {
            // Instances that were never freed may still run code of the library: it stays.
            std::mem::forget(std::mem::replace(&mut self.code, Code::None));
        }
    }
}

/// Turns a text into a C string.
pub(super) fn c_string(what: &'static str, text: &str) -> Result<CString> {
    let usable = CString::new(text).ok().filter(|text| !text.is_empty());
    usable.ok_or_else(|| FmiError::Text { what, text: text.to_owned() })
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
