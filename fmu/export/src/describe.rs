//! The function with which a packager asks a library for its model descriptions. It exists with the feature `model-description` only.
#![allow(clippy::missing_safety_doc)] // The contract is that of `fmu_abi::describe::Describe`.

use core::ffi::{c_char, c_int, c_void};
use std::ffi::CString;
use std::panic::catch_unwind;
use std::path::{Path, PathBuf};

use fmu_abi::describe::{ERROR, Take};

use crate::ffi::text;
use crate::model_description::{model_description, terminals_and_icons};
use crate::panics::panic_message;
use crate::slave::Slave;
use crate::standard::Standard;

/// `fmu_export_describe_1`
pub unsafe fn fmu_export_describe_1<S: Slave>(resources: *const c_char, icon: c_int, take: Take, context: *mut c_void) {
    // SAFETY: by contract it is NULL or zero-terminated.
    let resources = unsafe { text(resources) }.ok().map(PathBuf::from);
    let described = catch_unwind(|| texts::<S>(resources.as_deref(), icon != 0));
    let give = |name: &core::ffi::CStr, text: String| {
        // An error text may hold a zero.
        let text = CString::new(text.replace('\0', " ")).unwrap_or_default();
        // SAFETY: by contract `take` takes two texts and its context.
        unsafe { take(context, name.as_ptr(), text.as_ptr()) };
    };
    match described {
        Ok(Ok(texts)) => texts.into_iter().for_each(|(name, text)| give(name, text)),
        Ok(Err(reason)) => give(ERROR, reason),
        Err(payload) => give(ERROR, format!("the model panicked: {}", panic_message(payload))),
    }
}

/// Names and texts.
fn texts<S: Slave>(resources: Option<&Path>, icon: bool) -> Result<Vec<(&'static core::ffi::CStr, String)>, String> {
    S::load_variables(resources).map_err(|error| error.to_string())?;
    let of = |standard| model_description::<S>(standard).map_err(|error| error.to_string());
    let mut texts =
        vec![(c"fmi2/modelDescription.xml", of(Standard::Fmi2)?), (c"fmi3/modelDescription.xml", of(Standard::Fmi3)?)];
    if icon || !S::INFO.terminals.is_empty() {
        let terminals = terminals_and_icons::<S>(icon).map_err(|error| error.to_string())?;
        texts.push((c"fmi3/terminalsAndIcons/terminalsAndIcons.xml", terminals));
    }
    Ok(texts)
}
