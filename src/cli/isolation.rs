//! Which FMUs run in processes of their own, and what they may take there.

use std::path::Path;
use std::time::Duration;

use anyhow::Context as _;
use clap::Args;

use super::packaging;
use crate::fmi::{Bounds, Fmu, Isolation};
use crate::package;

/// Time that a call may take unless something else is asked for, s.
const TIME: f64 = 60.0;
/// Longest time limit, s.
const LONGEST: f64 = 1e9;
/// Memory that a process may take unless something else is asked for, MiB.
const MEMORY: u32 = 4096;

/// How FMUs are run.
#[derive(Args)]
pub struct IsolationOptions {
    /// Run each instance of an FMU in a process of its own, which is all that it can take down [default: of FMUs that are
    /// not of this project]
    #[arg(long, conflicts_with = "no_isolate")]
    isolate: bool,
    /// Run the FMU in this process: faster, for FMUs that you trust
    #[arg(long)]
    no_isolate: bool,
    /// Longest time that a call of an isolated FMU may take, s; 0: any
    #[arg(long, value_name = "S", default_value_t = TIME, value_parser = parse_time, allow_negative_numbers = true)]
    time_limit: f64,
    /// Memory (address space) that the process of an isolated FMU may take, MiB; 0: any. Not on Windows
    #[arg(long, value_name = "MIB", default_value_t = MEMORY)]
    memory_limit: u32,
}

fn parse_time(text: &str) -> Result<f64, String> {
    let time = text.trim().parse().ok().filter(|time| (0.0..=LONGEST).contains(time));
    time.ok_or_else(|| format!("a time from 0 to {LONGEST:e} s is expected"))
}

impl Default for IsolationOptions {
    fn default() -> Self {
        Self { isolate: false, no_isolate: false, time_limit: TIME, memory_limit: MEMORY }
    }
}

impl IsolationOptions {
    /// Opens an FMU of the user.
    pub fn open(&self, path: &Path) -> anyhow::Result<Fmu> {
        if self.no_isolate {
            return Ok(Fmu::open(path)?);
        }
        let is_trusted = |identifier: &str, library: &Path| !self.isolate && package::is_own(identifier, library);
        Ok(Fmu::open_isolated_unless(path, &self.isolation()?, is_trusted)?)
    }

    /// Packages the FMUs of this project, with progress, and opens the one with this identifier.
    pub fn open_own(&self, identifier: &str) -> anyhow::Result<Fmu> {
        let path = packaging::path(identifier)?;
        if self.isolate { Ok(Fmu::open_isolated(path, &self.isolation()?)?) } else { Ok(Fmu::open(path)?) }
    }

    fn isolation(&self) -> anyhow::Result<Isolation> {
        let program = std::env::current_exe().context("cannot find this program's own file")?;
        let time = (self.time_limit > 0.0).then(|| Duration::from_secs_f64(self.time_limit));
        let memory = (self.memory_limit > 0).then(|| u64::from(self.memory_limit) << 20);
        Ok(Isolation { program, bounds: Bounds { time, memory } })
    }
}
