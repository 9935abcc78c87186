//! The master's side: starts the worker, sends and receives a message each communication step, and ends it.

use std::io;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use serde::Serialize;
use thiserror::Error;

use super::protocol::{Circuit, Job, Ramp, Reply, Request, State, Wanted, line, take};
use videg_system::output::{KeptOutput, Part};
use videg_system::pipes::{Heard, Pipes};
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
    #[error("the process of ngspice ended {when} ({how}){said}")]
    Died { when: String, how: String, said: String },
    /// The worker does not answer.
    #[error("no answer of ngspice {when} within {} s", limit.as_secs_f64())]
    TimeLimit { when: String, limit: Duration },
}

impl LiveError {
    /// The error with a `hint`, where ngspice has ended the analysis.
    #[must_use]
    pub fn with_hint(self, hint: &str) -> Self {
        match self {
            Self::Failure(text) if text.contains("too small") => Self::Failure(text + hint),
            other => other,
        }
    }
}

/// A running worker.
pub struct Worker {
    group: ProcessGroup,
    pipes: Pipes,
    /// What it sent and nobody has read yet.
    heard: Vec<u8>,
    stderr: KeptOutput,
    limit: Duration,
    time: f64,
    /// Working folder and home of the worker: no start-up file of ngspice lies there.
    _folder: TemporaryFolder,
}

impl Worker {
    /// Starts `program` as a worker for `job`. Each reply may take `limit` of real time.
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
        let stderr = child.stderr.take().ok_or_else(|| fail(io::Error::other("no pipe")))?;
        let stderr = KeptOutput::new(stderr, Part::Beginning(KEPT_STDERR)).map_err(fail)?;
        let pipes = Pipes::of(child).map_err(fail)?;
        let mut worker = Self { group, pipes, heard: Vec::new(), stderr, limit, time: 0.0, _folder: folder };
        worker.send(job);
        Ok(worker)
    }

    /// The circuit, as soon as ngspice has read it.
    ///
    /// # Errors
    /// If ngspice does not take the netlist, dies or takes too long; the same for all that follow.
    pub fn circuit(&mut self) -> Result<Circuit, LiveError> {
        match self.receive(0.0)? {
            Reply::Circuit(circuit) => Ok(circuit),
            _ => Err(self.died(0.0)),
        }
    }

    /// Says what is wanted of each communication point, and begins; the state at 0 s.
    pub fn begin(&mut self, wanted: Wanted) -> Result<State, LiveError> {
        self.state(&Request::Wanted(wanted), 0.0)
    }

    /// Runs ngspice over a communication step.
    pub fn step(&mut self, ramp: Ramp) -> Result<State, LiveError> {
        let to = ramp.to;
        let state = self.state(&Request::Ramp(ramp), to)?;
        self.time = to;
        Ok(state)
    }

    /// Energies that the elements took so far, J.
    pub fn energies(&mut self) -> Result<Vec<f64>, LiveError> {
        let time = self.time;
        match self.ask(&Request::Energies, time)? {
            Reply::Energies(energies) => Ok(energies),
            _ => Err(self.died(time)),
        }
    }

    fn state(&mut self, request: &Request, to: f64) -> Result<State, LiveError> {
        match self.ask(request, to)? {
            Reply::Reached(state) => Ok(state),
            _ => Err(self.died(to)),
        }
    }

    fn ask(&mut self, request: &Request, to: f64) -> Result<Reply, LiveError> {
        self.send(request);
        self.receive(to)
    }

    /// Sends a message, if the worker takes it. One that has died says why in its last reply, and one that hangs gives none.
    fn send(&mut self, message: &impl Serialize) {
        let Ok(line) = line(message) else { return };
        let (mut rest, start) = (line.as_slice(), Instant::now());
        while !rest.is_empty() && start.elapsed() < self.limit {
            match self.pipes.write(rest, self.limit.saturating_sub(start.elapsed())) {
                Ok(count) => rest = &rest[count..],
                Err(_) => return,
            }
        }
    }

    /// The next reply, on the way to the time `to`, s.
    fn receive(&mut self, to: f64) -> Result<Reply, LiveError> {
        let start = Instant::now();
        loop {
            match take(&mut self.heard) {
                Ok(Some(Reply::Failure(text))) => return Err(LiveError::Failure(text)),
                Ok(Some(reply)) => return Ok(reply),
                Ok(None) => {}
                Err(_) => return Err(self.died(to)),
            }
            let left = self.limit.saturating_sub(start.elapsed());
            match self.pipes.read(&mut self.heard, left) {
                Ok(Heard::Nothing) if left.is_zero() => {
                    return Err(LiveError::TimeLimit { when: self.when(to), limit: self.limit });
                }
                Ok(Heard::Something | Heard::Nothing) => {}
                Ok(Heard::End) | Err(_) => return Err(self.died(to)),
            }
        }
    }

    fn died(&mut self, to: f64) -> LiveError {
        // It has closed its stdout, but may still be about to end.
        let how = self.group.end().map_or_else(|cause| cause.to_string(), |status| status.to_string());
        let said = self.stderr.text();
        let said = said.trim().lines().fold(String::new(), |all, line| all + ": " + line);
        LiveError::Died { when: self.when(to), how, said }
    }

    fn when(&self, to: f64) -> String {
        if to > 0.0 { format!("between {} s and {to} s", self.time) } else { "about the netlist".to_owned() }
    }
}
