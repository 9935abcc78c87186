//! The master's side: starts the worker, sends and receives a message each communication step, and ends it.

use std::io::{self, BufReader, BufWriter};
use std::path::{Path, PathBuf};
use std::process::{ChildStdin, ChildStdout, Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};
use std::time::{Duration, Instant};

use thiserror::Error;

use super::protocol::{Job, Ramp, Reply, receive, send};
use videg_system::output::{KeptOutput, Part};
use videg_system::processes::ProcessGroup;
use videg_system::temporary::TemporaryFolder;

/// Verb of the command-line tool that runs the worker.
pub const WORKER_VERB: &str = "ngspice-worker";
/// Bytes of the worker's stderr that are kept.
const KEPT_STDERR: usize = 4096;

/// Why ngspice does not go on.
#[derive(Debug, Error)]
#[allow(missing_docs, reason = "the message of each variant names its fields")]
pub enum LiveError {
    /// The worker cannot be started.
    #[error("cannot start {} {WORKER_VERB}: {cause}", program.display())]
    Start { program: PathBuf, cause: io::Error },
    /// ngspice, or the library itself, is at fault; in its words.
    #[error("{0}")]
    Failure(String),
    /// The worker died.
    #[error("the process of ngspice ended between {from} s and {to} s ({how}){said}")]
    Died { from: f64, to: f64, how: String, said: String },
    /// The worker does not answer.
    #[error("ngspice did not get from {from} s to {to} s within {} s", limit.as_secs_f64())]
    TimeLimit { from: f64, to: f64, limit: Duration },
}

/// A running worker.
pub struct Worker {
    group: ProcessGroup,
    requests: BufWriter<ChildStdin>,
    replies: Receiver<io::Result<Option<Reply>>>,
    stderr: KeptOutput,
    limit: Duration,
    vectors: usize,
    /// Working folder and home of the worker: no start-up file of ngspice lies there.
    _folder: TemporaryFolder,
}

impl Worker {
    /// Starts `program` as a worker for `job`. Each communication step may take `limit` of real time.
    ///
    /// # Errors
    /// If the program cannot be started.
    pub fn start(program: &Path, job: &Job, limit: Duration) -> Result<Self, LiveError> {
        let fail = |cause| LiveError::Start { program: program.to_owned(), cause };
        let folder = TemporaryFolder::new("videg-ngspice-").map_err(fail)?;
        let mut command = Command::new(program);
        command
            .arg(WORKER_VERB)
            .current_dir(folder.path())
            .env("HOME", folder.path())
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped());
        let mut group = ProcessGroup::start(&mut command).map_err(fail)?;
        let child = &mut group.child;
        let missing = || fail(io::Error::other("no pipe"));
        let requests = BufWriter::new(child.stdin.take().ok_or_else(missing)?);
        let replies = read_replies(child.stdout.take().ok_or_else(missing)?).map_err(fail)?;
        let stderr =
            KeptOutput::new(child.stderr.take().ok_or_else(missing)?, Part::Beginning(KEPT_STDERR)).map_err(fail)?;
        let vectors = job.vectors.len();
        let mut worker = Self { group, requests, replies, stderr, limit, vectors, _folder: folder };
        // A worker that is gone already is found out by the first step.
        let _ = send(&mut worker.requests, job);
        Ok(worker)
    }

    /// Runs ngspice over a communication step; `point` gets the time, s, and the job's vectors at each time point that it
    /// accepts on the way.
    ///
    /// # Errors
    /// If ngspice gives up, dies or takes too long.
    pub fn step(&mut self, ramp: &Ramp, mut point: impl FnMut(f64, &[f64])) -> Result<(), LiveError> {
        let (from, to) = (ramp.from, ramp.to);
        // A worker that has died says why in its last reply, so that is read even if the request does not get through.
        let _ = send(&mut self.requests, ramp);
        let begun = Instant::now();
        loop {
            // The limit is for the step: a worker that creeps sends points now and then.
            match self.replies.recv_timeout(self.limit.saturating_sub(begun.elapsed())) {
                Ok(Ok(Some(Reply::Points(values)))) => {
                    for row in values.chunks_exact(1 + self.vectors) {
                        point(row[0], &row[1..]);
                    }
                }
                Ok(Ok(Some(Reply::Reached))) => return Ok(()),
                Ok(Ok(Some(Reply::Failure(text)))) => return Err(LiveError::Failure(text)),
                Err(RecvTimeoutError::Timeout) => return Err(LiveError::TimeLimit { from, to, limit: self.limit }),
                _ => return Err(self.died(from, to)),
            }
        }
    }

    fn died(&mut self, from: f64, to: f64) -> LiveError {
        // It has closed its stdout, but may still be about to end.
        let how = self.group.end().map_or_else(|cause| cause.to_string(), |status| status.to_string());
        let said = self.stderr.text();
        let said = said.trim().lines().fold(String::new(), |all, line| all + ": " + line);
        LiveError::Died { from, to, how, said }
    }
}

/// Reads replies in a thread of its own, because a pipe cannot be read with a time limit. At most one waits.
fn read_replies(stdout: ChildStdout) -> io::Result<Receiver<io::Result<Option<Reply>>>> {
    let (sender, receiver) = sync_channel(1);
    std::thread::Builder::new().spawn(move || {
        let mut reader = BufReader::new(stdout);
        loop {
            let reply = receive(&mut reader);
            let last = !matches!(reply, Ok(Some(_)));
            if sender.send(reply).is_err() || last {
                break;
            }
        }
    })?;
    Ok(receiver)
}
