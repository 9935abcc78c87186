//! Errors of the ngspice backend.

use std::path::PathBuf;
use std::process::ExitStatus;

use thiserror::Error;

use super::raw::RawError;

/// Error of the ngspice backend. Where ngspice said something, the message carries its own lines.
#[derive(Debug, Error)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the message of each variant names its fields")]
pub enum NgspiceError {
    /// There is no such program.
    #[error(
        "ngspice not found: {looked}; install it (Debian, Ubuntu: apt install ngspice) or name it in VIDEG_NGSPICE"
    )]
    Missing { looked: String },
    /// The program is there and cannot be started.
    #[error("cannot start {}: {cause}", program.display())]
    Start { program: PathBuf, cause: std::io::Error },
    /// It took too long, and was ended.
    #[error("ngspice did not finish within its time limit of {limit} s{said}")]
    TimeLimit { limit: f64, said: Complaints },
    /// It failed and admits it.
    #[error("ngspice failed ({status}){said}")]
    Failed { status: ExitStatus, said: Complaints },
    /// It claims success and has no, or half a, result.
    #[error("ngspice stopped at {reached} s, before the end of the run at {until} s{said}")]
    Stopped { reached: f64, until: f64, said: Complaints },
    /// Its result cannot be read.
    #[error("result of ngspice: {0}")]
    Raw(#[from] RawError),
    /// A value cannot be written into a netlist.
    #[error("{name} = {value}: {bound}")]
    Value { name: String, value: String, bound: &'static str },
    /// A table of capacitances makes no sense.
    #[error("table of capacitances, row {row}: {reason}")]
    Table { row: usize, reason: String },
    /// A file could not be written or read.
    #[error("{}: {cause}", path.display())]
    File { path: PathBuf, cause: std::io::Error },
    /// The shared library, or the process that runs it, does not go on.
    #[error(transparent)]
    Live(#[from] super::live::LiveError),
    /// The embedded circuit refused something.
    #[error("embedded circuit: {0}")]
    Circuit(#[from] videg_circuit::Error),
    /// The source of C(t) refused something.
    #[error(transparent)]
    Harvester(Box<dyn std::error::Error + Send + Sync>),
}

impl NgspiceError {
    /// Whether ngspice has ended too early: its results until then are valid.
    pub fn is_stop(&self) -> bool {
        matches!(self, Self::Stopped { .. } | Self::TimeLimit { .. } | Self::Failed { .. } | Self::Live(_))
    }

    /// Whether its time step became too small at a point of time; with other time points it may get beyond.
    pub fn is_step_too_small(&self) -> bool {
        match self {
            Self::Stopped { said, .. } => said.give_up(),
            Self::Live(live) => Complaints::in_output(&live.to_string()).give_up(),
            _ => false,
        }
    }
}

/// Lines of ngspice that tell why it stopped; empty if it said nothing of the kind.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Complaints(Vec<String>);

impl Complaints {
    /// Words by which ngspice's complaints are known.
    const SIGNS: [&'static str; 7] = ["error", "abort", "too small", "singular", "fatal", "cannot", "no such"];
    /// Lines kept: the first complaint is the cause, the rest its echo.
    const LINES: usize = 8;
    /// Characters kept of a line.
    const WIDTH: usize = 200;

    /// Picks the complaints out of what ngspice wrote; control characters are left out.
    pub(super) fn in_output(output: &str) -> Self {
        let complaint = |line: &&str| {
            let line = line.to_lowercase();
            Self::SIGNS.iter().any(|sign| line.contains(sign))
        };
        let shown = |line: &str| line.trim().chars().filter(|c| !c.is_control()).take(Self::WIDTH).collect();
        Self(output.lines().filter(complaint).take(Self::LINES).map(shown).collect())
    }

    /// Whether ngspice says that it gives up.
    pub(super) fn give_up(&self) -> bool {
        const FATAL: [&str; 3] = ["abort", "too small", "singular matrix"];
        self.0.iter().any(|line| FATAL.iter().any(|sign| line.to_lowercase().contains(sign)))
    }
}

impl std::fmt::Display for Complaints {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.0.iter().try_for_each(|line| write!(f, "\n  ngspice: {line}"))
    }
}
