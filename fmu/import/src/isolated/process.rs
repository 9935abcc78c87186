//! A worker as the host sees it: started, asked, watched and ended.

use std::io;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use super::bounds::WORKER_VERB;
use super::ending::How;
use super::protocol::{Given, Opening, Reply, SPARE, build, frame, longest_answer, unframe};
use crate::logging::LogRecord;
use crate::request::Request;
use videg_system::output::{KeptOutput, Part};
use videg_system::pipes::{Heard, Pipes};
use videg_system::processes::ProcessGroup;

/// Polling interval for the end of a silent worker: a child of it may hold its pipes open.
const LOOK: Duration = Duration::from_millis(100);
/// Time in which a worker that has closed its pipes must end.
const FAREWELL: Duration = Duration::from_secs(1);
/// Bytes kept of the end of what a worker prints.
const KEPT: usize = 2048;

/// A worker. Dropping it ends it, together with what it started and did not send away.
pub(super) struct Process {
    group: ProcessGroup,
    pipes: Pipes,
    /// What it sent and nobody has read yet.
    heard: Vec<u8>,
    /// How many calls there were.
    calls: u64,
    printed: KeptOutput,
}

impl Process {
    /// Starts a worker in `folder`.
    pub fn start(program: &Path, folder: &Path) -> io::Result<Self> {
        let mut command = Command::new(program);
        command.arg(WORKER_VERB).current_dir(folder);
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut group = ProcessGroup::start(&mut command)?;
        let child = &mut group.child;
        let stderr = child.stderr.take().ok_or_else(|| io::Error::other("no pipe"))?;
        let printed = KeptOutput::new(stderr, Part::End(KEPT))?;
        let pipes = Pipes::of(child)?;
        Ok(Self { group, pipes, heard: Vec::new(), calls: 0, printed })
    }

    /// Tells the worker what it is for and returns what it says to that. After an error the worker is gone.
    pub fn open(&mut self, opening: &Opening, limit: Option<Duration>) -> Result<Reply, How> {
        let framed = frame(&build()).and_then(|first| Ok([first, frame(opening)?].concat()));
        self.ask(framed, SPARE, &mut Deadline::after(limit), |_| ())
    }

    /// Has a call carried out, which must be done within `limit`; its status, and what else it gave. `log` gets the
    /// records on the way. After an error the worker is gone.
    pub fn call(
        &mut self,
        request: &Request<'_>,
        limit: Option<Duration>,
        log: impl FnMut(LogRecord),
    ) -> Result<(i32, Given), How> {
        self.calls += 1;
        let framed = frame(&(self.calls, request));
        match self.ask(framed, longest_answer(request), &mut Deadline::after(limit), log)? {
            Reply::Done { call, status, given } if call == self.calls => Ok((status, given)),
            Reply::Done { call, .. } => {
                Err(self.end(How::Garbled(format!("the answer to call {call} in answer to call {}", self.calls))))
            }
            other => Err(self.end(How::Garbled(format!("{} in answer to a call", other.name())))),
        }
    }

    fn ask(
        &mut self,
        framed: io::Result<Vec<u8>>,
        longest: usize,
        deadline: &mut Deadline,
        mut log: impl FnMut(LogRecord),
    ) -> Result<Reply, How> {
        let bytes = framed.map_err(|cause| How::Refused(cause.to_string())).map_err(|how| self.end(how))?;
        self.send(&bytes, deadline).map_err(|how| self.end(how))?;
        loop {
            match self.next(deadline, longest) {
                Ok(Reply::Log(record)) => log(record),
                Ok(answer) => return Ok(answer),
                Err(how) => return Err(self.end(how)),
            }
        }
    }

    fn send(&mut self, mut bytes: &[u8], deadline: &mut Deadline) -> Result<(), How> {
        while !bytes.is_empty() {
            match self.pipes.write(bytes, deadline.wait()?) {
                Ok(0) if self.has_ended()? => return Ok(()),
                Ok(count) => bytes = &bytes[count..],
                // It is gone, and has said why: see what it sent last.
                Err(_) => return Ok(()),
            }
        }
        Ok(())
    }

    fn next(&mut self, deadline: &mut Deadline, longest: usize) -> Result<Reply, How> {
        loop {
            if let Some(message) = self.heard(longest)? {
                return Ok(message);
            }
            match self.pipes.read(&mut self.heard, deadline.wait()?) {
                Ok(Heard::Nothing) if self.has_ended()? => {
                    // It may have answered after that look at the pipe, and ended before the look at it.
                    let _ = self.pipes.read(&mut self.heard, Duration::ZERO);
                    let last = self.heard(longest)?;
                    return last.map_or_else(|| Err(self.ended()), Ok);
                }
                Ok(Heard::Something | Heard::Nothing) => {}
                Ok(Heard::End) => return Err(How::Silent),
                Err(cause) => return Err(How::Refused(cause.to_string())),
            }
        }
    }

