//! What a packager asks a library that was built for it: the model descriptions. No function of FMI; libraries in FMUs do not have it.

use core::ffi::{c_char, c_int, c_void};

/// Name of the function, a [`Describe`], with the version of its signature.
pub const SYMBOL: &core::ffi::CStr = c"fmu_export_describe_1";

/// Gives `take` each text that describes the FMU: under `fmi2/` and `fmi3/`, and the name that it has in an archive of that version,
/// or the reason why there are none, under [`ERROR`]. `resources` is the folder `resources` of the sources, or NULL; with `icon`,
/// the archive has a picture.
pub type Describe = unsafe extern "C" fn(resources: *const c_char, icon: c_int, take: Take, context: *mut c_void);

/// Takes name and text, zero-terminated UTF-8 that is valid during the call, and the context of [`Describe`].
pub type Take = unsafe extern "C" fn(context: *mut c_void, name: *const c_char, text: *const c_char);

/// The name under which the reason is given.
pub const ERROR: &core::ffi::CStr = c"error";
