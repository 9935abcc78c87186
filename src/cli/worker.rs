//! `videg ngspice-worker` and `videg fmu-worker`: processes in which a shared library runs that may take its process down:
//! that of ngspice, for `--circuit ngspice`, and those of isolated FMUs.

use anyhow::Context as _;

use super::Verdict;
use crate::fmi::isolated;
use crate::ngspice::live;

/// Serves one instance of an FMU on stdin and stdout.
pub fn run_fmu() -> anyhow::Result<Verdict> {
    let requests = take_stdin().context("cannot take stdin for the requests")?;
    let replies = take_stdout().context("cannot take stdout for the replies")?;
    isolated::serve(requests, replies).context("the process that runs the FMU is gone")?;
    Ok(Verdict::Passed)
}

/// Serves one circuit on stdin and stdout.
pub fn run_ngspice() -> anyhow::Result<Verdict> {
    let replies = take_stdout().context("cannot take stdout for the replies")?;
    live::serve(replies).context("the process that couples ngspice is gone")?;
    Ok(Verdict::Passed)
}

/// Stdout for the replies alone: whatever the library prints itself goes to stderr from here on.
#[cfg(unix)]
fn take_stdout() -> std::io::Result<std::fs::File> {
    let replies = rustix::io::dup(std::io::stdout())?;
    rustix::stdio::dup2_stdout(std::io::stderr())?;
    Ok(replies.into())
}

/// Stdin for the requests alone: the library finds an empty one, and may close it.
#[cfg(unix)]
fn take_stdin() -> std::io::Result<std::io::BufReader<std::fs::File>> {
    let requests = rustix::io::dup(std::io::stdin())?;
    rustix::stdio::dup2_stdin(std::fs::File::open("/dev/null")?)?;
    Ok(std::io::BufReader::new(requests.into()))
}

#[cfg(not(unix))]
#[allow(clippy::unnecessary_wraps)] // as on Unix
fn take_stdin() -> std::io::Result<std::io::Stdin> {
    Ok(std::io::stdin())
}

/// Windows keeps a table of its own for C libraries; ngspice hands its text to the callback there.
#[cfg(not(unix))]
fn take_stdout() -> std::io::Result<std::io::Stdout> {
    Ok(std::io::stdout())
}
