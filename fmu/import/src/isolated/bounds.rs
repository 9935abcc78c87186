//! How an FMU is isolated: by which program, and within which bounds.

use std::path::PathBuf;
use std::time::Duration;

/// Verb of the command-line tool that runs the worker.
pub const WORKER_VERB: &str = "fmu-worker";

/// How an FMU is run in processes of its own.
#[derive(Debug, Clone)]
pub struct Isolation {
    /// The program whose verb [`WORKER_VERB`] serves: `videg`.
    pub program: PathBuf,
    /// What a worker may take.
    pub bounds: Bounds,
}

/// What a worker may take.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Bounds {
    /// Longest time that a call may take; none: any.
    pub time: Option<Duration>,
    /// Address space of the process, bytes; none: any. On macOS and Windows it is not bounded.
    pub memory: Option<u64>,
}

impl Bounds {
    /// What the worker comes to when it sets these (`worker`): lower ones where the user may not have so much, and none of
    /// memory where the system has no such bound.
    pub(super) fn in_force(self) -> Self {
        #[cfg(all(unix, not(target_vendor = "apple")))]
        let memory = {
            let most = rustix::process::getrlimit(rustix::process::Resource::As).maximum;
            self.memory.map(|bytes| most.map_or(bytes, |most| bytes.min(most)))
        };
        #[cfg(not(all(unix, not(target_vendor = "apple"))))]
        let memory = None;
        Self { memory, ..self }
    }
}

impl Default for Bounds {
    fn default() -> Self {
        Self { time: Some(Duration::from_secs(60)), memory: Some(4 << 30) }
    }
}
