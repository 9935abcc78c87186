//! The shared library of ngspice and the functions that a transient analysis with external sources takes.

use std::error::Error as _;
use std::ffi::{CString, NulError, c_char, c_int, c_void};
use std::path::PathBuf;

use libloading::Library;
use thiserror::Error;

/// Environment variable that names the library where the system does not find it.
pub const LIBRARY_VARIABLE: &str = "VIDEG_NGSPICE_LIBRARY";

/// File names of the library.
const NAMES: &[&str] = if cfg!(windows) {
    &["ngspice.dll"]
} else if cfg!(target_vendor = "apple") {
    &["libngspice.0.dylib", "libngspice.dylib"]
} else {
    &["libngspice.so.0", "libngspice.so"]
};

/// Why the library cannot be used.
#[derive(Debug, Error)]
#[allow(missing_docs, reason = "the message of each variant names its fields")]
pub enum LibraryError {
    /// It is not there, or the system cannot load it.
    #[error(
        "cannot load the shared library of ngspice ({names}): {cause}; install it (Debian, Ubuntu: apt install \
         libngspice0) or name it in {LIBRARY_VARIABLE}"
    )]
    Missing { names: String, cause: String },
    /// It is another library.
    #[error("{path} is not the shared library of ngspice: it does not export {symbol}")]
    Symbol { path: String, symbol: &'static str },
    /// A text for ngspice has a zero byte.
    #[error("a line for ngspice: {0}")]
    ZeroByte(#[from] NulError),
}

/// One value of the data that ngspice sends at each accepted time point.
#[repr(C)]
pub struct VectorValue {
    pub name: *const c_char,
    pub real: f64,
    imaginary: f64,
    is_scale: bool,
    is_complex: bool,
}

/// All values at an accepted time point.
#[repr(C)]
pub struct VectorValues {
    pub count: c_int,
    index: c_int,
    pub values: *const *const VectorValue,
}

/// Text for the user.
pub type SendChar = unsafe extern "C" fn(*const c_char, c_int, *mut c_void) -> c_int;
/// ngspice wants the process to end: status, at once, because of `quit`.
pub type ControlledExit = unsafe extern "C" fn(c_int, bool, bool, c_int, *mut c_void) -> c_int;
/// A time point has been accepted.
pub type SendData = unsafe extern "C" fn(*const VectorValues, c_int, c_int, *mut c_void) -> c_int;
/// An analysis begins. Without such a callback ngspice does not prepare the data of [`SendData`] either.
pub type SendInitData = unsafe extern "C" fn(*const c_void, c_int, *mut c_void) -> c_int;
/// The value of an external voltage source at a time.
pub type GetVoltage = unsafe extern "C" fn(*mut f64, f64, *const c_char, c_int, *mut c_void) -> c_int;
/// Time, next step, last step, redo, instance, place of the call.
pub type GetSync = unsafe extern "C" fn(f64, *mut f64, f64, c_int, c_int, c_int, *mut c_void) -> c_int;

/// The functions that ngspice calls back.
#[derive(Clone, Copy)]
pub struct Callbacks {
    pub text: SendChar,
    pub exit: ControlledExit,
    pub begin: SendInitData,
    pub data: SendData,
    pub voltage: GetVoltage,
    pub sync: GetSync,
}

type Unused = Option<unsafe extern "C" fn()>;
type Init =
    unsafe extern "C" fn(SendChar, Unused, ControlledExit, SendData, SendInitData, Unused, *mut c_void) -> c_int;
type InitSync = unsafe extern "C" fn(GetVoltage, Unused, GetSync, *mut c_int, *mut c_void) -> c_int;
type Circ = unsafe extern "C" fn(*mut *mut c_char) -> c_int;
type Command = unsafe extern "C" fn(*mut c_char) -> c_int;

/// The library, loaded.
pub struct Ngspice {
    init: Init,
    init_sync: InitSync,
    circ: Circ,
    command: Command,
    // Last, so that it goes after the functions.
    _library: Library,
}

impl Ngspice {
    /// Loads the library: the one that [`LIBRARY_VARIABLE`] names, else the system's.
    pub fn load() -> Result<Self, LibraryError> {
        let named = std::env::var_os(LIBRARY_VARIABLE).map(PathBuf::from);
        let candidates = named.map_or_else(|| NAMES.iter().map(PathBuf::from).collect(), |path| vec![path]);
        let mut cause = String::new();
        for path in &candidates {
            // SAFETY: loading runs foreign code, which is what the caller asked for.
            match unsafe { Library::new(path) } {
                Ok(library) => return Self::resolve(library, &path.display().to_string()),
                // The source has the words of the linker; the error itself says only what failed.
                Err(error) => cause = error.source().unwrap_or(&error).to_string(),
            }
        }
        let names = candidates.iter().map(|path| path.display().to_string()).collect::<Vec<_>>().join(", ");
        Err(LibraryError::Missing { names, cause })
    }

    fn resolve(library: Library, path: &str) -> Result<Self, LibraryError> {
        macro_rules! function {
            ($type:ty, $name:literal) => {
                // SAFETY: libngspice exports this name with this signature (sharedspice.h).
                *unsafe { library.get::<$type>($name) }
                    .map_err(|_| LibraryError::Symbol { path: path.to_owned(), symbol: $name })?
            };
        }
        Ok(Self {
            init: function!(Init, "ngSpice_Init"),
            init_sync: function!(InitSync, "ngSpice_Init_Sync"),
            circ: function!(Circ, "ngSpice_Circ"),
            command: function!(Command, "ngSpice_Command"),
            _library: library,
        })
    }

    /// Registers the callbacks; each gets `user`.
    ///
    /// # Safety
    /// `user` is what the callbacks expect, and stays so as long as `self` is called.
    pub unsafe fn initialize(&self, callbacks: Callbacks, user: *mut c_void) {
        let Callbacks { text, exit, begin, data, voltage, sync } = callbacks;
        let mut identity = 0;
        // SAFETY: the signatures are those of sharedspice.h; callbacks that are left out may be NULL.
        unsafe {
            (self.init)(text, None, exit, data, begin, None, user);
            (self.init_sync)(voltage, None, sync, &raw mut identity, user);
        }
    }

    /// Reads a circuit. ngspice reports success even for a bad one; the analysis then does not run.
    pub fn circuit(&self, lines: &[String]) -> Result<(), LibraryError> {
        let lines = lines.iter().map(|line| CString::new(line.as_str())).collect::<Result<Vec<_>, _>>()?;
        let mut pointers: Vec<*mut c_char> = lines.iter().map(|line| line.as_ptr().cast_mut()).collect();
        pointers.push(std::ptr::null_mut());
        // SAFETY: ngspice copies the lines; the array ends with NULL.
        unsafe { (self.circ)(pointers.as_mut_ptr()) };
        Ok(())
    }

    /// Executes a command; returns when it is done. A transient analysis calls back meanwhile.
    pub fn command(&self, command: &str) -> Result<(), LibraryError> {
        let command = CString::new(command)?;
        // SAFETY: ngspice copies the command.
        unsafe { (self.command)(command.as_ptr().cast_mut()) };
        Ok(())
    }
}
