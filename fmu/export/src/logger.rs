//! Messages to the importer, through its variadic logger callback.

use core::cell::Cell;
use core::ffi::CStr;
use core::fmt::Display;
use fmu_abi::fmi3::{fmi3InstanceEnvironment, fmi3Status, fmi3String};
use fmu_abi::{
    fmi2CallbackLogger, fmi2ComponentEnvironment, fmi2Discard, fmi2Error, fmi2Fatal, fmi2OK, fmi2Status, fmi2Warning,
};
use std::ffi::CString;

/// A log category, as listed in `modelDescription.xml`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LogCategory {
    /// Events of the model.
    Events,
    /// Calls that the standard forbids and that work all the same.
    Tolerated,
    /// Messages that go with `fmi2Warning`.
    Warning,
    /// Messages that go with `fmi2Discard`.
    Discard,
    /// Messages that go with `fmi2Error`.
    Error,
    /// Messages that go with `fmi2Fatal`.
    Fatal,
}

impl LogCategory {
    /// All categories, in the order of `modelDescription.xml`.
    pub const ALL: [Self; 6] = [Self::Events, Self::Tolerated, Self::Warning, Self::Discard, Self::Error, Self::Fatal];

    /// Name of the category that stands for all of them.
    pub const ALL_NAME: &'static str = "logAll";

    const fn c_name(self) -> &'static CStr {
        match self {
            Self::Events => c"logEvents",
            Self::Tolerated => c"logTolerated",
            Self::Warning => c"logStatusWarning",
            Self::Discard => c"logStatusDiscard",
            Self::Error => c"logStatusError",
            Self::Fatal => c"logStatusFatal",
        }
    }

    /// The name that FMI 2.0 gives it; `logTolerated` is a category of this exporter.
    pub fn name(self) -> &'static str {
        self.c_name().to_str().unwrap_or_default()
    }

    /// What is logged under it.
    pub const fn description(self) -> &'static str {
        match self {
            Self::Events => "Events of the model",
            Self::Tolerated => "Calls that the standard forbids and that work all the same; they return OK",
            Self::Warning => "Messages that go with the status Warning",
            Self::Discard => "Messages that go with the status Discard",
            Self::Error => "Messages that go with the status Error",
            Self::Fatal => "Messages that go with the status Fatal",
        }
    }

    /// The category with this name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|c| c.name() == name)
    }

    const fn bit(self) -> u8 {
        1 << self as u8
    }
}

/// What takes the messages.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Callback {
    /// Nothing.
    None,
    /// The logger of FMI 2.0.
    Fmi2(fmi2CallbackLogger),
    /// That of FMI 3.0.
    Fmi3(unsafe extern "C" fn(fmi3InstanceEnvironment, fmi3Status, fmi3String, fmi3String)),
}

/// Sends messages to the importer. Nothing is formatted that is not sent.
pub struct Logger {
    callback: Callback,
    environment: fmi2ComponentEnvironment,
    instance_name: CString,
    enabled: u8,
    warned: Cell<bool>,
    /// Numbers of the warnings that have been given once, as bits.
    given: Cell<u64>,
}

const ALL_BITS: u8 = 0b11_1111;
const ALWAYS_ON: u8 = LogCategory::Error.bit() | LogCategory::Fatal.bit();

impl Logger {
    /// A logger that says nothing, for use of a slave without an importer.
    pub fn silent() -> Self {
        Self::new(Callback::None, core::ptr::null_mut(), "", false)
    }

    /// A logger on the callback of the importer.
    pub(crate) fn new(
        callback: Callback,
        environment: fmi2ComponentEnvironment,
        instance_name: &str,
        logging_on: bool,
    ) -> Self {
        Self {
            callback,
            environment,
            instance_name: c_string(instance_name),
            enabled: if logging_on { ALL_BITS } else { 0 },
            warned: Cell::new(false),
            given: Cell::new(0),
        }
    }

    /// Reports an event of the model (category `logEvents`).
    pub fn event(&self, message: impl Display) {
        self.send(fmi2OK, LogCategory::Events, &message);
    }

    /// Reports a call that FMI 2.0 forbids and that works all the same (category `logTolerated`). The C function returns
    /// `fmi2OK`: many importers take `fmi2Warning` for a failure.
    pub(crate) fn tolerated(&self, message: impl Display) {
        self.send(fmi2OK, LogCategory::Tolerated, &message);
    }

