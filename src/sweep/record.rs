//! The file of results while it is being written: locked, in order, and such that a killed sweep can go on.

use std::fs::{File, OpenOptions, TryLockError};
use std::io::{self, BufReader, Seek as _, SeekFrom, Write as _};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use super::document::differences;
use super::lines::{self, Extent};
use super::{Shard, Sweep, SweepError, column};

/// How often results are forced to the disk: what a power cut may cost.
const SYNC_EVERY: Duration = Duration::from_secs(10);

/// Name of the document in a folder of results.
pub(super) const DOCUMENT: &str = "sweep.json";
/// Name of the results of a whole sweep.
pub(super) const RESULTS: &str = "sweep.csv";

/// What is there of a sweep, or of a shard of it.
pub(super) enum Found {
    /// Everything.
    Complete {
        /// Runs that failed.
        failed: u64,
    },
    /// Results up to some run.
    Unfinished(Record),
}

/// Results that are being written.
pub(super) struct Record {
    file: File,
    part: PathBuf,
    path: PathBuf,
    /// First run that is not in it.
    pub next: u64,
    /// Runs in it that failed.
    pub failed: u64,
    /// Its last line, if it has any.
    pub last: Vec<u8>,
    synced: Instant,
}

/// The file of the results of `shard`, or of the whole.
pub(super) fn results_path(folder: &Path, shard: Option<Shard>) -> PathBuf {
    folder.join(shard.map_or_else(|| RESULTS.to_owned(), Shard::file_name))
}

/// The runs that `shard`, or the whole, consists of.
pub(super) fn range(sweep: &Sweep, shard: Option<Shard>) -> Range<u64> {
    shard.map_or(0..sweep.runs(), |shard| shard.range(sweep.runs()))
}

impl Record {
    /// Opens the results of `shard` of `sweep` in `folder`; with `fresh` whatever was there goes.
    ///
    /// # Errors
    /// Results of another sweep; results that another process is writing; a refusal of the file system.
    pub fn open(folder: &Path, sweep: &Sweep, shard: Option<Shard>, fresh: bool) -> Result<Found, SweepError> {
        std::fs::create_dir_all(folder).map_err(SweepError::file("make the folder", folder))?;
        let path = results_path(folder, shard);
        check_document(folder, sweep, &path, fresh)?;
        let part = partial(&path);
        let file = lock(&part)?;
        write_document(folder, sweep, &path)?;
        let range = range(sweep, shard);
        let heading = column::line(sweep.columns().iter().map(|column| column.name.as_str()));
        if fresh {
            remove(&path)?;
            remove(&path.with_extension("parquet"))?;
            file.set_len(0).map_err(SweepError::file("empty", &part))?;
        } else if let Some(extent) = complete(&path, &heading, &range)? {
            remove(&part)?;
            return Ok(Found::Complete { failed: extent.failed });
        }
        let extent = extent(&file, &part, &heading, &range)?;
        let mut record = Self {
            file,
            part,
            path,
            next: range.start + extent.lines,
            failed: extent.failed,
            last: extent.last,
            synced: Instant::now(),
        };
        record.go_on_after(extent.bytes)?;
        if extent.bytes == 0 {
            record.write(&heading)?;
        }
        Ok(Found::Unfinished(record))
    }

    fn go_on_after(&mut self, bytes: u64) -> Result<(), SweepError> {
        let cut = self.file.set_len(bytes).and_then(|()| self.file.seek(SeekFrom::Start(bytes)));
        cut.map(|_| ()).map_err(SweepError::file("cut", &self.part))
    }

    /// The file while it is being written.
    pub fn part(&self) -> &Path {
        &self.part
    }

    /// Adds the lines of the runs that are due.
    ///
    /// # Errors
    /// If they cannot be written; those before stay.
    pub fn append(&mut self, lines: &[Vec<u8>]) -> Result<(), SweepError> {
        if lines.is_empty() {
            return Ok(());
        }
        self.write(&lines.concat())?;
        self.next += lines.len() as u64;
        self.failed += lines.iter().filter(|line| lines::has_failed(line)).count() as u64;
        if self.synced.elapsed() >= SYNC_EVERY {
            self.file.sync_data().map_err(|cause| self.full(cause))?;
            self.synced = Instant::now();
        }
        Ok(())
    }

    fn write(&mut self, bytes: &[u8]) -> Result<(), SweepError> {
        self.file.write_all(bytes).map_err(|cause| self.full(cause))
    }

    fn full(&self, cause: io::Error) -> SweepError {
        SweepError::Full { path: self.part.clone(), next: self.next, cause }
    }

    /// Forces what is there to the disk.
    ///
    /// # Errors
    /// If the disk refuses.
    pub fn sync(&self) -> Result<(), SweepError> {
        self.file.sync_all().map_err(|cause| self.full(cause))
    }

