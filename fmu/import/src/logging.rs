//! Statuses and messages of an FMU, and the C callbacks that collect them.

use std::collections::VecDeque;
use std::ffi::{CStr, c_char, c_void};
use std::fmt;
use std::mem::MaybeUninit;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use fmu_abi::{
    fmi2CallbackFunctions, fmi2CallbackLogger, fmi2ComponentEnvironment, fmi2Discard, fmi2Error, fmi2Fatal, fmi2OK,
    fmi2Pending, fmi2Status, fmi2String, fmi2Warning,
};
use serde::{Deserialize, Serialize};

/// How many messages an instance remembers.
const REMEMBERED: usize = 100;
/// How many of them an error shows.
const SHOWN: usize = 5;
/// Longest part of a message that is kept, in bytes.
const MAX_MESSAGE: usize = 4096;

/// Result of a call, as FMI counts them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Status {
    /// All well.
    Ok,
    /// Something is odd, the computation goes on.
    Warning,
    /// The call was not carried out (or only in part); the master may try another.
    Discard,
    /// The instance cannot go on.
    Error,
    /// No instance of the FMU can go on.
    Fatal,
    /// The step is under way; never allowed here, since no asynchronous step is asked for.
    Pending,
    /// A number that FMI 2.0 does not define.
    Unknown(i32),
}

impl From<fmi2Status> for Status {
    #[allow(non_upper_case_globals)] // names of the standard
    fn from(status: fmi2Status) -> Self {
        match status {
            fmi2OK => Self::Ok,
            fmi2Warning => Self::Warning,
            fmi2Discard => Self::Discard,
            fmi2Error => Self::Error,
            fmi2Fatal => Self::Fatal,
            fmi2Pending => Self::Pending,
            other => Self::Unknown(other),
        }
    }
}

impl fmt::Display for Status {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Ok => out.write_str("OK"),
            Self::Warning => out.write_str("Warning"),
            Self::Discard => out.write_str("Discard"),
            Self::Error => out.write_str("Error"),
            Self::Fatal => out.write_str("Fatal"),
            Self::Pending => out.write_str("Pending"),
            Self::Unknown(number) => write!(out, "the undefined status {number}"),
        }
    }
}

/// One message of an FMU.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct LogRecord {
    /// Name of the instance.
    pub instance: String,
    /// How bad it is.
    pub status: Status,
    /// Log category.
    pub category: String,
    /// The text. Where an FMU passes a format with arguments, this is the format: see the module's source for why.
    pub message: String,
}

impl LogRecord {
    /// The record with texts no longer than those that come from an FMU in this process.
    pub(super) fn cut(mut self) -> Self {
        // A byte that is no text becomes a sign of three.
        const LONGEST: usize = 3 * MAX_MESSAGE;
        for text in [&mut self.instance, &mut self.category, &mut self.message] {
            let end = (0..=LONGEST.min(text.len())).rev().find(|end| text.is_char_boundary(*end));
            text.truncate(end.unwrap_or(0));
        }
        self
    }
}

impl fmt::Display for LogRecord {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "[{}] {}: {}", self.category, self.status, self.message.trim_end())
    }
}

/// Takes the messages of an instance as they come, on whichever thread the FMU sends them from.
pub type LogSink = Box<dyn FnMut(&LogRecord) + Send>;

/// How an instance logs. The default asks for warnings and errors only, where the FMU has categories for them.
#[derive(Default)]
pub struct Logging {
    /// Asks the FMU for debug messages.
    pub enabled: bool,
    /// Takes each message, besides the memory of the instance.
    pub sink: Option<LogSink>,
}

impl Logging {
    /// Asks for debug messages and hands each message to `sink`.
    pub fn to(sink: impl FnMut(&LogRecord) + Send + 'static) -> Self {
        Self { enabled: true, sink: Some(Box::new(sink)) }
    }
}

/// The `componentEnvironment` of one instance.
pub(super) struct Environment {
    log: Mutex<Log>,
    /// Messages so far.
    count: AtomicUsize,
}

struct Log {
    remembered: VecDeque<LogRecord>,
    sink: Option<LogSink>,
}

impl Environment {
    pub(super) fn new(sink: Option<LogSink>) -> Arc<Self> {
        let log = Mutex::new(Log { remembered: VecDeque::new(), sink });
        Arc::new(Self { log, count: AtomicUsize::new(0) })
    }

