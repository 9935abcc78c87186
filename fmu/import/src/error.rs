//! Errors of the importer.
//!
//! Every message is one line that names what, where, found and allowed. Causes are part of that line instead of a
//! chain of sources, so that no way of printing loses or repeats them.

use std::io;
use std::path::{Path, PathBuf};

use thiserror::Error;

use super::logging::{LogRecord, Status};

use super::isolated::Ending;

/// Result of the importer.
pub type Result<T> = std::result::Result<T, FmiError>;

/// Why an FMU could not be opened, loaded or called.
#[derive(Debug, Error)]
#[allow(missing_docs, reason = "the message of each variant names its fields")]
pub enum FmiError {
    /// The file system refused.
    #[error("cannot {action} {}: {cause}", path.display())]
    Io { action: &'static str, path: PathBuf, cause: io::Error },
    /// The file is no zip archive, or a broken one.
    #[error("{}: not a readable FMU (zip) archive: {cause}", path.display())]
    NotAnArchive { path: PathBuf, cause: zip::result::ZipError },
    /// The archive has no file of this name.
    #[error("{}: the archive has no {entry}", path.display())]
    MissingEntry { path: PathBuf, entry: &'static str },
    /// The archive breaks a safety rule.
    #[error("{}: refused: {reason}", path.display())]
    Refused { path: PathBuf, reason: String },
    /// The model description cannot be used.
    #[error("{origin}: {cause}")]
    Description { origin: String, cause: String },
    /// There is no binary for this machine.
    #[error("{}: no binary for this platform (wanted {wanted}, the FMU has: {})", path.display(), list(found))]
    NoBinary { path: PathBuf, wanted: String, found: Vec<String> },
    /// An FMU of FMI 3.0, which is described but not run.
    #[error("it is of FMI {found}; FMUs of FMI 2.0 are run, those of 3.0 can only be described (videg fmu info)")]
    Version { found: String },
    /// The dynamic linker refused the library.
    #[error("cannot load {}: {cause}", path.display())]
    Load { path: PathBuf, cause: libloading::Error },
    /// The library lacks a function of the co-simulation interface.
    #[error("{} does not export {symbol}, which FMI 2.0 for co-simulation requires", path.display())]
    MissingSymbol { path: PathBuf, symbol: &'static str },
    /// The library speaks another version of FMI or uses other C types.
    #[error("{}: {function} returned \"{found}\", allowed is \"{allowed}\"", path.display())]
    WrongInterface { path: PathBuf, function: &'static str, found: String, allowed: &'static str },
    /// `fmi2Instantiate` returned NULL.
    #[error(
        "fmi2Instantiate of '{instance}' (model {model}, guid {guid}) failed{}; a model description that belongs \
             to another build of the library is a usual reason",
        tail(messages)
    )]
    Instantiate { instance: String, model: String, guid: String, messages: Vec<LogRecord> },
    /// A call returned something else than OK or Warning.
    #[error("{}", failed(function, instance, *status, messages))]
    Call { function: &'static str, instance: String, status: Status, messages: Vec<LogRecord> },
    /// An earlier call returned Fatal: no instance of this FMU may be called any more.
    #[error("{function} of '{instance}' was not called: the FMU {model} reported a fatal error before")]
    Dead { function: &'static str, instance: String, model: String },
    /// The FMU does not offer an optional function.
    #[error("{function} of '{instance}' was not called: the FMU does not declare {capability}")]
    NotSupported { function: &'static str, instance: String, capability: &'static str },
    /// Slices that belong together have different lengths, a state belongs to another instance, or is too large.
    #[error("{function} of '{instance}': {reason}")]
    Arguments { function: &'static str, instance: String, reason: String },
    /// The process of an isolated FMU cannot be started.
    #[error("cannot start {} {} for the FMU: {cause}", program.display(), super::isolated::WORKER_VERB)]
    Worker { program: PathBuf, cause: String },
    /// The process of an isolated FMU cannot use the library; in its words.
    #[error("{0}")]
    Refusal(String),
    /// The process of an isolated FMU has ended, or had to be.
    #[error("{0}")]
    Isolated(Box<Ending>),
    /// A text holds a zero byte, or a name is empty.
    #[error("{what} \"{}\" cannot be passed to an FMU: it is empty or holds a zero byte", text.escape_debug())]
    Text { what: &'static str, text: String },
    /// A variable does not exist.
    #[error("model {model} has no variable \"{name}\"{}", hint(suggestion.as_ref()))]
    UnknownVariable { model: String, name: String, suggestion: Option<String> },
    /// A value does not suit its variable.
    #[error(transparent)]
    Value(#[from] ValueError),
}

impl FmiError {
    /// The status of a failed call, if this is one.
    pub fn status(&self) -> Option<Status> {
        match self {
            Self::Call { status, .. } => Some(*status),
            _ => None,
        }
    }

    pub(super) fn io(action: &'static str, path: &Path) -> impl FnOnce(io::Error) -> Self {
        move |cause| Self::Io { action, path: path.to_path_buf(), cause }
    }
}

/// Why a value does not suit its variable.
#[derive(Debug, Error, Clone, PartialEq)]
#[allow(missing_docs, reason = "the message of each variant names its fields")]
pub enum ValueError {
    /// The variable cannot be set from outside.
    #[error("{variable} cannot be set: it is {variability} {causality}; inputs and parameters can be set")]
    NotSettable { variable: String, variability: &'static str, causality: &'static str },
    /// The text does not read as the type of the variable.
    #[error("{variable} = \"{}\": allowed is {allowed}", found.escape_debug())]
    Parse { variable: String, found: String, allowed: String },
    /// The value lies outside its bounds.
    #[error("{variable} = {found} is out of range: allowed is {allowed}")]
    Range { variable: String, found: String, allowed: String },
}

fn list(names: &[String]) -> String {
    if names.is_empty() { "none".to_owned() } else { names.join(", ") }
}

fn hint(suggestion: Option<&String>) -> String {
    suggestion.map_or_else(String::new, |name| format!("; did you mean \"{name}\"?"))
}

fn tail(messages: &[LogRecord]) -> String {
    if messages.is_empty() {
        return String::new();
    }
    let lines: Vec<_> = messages.iter().map(|record| record.message.as_str()).collect();
    format!("; the FMU said: {}", lines.join(" | "))
}

/// What the FMU said, then which call it was; without a message the call alone.
fn failed(function: &str, instance: &str, status: Status, messages: &[LogRecord]) -> String {
    let call = format!("{function} of '{instance}' returned {status}");
    if messages.is_empty() {
        return call;
    }
    let prefix = format!("{function}: ");
    let said = messages.iter().map(|record| record.message.strip_prefix(&prefix).unwrap_or(&record.message));
    format!("{} ({call})", said.collect::<Vec<_>>().join(" | "))
}
