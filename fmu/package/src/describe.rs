//! Asks a library for its model descriptions: see [`fmu_abi::describe`].

use core::ffi::{CStr, c_char, c_int, c_void};
use std::ffi::CString;
use std::path::Path;

use fmu_abi::describe::{Describe, ERROR, SYMBOL};
use libloading::Library;

use super::error::{PackageError, Result};
use super::version::FmiVersion;

/// What a library says about its FMU: names of entries and their texts.
pub(crate) struct Descriptions(Vec<(String, String)>);

impl Descriptions {
    /// Asks `library`, whose code is run. The FMU of `package` will have the folder `resources`, and with `icon` a picture.
    ///
    /// # Errors
    /// When the library is none, or the model has no description.
    pub(crate) fn of(package: &str, library: &Path, resources: Option<&Path>, icon: bool) -> Result<Self> {
        let failed = |cause| PackageError::NoDescribe { library: library.to_owned(), cause };
        let undescribed = |reason: String| PackageError::Undescribed { package: package.to_owned(), reason };
        let resources = match resources.map(|folder| folder.to_str().map(CString::new)) {
            None => None,
            Some(Some(Ok(folder))) => Some(folder),
            Some(_) => return Err(undescribed("the name of the folder of its resources is not UTF-8".to_owned())),
        };
        let mut texts: Vec<(String, String)> = Vec::new();
        // A copy, since one that stays loaded would stand for the next build under the same name.
        let copied = tempfile::tempdir().and_then(|folder| {
            let copy = folder.path().join(library.file_name().unwrap_or_default());
            std::fs::copy(library, &copy).map(|_| (folder, copy))
        });
        let (_folder, copy) = copied.map_err(PackageError::io("copy", library))?;
        // SAFETY: it was built for this; what its code does at loading is as trusted as its build script.
        let library = unsafe { Library::new(&copy) }.map_err(failed)?;
        // SAFETY: nothing else has this name.
        let describe = unsafe { library.get::<Describe>(SYMBOL.to_bytes()) }.map_err(failed)?;
        let resources = resources.as_ref().map_or(core::ptr::null(), |folder| folder.as_ptr());
        // SAFETY: the contract of the function: `take` gets `texts`, which nobody else uses meanwhile.
        unsafe { describe(resources, c_int::from(icon), take, (&raw mut texts).cast()) };
        let error = texts.iter().find(|(name, _)| name.as_bytes() == ERROR.to_bytes());
        if let Some((_, reason)) = error {
            return Err(undescribed(reason.clone()));
        }
        Ok(Self(texts))
    }

    /// The texts for a version of FMI, by the names that they have in an archive.
    pub(crate) fn texts(&self, version: FmiVersion) -> impl Iterator<Item = (&str, &str)> {
        let folder = if version == FmiVersion::Fmi2 { "fmi2/" } else { "fmi3/" };
        self.0.iter().filter_map(move |(name, text)| Some((name.strip_prefix(folder)?, text.as_str())))
    }
}

/// Keeps a text.
unsafe extern "C" fn take(context: *mut c_void, name: *const c_char, text: *const c_char) {
    // SAFETY: the library calls it with its context and two texts, within the call of `describe`.
    let (texts, name, text) =
        unsafe { (&mut *context.cast::<Vec<(String, String)>>(), CStr::from_ptr(name), CStr::from_ptr(text)) };
    texts.push((name.to_string_lossy().into_owned(), text.to_string_lossy().into_owned()));
}
