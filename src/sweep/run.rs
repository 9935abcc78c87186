//! Running a sweep: all cores compute runs, and results are written in order as they come.

use std::path::{Path, PathBuf};

use super::document::DOCUMENT;
use super::record::{self, Found, Record};
use super::{Engine, Shard, Summary, Sweep, SweepError, derived, sums, waves};
use crate::progress::Progress;
use crate::threads::{self, Sharing};

/// Most results that wait for an earlier one.
const AHEAD: u64 = 4096;

/// A sweep, its engine and its folder.
#[derive(Clone, Copy)]
pub struct Options<'a> {
    /// The sweep.
    pub sweep: &'a Sweep,
    /// Computes the runs.
    pub engine: &'a Engine,
    /// The folder.
    pub folder: &'a Path,
    /// A share of the runs, or all.
    pub shard: Option<Shard>,
    /// Most runs at once.
    pub jobs: usize,
    /// Whether to replace results in the folder.
    pub fresh: bool,
}

impl<'a> Options<'a> {
    /// All runs of `sweep`, on all cores, into `folder`; results that are there are kept.
    pub fn new(sweep: &'a Sweep, engine: &'a Engine, folder: &'a Path) -> Self {
        let jobs = std::thread::available_parallelism().map_or(1, usize::from);
        Self { sweep, engine, folder, shard: None, jobs, fresh: false }
    }
}

/// Outcome of a sweep or of a merge.
#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    /// Runs that this sweep or shard consists of; most runs of one that takes samples until a mean is precise, and has not ended.
    pub runs: u64,
    /// Runs that are in the file.
    pub done: u64,
    /// Runs that failed.
    pub failed: u64,
    /// Runs that were there from the beginning.
    pub resumed_from: u64,
    /// Files written.
    pub files: Vec<PathBuf>,
    /// Of complete results with several samples.
    pub statistics: Option<Summary>,
}

impl Report {
    /// Whether every run is in the file.
    pub fn is_complete(&self) -> bool {
        self.done == self.runs
    }
}

/// Runs `sweep`, going on where the results in the folder end. The observer first hears of the runs that were there; if it
/// stops the sweep, the runs that have begun are finished.
///
/// # Errors
/// Results of another sweep, or of another build of the model; a refusal of the file system; an FMU that is beyond use.
pub fn run(options: &Options<'_>, observer: &dyn Progress) -> Result<Report, SweepError> {
    let Options { sweep, engine, folder, shard, fresh, .. } = *options;
    let path = record::results_path(folder, shard);
    let mut files = vec![path.clone(), folder.join(DOCUMENT)];
    let mut is_summed = false;
    let (runs, done, failed, resumed_from) = match Record::open(folder, sweep, shard, fresh)? {
        Found::Complete { runs, failed } => {
            is_summed = sums::check(&path)?;
            (runs, runs, failed, runs)
        }
        Found::Unfinished(mut record) => {
            let resumed_from = record.runs;
            check_last(sweep, engine, &record)?;
            let computed = compute(options, &mut record, observer).and_then(|()| record.sync());
            let (next, kept) = (record.next(), record.kept());
            computed.map_err(|cause| SweepError::Ended { path: kept.clone(), next, cause: cause.into() })?;
            let (done, failed, range) = (record.runs, record.failed, record.order().range().clone());
            let is_complete = next == range.end;
            if is_complete {
                record.finish(sweep.document())?;
            } else {
                files[0] = kept;
            }
            (if is_complete { done } else { range.end - range.start }, done, failed, resumed_from)
        }
    };
    let mut statistics = None;
    if done == runs {
        if shard.is_none() {
            let derived = derived::write(&path, sweep.document(), resumed_from < runs, is_summed)?;
            files.extend(derived.files);
            statistics = derived.statistics;
        } else if is_summed {
            sums::clear(folder);
        } else {
            sums::record(folder, sweep.document(), &[&path])?;
        }
    }
    Ok(Report { runs, done, failed, resumed_from, files, statistics })
}

/// Checks that this program gives the last line that is there again. Lines of runs that failed do not count: the machine may
/// have been the reason.
fn check_last(sweep: &Sweep, engine: &Engine, record: &Record) -> Result<(), SweepError> {
    let Some((number, line)) = &record.last else { return Ok(()) };
    let run = sweep.run(*number);
    let outcome = engine.run(sweep, &run)?;
    if engine.is_isolated() && outcome.is_err() || sweep.line(&run, &outcome) == *line {
        return Ok(());
    }
    let reason = format!(
        "run {} gives another result here: the results are of another build of the model or another machine; go on with \
         that, or begin anew with --fresh",
        run.number
    );
    Err(SweepError::content(&record.kept(), reason))
}

fn compute(options: &Options<'_>, record: &mut Record, observer: &dyn Progress) -> Result<(), SweepError> {
    let Options { sweep, engine, jobs, .. } = *options;
    let line = |number| {
        let run = sweep.run(number);
        engine.run(sweep, &run).map(|outcome| sweep.line(&run, &outcome))
    };
    let range = record.order().range().clone();
    let tell = |next: u64| observer.advance(next - range.start, range.end - range.start, &[]);
    tell(record.next());
    let is_stopped = || observer.is_stopped();
    let sharing = Sharing { threads: engine.at_once(jobs), ahead: AHEAD, is_stopped: &is_stopped };
    if record.order().stage().is_some() {
        return waves::compute(record, sharing, line, tell);
    }
    threads::in_order(record.next()..range.end, sharing, line, |lines| {
        record.append(&lines)?;
        tell(record.next());
        Ok(())
    })
}