    /// Gives the complete results their name.
    ///
    /// # Errors
    /// If the file system refuses.
    pub fn finish(self) -> Result<(), SweepError> {
        self.sync()?;
        std::fs::rename(&self.part, &self.path).map_err(SweepError::file("rename", &self.part))
    }
}

/// Name under which a file is written before it is complete.
pub(super) fn partial(path: &Path) -> PathBuf {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(".part");
    path.with_file_name(name)
}

/// Opens `part`, which no other process has open to write.
pub(super) fn lock(part: &Path) -> Result<File, SweepError> {
    let mut options = OpenOptions::new();
    let file = options.read(true).write(true).create(true).truncate(false).open(part);
    let file = file.map_err(SweepError::file("open", part))?;
    match file.try_lock() {
        Ok(()) => Ok(file),
        Err(TryLockError::WouldBlock) => Err(SweepError::Locked { path: part.to_owned() }),
        // Some file systems of clusters have no locks; their schedulers see to it that a shard runs once.
        Err(TryLockError::Error(cause)) if cause.kind() == io::ErrorKind::Unsupported => Ok(file),
        Err(TryLockError::Error(cause)) => Err(SweepError::file("lock", part)(cause)),
    }
}

/// How far the results at `path` are complete; none if there are none.
fn complete(path: &Path, heading: &[u8], range: &Range<u64>) -> Result<Option<Extent>, SweepError> {
    let file = match File::open(path) {
        Ok(file) => file,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(SweepError::file("open", path)(error)),
    };
    let extent = extent(&file, path, heading, range)?;
    let length = file.metadata().map_err(SweepError::file("read", path))?.len();
    if extent.bytes == length && extent.lines == range.end - range.start {
        return Ok(Some(extent));
    }
    let due = range.start + extent.lines;
    let reason = format!("it was changed after it was complete: line {} is not run {due}", extent.lines + 2);
    Err(SweepError::content(path, reason + "; --fresh begins anew"))
}

fn extent(file: &File, path: &Path, heading: &[u8], range: &Range<u64>) -> Result<Extent, SweepError> {
    let (mut from, most) = (BufReader::new(file), range.end - range.start);
    from.rewind()
        .and_then(|()| lines::follow(from, heading, range.start, most, |_| Ok(())))
        .map_err(SweepError::file("read", path))
}

fn remove(path: &Path) -> Result<(), SweepError> {
    match std::fs::remove_file(path) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(SweepError::file("remove", path)(error)),
        _ => Ok(()),
    }
}

/// That the folder holds this sweep or none; with `fresh`, that no other shard of another sweep would be orphaned.
fn check_document(folder: &Path, sweep: &Sweep, path: &Path, fresh: bool) -> Result<(), SweepError> {
    let document = folder.join(DOCUMENT);
    let own = [path.to_owned(), partial(path)];
    let there = match std::fs::read_to_string(&document) {
        Ok(there) => there,
        Err(error) if error.kind() == io::ErrorKind::NotFound => String::new(),
        Err(error) => return Err(SweepError::file("read", &document)(error)),
    };
    if there == sweep.document() {
        return Ok(());
    }
    if there.is_empty() && !own.iter().any(|file| file.exists()) {
        return Ok(());
    }
    if !fresh {
        let differences = differences(&there, sweep.document());
        let reason =
            format!("it belongs to another sweep ({differences}); choose another --output, or --fresh to begin anew");
        return Err(SweepError::content(&document, reason));
    }
    match others(folder, &own)? {
        Some(other) => {
            let reason = "results of another sweep; remove them, or choose another --output";
            Err(SweepError::content(&other, reason))
        }
        None => remove(&document),
    }
}

/// Results in the folder that are not `own`.
fn others(folder: &Path, own: &[PathBuf]) -> Result<Option<PathBuf>, SweepError> {
    let entries = std::fs::read_dir(folder).map_err(SweepError::file("read", folder))?;
    let is_result = |path: &PathBuf| {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let name = name.trim_end_matches(".part");
        name == RESULTS || Shard::of_file_name(name).is_some()
    };
    Ok(entries.flatten().map(|entry| entry.path()).find(|path| is_result(path) && !own.contains(path)))
}

/// Writes the document if it is not there. The name before it is complete is that of the shard: others may be at it.
pub(super) fn write_document(folder: &Path, sweep: &Sweep, results: &Path) -> Result<(), SweepError> {
    let document = folder.join(DOCUMENT);
    if document.exists() {
        return Ok(());
    }
    write_whole(&document, &results.with_extension("json.part"), sweep.document().as_bytes())
}

/// Writes `path` under the name `part` first, so that a reader never sees half of it.
pub(super) fn write_whole(path: &Path, part: &Path, content: &[u8]) -> Result<(), SweepError> {
    std::fs::write(part, content).and_then(|()| std::fs::rename(part, path)).map_err(SweepError::file("write", path))
}
