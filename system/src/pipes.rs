//! The pipes to a child, written and read with a limit on waiting: it may neither read nor write any more.

use std::io;
use std::process::{Child, ChildStdin, ChildStdout};
use std::time::Duration;

pub use ends::{Pipes, watch};

/// Result of waiting for bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Heard {
    /// Some have come.
    Something,
    /// None have come yet.
    Nothing,
    /// The other side has closed.
    End,
}

impl Pipes {
    /// Takes stdin and stdout of a child, which must be pipes.
    ///
    /// # Errors
    /// If one is no pipe, or the system refuses.
    pub fn of(child: &mut Child) -> io::Result<Self> {
        let missing = || io::Error::other("no pipe");
        Self::new(child.stdin.take().ok_or_else(missing)?, child.stdout.take().ok_or_else(missing)?)
    }
}

/// Bytes that are read at once.
const CHUNK: usize = 1 << 16;
/// Longest time that either side waits without sleeping: most calls of an FMU, and most steps of a host, take less.
#[cfg(unix)]
const WATCH: Duration = Duration::from_micros(200);

#[cfg(unix)]
mod ends {
    use std::io::{ErrorKind, Read as _, Write as _};
    use std::os::fd::AsFd;
    use std::time::Instant;

    use rustix::event::{PollFd, PollFlags, Timespec, poll};

    use super::{CHUNK, ChildStdin, ChildStdout, Duration, Heard, WATCH, io};

    /// Both pipes.
    #[derive(Debug)]
    pub struct Pipes {
        requests: ChildStdin,
        replies: ChildStdout,
        chunk: Box<[u8]>,
    }

    impl Pipes {
        pub(super) fn new(requests: ChildStdin, replies: ChildStdout) -> io::Result<Self> {
            // These are the ends of this process alone: those of the child go on to block.
            rustix::io::ioctl_fionbio(&requests, true)?;
            rustix::io::ioctl_fionbio(&replies, true)?;
            Ok(Self { requests, replies, chunk: vec![0; CHUNK].into() })
        }

        /// Writes the beginning of `bytes`, waiting at most `wait`; says how many.
        ///
        /// # Errors
        /// If the child has closed the pipe.
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

        /// Appends what has come to `bytes`, waiting at most `wait`, and before that a little without sleeping.
        ///
        /// # Errors
        /// If the pipe cannot be read.
        pub fn read(&mut self, bytes: &mut Vec<u8>, wait: Duration) -> io::Result<Heard> {
            watch(&self.replies, wait);
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

    /// Looks for bytes at an `end` of a pipe for at most `wait` and at most [`WATCH`] without sleeping, because a processor that
    /// sleeps takes tens of microseconds to wake. The processor is offered to other processes in between.
    pub fn watch(end: &impl AsFd, wait: Duration) {
        let (start, wait) = (Instant::now(), wait.min(WATCH));
        while start.elapsed() < wait && matches!(is_ready(end, PollFlags::IN, Duration::ZERO), Ok(false)) {
            std::thread::yield_now();
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

    /// Nothing: whoever reads from a pipe waits for it asleep.
    pub fn watch<T>(_: &T, _: Duration) {}

    /// Both pipes.
    #[derive(Debug)]
    pub struct Pipes {
        requests: ChildStdin,
        replies: Receiver<Vec<u8>>,
    }

    impl Pipes {
        pub(super) fn new(requests: ChildStdin, mut replies: ChildStdout) -> io::Result<Self> {
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

        /// Writes the beginning of `bytes`, waiting at most `wait`; says how many.
        ///
        /// # Errors
        /// If the child has closed the pipe.
        pub fn write(&mut self, bytes: &[u8], _: Duration) -> io::Result<usize> {
            self.requests.write(bytes)
        }

        /// Appends what has come to `bytes`, waiting at most `wait`.
        ///
        /// # Errors
        /// If the pipe cannot be read.
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

#[cfg(test)]
#[cfg(unix)]
mod tests {
    use std::process::{Command, Stdio};

    use super::*;
    use crate::processes::ProcessGroup;

    /// A child that does what `script` says.
    fn child(script: &str) -> (ProcessGroup, Pipes) {
        let mut command = Command::new("sh");
        command.args(["-c", script]).stdin(Stdio::piped()).stdout(Stdio::piped());
        let mut group = ProcessGroup::start(&mut command).unwrap();
        let pipes = Pipes::of(&mut group.child).unwrap();
        (group, pipes)
    }

    const LONG: Duration = Duration::from_secs(60);
    const SHORT: Duration = Duration::from_millis(10);

    #[test]
    fn what_is_written_is_read_to_the_end() {
        let (_group, mut pipes) = child("head -c 6");
        let mut bytes = Vec::new();
        assert_eq!(pipes.read(&mut bytes, SHORT).unwrap(), Heard::Nothing);
        for part in ["one", "two"] {
            assert_eq!(pipes.write(part.as_bytes(), LONG).unwrap(), 3);
        }
        while pipes.read(&mut bytes, LONG).unwrap() == Heard::Something {}
        assert_eq!(bytes, b"onetwo");
        assert_eq!(pipes.read(&mut bytes, LONG).unwrap(), Heard::End);
    }

    #[test]
    fn a_child_that_does_not_read_takes_no_more_than_the_time_allowed() {
        let (_group, mut pipes) = child("sleep 1000");
        let bytes = vec![0; 1 << 16];
        while pipes.write(&bytes, SHORT).unwrap() > 0 {}
        let (_group, mut pipes) = child("exec 0<&-; echo closed; sleep 1000");
        assert_eq!(pipes.read(&mut Vec::new(), LONG).unwrap(), Heard::Something);
        assert!(pipes.write(&bytes, SHORT).is_err());
    }
}
