//! A child process that answers requests, each in time, as its host sees it: started, asked, watched and ended; and the
//! requests as the child sees them. Messages travel over its stdin and stdout.

use std::fs::File;
use std::io::{self, BufReader};
use std::process::{Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

use serde::{Serialize, de::DeserializeOwned};

use crate::messages::{self, frame, take};
use crate::output::{KeptOutput, Part};
use crate::pipes::{Heard, Pipes, watch};
use crate::processes::ProcessGroup;
use crate::streams::{take_stdin, take_stdout};

/// Polling interval for the end of a silent worker: a child of it may hold its pipes open.
const LOOK: Duration = Duration::from_millis(100);
/// Time in which a worker that has closed its pipes must end.
const FAREWELL: Duration = Duration::from_secs(1);

/// A worker. Dropping it ends it, together with what it started and did not send away.
#[derive(Debug)]
pub struct Worker {
    group: ProcessGroup,
    pipes: Pipes,
    /// What it sent and nobody has read yet.
    heard: Vec<u8>,
    printed: KeptOutput,
}

/// Why a worker ended.
#[derive(Debug, Clone)]
pub enum End {
    /// Its process ended.
    Ended(ExitStatus),
    /// An answer took longer than it may.
    TooLong,
    /// It closed its pipes, but its process goes on.
    Silent,
    /// It sent something that is no answer.
    Garbled(String),
    /// The system refused something.
    Refused(String),
}

impl Worker {
    /// Starts `command` as a worker; `kept` of its stderr is kept.
    ///
    /// # Errors
    /// If the system refuses.
    pub fn start(command: &mut Command, kept: Part) -> io::Result<Self> {
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut group = ProcessGroup::start(command)?;
        let child = &mut group.child;
        let stderr = child.stderr.take().ok_or_else(|| io::Error::other("no pipe"))?;
        let printed = KeptOutput::new(stderr, kept)?;
        let pipes = Pipes::of(child)?;
        Ok(Self { group, pipes, heard: Vec::new(), printed })
    }

    /// Sends a request.
    ///
    /// # Errors
    /// If the worker does not take it in time: then it is gone. One that has ended has said why in its last answer.
    pub fn send(&mut self, request: &impl Serialize, deadline: &mut Deadline) -> Result<(), End> {
        self.write(request, deadline).map_err(|end| self.end(end))
    }

    /// The next answer, of at most `longest` bytes.
    ///
    /// # Errors
    /// If none comes in time, or something else: then the worker is gone.
    pub fn receive<T: DeserializeOwned>(&mut self, longest: usize, deadline: &mut Deadline) -> Result<T, End> {
        self.next(longest, deadline).map_err(|end| self.end(end))
    }

    fn write(&mut self, request: &impl Serialize, deadline: &mut Deadline) -> Result<(), End> {
        let framed = frame(request).map_err(|cause| refused(&cause))?;
        let mut rest = framed.as_slice();
        while !rest.is_empty() {
            match self.pipes.write(rest, deadline.wait()?) {
                Ok(0) if self.has_ended()? => return Ok(()),
                Ok(count) => rest = &rest[count..],
                // It is gone, and has said why: see what it sent last.
                Err(_) => return Ok(()),
            }
        }
        Ok(())
    }

    fn next<T: DeserializeOwned>(&mut self, longest: usize, deadline: &mut Deadline) -> Result<T, End> {
        loop {
            if let Some(answer) = self.heard(longest)? {
                return Ok(answer);
            }
            match self.pipes.read(&mut self.heard, deadline.wait()?) {
                Ok(Heard::Nothing) if self.has_ended()? => {
                    // It may have answered after that look at the pipe, and ended before the look at it.
                    let _ = self.pipes.read(&mut self.heard, Duration::ZERO);
                    let last = self.heard(longest)?;
                    return last.map_or_else(|| Err(self.ended()), Ok);
                }
                Ok(Heard::Something | Heard::Nothing) => {}
                Ok(Heard::End) => return Err(End::Silent),
                Err(cause) => return Err(refused(&cause)),
            }
        }
    }

    /// The next answer, if it is complete.
    fn heard<T: DeserializeOwned>(&mut self, longest: usize) -> Result<Option<T>, End> {
        take(&mut self.heard, longest).map_err(|cause| End::Garbled(cause.to_string()))
    }

    fn has_ended(&mut self) -> Result<bool, End> {
        self.group.has_ended().map_err(|cause| refused(&cause))
    }

    /// Ends it; what became of it is `end`, or its own end where that comes first.
    pub fn end(&mut self, end: End) -> End {
        if matches!(end, End::Silent) && matches!(self.group.wait(Some(FAREWELL)), Ok(true)) {
            return self.ended();
        }
        let _ = self.group.end();
        end
    }

    /// Its own end, and that of its group.
    fn ended(&mut self) -> End {
        self.group.end().map_or_else(|cause| refused(&cause), End::Ended)
    }

    /// What is kept of its stderr, once it has ended.
    pub fn printed(&self) -> String {
        self.printed.text()
    }
}

fn refused(cause: &io::Error) -> End {
    End::Refused(cause.to_string())
}

/// The time at which a worker must have answered.
#[derive(Debug)]
pub struct Deadline {
    end: Option<Instant>,
    is_past: bool,
}

impl Deadline {
    /// From now on `limit`; none: any time.
    pub fn after(limit: Option<Duration>) -> Self {
        Self { end: limit.and_then(|limit| Instant::now().checked_add(limit)), is_past: false }
    }

    /// How long to wait before the next look. There is one look after the end: the answer may have come while this
    /// process was stopped.
    fn wait(&mut self) -> Result<Duration, End> {
        let Some(end) = self.end else { return Ok(LOOK) };
        let left = end.saturating_duration_since(Instant::now());
        if left.is_zero() && std::mem::replace(&mut self.is_past, true) {
            return Err(End::TooLong);
        }
        Ok(left.min(LOOK))
    }
}

/// The requests to this process, which is the worker.
#[derive(Debug)]
pub struct Requests(BufReader<File>);

/// Takes stdin and stdout of this process for requests and replies alone: what else reads finds nothing, and what else writes, writes
/// to stderr.
///
/// # Errors
/// If the system refuses, or one is closed.
pub fn take_streams() -> io::Result<(Requests, File)> {
    let failed = |what: &'static str| {
        move |cause: io::Error| io::Error::new(cause.kind(), format!("cannot take {what}: {cause}"))
    };
    let requests = take_stdin().map_err(failed("stdin for the requests"))?;
    Ok((Requests(BufReader::new(requests)), take_stdout().map_err(failed("stdout for the replies"))?))
}

