//! Runs in which ngspice stops before the end, and those that it repeats.

use serde::Serialize;

use crate::ngspice::SolverRun;

/// A run of ngspice that ended too early.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Stop {
    /// What ran.
    pub task: String,
    /// How far it got, s.
    pub reached: f64,
    /// The end of the run, s.
    pub until: f64,
    /// Why it ended.
    pub reason: String,
    /// What cannot be judged beyond `reached`, or at all where that is 0.
    pub open: Vec<String>,
}

impl Stop {
    /// The stop of `run`, if it has one.
    pub fn of(task: &str, run: &SolverRun, until: f64, open: &[String]) -> Option<Self> {
        let error = run.stop.as_ref()?.to_string();
        let lines: Vec<_> = error.lines().map(str::trim).collect();
        let also = run.repeated.iter().map(|change| format!(", also with {change}"));
        let reason = lines.join(", ") + &also.collect::<String>();
        let reached = run.waveforms.time.last().copied().unwrap_or_default();
        Some(Self { task: task.to_owned(), reached, until, reason, open: open.to_vec() })
    }

    /// It in words.
    pub fn sentence(&self) -> String {
        let from = if self.reached > 0.0 {
            format!("beyond {} s, up to which all solvers are compared", microseconds(self.reached))
        } else {
            "for the whole run".to_owned()
        };
        format!("{}: {}. What stays open {from}: {}", self.task, self.reason, self.open.join("; "))
    }
}

/// A change with which ngspice was repeated after it had stopped.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Repeat {
    /// What ran.
    pub task: String,
    /// What was changed.
    pub change: String,
}

impl Repeat {
    /// The changes of `run`.
    pub fn of(task: &str, run: &SolverRun) -> impl Iterator<Item = Self> {
        run.repeated.iter().map(move |change| Self { task: task.to_owned(), change: change.clone() })
    }

    /// It in words.
    pub fn sentence(&self) -> String {
        format!("{} was repeated with {}, as ngspice had found no way on", self.task, self.change)
    }
}

/// A time, s, to the microsecond, for people to read.
pub fn microseconds(time: f64) -> f64 {
    (1e6 * time).round() / 1e6
}
