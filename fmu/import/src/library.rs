//! The shared library of an FMU and the functions it exports.

use std::ffi::{CStr, c_char};
use std::path::Path;

use fmu_abi as abi;
use libloading::Library;

use super::error::{FmiError, Result};

/// Name of this machine's folder in `binaries/`.
pub const HOST_PLATFORM: &str = if cfg!(windows) {
    if cfg!(target_pointer_width = "64") { "win64" } else { "win32" }
} else if cfg!(target_vendor = "apple") {
    "darwin64"
} else if cfg!(target_pointer_width = "64") {
    "linux64"
} else {
    "linux32"
};

/// Extension of shared libraries on this machine.
pub const LIBRARY_EXTENSION: &str = library_extension(HOST_PLATFORM);

/// Extension of shared libraries on a platform, as `binaries/` names it: `so`, unless it is Windows or macOS.
pub const fn library_extension(platform: &str) -> &'static str {
    match platform.as_bytes() {
        [b'w', b'i', b'n', ..] => "dll",
        [b'd', b'a', b'r', b'w', b'i', b'n', ..] => "dylib",
        _ => "so",
    }
}

/// Path of the library inside an FMU, with forward slashes.
pub(super) fn entry_name(platform: &str, model_identifier: &str) -> String {
    format!("binaries/{platform}/{model_identifier}.{}", library_extension(platform))
}

macro_rules! functions {
    (; create { $($create:tt)* } other { $($other:tt)* } common { $($common:tt)* } exchange $exchange:tt) => {
        functions! { $($other)* $($create)* $($common)* }
    };
    ($($name:ident $signature:ident $arguments:tt $(-> $ret:ty)?;)*) => {
        /// All functions of the co-simulation interface.
        #[derive(Clone, Copy)]
        #[allow(dead_code)] // some serve asynchronous steps only, but every FMU must export them
        #[allow(non_snake_case)] // names of the standard
        pub(super) struct Functions { $(pub(super) $name: abi::$signature),* }

        impl Functions {
            /// Finds every function in `library`, which lies at `path`.
            ///
            /// # Safety
            /// The library's functions of these names have the signatures of FMI 2.0.
            unsafe fn resolve(library: &Library, path: &Path) -> Result<Self> {
                let missing = |symbol| move |_| FmiError::MissingSymbol { path: path.to_path_buf(), symbol };
                Ok(Self {$(
                    // SAFETY: the caller vouches for the signatures.
                    $name: *unsafe { library.get::<abi::$signature>(stringify!($name)) }
                        .map_err(missing(stringify!($name)))?,
                )*})
            }
        }

        /// The table of those functions which go by the names of its fields where this stands.
        #[cfg(test)]
        macro_rules! functions_in_scope {
            () => {
                $crate::library::Functions { $($name),* }
            };
        }
    };
}
abi::functions!([functions]);

macro_rules! names {
    (;
        create { $($create:ident $create_type:ident $parts:tt -> $component:ty;)* }
        other { $($other:ident $other_type:ident $others:tt $(-> $ret:ty)?;)* }
        status { $($name:ident $signature:ident $arguments:tt;)* }
    ) => {
        &[$(stringify!($create),)* $(stringify!($other),)* $(stringify!($name),)*]
    };
}

/// Names of all functions of FMI 3.0, which each of its libraries must have since 3.0.1.
pub const FUNCTIONS_3: &[&str] = fmu_abi::functions3!([names]);

#[cfg(test)]
#[allow(clippy::single_component_path_imports, reason = "makes the macro visible to other modules")]
pub(crate) use functions_in_scope;

/// Loads the library at `file` and checks that it speaks FMI 2.0 with the default C types. Errors call it `path`.
///
/// This runs the library's initializers: from here on the FMU is trusted like any native code.
pub(super) fn load(file: &Path, path: &Path) -> Result<(Library, Functions)> {
    let library = open(file).map_err(|cause| FmiError::Load { path: path.to_path_buf(), cause })?;
    // SAFETY: an FMI 2.0 library exports these names with these signatures.
    let functions = unsafe { Functions::resolve(&library, path)? };
    check(&functions, path)?;
    Ok((library, functions))
}

/// Resolves everything at once: a symbol that is missing shows here, not in the middle of a simulation.
#[cfg(unix)]
fn open(path: &Path) -> std::result::Result<Library, libloading::Error> {
    use libloading::os::unix::{Library, RTLD_LOCAL, RTLD_NOW};
    // SAFETY: loading runs foreign code, which is what the caller asked for.
    unsafe { Library::open(Some(path), RTLD_NOW | RTLD_LOCAL) }.map(Into::into)
}

/// Looks for the library's own dependencies beside it.
#[cfg(windows)]
fn open(path: &Path) -> std::result::Result<Library, libloading::Error> {
    use libloading::os::windows::{LOAD_WITH_ALTERED_SEARCH_PATH, Library};
    // SAFETY: loading runs foreign code, which is what the caller asked for.
    unsafe { Library::load_with_flags(path, LOAD_WITH_ALTERED_SEARCH_PATH) }.map(Into::into)
}

fn check(functions: &Functions, path: &Path) -> Result<()> {
    // SAFETY: the functions take nothing and return static strings.
    let (version, types) =
        unsafe { (static_text((functions.fmi2GetVersion)()), static_text((functions.fmi2GetTypesPlatform)())) };
    let (function, found, allowed) = if !version.starts_with("2.0") {
        ("fmi2GetVersion", version, "2.0")
    } else if types != "default" {
        ("fmi2GetTypesPlatform", types, "default")
    } else {
        return Ok(());
    };
    Err(FmiError::WrongInterface { path: path.to_owned(), function, found, allowed })
}

/// # Safety
/// `pointer` is NULL or points to a zero-terminated string.
unsafe fn static_text(pointer: *const c_char) -> String {
    if pointer.is_null() {
        return String::new();
    }
    // SAFETY: as the caller promises.
    unsafe { CStr::from_ptr(pointer) }.to_string_lossy().into_owned()
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::{entry_name, load};

    #[test]
    fn libraries_are_named_after_platform_and_model() {
        assert_eq!(entry_name("linux64", "Toy"), "binaries/linux64/Toy.so");
        assert_eq!(entry_name("win64", "Toy"), "binaries/win64/Toy.dll");
        assert_eq!(entry_name("darwin64", "Toy"), "binaries/darwin64/Toy.dylib");
    }

    #[test]
    fn a_missing_library_is_an_error_that_names_it() {
        let error = load(Path::new("/nowhere/Toy.so"), Path::new("x.fmu/Toy.so")).err().unwrap().to_string();
        assert!(error.starts_with("cannot load x.fmu/Toy.so: "), "{error}");
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn a_library_of_another_kind_lacks_a_symbol() {
        let Ok(maps) = std::fs::read_to_string("/proc/self/maps") else { return };
        let libc =
            maps.lines().filter_map(|line| line.split_whitespace().nth(5)).find(|path| path.contains("/libc.so"));
        let Some(libc) = libc else { return };
        let error = load(Path::new(libc), Path::new(libc)).err().unwrap().to_string();
        assert!(error.contains("does not export fmi2GetTypesPlatform"), "{error}");
    }
}
