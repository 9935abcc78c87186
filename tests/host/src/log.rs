//! A logger that keeps what it is told.

use core::ffi::{CStr, c_char, c_void};
use fmu_export::abi::{fmi2CallbackFunctions, fmi2CallbackLogger, fmi2ComponentEnvironment, fmi2Status, fmi2String};

/// One call of the logger.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    /// Status it goes with.
    pub status: fmi2Status,
    /// Category.
    pub category: String,
    /// Text.
    pub message: String,
}

/// What the environment pointer of an instance points to.
#[derive(Debug, Default)]
pub struct Log(pub Vec<Line>);

/// Whether there is a logger: Miri does not call a function of fixed arguments as a variadic one.
pub const LOGS: bool = !cfg!(miri);

impl Log {
    /// The messages since this was last asked.
    pub fn take(&mut self) -> Vec<Line> {
        core::mem::take(&mut self.0)
    }

    /// Callbacks that write to this log, which must stay where it is.
    pub fn callbacks(&mut self) -> fmi2CallbackFunctions {
        // Stable Rust cannot define a variadic function. A call with one pointer argument passes it as a fixed one on
        // the platforms that run these tests (System V and Windows x64, AArch64 Linux).
        let plain: unsafe extern "C" fn(_, _, _, _, _, *const c_char) = keep;
        // SAFETY: see above; the exporter always passes one argument.
        let variadic = unsafe { core::mem::transmute::<*const c_void, fmi2CallbackLogger>(plain as *const c_void) };
        fmi2CallbackFunctions {
            logger: LOGS.then_some(variadic),
            allocateMemory: None,
            freeMemory: None,
            stepFinished: None,
            componentEnvironment: core::ptr::from_mut(self).cast(),
        }
    }
}

unsafe extern "C" fn keep(
    environment: fmi2ComponentEnvironment,
    _instance: fmi2String,
    status: fmi2Status,
    category: fmi2String,
    _format: fmi2String,
    argument: *const c_char,
) {
    // SAFETY: the environment is that of `callbacks`, and the strings are zero-terminated.
    let (log, category, message) =
        unsafe { (&mut *environment.cast::<Log>(), CStr::from_ptr(category), CStr::from_ptr(argument)) };
    let [category, message] = [category, message].map(|text| text.to_string_lossy().into_owned());
    log.0.push(Line { status, category, message });
}
