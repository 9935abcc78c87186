//! The file of results while it is written: locked, in order, so that a killed sweep can be resumed.

use std::fs::File;
use std::io::{self, BufReader, Seek as _, SeekFrom, Write as _};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use super::folder::{self, RESULTS};
use super::lines::{self, Extent, Rest};
use super::order::Order;
use super::unfinished::Unfinished;
use super::{Column, Shard, Sweep, SweepError, column, sums};

/// How often results are forced to the disk: what a power cut may cost.
const SYNC_EVERY: Duration = Duration::from_secs(10);

/// Why a line is not thrown away, and what to do.
const NOT_TORN: &str = "no interruption leaves a whole line like that, so nothing is thrown away: take out that line and all \
                        behind it to go on from there, or begin anew with --fresh";

/// Results that are there of a sweep, or of a shard of it.
pub(super) enum Found {
    /// Everything.
    Complete {
        /// Runs in it.
        runs: u64,
        /// Those of them that failed.
        failed: u64,
    },
    /// Results up to some run.
    Unfinished(Box<Record>),
}

/// Results that are being written.
pub(super) struct Record {
    results: Unfinished,
    path: PathBuf,
    order: Order,
    /// Runs in it.
    pub runs: u64,
    /// Runs in it that failed.
    pub failed: u64,
    /// The last run in it that did not fail, and its line.
    pub last: Option<(u64, Vec<u8>)>,
    synced: Instant,
}

/// The file of the results of `shard`, or of the whole.
pub(super) fn results_path(folder: &Path, shard: Option<Shard>) -> PathBuf {
    folder.join(shard.map_or_else(|| RESULTS.to_owned(), Shard::file_name))
}

impl Record {
    /// Opens the results of `shard` of `sweep` in `folder`; with `fresh` whatever was there goes.
    pub fn open(folder: &Path, sweep: &Sweep, shard: Option<Shard>, fresh: bool) -> Result<Found, SweepError> {
        std::fs::create_dir_all(folder).map_err(SweepError::file("make the folder", folder))?;
        let path = results_path(folder, shard);
        let results = folder::claim(folder, sweep.document(), &path, fresh)?;
        if let Some(extent) = complete(&path, sweep.columns(), sweep.order(shard))? {
            results.discard()?;
            return Ok(Found::Complete { runs: extent.lines, failed: extent.failed });
        }
        let mut order = sweep.order(shard);
        let extent = extent(&results.file, &results.kept(), sweep.columns(), &mut order)?;
        if let Rest::Wrong(reason) = extent.rest {
            return Err(SweepError::content(&results.kept(), format!("{reason}; {NOT_TORN}")));
        }
        let mut record = Self {
            results,
            path,
            order,
            runs: extent.lines,
            failed: extent.failed,
            last: extent.last,
            synced: Instant::now(),
        };
        record.go_on_after(extent.bytes)?;
        if extent.bytes == 0 {
            record.write(&column::heading(sweep.columns()))?;
        }
        Ok(Found::Unfinished(record.into()))
    }

    fn go_on_after(&mut self, bytes: u64) -> Result<(), SweepError> {
        let cut = self.results.file.set_len(bytes).and_then(|()| self.results.file.seek(SeekFrom::Start(bytes)));
        cut.map(|_| ()).map_err(SweepError::file("cut", &self.kept()))
    }

    /// Which runs follow.
    pub fn order(&self) -> &Order {
        &self.order
    }

    /// First run that is not in it.
    pub fn next(&self) -> u64 {
        self.order.next()
    }

    /// Where the results are if they do not become complete.
    pub fn kept(&self) -> PathBuf {
        self.results.kept()
    }

    /// Adds the lines of the runs that follow.
    pub fn append(&mut self, lines: &[Vec<u8>]) -> Result<(), SweepError> {
        if lines.is_empty() {
            return Ok(());
        }
        self.write(&lines.concat())?;
        for line in lines {
            self.order.took(line);
        }
        self.runs += lines.len() as u64;
        self.failed += lines.iter().filter(|line| lines::has_failed(line)).count() as u64;
        if self.synced.elapsed() >= SYNC_EVERY {
            self.results.file.sync_data().map_err(|cause| self.full(cause))?;
            self.synced = Instant::now();
        }
        Ok(())
    }

    fn write(&mut self, bytes: &[u8]) -> Result<(), SweepError> {
        self.results.file.write_all(bytes).map_err(|cause| self.full(cause))
    }

    fn full(&self, cause: io::Error) -> SweepError {
        SweepError::file("write", &self.kept())(cause)
    }

    /// Forces what is there to the disk.
    pub fn sync(&self) -> Result<(), SweepError> {
        self.results.file.sync_all().map_err(|cause| self.full(cause))
    }

    /// Gives the complete results of the sweep of `document` their name.
    pub fn finish(mut self, document: &str) -> Result<(), SweepError> {
        self.sync()?;
        let folder = self.path.parent().unwrap_or(Path::new(""));
        folder::write_document(folder, document, &self.path)?;
        // Of those that were there before `fresh`; killed from here on, none are compared with others' checksums.
        sums::forget(folder, document, &[vec![self.path.clone()], folder::derived_from(&self.path)].concat())?;
        self.results.finish()
    }
}

/// How far the results at `path` are complete; none if there are none.
fn complete(path: &Path, columns: &[Column], mut order: Order) -> Result<Option<Extent>, SweepError> {
    let file = match videg_input::open_regular(path) {
        Ok(file) => file,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(SweepError::file("open", path)(error)),
    };
    let extent = extent(&file, path, columns, &mut order)?;
    let length = file.metadata().map_err(SweepError::file("read", path))?.len();
    match extent.check_complete(length, &order) {
        Ok(()) => Ok(Some(extent)),
        Err(reason) => {
            let reason = format!("it was changed after it was complete: {reason}; --fresh begins anew");
            Err(SweepError::content(path, reason))
        }
    }
}

fn extent(file: &File, path: &Path, columns: &[Column], order: &mut Order) -> Result<Extent, SweepError> {
    let mut from = BufReader::new(file);
    from.rewind().and_then(|()| lines::follow(from, columns, order, |_| Ok(()))).map_err(SweepError::file("read", path))
}
