//! Threads that share work. A system that is short of them gives fewer than were asked for, which is no reason to end.

use std::io;
use std::thread::{Builder, Scope};

/// Starts up to `count` threads for `work`; how many there are, and why there are no more.
pub(crate) fn start<'scope>(
    scope: &'scope Scope<'scope, '_>,
    count: usize,
    work: impl Fn() + Send + Copy + 'scope,
) -> (usize, Option<io::Error>) {
    for started in 0..count {
        if let Err(cause) = Builder::new().spawn_scoped(scope, work) {
            return (started, Some(cause));
        }
    }
    (count, None)
}

/// Has up to `count` threads do `work` at once, this one among them.
#[cfg(feature = "tool")]
pub(crate) fn share(count: usize, work: impl Fn() + Send + Copy) {
    std::thread::scope(|scope| {
        // With none but this one it takes longer.
        let _ = start(scope, count.saturating_sub(1), work);
        work();
    });
}
