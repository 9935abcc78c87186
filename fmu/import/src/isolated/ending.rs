//! The end of a worker: FMU, call, cause, and its last messages.

use std::fmt;
use std::path::PathBuf;

use super::bounds::Bounds;
use crate::logging::LogRecord;
use videg_system::worker::End;

/// The end of a worker before its time.
#[derive(Debug, Clone)]
pub struct Ending {
    pub(super) path: PathBuf,
    /// The call: function, instance, time.
    pub(super) call: String,
    pub(super) how: End,
    pub(super) bounds: Bounds,
    /// The last messages of the FMU, oldest first.
    pub(super) messages: Vec<LogRecord>,
    /// The end of what it printed.
    pub(super) printed: String,
}

impl Ending {
    fn how(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.how {
            End::Ended(status) => write!(out, "ended its process ({status}{})", self.memory()),
            End::TooLong => {
                let limit = self.bounds.time.unwrap_or_default().as_secs_f64();
                write!(out, "took longer than the time limit of {limit} s; its process was ended")
            }
            End::Silent => out.write_str("closed the pipes of its process, which was ended"),
            End::Garbled(what) => write!(out, "corrupted its process, which was ended (what it sent: {what})"),
            End::Refused(cause) => write!(out, "lost its process ({cause})"),
        }
    }

    /// The bound on memory, a usual reason to crash.
    fn memory(&self) -> String {
        self.bounds.memory.map_or_else(String::new, |bytes| format!("; memory limit {} MiB", bytes >> 20))
    }
}

impl fmt::Display for Ending {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "{}: {} ", self.path.display(), self.call)?;
        self.how(out)?;
        if !self.messages.is_empty() {
            let said: Vec<_> = self.messages.iter().map(|record| record.message.trim_end()).collect();
            write!(out, "; the FMU had logged: {}", said.join(" | "))?;
        }
        let lines: Vec<_> = self.printed.lines().map(str::trim).filter(|line| !line.is_empty()).collect();
        if lines.is_empty() { Ok(()) } else { write!(out, "; it had printed: {}", lines.join(" | ")) }
    }
}
