//! Where ngspice stops ahead of the end: what is left to say up to there, and which claims stay open.

use serde::Serialize;

use super::{Case, Check, Solver};
use crate::ngspice::{Outcome, Waveforms};

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
    /// The stop of `outcome`, if it has one.
    pub fn of(task: &str, outcome: &Outcome, until: f64, open: Vec<String>) -> Option<Self> {
        let error = outcome.stop.as_ref()?.to_string();
        let lines: Vec<_> = error.lines().map(str::trim).collect();
        let also = outcome.repeated.iter().map(|change| format!(", also with {change}"));
        let reason = lines.join(", ") + &also.collect::<String>();
        let reached = outcome.waveforms.time.last().copied().unwrap_or_default();
        Some(Self { task: task.to_owned(), reached, until, reason, open })
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

/// What was changed in a run of ngspice that found no way on, and then did.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Repeat {
    /// What ran.
    pub task: String,
    /// What was changed.
    pub change: String,
}

impl Repeat {
    /// The changes of `outcome`.
    pub fn of(task: &str, outcome: &Outcome) -> impl Iterator<Item = Self> {
        outcome.repeated.iter().map(move |change| Self { task: task.to_owned(), change: change.clone() })
    }

    /// It in words.
    pub fn sentence(&self) -> String {
        format!("{} was repeated with {}, as ngspice had found no way on", self.task, self.change)
    }
}

/// A time, s, to the microsecond, for people to read.
fn microseconds(time: f64) -> f64 {
    (1e6 * time).round() / 1e6
}

/// Case and runs up to where the first run stopped; runs that hold nothing are left out. `None` if all are whole.
pub fn common(case: &Case, runs: &[(Solver, Waveforms)]) -> Option<(Case, Vec<(Solver, Waveforms)>)> {
    let held = || runs.iter().filter(|(_, run)| run.samples.len() > 1);
    let rows = held().map(|(_, run)| run.samples.len()).min()?;
    if rows == case.table.len() && held().count() == runs.len() {
        return None;
    }
    let cut = |(solver, run): &(Solver, Waveforms)| {
        let mut run = run.clone();
        run.truncate(rows);
        (*solver, run)
    };
    Some((case.cut(rows), held().map(cut).collect()))
}

/// Says in the names of `checks`, and in their claims, that they are about the time up to `reached`, s.
pub fn limited(checks: Vec<Check>, reached: f64) -> Vec<Check> {
    let to = format!(", up to {} s", microseconds(reached));
    let limit = |mut check: Check| {
        check.name += &to;
        if let Some(claim) = &mut check.claim {
            claim.says += &to;
        }
        check
    };
    checks.into_iter().map(limit).collect()
}
