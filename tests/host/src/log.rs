//! A logger that keeps what it is told.

use core::ffi::{CStr, c_char};
use fmu_export::abi::{
    fmi2CallbackFunctions, fmi2CallbackLogger, fmi2Component, fmi2ComponentEnvironment, fmi2ResetTYPE, fmi2Status,
    fmi2String,
};

/// One call of the logger.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    /// Name of the instance.
    pub instance: String,
    /// Status it goes with.
    pub status: fmi2Status,
    /// Category.
    pub category: String,
    /// Text.
    pub message: String,
}

/// What the environment pointer of an instance points to.
#[derive(Debug, Default)]
pub struct Log {
    /// The messages.
    pub lines: Vec<Line>,
    /// Called from inside the logger, if it is there: a host that breaks the rules.
    pub reenter: Option<(fmi2ResetTYPE, fmi2Component)>,
    /// The answer.
    pub reentered: Option<fmi2Status>,
}

impl Log {
    /// The messages since this was last asked.
    pub fn take(&mut self) -> Vec<Line> {
        core::mem::take(&mut self.lines)
    }

    /// Callbacks that write to this log, which must stay where it is. Not of a reference: the one who owns the log looks at
    /// it between the calls.
    pub fn callbacks(log: *mut Self) -> fmi2CallbackFunctions {
        fmi2CallbackFunctions {
            logger: Some(logger()),
            allocateMemory: None,
            freeMemory: None,
            stepFinished: None,
            componentEnvironment: log.cast(),
        }
    }
}

/// Stable Rust cannot define a variadic function. A call with one pointer argument passes it as a fixed one on the
/// platforms that run these tests (System V and Windows x64, 64-bit Arm on Linux).
#[cfg(not(miri))]
fn logger() -> fmi2CallbackLogger {
    let plain: unsafe extern "C" fn(_, _, _, _, _, *const c_char) = keep;
    // SAFETY: see above; the exporter always passes one argument.
    unsafe { core::mem::transmute::<*const core::ffi::c_void, fmi2CallbackLogger>(plain as *const core::ffi::c_void) }
}

/// Miri does not call a function of fixed arguments as a variadic one, but its compiler can define one.
#[cfg(miri)]
fn logger() -> fmi2CallbackLogger {
    unsafe extern "C" fn variadic(
        environment: fmi2ComponentEnvironment,
        instance: fmi2String,
        status: fmi2Status,
        category: fmi2String,
        format: fmi2String,
        mut arguments: ...
    ) {
        // SAFETY: the exporter always passes one argument, a text.
        unsafe { keep(environment, instance, status, category, format, arguments.next_arg()) }
    }
    variadic
}

unsafe extern "C" fn keep(
    environment: fmi2ComponentEnvironment,
    instance: fmi2String,
    status: fmi2Status,
    category: fmi2String,
    format: fmi2String,
    argument: *const c_char,
) {
    // SAFETY: the environment is that of `callbacks`, and the strings are zero-terminated.
    let log = unsafe { &mut *environment.cast::<Log>() };
    let texts = [instance, category, format, argument].map(|text| unsafe { CStr::from_ptr(text) });
    let [instance, category, format, message] = texts.map(|text| text.to_string_lossy().into_owned());
    assert_eq!(format, "%s", "a percent sign in a message must not be interpreted");
    log.lines.push(Line { instance, status, category, message });
    if let Some((reset, component)) = log.reenter {
        // SAFETY: the component is live.
        log.reentered = Some(unsafe { reset(component) });
    }
}
