//! The worker: a process that loads the library of an FMU and serves one instance of it.

use std::io::{self, Read, Write};
use std::sync::{Arc, Mutex, PoisonError};

use fmi2_abi::fmi2OK;

use super::protocol::{Given, Opening, Reply, Request, receive, send};
use super::session::Session;
use crate::fmi::library;
use crate::fmi::logging::Environment;

/// Serves one instance: reads calls from `requests`, answers on `replies`, and returns when the other side has closed.
///
/// # Errors
/// If the other side cannot be read or written.
pub fn serve(mut requests: impl Read, replies: impl Write + Send + 'static) -> io::Result<()> {
    let Some(opening) = receive::<Opening>(&mut requests)? else { return Ok(()) };
    confine::begin(&opening)?;
    let replies = Arc::new(Mutex::new(replies));
    let say = |reply: &Reply| send(&mut *replies.lock().unwrap_or_else(PoisonError::into_inner), reply);
    let (library, functions) = match library::load(&opening.library, &opening.shown) {
        Ok(loaded) => loaded,
        Err(error) => return say(&Reply::Refused(error.to_string())),
    };
    let log = Arc::clone(&replies);
    let environment = Environment::new(Some(Box::new(move |record| {
        // Nobody is left to be told if this fails.
        let _ = send(&mut *log.lock().unwrap_or_else(PoisonError::into_inner), &Reply::Log(record.clone()));
    })));
    let mut session = Session::new(&functions, environment);
    say(&Reply::Loaded)?;
    while let Some(request) = receive(&mut requests)? {
        if matches!(request, Request::Unload) {
            library.close().map_err(io::Error::other)?;
            return say(&Reply::Done { status: fmi2OK, given: Given::Nothing });
        }
        let (status, given) = session.answer(request);
        say(&Reply::Done { status, given })?;
    }
    // The process ends: nothing is to run any more that the FMU may have left to be run.
    std::mem::forget(library);
    Ok(())
}

#[cfg(unix)]
mod confine {
    use std::io;
    use std::time::Duration;

    use rustix::process::{Resource, Rlimit, Signal, getppid, kill_current_process_group, setrlimit};

    use super::Opening;

    /// How often the worker looks whether there is anybody to work for: the FMU may be in a call without end.
    const LOOK: Duration = Duration::from_millis(500);

    /// Bounds what this process may take, and ends it when the host is gone.
    pub fn begin(opening: &Opening) -> io::Result<()> {
        let bound = |resource, bytes| setrlimit(resource, Rlimit { current: Some(bytes), maximum: Some(bytes) });
        bound(Resource::Core, 0)?;
        if let Some(bytes) = opening.memory {
            bound(Resource::As, bytes)?;
        }
        let host = i32::try_from(opening.host).ok();
        std::thread::Builder::new().stack_size(1 << 16).spawn(move || {
            while getppid().map(rustix::process::Pid::as_raw_pid) == host {
                std::thread::sleep(LOOK);
            }
            let _ = kill_current_process_group(Signal::KILL);
        })?;
        Ok(())
    }
}

#[cfg(not(unix))]
mod confine {
    use super::{Opening, io};

    #[allow(clippy::unnecessary_wraps)] // as on Unix
    pub fn begin(_: &Opening) -> io::Result<()> {
        Ok(())
    }
}
