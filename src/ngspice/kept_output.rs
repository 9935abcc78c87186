//! The output of a child on a stream: read to the end, so that the child never waits for a reader; the beginning is kept.

use std::io::{self, Read};
use std::sync::mpsc::{Receiver, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// Longest wait for the rest when the child has ended: a process that it started and detached may hold the stream open.
const FAREWELL: Duration = Duration::from_secs(1);

/// A stream that is being read.
pub(super) struct KeptOutput {
    kept: Arc<Mutex<Vec<u8>>>,
    /// Closed at the end of the stream.
    end: Receiver<()>,
}

impl KeptOutput {
    /// Reads `stream` in a thread and keeps its first `most` bytes.
    pub fn new(mut stream: impl Read + Send + 'static, most: usize) -> io::Result<Self> {
        let (kept, (sender, end)) = (Arc::new(Mutex::new(Vec::new())), channel());
        let shared = Arc::clone(&kept);
        std::thread::Builder::new().spawn(move || {
            let _until_the_end = sender;
            let mut chunk = [0; 4096];
            // A stream that breaks has ended.
            while let Ok(count @ 1..) = stream.read(&mut chunk) {
                let mut kept = shared.lock().unwrap_or_else(PoisonError::into_inner);
                let count = count.min(most.saturating_sub(kept.len()));
                kept.extend(&chunk[..count]);
            }
        })?;
        Ok(Self { kept, end })
    }

    /// The beginning of what was said by a child that has ended.
    pub fn text(&self) -> String {
        // Nothing is ever sent: this ends when the stream does, or in time.
        let _ = self.end.recv_timeout(FAREWELL);
        String::from_utf8_lossy(&self.kept.lock().unwrap_or_else(PoisonError::into_inner)).into_owned()
    }
}
