//! FMUs that run in a process of their own: if one fails, this process goes on and reports how.
//!
//! Each instance has a worker: a child process that loads the library, calls it for one instance, and exchanges messages
//! with this process over its stdin and stdout (`protocol`). On this side an isolated instance (`remote`) takes the same requests as one
//! in this process, so that [`Instance`](super::Instance) knows no difference.
//!
//! A worker is held to its limits from outside (`process`): a call that takes too long ends it together with all that it
//! started, and nothing that it sends is believed without a look. It is no sandbox: an FMU may still do what its user may.

mod bounds;
mod ending;
mod pool;
mod process;
mod protocol;
mod remote;
mod session;
mod worker;

pub use bounds::{Bounds, Isolation, WORKER_VERB};
pub use ending::Ending;
pub(super) use pool::Pool;
pub(super) use protocol::LONGEST_STATE;
pub(super) use remote::{Loss, Remote};
pub use worker::serve;
