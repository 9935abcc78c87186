//! Waiting for what another process does.

use std::time::{Duration, Instant};

/// What `what` gives, as soon as it gives something.
pub fn wait_for<T>(mut what: impl FnMut() -> Option<T>) -> T {
    let end = Instant::now() + Duration::from_secs(100);
    loop {
        if let Some(found) = what() {
            return found;
        }
        assert!(Instant::now() < end, "it takes too long");
        std::thread::sleep(Duration::from_millis(20));
    }
}
