//! `videg ngspice-worker`: the process in which the shared library of ngspice runs. For `--circuit ngspice` only.

use anyhow::Context as _;

use super::Verdict;
use crate::ngspice::live;

/// Serves one circuit on stdin and stdout.
pub fn run() -> anyhow::Result<Verdict> {
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

/// Windows keeps a table of its own for C libraries; ngspice hands its text to the callback there.
#[cfg(not(unix))]
fn take_stdout() -> std::io::Result<std::io::Stdout> {
    Ok(std::io::stdout())
}
