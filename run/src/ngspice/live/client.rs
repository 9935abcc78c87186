//! The master's side: starts the worker, sends and receives a message each communication step, and ends it.

use std::io;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

use thiserror::Error;

use super::protocol::{Circuit, Job, Ramp, Reply, Request, State, Wanted, build};
use videg_system::output::Part;
use videg_system::temporary::TemporaryFolder;
use videg_system::worker::{Deadline, End};

/// Verb of the command-line tool that runs the worker.
pub const WORKER_VERB: &str = "ngspice-worker";
/// Bytes of the worker's stderr that are kept.
const KEPT_STDERR: usize = 4096;
/// Longest reply, bytes: names of as many elements and nodes as a circuit may have.
const LONGEST_REPLY: usize = 1 << 22;

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
    process: videg_system::worker::Worker,
    limit: Duration,
    time: f64,
    /// Working folder and home of the worker: no start-up file of ngspice lies there.
    _folder: TemporaryFolder,
}

impl Worker {
    /// Starts `program` as a worker for `job`. Each request may take `limit` of real time.
    ///
    /// # Errors
    /// If the program cannot be started, or does not take the job.
    pub fn start(program: &Path, job: &Job, limit: Duration) -> Result<Self, LiveError> {
        let fail = |cause| LiveError::Start { program: program.to_owned(), cause };
        let folder = TemporaryFolder::new("videg-ngspice-").map_err(fail)?;
        let mut command = Command::new(program);
        command.arg(WORKER_VERB).current_dir(folder.path()).env("HOME", folder.path());
        let process = videg_system::worker::Worker::start(&mut command, Part::Beginning(KEPT_STDERR)).map_err(fail)?;
        let mut worker = Self { process, limit, time: 0.0, _folder: folder };
        let mut deadline = Deadline::after(Some(limit));
        let sent = worker.process.send(&build(), &mut deadline);
        sent.and_then(|()| worker.process.send(job, &mut deadline)).map_err(|end| worker.lost(end, 0.0))?;
        Ok(worker)
    }

    /// The circuit, as soon as ngspice has read it.
    ///
    /// # Errors
    /// If ngspice does not take the netlist, dies or takes too long; the same for all that follow.
    pub fn circuit(&mut self) -> Result<Circuit, LiveError> {
        match self.receive(&mut Deadline::after(Some(self.limit)), 0.0)? {
            Reply::Circuit(circuit) => Ok(circuit),
            _ => Err(self.garbled(0.0)),
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
            Reply::Energies(energies) if energies.iter().all(|energy| energy.is_finite()) => Ok(energies),
            Reply::Energies(_) => Err(self.overflow(time)),
            _ => Err(self.garbled(time)),
        }
    }

    fn state(&mut self, request: &Request, to: f64) -> Result<State, LiveError> {
        match self.ask(request, to)? {
            Reply::Reached(state) if state.is_finite() => Ok(state),
            Reply::Reached(_) => Err(self.overflow(to)),
            _ => Err(self.garbled(to)),
        }
    }

    /// The reply to a request on the way to the time `to`, s.
    fn ask(&mut self, request: &Request, to: f64) -> Result<Reply, LiveError> {
        let mut deadline = Deadline::after(Some(self.limit));
        self.process.send(request, &mut deadline).map_err(|end| self.lost(end, to))?;
        self.receive(&mut deadline, to)
    }

    fn receive(&mut self, deadline: &mut Deadline, to: f64) -> Result<Reply, LiveError> {
        match self.process.receive(LONGEST_REPLY, deadline) {
            Ok(Reply::Failure(text)) => Err(LiveError::Failure(text)),
            Ok(reply) => Ok(reply),
            Err(end) => Err(self.lost(end, to)),
        }
    }

    fn overflow(&self, to: f64) -> LiveError {
        LiveError::Failure(format!("a voltage, current, charge or energy {} is too large for a number", self.when(to)))
    }

    fn garbled(&mut self, to: f64) -> LiveError {
        let end = self.process.end(End::Garbled("the answer to another request".to_owned()));
        self.lost(end, to)
    }

    fn lost(&self, end: End, to: f64) -> LiveError {
        let when = self.when(to);
        let how = match end {
            End::TooLong => return LiveError::TimeLimit { when, limit: self.limit },
            End::Ended(status) => status.to_string(),
            End::Silent => "it had closed its pipes".to_owned(),
            End::Garbled(what) => format!("what it sent: {what}"),
            End::Refused(cause) => cause,
        };
        let said = self.process.printed();
        let said = said.trim().lines().fold(String::new(), |all, line| all + ": " + line);
        LiveError::Died { when, how, said }
    }

    fn when(&self, to: f64) -> String {
        if to > 0.0 { format!("between {} s and {to} s", self.time) } else { "about the netlist".to_owned() }
    }
}