    /// How many messages there were so far.
    #[inline]
    pub(super) fn count(&self) -> usize {
        self.count.load(Ordering::Relaxed)
    }

    /// The last messages after the first `before`, oldest first, as errors show them: of complaints, or else of all.
    pub(super) fn last(&self, before: usize) -> Vec<LogRecord> {
        let mut all = self.all();
        all.drain(..all.len().saturating_sub(self.count() - before));
        let complaints: Vec<_> = all.iter().filter(|record| record.status != Status::Ok).cloned().collect();
        let shown = if complaints.is_empty() { all } else { complaints };
        let skipped = shown.len().saturating_sub(SHOWN);
        shown.into_iter().skip(skipped).collect()
    }

    /// All remembered messages, oldest first.
    pub(super) fn all(&self) -> Vec<LogRecord> {
        self.lock().remembered.iter().cloned().collect()
    }

    fn lock(&self) -> MutexGuard<'_, Log> {
        self.log.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Remembers a message and hands it to the sink.
    pub(super) fn take(&self, record: LogRecord) {
        let mut log = self.lock();
        if let Some(sink) = &mut log.sink {
            // A panic must not cross the C frames of the FMU.
            if catch_unwind(AssertUnwindSafe(|| sink(&record))).is_err() {
                log.sink = None;
            }
        }
        if log.remembered.len() == REMEMBERED {
            log.remembered.pop_front();
        }
        log.remembered.push_back(record);
        self.count.fetch_add(1, Ordering::Relaxed);
    }

    /// The callbacks to pass to `fmi2Instantiate`; they must not outlive this environment.
    pub(super) fn callbacks(self: &Arc<Self>) -> fmi2CallbackFunctions {
        fmi2CallbackFunctions {
            logger: Some(variadic_logger()),
            allocateMemory: Some(calloc),
            freeMemory: Some(free),
            stepFinished: None,
            componentEnvironment: Arc::as_ptr(self).cast_mut().cast(),
        }
    }
}

unsafe extern "C" {
    // The C library's own, which every Rust program with `std` links.
    fn calloc(count: usize, size: usize) -> *mut c_void;
    fn free(memory: *mut c_void);
}

/// Whether the first variadic argument arrives where a sixth named argument would. That holds for the C ABIs of
/// x86-64 (System V and Windows) and of `AArch64` (AAPCS64), but not on Apple's `AArch64`, where variadic arguments
/// always go to the stack.
pub(super) const READS_FIRST_ARGUMENT: bool =
    cfg!(any(target_arch = "x86_64", all(target_arch = "aarch64", not(target_vendor = "apple"))));

type NamedLogger = unsafe extern "C" fn(
    fmi2ComponentEnvironment,
    fmi2String,
    fmi2Status,
    fmi2String,
    fmi2String,
    MaybeUninit<*const c_char>,
);

/// [`log`] under the type that FMI gives it.
///
/// Stable Rust cannot define a variadic function, and the project needs no C compiler. On the ABIs that videg runs
/// on, a variadic call passes named arguments exactly as a call without variadic ones does and the caller cleans up,
/// so a function with named arguments may stand in. Arguments after the message cannot be walked this way; only the
/// first is within reach, which is enough for the idiom `logger(.., "%s", text)` that careful exporters use.
fn variadic_logger() -> fmi2CallbackLogger {
    // SAFETY: both are pointers to C functions; that calls through the variadic type reach the named arguments is
    // argued above.
    unsafe { std::mem::transmute::<NamedLogger, fmi2CallbackLogger>(log) }
}

/// Takes one message. `first` has been passed only if the format asks for it, hence `MaybeUninit`: otherwise it is
/// whatever the register (on Windows: the caller's stack) holds, and must not be looked at.
unsafe extern "C" fn log(
    environment: fmi2ComponentEnvironment,
    instance: fmi2String,
    status: fmi2Status,
    category: fmi2String,
    message: fmi2String,
    first: MaybeUninit<*const c_char>,
) {
    if environment.is_null() {
        return;
    }
    // SAFETY: `callbacks` has put a live `Environment` there, and the instance keeps it alive.
    let environment = unsafe { &*environment.cast_const().cast::<Environment>() };
    // SAFETY: the FMU passes NULL or zero-terminated strings.
    let (instance, category, mut message) = unsafe { (text(instance), text(category), text(message)) };
    if READS_FIRST_ARGUMENT && message == "%s" {
        // SAFETY: the format "%s" promises one argument, a string.
        message = unsafe { text(first.assume_init()) };
    }
    environment.take(LogRecord { instance, status: status.into(), category, message });
}

