//! The process of an isolated FMU as the host asks it.

use std::io;
use std::path::Path;
use std::process::Command;
use std::time::Duration;

use super::bounds::WORKER_VERB;
use super::protocol::{Given, Opening, Reply, SPARE, build, longest_answer};
use crate::logging::LogRecord;
use crate::request::Request;
use videg_system::output::Part;
use videg_system::worker::{Deadline, End, Worker};

/// Bytes kept of the end of what a worker prints.
const KEPT: usize = 2048;

/// A worker with the number of calls that there were.
pub(super) struct Process {
    worker: Worker,
    calls: u64,
}

impl Process {
    /// Starts a worker in `folder`.
    pub fn start(program: &Path, folder: &Path) -> io::Result<Self> {
        let mut command = Command::new(program);
        command.arg(WORKER_VERB).current_dir(folder);
        Ok(Self { worker: Worker::start(&mut command, Part::End(KEPT))?, calls: 0 })
    }

    /// Tells the worker what it is for and returns what it says to that. After an error the worker is gone.
    pub fn open(&mut self, opening: &Opening, limit: Option<Duration>) -> Result<Reply, End> {
        let mut deadline = Deadline::after(limit);
        self.worker.send(&build(), &mut deadline)?;
        self.worker.send(opening, &mut deadline)?;
        self.worker.receive(SPARE, &mut deadline)
    }

    /// Has a call carried out, which must be done within `limit`; its status, and what else it gave. `log` gets the
    /// records on the way. After an error the worker is gone.
    pub fn call(
        &mut self,
        request: &Request<'_>,
        limit: Option<Duration>,
        mut log: impl FnMut(LogRecord),
    ) -> Result<(i32, Given), End> {
        self.calls += 1;
        let mut deadline = Deadline::after(limit);
        self.worker.send(&(self.calls, request), &mut deadline)?;
        // Log records come with any call.
        let longest = longest_answer(request).max(SPARE);
        let garbled = loop {
            match self.worker.receive(longest, &mut deadline)? {
                Reply::Log(record) => log(record),
                Reply::Done { call, status, given } if call == self.calls => return Ok((status, given)),
                Reply::Done { call, .. } => {
                    break format!("the answer to call {call} in answer to call {}", self.calls);
                }
                other => break format!("{} in answer to a call", other.name()),
            }
        };
        Err(self.worker.end(End::Garbled(garbled)))
    }

    /// The end of what it printed.
    pub fn printed(&self) -> String {
        self.worker.printed()
    }
}

#[cfg(test)]
#[cfg(unix)]
mod tests {
    use std::os::unix::fs::PermissionsExt as _;

    use videg_system::messages::frame;

    use super::*;

    /// A worker that says `reply` and sleeps.
    fn worker(reply: &Reply) -> (tempfile::TempDir, Process) {
        let folder = tempfile::tempdir().unwrap();
        let program = folder.path().join("worker");
        std::fs::write(folder.path().join("said"), frame(reply).unwrap()).unwrap();
        std::fs::write(&program, "#!/bin/sh\ncat said\nsleep 100\n").unwrap();
        std::fs::set_permissions(&program, std::fs::Permissions::from_mode(0o755)).unwrap();
        let process = Process::start(&program, folder.path()).unwrap();
        (folder, process)
    }

    #[test]
    fn an_answer_to_another_call_or_one_longer_than_its_call_lets_it_is_none() {
        for (call, given, expected) in [
            (7, Given::Nothing, "the answer to call 7 in answer to call 1"),
            (1, Given::Bytes(vec![0; 1 << 20]), "allowed are 65536"),
        ] {
            let (_folder, mut process) = worker(&Reply::Done { call, status: 0, given });
            let end = process.call(&Request::Free, None, |_| ()).unwrap_err();
            assert!(matches!(&end, End::Garbled(what) if what.ends_with(expected)), "{end:?}");
        }
        let (_folder, mut process) = worker(&Reply::Loaded);
        let end = process.call(&Request::Free, None, |_| ()).unwrap_err();
        assert!(matches!(&end, End::Garbled(what) if what.starts_with("that the library is loaded")), "{end:?}");
    }
}
