//! The pipes to a worker, written and read with a limit on waiting: it may neither read nor write any more.

use std::io;
use std::process::{ChildStdin, ChildStdout};
use std::time::Duration;

pub(super) use ends::Pipes;

/// Result of waiting for bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Heard {
    /// Some have come.
    Something,
    /// None have come yet.
    Nothing,
    /// The other side has closed.
    End,
}

/// Bytes that are read at once.
const CHUNK: usize = 1 << 16;

#[cfg(unix)]
mod ends {
    use std::io::{ErrorKind, Read as _, Write as _};
    use std::os::fd::AsFd;

    use rustix::event::{PollFd, PollFlags, Timespec, poll};

    use super::{CHUNK, ChildStdin, ChildStdout, Duration, Heard, io};

    /// Both pipes.
    pub struct Pipes {
        requests: ChildStdin,
        replies: ChildStdout,
        chunk: Box<[u8]>,
    }

    impl Pipes {
        /// Takes over the pipes of a child.
        pub fn new(requests: ChildStdin, replies: ChildStdout) -> io::Result<Self> {
            // These are the ends of this process alone: those of the worker go on to block.
            rustix::io::ioctl_fionbio(&requests, true)?;
            rustix::io::ioctl_fionbio(&replies, true)?;
            Ok(Self { requests, replies, chunk: vec![0; CHUNK].into() })
        }

        /// Writes the beginning of `bytes`, waiting at most `wait`; says how many.
        pub fn write(&mut self, bytes: &[u8], wait: Duration) -> io::Result<usize> {
            match self.requests.write(bytes) {
                Err(cause) if cause.kind() == ErrorKind::WouldBlock => {
                    is_ready(&self.requests, PollFlags::OUT, wait)?;
                    Ok(0)
                }
                Err(cause) if cause.kind() == ErrorKind::Interrupted => Ok(0),
                result => result,
            }
        }

        /// Appends what has come to `bytes`, waiting at most `wait`.
        pub fn read(&mut self, bytes: &mut Vec<u8>, wait: Duration) -> io::Result<Heard> {
            if !is_ready(&self.replies, PollFlags::IN, wait)? {
                return Ok(Heard::Nothing);
            }
            match self.replies.read(&mut self.chunk) {
                Ok(0) => Ok(Heard::End),
                Ok(count) => {
                    bytes.extend_from_slice(&self.chunk[..count]);
                    Ok(Heard::Something)
                }
                Err(cause) if matches!(cause.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted) => {
                    Ok(Heard::Nothing)
                }
                Err(cause) => Err(cause),
            }
        }
    }

    /// Waits until there is something to do, or the other side has closed.
    fn is_ready(end: &impl AsFd, what: PollFlags, wait: Duration) -> io::Result<bool> {
        let wait = Timespec::try_from(wait).map_err(io::Error::other)?;
        match poll(&mut [PollFd::new(end, what)], Some(&wait)) {
            Ok(count) => Ok(count > 0),
            Err(rustix::io::Errno::INTR) => Ok(false),
            Err(cause) => Err(cause.into()),
        }
    }
}

/// Elsewhere a thread reads, and requests are written without a limit: they are short, and the worker reads them all.
#[cfg(not(unix))]
mod ends {
    use std::io::{Read as _, Write as _};
    use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};

    use super::{CHUNK, ChildStdin, ChildStdout, Duration, Heard, io};

    /// Both pipes.
    pub struct Pipes {
        requests: ChildStdin,
        replies: Receiver<Vec<u8>>,
    }

    impl Pipes {
        pub fn new(requests: ChildStdin, mut replies: ChildStdout) -> io::Result<Self> {
            let (sender, receiver) = sync_channel(1);
            std::thread::Builder::new().spawn(move || {
                let mut chunk = vec![0; CHUNK];
                while let Ok(count @ 1..) = replies.read(&mut chunk) {
                    if sender.send(chunk[..count].to_vec()).is_err() {
                        break;
                    }
                }
            })?;
            Ok(Self { requests, replies: receiver })
        }

        pub fn write(&mut self, bytes: &[u8], _: Duration) -> io::Result<usize> {
            self.requests.write(bytes)
        }

        pub fn read(&mut self, bytes: &mut Vec<u8>, wait: Duration) -> io::Result<Heard> {
            match self.replies.recv_timeout(wait) {
                Ok(chunk) => {
                    bytes.extend_from_slice(&chunk);
                    Ok(Heard::Something)
                }
                Err(RecvTimeoutError::Timeout) => Ok(Heard::Nothing),
                Err(RecvTimeoutError::Disconnected) => Ok(Heard::End),
            }
        }
    }
}
