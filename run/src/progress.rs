//! Progress of a long run: the trait through which every long run tells its caller how far it is.

use std::time::{Duration, Instant};

/// A task in work.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Running {
    /// Its name.
    pub name: String,
    /// The part that is done, if it is known, %.
    pub percent: Option<u8>,
}

/// Follows a run. Each method does nothing unless it is implemented; `()` ignores everything. Runs call it from several
/// threads.
pub trait Progress: Sync {
    /// An item of the run begins, e.g. a figure of the paper.
    fn begin(&self, _name: &str, _title: &str) {}

    /// `done` of the `total` parts of the present item are done; `running` are those in work, where they have names.
    fn advance(&self, _done: u64, _total: u64, _running: &[Running]) {}

    /// An item is complete.
    fn end(&self, _name: &str, _took: Duration) {}

    /// Whether the caller wants the run to stop. A run that stops returns what it has, or an error if that is no result.
    fn is_stopped(&self) -> bool {
        false
    }
}

impl Progress for () {}

/// Does `work` as an item of a run.
pub fn during<T, E>(
    observer: &dyn Progress,
    name: &str,
    title: &str,
    work: impl FnOnce() -> Result<T, E>,
) -> Result<T, E> {
    let started = Instant::now();
    observer.begin(name, title);
    let result = work()?;
    observer.end(name, started.elapsed());
    Ok(result)
}
