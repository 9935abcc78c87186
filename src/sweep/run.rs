//! Running a sweep: all cores compute runs, and results are written in order as they come.

use std::ops::Range;
use std::path::{Path, PathBuf};

use super::document::DOCUMENT;
use super::record::{self, Found, Record};
use super::{Engine, Shard, Sweep, SweepError, sums, table};
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
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Report {
    /// Runs that this sweep or shard consists of.
    pub runs: u64,
    /// Runs that are in the file.
    pub done: u64,
    /// Runs that failed.
    pub failed: u64,
    /// Runs that were there from the beginning.
    pub resumed_from: u64,
    /// Files written.
    pub files: Vec<PathBuf>,
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
    let range = record::range(sweep, shard);
    let runs = range.end - range.start;
    let path = record::results_path(folder, shard);
    let mut files = vec![path.clone(), folder.join(DOCUMENT)];
    let mut is_summed = false;
    let (done, failed, resumed_from) = match Record::open(folder, sweep, shard, fresh)? {
        Found::Complete { failed } => {
            is_summed = sums::check(&path)?;
            (runs, failed, runs)
        }
        Found::Unfinished(mut record) => {
            let resumed_from = record.next - range.start;
            check_last(sweep, engine, &record)?;
            let computed = compute(options, &range, &mut record, observer).and_then(|()| record.sync());
            let (next, kept) = (record.next, record.kept());
            computed.map_err(|cause| SweepError::Ended { path: kept.clone(), next, cause: cause.into() })?;
            let (done, failed) = (next - range.start, record.failed);
            if done < runs {
                files[0] = kept;
            } else {
                record.finish(sweep.document())?;
            }
            (done, failed, resumed_from)
        }
    };
    if done == runs {
        let is_new = resumed_from < runs;
        let parquet = shard.is_none().then(|| table::write(&path, sweep.columns(), sweep.document(), is_new));
        let parquet = parquet.transpose()?;
        let mut missing: Vec<&Path> = (!is_summed).then_some(path.as_path()).into_iter().collect();
        if let Some(parquet) = &parquet
            && (is_new || !sums::check(parquet)?)
        {
            missing.push(parquet);
        }
        if missing.is_empty() {
            sums::clear(folder);
        } else {
            sums::record(folder, sweep.document(), &missing)?;
        }
        files.extend(parquet);
    }
    Ok(Report { runs, done, failed, resumed_from, files })
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

fn compute(
    options: &Options<'_>,
    range: &Range<u64>,
    record: &mut Record,
    observer: &dyn Progress,
) -> Result<(), SweepError> {
    let Options { sweep, engine, jobs, .. } = *options;
    let line = |number| {
        let run = sweep.run(number);
        engine.run(sweep, &run).map(|outcome| sweep.line(&run, &outcome))
    };
    let tell = |next: u64| observer.advance(next - range.start, range.end - range.start, &[]);
    tell(record.next);
    let is_stopped = || observer.is_stopped();
    let sharing = Sharing { threads: engine.at_once(jobs), ahead: AHEAD, is_stopped: &is_stopped };
    threads::in_order(record.next..range.end, sharing, line, |lines| {
        record.append(&lines)?;
        tell(record.next);
        Ok(())
    })
}