    /// Reports that something is odd though the computation goes on (category `logStatusWarning`). The C function
    /// that is under way returns `fmi2Warning` if it succeeds otherwise.
    pub fn warning(&self, message: impl Display) {
        self.warned.set(true);
        self.send(fmi2Warning, LogCategory::Warning, &message);
    }

    /// Gives a [`warning`](Self::warning), unless one of the same `number`, 0 to 63, was given since the instance was made
    /// or reset. No FMU state holds which were: a step that is taken back and tried again does not warn twice. One that
    /// nobody saw, since its category is off, counts as given: the call returned `fmi2Warning` all the same.
    pub fn warning_once(&self, number: u32, message: impl Display) {
        if !self.has_given(number) {
            self.given.set(self.given.get() | Self::given_bit(number));
            self.warning(message);
        }
    }

    /// Whether [`warning_once`](Self::warning_once) has nothing to say under this number any more.
    pub fn has_given(&self, number: u32) -> bool {
        self.given.get() & Self::given_bit(number) != 0
    }

    const fn given_bit(number: u32) -> u64 {
        1 << (number % u64::BITS)
    }

    /// Warnings that were given once may be given again.
    pub(crate) fn forget_given(&self) {
        self.given.set(0);
    }

    /// Whether messages of this category reach anyone, for models that must work to make them. Errors always do: what
    /// an importer switches on and off is debug logging, and a call that fails owes its reason.
    pub fn is_enabled(&self, category: LogCategory) -> bool {
        !matches!(self.callback, Callback::None) && (self.enabled | ALWAYS_ON) & category.bit() != 0
    }

    /// Reports a call that did not succeed, under the category of its status.
    pub(crate) fn status(&self, status: fmi2Status, message: impl Display) {
        let category = match status {
            fmi2Warning => LogCategory::Warning,
            fmi2Discard => LogCategory::Discard,
            fmi2Error => LogCategory::Error,
            fmi2Fatal => LogCategory::Fatal,
            _ => LogCategory::Events,
        };
        self.send(status, category, &message);
    }

    /// Switches all categories on or off.
    pub(crate) fn enable_all(&mut self, on: bool) {
        self.enabled = if on { ALL_BITS } else { 0 };
    }

    /// Switches one category on or off.
    pub(crate) const fn enable(&mut self, category: LogCategory, on: bool) {
        if on {
            self.enabled |= category.bit();
        } else {
            self.enabled &= !category.bit();
        }
    }

    /// Leaves exactly these categories on.
    pub(crate) fn enable_only(&mut self, categories: impl Iterator<Item = LogCategory>) {
        self.enabled = categories.fold(0, |bits, c| bits | c.bit());
    }

    /// Whether a warning was given during the call that is under way.
    pub(crate) fn has_warned(&self) -> bool {
        self.warned.get()
    }

    /// The same, at the end of the call.
    pub(crate) fn take_warned(&self) -> bool {
        self.warned.take()
    }

    fn send(&self, status: fmi2Status, category: LogCategory, message: &dyn Display) {
        if !self.is_enabled(category) {
            return;
        }
        let (environment, text, category) = (self.environment, message.to_string(), category.c_name().as_ptr());
        // SAFETY, for both: the callback came from the importer with this environment; all strings are zero-terminated
        // and outlive the call. The fixed format keeps a percent sign in the message from being interpreted.
        match self.callback {
            Callback::None => {}
            Callback::Fmi2(callback) => {
                let (name, text) = (self.instance_name.as_ptr(), c_string(&text));
                unsafe { callback(environment, name, status, category, c"%s".as_ptr(), text.as_ptr()) };
            }
            Callback::Fmi3(callback) => {
                let text = c_string(&text.replace('#', "##")); // what stands between two of them is a variable
                unsafe { callback(environment, status, category, text.as_ptr()) };
            }
        }
    }
}

/// A C string; a NUL inside, which C cannot hold, becomes the replacement character.
pub(crate) fn c_string(text: &str) -> CString {
    CString::new(text).unwrap_or_else(|_| CString::new(text.replace('\0', "\u{fffd}")).unwrap_or_default())
}

#[cfg(test)]
mod tests {
    use super::Logger;

    #[test]
    fn a_warning_is_given_once_though_nobody_sees_it_and_again_after_a_reset() {
        let log = Logger::silent();
        for number in [0, 63] {
            assert!(!log.has_given(number));
            log.warning_once(number, "odd");
            assert!(log.has_given(number) && log.take_warned());
            log.warning_once(number, "odd");
            assert!(!log.take_warned());
        }
        assert!(!log.has_given(1));
        log.forget_given();
        assert!(!log.has_given(0) && !log.has_given(63));
    }
}
