//! Running a sweep: all cores compute runs, one thread writes them in order.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use super::record::{self, Found, Record};
use super::{Engine, Shard, Sweep, SweepError, table};

/// Runs that may be done before one that is due: what the results wait in.
const AHEAD: u64 = 4096;
/// How often results are written and progress is shown.
const BEAT: Duration = Duration::from_millis(100);

/// Where results go, and which.
pub struct Job<'a> {
    /// The folder.
    pub folder: &'a Path,
    /// A share of the runs, or all.
    pub shard: Option<Shard>,
    /// How many runs go on at once.
    pub jobs: usize,
    /// Whether what is there goes.
    pub fresh: bool,
    /// Set from elsewhere when the sweep is to end early.
    pub stop: &'a AtomicBool,
}

/// Watches a sweep.
pub trait Watch {
    /// Of `total` runs, `done` are done; those that were there from the beginning are shown first.
    fn show(&mut self, done: u64, total: u64);
}

/// What came of a sweep.
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

/// Runs `sweep`, going on where the results in the folder end.
///
/// # Errors
/// Results of another sweep, or of another build of the model; a refusal of the file system; an FMU that is beyond use.
pub fn run(sweep: &Sweep, engine: &Engine, job: &Job<'_>, watch: &mut dyn Watch) -> Result<Report, SweepError> {
    let range = record::range(sweep, job.shard);
    let runs = range.end - range.start;
    let path = record::results_path(job.folder, job.shard);
    let mut files = vec![path.clone(), job.folder.join(record::DOCUMENT)];
    let (done, failed, resumed_from) = match Record::open(job.folder, sweep, job.shard, job.fresh)? {
        Found::Complete { failed } => (runs, failed, runs),
        Found::Unfinished(mut record) => {
            let resumed_from = record.next - range.start;
            check_last(sweep, engine, &record)?;
            compute(sweep, engine, job, &range, &mut record, watch)?;
            let (done, failed) = (record.next - range.start, record.failed);
            if done < runs {
                record.sync()?;
            } else {
                record.finish()?;
            }
            (done, failed, resumed_from)
        }
    };
    if done == runs && job.shard.is_none() {
        files.push(table::write(&path, sweep.columns(), sweep.document(), resumed_from < runs)?);
    }
    Ok(Report { runs, done, failed, resumed_from, files })
}

/// That the last line that is there is what this program makes of its run.
fn check_last(sweep: &Sweep, engine: &Engine, record: &Record) -> Result<(), SweepError> {
    if record.last.is_empty() {
        return Ok(());
    }
    let run = sweep.run(record.next - 1);
    if sweep.line(&run, &engine.run(sweep, &run)?) == record.last {
        return Ok(());
    }
    let reason = format!(
        "run {} comes out otherwise here: the results are of another build of the model or another machine; go on with that, \
         or begin anew with --fresh",
        run.number
    );
    Err(SweepError::content(record.part(), reason))
}

/// What the threads share.
struct Desk {
    state: Mutex<State>,
    /// Somebody has done or taken something.
    changed: Condvar,
}

struct State {
    /// The next run to compute.
    next: u64,
    /// The next run to write.
    due: u64,
    /// Lines of runs that are done, by number.
    done: BTreeMap<u64, Vec<u8>>,
    /// Threads that compute.
    working: usize,
    /// Why no run can go on.
    broken: Option<SweepError>,
}

impl Desk {
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Counts a thread out, however it ends.
struct Working<'a>(&'a Desk);

impl Drop for Working<'_> {
    fn drop(&mut self) {
        self.0.lock().working -= 1;
        self.0.changed.notify_all();
    }
}

fn compute(
    sweep: &Sweep,
    engine: &Engine,
    job: &Job<'_>,
    range: &Range<u64>,
    record: &mut Record,
    watch: &mut dyn Watch,
) -> Result<(), SweepError> {
    let left = usize::try_from(range.end - record.next).unwrap_or(usize::MAX);
    let working = engine.at_once(job.jobs).clamp(1, left.max(1));
    let state = State { next: record.next, due: record.next, done: BTreeMap::new(), working, broken: None };
    let desk = Desk { state: Mutex::new(state), changed: Condvar::new() };
    let halt = AtomicBool::new(false);
    std::thread::scope(|scope| {
        for _ in 0..working {
            scope.spawn(|| {
                let _working = Working(&desk);
                work(sweep, engine, &desk, range.end, || {
                    halt.load(Ordering::Relaxed) || job.stop.load(Ordering::Relaxed)
                });
            });
        }
        let written = write(&desk, range, record, watch);
        halt.store(true, Ordering::Relaxed); // nobody needs to compute what cannot be written
        desk.changed.notify_all();
        written
    })
}

/// Computes runs until there are none or they are to stop.
fn work(sweep: &Sweep, engine: &Engine, desk: &Desk, end: u64, stopped: impl Fn() -> bool) {
    loop {
        let mut state = desk.lock();
        while state.next < end && state.next >= state.due + AHEAD && !stopped() {
            state = desk.changed.wait_timeout(state, BEAT).unwrap_or_else(PoisonError::into_inner).0;
        }
        if state.next >= end || state.broken.is_some() || stopped() {
            return;
        }
        let number = state.next;
        state.next += 1;
        drop(state);
        let run = sweep.run(number);
        let outcome = engine.run(sweep, &run);
        let mut state = desk.lock();
        match outcome {
            Ok(outcome) => {
                state.done.insert(number, sweep.line(&run, &outcome));
                if state.done.len() as u64 == AHEAD / 2 {
                    desk.changed.notify_all();
                }
            }
            Err(error) => {
                state.broken.get_or_insert(error);
                return;
            }
        }
    }
}

/// Writes what is done in its order, until nobody computes any more.
fn write(desk: &Desk, range: &Range<u64>, record: &mut Record, watch: &mut dyn Watch) -> Result<(), SweepError> {
    let total = range.end - range.start;
    loop {
        watch.show(record.next - range.start, total);
        let mut state = desk.lock();
        let is_pressing = state.done.len() as u64 >= AHEAD / 2 && state.done.contains_key(&state.due);
        if state.working > 0 && !is_pressing {
            state = desk.changed.wait_timeout(state, BEAT).unwrap_or_else(PoisonError::into_inner).0;
        }
        let at_work = state.working > 0;
        let mut lines = Vec::new();
        while let Some(line) = {
            let due = state.due;
            state.done.remove(&due)
        } {
            lines.push(line);
            state.due += 1;
        }
        drop(state);
        desk.changed.notify_all();
        record.append(&lines)?;
        if !at_work {
            watch.show(record.next - range.start, total);
            return desk.lock().broken.take().map_or(Ok(()), Err);
        }
    }
}
