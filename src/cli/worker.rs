//! `videg ngspice-worker` and `videg fmu-worker`: processes in which a shared library runs that may take its process down:
//! that of ngspice, for `--circuit ngspice`, and those of isolated FMUs.

use std::io::BufReader;

use anyhow::Context as _;

use super::Verdict;
use super::streams::{take_stdin, take_stdout};
use crate::fmi::isolated;
use crate::ngspice::live;

/// Serves one instance of an FMU on stdin and stdout.
pub fn run_fmu() -> anyhow::Result<Verdict> {
    let requests = take_stdin().context("cannot take stdin for the requests")?;
    let replies = take_stdout().context("cannot take stdout for the replies")?;
    isolated::serve(BufReader::new(requests), replies).context("the process that runs the FMU is gone")?;
    Ok(Verdict::Passed)
}

/// Serves one circuit on stdin and stdout.
pub fn run_ngspice() -> anyhow::Result<Verdict> {
    let replies = take_stdout().context("cannot take stdout for the replies")?;
    live::serve(replies).context("the process that couples ngspice is gone")?;
    Ok(Verdict::Passed)
}
