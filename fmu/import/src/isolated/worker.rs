//! The worker: a process that loads the library of an FMU and serves one instance.

use std::io;
use std::sync::{Arc, Mutex, PoisonError};

use fmu_abi::fmi2OK;

use super::protocol::{Call, Given, Opening, Reply, build};
use super::session::Session;
use crate::library;
use crate::logging::Environment;
use crate::request::Request;
use videg_system::messages::send;
use videg_system::worker::take_streams;

/// Serves one instance: takes stdin and stdout of this process, reads calls, answers, and returns when the other side has closed.
///
/// # Errors
/// If the streams cannot be taken, or the other side cannot be read or written.
pub fn serve() -> io::Result<()> {
    let (mut requests, replies) = take_streams()?;
    let replies = Arc::new(Mutex::new(replies));
    let say = |reply: &Reply| send(&mut *replies.lock().unwrap_or_else(PoisonError::into_inner), reply);
    let Some(host) = requests.receive::<String>()? else { return Ok(()) };
    if host != build() {
        return say(&Reply::Unable(format!("it is of videg {}, and this is {host}", build())));
    }
    let Some(opening) = requests.receive::<Opening>()? else { return Ok(()) };
    if let Err(cause) = confine::begin(&opening) {
        return say(&Reply::Unable(cause.to_string()));
    }
    let (library, functions) = match library::load(opening.library.as_ref(), opening.shown.as_ref()) {
        Ok(loaded) => loaded,
        Err(error) => return say(&Reply::Refused(error.to_string())),
    };
    let log = Arc::clone(&replies);
    let environment = Environment::new(Some(Box::new(move |record| {
        // An error cannot be reported to anybody.
        let _ = send(&mut *log.lock().unwrap_or_else(PoisonError::into_inner), &Reply::Log(record.clone()));
    })));
    let mut session = Session::new(&functions, environment);
    say(&Reply::Loaded)?;
    let this = std::process::id();
    while let Some((call, request)) = requests.receive::<Call>()? {
        if matches!(request, Request::Unload) {
            library.close().map_err(io::Error::other)?;
            return say(&Reply::Done { call, status: fmi2OK, given: Given::Nothing });
        }
        let (status, given) = session.answer(request);
        if std::process::id() != this {
            // The FMU has forked this process: the copy must neither answer nor read requests.
            confine::vanish();
        }
        say(&Reply::Done { call, status, given })?;
    }
    // The process ends: destructors of the FMU must not run.
    std::mem::forget((library, session));
    Ok(())
}

#[cfg(unix)]
mod confine {
    use std::io;
    use std::time::Duration;

    use rustix::process::{
        Resource, Rlimit, Signal, getpid, getppid, getrlimit, kill_current_process_group, kill_process, setrlimit,
    };

    use super::Opening;

    /// Polling interval for the end of the host: the FMU may be in a call without end.
    const LOOK: Duration = Duration::from_millis(500);

    /// Bounds what this process may take, and ends it when the host is gone.
    pub fn begin(opening: &Opening) -> io::Result<()> {
        bound(Resource::Core, 0).map_err(|cause| refused("core dumps", cause))?;
        if let Some(bytes) = opening.memory {
            bound(Resource::As, bytes).map_err(|cause| refused("address space", cause))?;
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

    /// Bounds a resource, unless the user has a lower bound: that one may not be raised, or should not be.
    fn bound(resource: Resource, most: u64) -> rustix::io::Result<()> {
        let most = getrlimit(resource).maximum.map_or(most, |given| given.min(most));
        setrlimit(resource, Rlimit { current: Some(most), maximum: Some(most) })
    }

    fn refused(what: &str, cause: rustix::io::Errno) -> io::Error {
        io::Error::other(format!("cannot bound {what}: {}", io::Error::from(cause)))
    }

    /// Ends this process at once, without destructors: they are the original's.
    pub fn vanish() -> ! {
        let _ = kill_process(getpid(), Signal::KILL);
        std::process::abort()
    }
}

#[cfg(not(unix))]
mod confine {
    use super::{Opening, io};

    #[allow(clippy::unnecessary_wraps)] // as on Unix
    pub fn begin(_: &Opening) -> io::Result<()> {
        Ok(())
    }

    pub fn vanish() -> ! {
        std::process::abort()
    }
}
