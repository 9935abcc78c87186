//! `videg ngspice-worker` and `videg fmu-worker`: processes for shared libraries that may crash: that of ngspice, for
//! `--circuit ngspice` and `--netlist`, and those of isolated FMUs.

use std::io;

use anyhow::Context as _;

use super::Exit;
use crate::ngspice::live;
use fmu_import::isolated;

/// Serves one instance of an FMU on stdin and stdout.
pub fn run_fmu() -> anyhow::Result<Exit> {
    unless_gone(isolated::serve()).context("the process that runs the FMU is gone")
}

/// Serves one circuit on stdin and stdout.
pub fn run_ngspice() -> anyhow::Result<Exit> {
    unless_gone(live::serve()).context("the process that couples ngspice is gone")
}

/// A worker ends without a message if its client ends during a reply.
fn unless_gone(served: io::Result<()>) -> io::Result<Exit> {
    match served {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => Err(error),
        _ => Ok(Exit::Passed),
    }
}
