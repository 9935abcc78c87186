//! A loaded FMU, as its instances share it.

use std::ffi::CString;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};

use libloading::Library;

use super::description::ModelDescription;
use super::error::{FmiError, Result};
use super::isolated::Pool;
use super::library::Functions;
use videg_system::temporary::TemporaryFolder;

/// What the instances share.
pub(super) struct Loaded {
    pub path: PathBuf,
    pub description: ModelDescription,
    pub guid: CString,
    pub resources: CString,
    /// Some instance returned Fatal: no function of the library may be called any more.
    pub fatal: AtomicBool,
    // In the order of dropping: the library, or what has loaded it, goes before the folder that holds it.
    pub code: Code,
    #[allow(dead_code, reason = "kept until it is dropped")]
    pub folder: Option<TemporaryFolder>,
}

/// Where the library of an FMU is loaded.
pub(super) enum Code {
    /// In this process; no library where the functions are part of this program.
    Here { functions: Box<Functions>, library: Option<Library> },
    /// In others.
    Isolated(Box<Pool>),
}

impl Loaded {
    pub fn is_dead(&self) -> bool {
        self.fatal.load(Ordering::Relaxed)
    }

    pub fn kill(&self) {
        self.fatal.store(true, Ordering::Relaxed);
    }
}

impl Drop for Loaded {
    fn drop(&mut self) {
        if let Code::Here { library, .. } = &mut self.code
            && *self.fatal.get_mut()
        {
            // Instances that were never freed may still run code of the library: it stays.
            std::mem::forget(library.take());
        }
    }
}

/// Turns a text into a C string.
pub(super) fn c_string(what: &'static str, text: &str) -> Result<CString> {
    let usable = CString::new(text).ok().filter(|text| !text.is_empty());
    usable.ok_or_else(|| FmiError::Text { what, text: text.to_owned() })
}