impl Requests {
    /// The next one; none if the host has closed.
    ///
    /// # Errors
    /// If it cannot be read, or is none.
    pub fn receive<T: DeserializeOwned>(&mut self) -> io::Result<Option<T>> {
        if self.0.buffer().is_empty() {
            watch(self.0.get_ref(), Duration::MAX);
        }
        messages::receive(&mut self.0)
    }
}

#[cfg(test)]
#[cfg(unix)]
mod tests {
    use super::*;

    /// A worker that says `bytes`, does `what`, and ends.
    fn worker(bytes: &[u8], what: &str) -> (tempfile::TempDir, Worker) {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("said"), bytes).unwrap();
        let mut command = Command::new("sh");
        command.args(["-c", &format!("cat said\n{what}")]).current_dir(folder.path());
        let worker = Worker::start(&mut command, Part::End(64)).unwrap();
        (folder, worker)
    }

    const SECONDS: Option<Duration> = Some(Duration::from_secs(60));

    fn answer<T: DeserializeOwned>(worker: &mut Worker, limit: Option<Duration>) -> Result<T, End> {
        worker.receive(1000, &mut Deadline::after(limit))
    }

    #[test]
    fn an_answer_that_came_in_time_is_heard_by_a_host_that_was_stopped() {
        let (_folder, mut worker) = worker(&frame(&7).unwrap(), "exit 3");
        while !worker.has_ended().unwrap() {
            std::thread::sleep(Duration::from_millis(1));
        }
        let mut deadline = Deadline::after(Some(Duration::ZERO));
        assert!(matches!(worker.next(1000, &mut deadline), Ok(7)));
        assert!(matches!(worker.next::<i32>(1000, &mut deadline), Err(End::TooLong)));
        assert!(matches!(worker.ended(), End::Ended(status) if status.code() == Some(3)));
    }

    #[test]
    fn each_end_has_its_reason() {
        let (_folder, mut one) = worker(&frame(&1.5).unwrap(), "echo oh no >&2; exit 3");
        assert!(matches!(answer(&mut one, SECONDS), Ok(1.5)));
        let end = answer::<f64>(&mut one, SECONDS).unwrap_err();
        assert!(matches!(end, End::Ended(status) if status.code() == Some(3)), "{end:?}");
        assert_eq!(one.printed(), "oh no\n");

        let (_folder, mut one) = worker(b"", "sleep 1000");
        let end = answer::<f64>(&mut one, Some(Duration::from_millis(1))).unwrap_err();
        assert!(matches!(end, End::TooLong), "{end:?}");
        // More than a pipe holds, and nobody reads.
        let (_folder, mut one) = worker(b"", "sleep 1000");
        let end = one.send(&vec![0_u8; 1 << 20], &mut Deadline::after(Some(Duration::from_millis(1)))).unwrap_err();
        assert!(matches!(end, End::TooLong), "{end:?}");

        let (_folder, mut one) = worker(b"", "exec 1>&-; sleep 1000");
        let end = answer::<f64>(&mut one, SECONDS).unwrap_err();
        assert!(matches!(end, End::Silent), "{end:?}");

        // Half an answer.
        let (_folder, mut one) = worker(&frame(&1.5).unwrap()[..7], "exit 5");
        let end = answer::<f64>(&mut one, SECONDS).unwrap_err();
        assert!(matches!(end, End::Ended(status) if status.code() == Some(5)), "{end:?}");

        // A child of it holds its pipes.
        let (_folder, mut one) = worker(b"", "sleep 1000 & exit 4");
        let end = answer::<f64>(&mut one, SECONDS).unwrap_err();
        assert!(matches!(end, End::Ended(status) if status.code() == Some(4)), "{end:?}");
    }

    #[test]
    fn an_answer_longer_than_allowed_takes_no_memory() {
        let (_folder, mut worker) = worker(&frame(&vec![0_u8; 1 << 20]).unwrap(), "sleep 1000");
        let end = answer::<Vec<u8>>(&mut worker, SECONDS).unwrap_err();
        assert!(matches!(&end, End::Garbled(what) if what.ends_with("allowed are 1000")), "{end:?}");
        assert!(worker.heard.len() < 1 << 18, "{} bytes are kept", worker.heard.len());
    }
}
