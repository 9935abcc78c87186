//! Threads that share work. A system that is short of them gives fewer than were asked for, which is no reason to end.

use std::io;
use std::panic::resume_unwind;
use std::thread::{Builder, Scope, ScopedJoinHandle};

/// Starts up to `count` threads for `work`; those that there are, and why there are no more.
pub fn start<'scope>(
    scope: &'scope Scope<'scope, '_>,
    count: usize,
    work: impl Fn() + Send + Copy + 'scope,
) -> (Vec<ScopedJoinHandle<'scope, ()>>, Option<io::Error>) {
    let mut threads = Vec::new();
    for _ in 0..count {
        match Builder::new().spawn_scoped(scope, work) {
            Ok(thread) => threads.push(thread),
            Err(cause) => return (threads, Some(cause)),
        }
    }
    (threads, None)
}

/// Waits until threads are gone, with what belonged to each: the end of their scope waits for their work alone.
pub fn join(threads: Vec<ScopedJoinHandle<'_, ()>>) {
    for thread in threads {
        thread.join().unwrap_or_else(|panic| resume_unwind(panic));
    }
}

/// Has up to `count` threads do `work` at once, this one among them.
pub fn share(count: usize, work: impl Fn() + Send + Copy) {
    std::thread::scope(|scope| {
        // With none but this one it takes longer.
        let (threads, _) = start(scope, count.saturating_sub(1), work);
        work();
        join(threads);
    });
}
