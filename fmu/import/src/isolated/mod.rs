//! FMUs that run in a process of their own: whatever becomes of them, this process goes on and says what happened.
//!
//! Each instance has a worker: a child process that loads the library, calls it for one instance, and exchanges messages
//! with this process over its stdin and stdout (`protocol`). On this side the functions of an isolated FMU form the same
//! table as those of a library (`proxy`), so that [`Instance`](super::Instance) knows no difference.
//!
//! A worker is held to its limits from outside (`process`): a call that takes too long ends it together with all that it
//! started, and nothing that it sends is believed without a look. It is no sandbox: an FMU may still do what its user may.

mod ending;
mod pipes;
mod pool;
mod process;
mod protocol;
mod proxy;
mod remote;
mod session;
mod worker;

use std::path::PathBuf;
use std::time::Duration;

pub use ending::Ending;
pub(super) use pool::{Pool, Wanted};
pub(super) use protocol::LONGEST_STATE;
pub(super) use proxy::FUNCTIONS;
pub(super) use remote::{Verdict, free, verdict};
pub use worker::serve;

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
    /// Address space of the process, bytes; none: any. On Windows it is not bounded.
    pub memory: Option<u64>,
}

impl Bounds {
    /// What the worker comes to when it sets these (`worker`): lower ones where the user may not have so much, and none of
    /// memory where the system has no such bound.
    fn in_force(self) -> Self {
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