    /// The next message, if it is complete.
    fn heard(&mut self, longest: usize) -> Result<Option<Reply>, How> {
        // Log records come with any call.
        unframe(&mut self.heard, longest.max(SPARE)).map_err(|cause| How::Garbled(cause.to_string()))
    }

    fn has_ended(&mut self) -> Result<bool, How> {
        self.group.has_ended().map_err(|cause| How::Refused(cause.to_string()))
    }

    /// Ends it; what became of it is `how`, or its own end where that comes first.
    fn end(&mut self, how: How) -> How {
        if matches!(how, How::Silent) && matches!(self.group.wait(Some(FAREWELL)), Ok(true)) {
            return self.ended();
        }
        let _ = self.group.end();
        how
    }

    /// Its own end, and that of its group.
    fn ended(&mut self) -> How {
        self.group.end().map_or_else(|cause| How::Refused(cause.to_string()), How::Ended)
    }

    /// The end of what it printed.
    pub fn printed(&self) -> String {
        self.printed.text()
    }
}

/// The time at which a worker must have answered.
struct Deadline {
    end: Option<Instant>,
    is_past: bool,
}

impl Deadline {
    fn after(limit: Option<Duration>) -> Self {
        Self { end: limit.and_then(|limit| Instant::now().checked_add(limit)), is_past: false }
    }

    /// How long to wait before the next look. There is one look after the end: the answer may have come while this
    /// process was stopped.
    fn wait(&mut self) -> Result<Duration, How> {
        let Some(end) = self.end else { return Ok(LOOK) };
        let left = end.saturating_duration_since(Instant::now());
        if left.is_zero() && std::mem::replace(&mut self.is_past, true) {
            return Err(How::TooLong);
        }
        Ok(left.min(LOOK))
    }
}

#[cfg(test)]
#[cfg(unix)]
mod tests {
    use std::os::unix::fs::PermissionsExt as _;

    use super::*;

    /// A worker that says `bytes`, does `what`, and ends.
    fn worker(bytes: &[u8], what: &str) -> (tempfile::TempDir, Process) {
        let folder = tempfile::tempdir().unwrap();
        let (said, program) = (folder.path().join("said"), folder.path().join("worker"));
        std::fs::write(&said, bytes).unwrap();
        std::fs::write(&program, format!("#!/bin/sh\ncat '{}'\n{what}\n", said.display())).unwrap();
        std::fs::set_permissions(&program, std::fs::Permissions::from_mode(0o755)).unwrap();
        let process = Process::start(&program, folder.path()).unwrap();
        (folder, process)
    }

    fn done(call: u64, given: Given) -> Vec<u8> {
        frame(&Reply::Done { call, status: 0, given }).unwrap()
    }

    #[test]
    fn an_answer_that_came_in_time_is_heard_by_a_host_that_was_stopped() {
        let (_folder, mut process) = worker(&frame(&Reply::Loaded).unwrap(), "exit 3");
        while !process.has_ended().unwrap() {
            std::thread::sleep(Duration::from_millis(1));
        }
        let mut deadline = Deadline::after(Some(Duration::ZERO));
        assert!(matches!(process.next(&mut deadline, SPARE), Ok(Reply::Loaded)));
        assert!(matches!(process.next(&mut deadline, SPARE), Err(How::TooLong)));
        assert!(matches!(process.ended(), How::Ended(status) if status.code() == Some(3)));
    }

    #[test]
    fn an_answer_to_another_call_is_none() {
        let (_folder, mut process) = worker(&done(7, Given::Nothing), "sleep 100");
        let how = process.call(&Request::Free, None, |_| ()).unwrap_err();
        assert!(matches!(&how, How::Garbled(what) if what == "the answer to call 7 in answer to call 1"), "{how:?}");
    }

    #[test]
    fn an_answer_longer_than_its_call_lets_it_takes_no_memory() {
        let (_folder, mut process) = worker(&done(1, Given::Bytes(vec![0; 1 << 20])), "sleep 100");
        let how = process.call(&Request::Free, None, |_| ()).unwrap_err();
        assert!(matches!(&how, How::Garbled(what) if what.ends_with("allowed are 65536")), "{how:?}");
        assert!(process.heard.len() < 4 * SPARE, "{} bytes are kept", process.heard.len());
    }
}