/// Copies a C string, up to a bound.
///
/// # Safety
/// `pointer` is NULL or points to a zero-terminated string.
unsafe fn text(pointer: *const c_char) -> String {
    if pointer.is_null() {
        return String::new();
    }
    // SAFETY: as the caller promises.
    let bytes = unsafe { CStr::from_ptr(pointer) }.to_bytes();
    String::from_utf8_lossy(bytes.get(..MAX_MESSAGE).unwrap_or(bytes)).into_owned()
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc;

    use super::{Environment, LogRecord, REMEMBERED, SHOWN, Status};

    fn send(environment: &std::sync::Arc<Environment>, message: &std::ffi::CStr, argument: &std::ffi::CStr) {
        let callbacks = environment.callbacks();
        let logger = callbacks.logger.unwrap();
        let (name, category) = (c"toy".as_ptr(), c"logAll".as_ptr());
        // SAFETY: live strings, and an argument for the format.
        unsafe { logger(callbacks.componentEnvironment, name, 1, category, message.as_ptr(), argument.as_ptr()) };
    }

    fn record(message: &str) -> LogRecord {
        let (instance, category) = ("toy".to_owned(), "logAll".to_owned());
        LogRecord { instance, status: Status::Warning, category, message: message.to_owned() }
    }

    #[test]
    fn a_message_behind_percent_s_is_shown_and_other_formats_stay_as_they_are() {
        let environment = Environment::new(None);
        send(&environment, c"%s", c"100 % real");
        send(&environment, c"%s at %g", c"not read");
        send(&environment, c"plain", c"not read");
        let wanted = if super::READS_FIRST_ARGUMENT { "100 % real" } else { "%s" };
        assert_eq!(environment.all(), [record(wanted), record("%s at %g"), record("plain")]);
    }

    #[test]
    fn records_of_another_process_are_cut_at_a_character() {
        let cut = record(&"\u{20ac}".repeat(10_000)).cut();
        assert_eq!(cut, record(&"\u{20ac}".repeat(4096)));
        let cut = record(&format!("a{}", "\u{20ac}".repeat(10_000))).cut();
        assert_eq!(cut, record(&format!("a{}", "\u{20ac}".repeat(4095))));
        assert_eq!(record("short").cut(), record("short"));
    }

    #[test]
    fn memory_is_bounded_and_the_sink_sees_everything() {
        let (sender, receiver) = mpsc::channel();
        let environment = Environment::new(Some(Box::new(move |record| sender.send(record.clone()).unwrap())));
        for _ in 0..REMEMBERED + 20 {
            send(&environment, c"again", c"");
        }
        assert_eq!(environment.all().len(), REMEMBERED);
        assert_eq!(receiver.try_iter().count(), REMEMBERED + 20);
    }

    #[test]
    fn a_panicking_sink_is_dropped_and_the_message_kept() {
        let environment = Environment::new(Some(Box::new(|_| panic!("sink"))));
        send(&environment, c"first", c"");
        send(&environment, c"second", c"");
        assert_eq!(environment.last(0), [record("first"), record("second")]);
    }

    #[test]
    fn an_error_shows_what_was_said_since_its_call_began() {
        let environment = Environment::new(None);
        send(&environment, c"of an earlier call", c"");
        let before = environment.count();
        assert_eq!(environment.last(before), []);
        for _ in 0..REMEMBERED + 20 {
            send(&environment, c"again", c"");
        }
        assert_eq!(environment.last(before), vec![record("again"); SHOWN]);
    }

    #[test]
    fn null_strings_are_empty() {
        let environment = Environment::new(None);
        let callbacks = environment.callbacks();
        let null = std::ptr::null::<std::ffi::c_char>();
        // SAFETY: NULL is allowed everywhere.
        unsafe { callbacks.logger.unwrap()(callbacks.componentEnvironment, null, 77, null, null, null) };
        assert_eq!(environment.all()[0].status, Status::Unknown(77));
        assert_eq!(environment.all()[0].message, "");
    }
}
