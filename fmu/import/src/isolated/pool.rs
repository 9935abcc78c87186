//! The workers of an FMU: one for each instance.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use super::bounds::Isolation;
use super::ending::Ending;
use super::process::Process;
use super::protocol::{Opening, Reply};
use super::remote::Remote;
use crate::component::Arguments;
use crate::error::{FmiError, Result};
use crate::logging::Environment;
use videg_system::worker::End;

/// Starts the workers of an FMU.
pub(crate) struct Pool {
    isolation: Isolation,
    /// The archive.
    path: PathBuf,
    folder: PathBuf,
    opening: Opening,
    /// A worker that has loaded the library and has no instance yet.
    spare: Mutex<Option<Process>>,
}

impl Pool {
    /// For the FMU at `path`, unpacked into `folder` with its library at `entry`; starts the first worker.
    pub fn new(mut isolation: Isolation, path: &Path, folder: &Path, entry: &str) -> Result<Self> {
        isolation.bounds = isolation.bounds.in_force();
        let opening = Opening {
            host: std::process::id(),
            library: folder.join(entry).into(),
            shown: path.join(entry).into(),
            memory: isolation.bounds.memory,
        };
        let (path, folder) = (path.to_owned(), folder.to_owned());
        let pool = Self { isolation, path, folder, opening, spare: Mutex::new(None) };
        let first = pool.start()?;
        *pool.spare.lock().unwrap_or_else(PoisonError::into_inner) = Some(first);
        Ok(pool)
    }

    /// Starts a worker, which loads the library.
    fn start(&self) -> Result<Process> {
        let program = &self.isolation.program;
        let mut process = Process::start(program, &self.folder)
            .map_err(|cause| FmiError::Worker { program: program.clone(), cause: cause.to_string() })?;
        let ended = |process: &Process, how| {
            let (path, call, bounds) = (self.path.clone(), "loading the library".to_owned(), self.isolation.bounds);
            let (messages, printed) = (Vec::new(), process.printed());
            FmiError::Isolated(Box::new(Ending { path, call, how, bounds, messages, printed }))
        };
        match process.open(&self.opening, self.isolation.bounds.time) {
            Ok(Reply::Loaded) => Ok(process),
            Ok(Reply::Unable(cause)) => Err(FmiError::Worker { program: program.clone(), cause }),
            Ok(Reply::Refused(reason)) => Err(FmiError::Refusal(reason)),
            Ok(other) => Err(ended(&process, End::Garbled(format!("{} in answer to the library", other.name())))),
            Err(how) => Err(ended(&process, how)),
        }
    }

    /// Makes an instance in a worker of its own; none if the FMU refuses.
    pub fn instantiate(&self, arguments: &Arguments<'_>, environment: &Arc<Environment>) -> Result<Option<Remote>> {
        let spare = self.spare.lock().unwrap_or_else(PoisonError::into_inner).take();
        let process = spare.map_or_else(|| self.start(), Ok)?;
        let remote = Remote::new(process, (&self.path, self.isolation.bounds), arguments, environment);
        remote.map_err(FmiError::Isolated)
    }
}
