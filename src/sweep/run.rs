//! Running a sweep: all cores compute runs, one thread writes them in order.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use super::folder;
use super::record::{self, Found, Record};
use super::{Engine, Shard, Sweep, SweepError, sums, table};
use crate::threads;

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
    let mut files = vec![path.clone(), job.folder.join(folder::DOCUMENT)];
    let mut is_summed = false;
    let (done, failed, resumed_from) = match Record::open(job.folder, sweep, job.shard, job.fresh)? {
        Found::Complete { failed } => {
            is_summed = sums::check(&path)?;
            (runs, failed, runs)
        }
        Found::Unfinished(mut record) => {
            let resumed_from = record.next - range.start;
            check_last(sweep, engine, &record)?;
            let computed = compute(sweep, engine, job, &range, &mut record, watch).and_then(|()| record.sync());
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
        let parquet = job.shard.is_none().then(|| table::write(&path, sweep.columns(), sweep.document(), is_new));
        let parquet = parquet.transpose()?;
        let mut missing: Vec<&Path> = (!is_summed).then_some(path.as_path()).into_iter().collect();
        if let Some(parquet) = &parquet
            && (is_new || !sums::check(parquet)?)
        {
            missing.push(parquet);
        }
        if missing.is_empty() {
            sums::clear(job.folder);
        } else {
            sums::record(job.folder, sweep.document(), &missing)?;
        }
        files.extend(parquet);
    }
    Ok(Report { runs, done, failed, resumed_from, files })
}

/// That the last line that is there is what this program makes of its run. Those of runs that failed do not count, as it may
/// be the machine that such a run failed on.
fn check_last(sweep: &Sweep, engine: &Engine, record: &Record) -> Result<(), SweepError> {
    let Some((number, line)) = &record.last else { return Ok(()) };
    let run = sweep.run(*number);
    let outcome = engine.run(sweep, &run)?;
    if engine.is_isolated() && outcome.is_err() || sweep.line(&run, &outcome) == *line {
        return Ok(());
    }
    let reason = format!(
        "run {} comes out otherwise here: the results are of another build of the model or another machine; go on with \
         that, or begin anew with --fresh",
        run.number
    );
    Err(SweepError::content(&record.kept(), reason))
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
    /// Whether a thread has left its run undone.
    panicked: bool,
}

impl Desk {
    /// For `working` threads that compute runs from number `next` on.
    fn new(next: u64, working: usize) -> Self {
        let state = State { next, due: next, done: BTreeMap::new(), working, broken: None, panicked: false };
        Self { state: Mutex::new(state), changed: Condvar::new() }
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Counts a thread out, however it ends.
struct Working<'a>(&'a Desk);

impl Drop for Working<'_> {
    fn drop(&mut self) {
        let mut state = self.0.lock();
        state.working -= 1;
        state.panicked |= std::thread::panicking();
        drop(state);
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
    let desk = Desk::new(record.next, working);
    let halt = AtomicBool::new(false);
    let line = |number| {
        let run = sweep.run(number);
        engine.run(sweep, &run).map(|outcome| sweep.line(&run, &outcome))
    };
    let stopped = || halt.load(Ordering::Relaxed) || job.stop.load(Ordering::Relaxed);
    std::thread::scope(|scope| {
        let (threads, refused) = threads::start(scope, working, || work(&desk, range.end, line, stopped));
        desk.lock().working -= working - threads.len();
        if let (true, Some(cause)) = (threads.is_empty(), refused) {
            return Err(SweepError::Threads { cause });
        }
        let written = write(&desk, range, record, watch);
        halt.store(true, Ordering::Relaxed); // nobody needs to compute what cannot be written
        desk.changed.notify_all();
        threads::join(threads);
        written
    })
}

/// Has `line` compute runs until there are none or they are to stop.
fn work(desk: &Desk, end: u64, line: impl Fn(u64) -> Result<Vec<u8>, SweepError>, stopped: impl Fn() -> bool) {
    let _working = Working(desk);
    loop {
        let mut state = desk.lock();
        let is_over = |state: &State| state.next >= end || state.broken.is_some() || state.panicked || stopped();
        while state.next >= state.due + AHEAD && !is_over(&state) {
            state = desk.changed.wait_timeout(state, BEAT).unwrap_or_else(PoisonError::into_inner).0;
        }
        if is_over(&state) {
            return;
        }
        let number = state.next;
        state.next += 1;
        drop(state);
        let outcome = line(number);
        let mut state = desk.lock();
        match outcome {
            Ok(line) => {
                state.done.insert(number, line);
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

#[cfg(test)]
#[allow(clippy::panic, reason = "one is what is tested")]
mod tests {
    use std::sync::atomic::AtomicUsize;

    use super::*;

    /// Whether a thread that is as far ahead as it may be waits for the run that is due.
    fn waits(desk: &Desk) -> bool {
        let asked = AtomicUsize::new(0);
        desk.lock().next = AHEAD;
        work(desk, u64::MAX, |_| Ok(Vec::new()), || asked.fetch_add(1, Ordering::Relaxed) >= 3);
        asked.into_inner() > 3
    }

    #[test]
    fn nobody_waits_for_a_run_that_nobody_will_finish() {
        let slow = Desk::new(0, 1);
        assert!(waits(&slow));
        let broken = Desk::new(0, 2);
        work(&broken, 1, |_| Err(SweepError::option("fmu", "x.fmu", "beyond use")), || false);
        assert!(!waits(&broken));
        let left = Desk::new(0, 2);
        std::thread::scope(|scope| scope.spawn(|| work(&left, 1, |_| panic!("a run"), || false)).join().unwrap_err());
        assert!(!waits(&left));
    }
}
