//! The output of a child on a stream: read to the end, so that the child never waits for a reader; a part is kept.

use std::io::{self, Read};
use std::sync::mpsc::{Receiver, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// Longest wait for the rest when the child has ended: a process that it started and detached may hold the stream open.
const FAREWELL: Duration = Duration::from_secs(1);

/// Which bytes of a stream are kept, at most as many.
#[derive(Debug, Clone, Copy)]
pub enum Part {
    /// Its first.
    Beginning(usize),
    /// Its last.
    End(usize),
}

/// A stream that is being read.
#[derive(Debug)]
pub struct KeptOutput {
    kept: Arc<Mutex<Vec<u8>>>,
    /// Closed at the end of the stream.
    end: Receiver<()>,
}

impl KeptOutput {
    /// Reads `stream` in a thread and keeps `part` of it.
    ///
    /// # Errors
    /// If the thread cannot be started.
    pub fn new(mut stream: impl Read + Send + 'static, part: Part) -> io::Result<Self> {
        let (kept, (sender, end)) = (Arc::new(Mutex::new(Vec::new())), channel());
        let shared = Arc::clone(&kept);
        std::thread::Builder::new().spawn(move || {
            let _until_the_end = sender;
            let mut chunk = [0; 4096];
            // A stream that breaks has ended.
            while let Ok(count @ 1..) = stream.read(&mut chunk) {
                let mut kept = shared.lock().unwrap_or_else(PoisonError::into_inner);
                kept.extend(&chunk[..count]);
                match part {
                    Part::Beginning(most) => kept.truncate(most),
                    Part::End(most) => {
                        let excess = kept.len().saturating_sub(most);
                        kept.drain(..excess);
                    }
                }
            }
        })?;
        Ok(Self { kept, end })
    }

    /// What is kept of a child that has ended.
    pub fn text(&self) -> String {
        // Nothing is ever sent: this ends when the stream does, or in time.
        let _ = self.end.recv_timeout(FAREWELL);
        String::from_utf8_lossy(&self.kept.lock().unwrap_or_else(PoisonError::into_inner)).into_owned()
    }
}
