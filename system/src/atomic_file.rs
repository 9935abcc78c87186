//! Files written atomically: under another name, forced to the disk, then renamed. A crash leaves the old file or the new one,
//! never part of one. A signal that ends the command-line tool removes its unfinished files (`remove_all`).

use std::collections::BTreeSet;
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use thiserror::Error;

/// Unfinished files of this process.
static PARTS: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

fn parts() -> MutexGuard<'static, BTreeSet<PathBuf>> {
    PARTS.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Name of a file until it is complete.
pub fn partial(path: &Path) -> PathBuf {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(".part");
    path.with_file_name(name)
}

/// Writes `content` to `path`, atomically. After an error nothing of it stays: a full disk needs the room.
///
/// # Errors
/// Another process that writes the same file; a refusal of the file system.
pub fn write(path: &Path, content: impl AsRef<[u8]>) -> io::Result<()> {
    fill(path, |file| file.write_all(content.as_ref()))
}

/// As [`write()`], where `content` writes the file.
///
/// # Errors
/// What `content` says; another process that writes the same file; a refusal of the file system.
pub fn fill<E: From<io::Error>>(path: &Path, content: impl FnOnce(&mut AtomicFile) -> Result<(), E>) -> Result<(), E> {
    let mut file = AtomicFile::create(path)?;
    match content(&mut file) {
        Ok(()) => Ok(file.finish()?),
        Err(error) => {
            file.discard();
            Err(error)
        }
    }
}

/// Name of an unfinished file. While this value lives, a signal that ends the process removes the file.
#[derive(Debug)]
pub struct Part {
    path: PathBuf,
}

impl Part {
    /// Registers the file that `make` makes; `make` returns its path.
    ///
    /// # Errors
    /// What `make` says.
    pub fn begin<T, E>(make: impl FnOnce() -> Result<(T, PathBuf), E>) -> Result<(T, Self), E> {
        // Locked, so that `remove_all` comes before or after.
        let mut parts = parts();
        let (made, path) = make()?;
        parts.insert(path.clone());
        Ok((made, Self { path }))
    }
}

impl Drop for Part {
    fn drop(&mut self) {
        parts().remove(&self.path);
    }
}

/// Removes the unfinished files of this process, which is about to end, and returns their names. While the second value lives,
/// no other file can be begun.
pub fn remove_all() -> (Vec<PathBuf>, impl Sized) {
    let mut parts = parts();
    // A file that is renamed by now is not there any more.
    let removed = std::mem::take(&mut *parts).into_iter().filter(|part| std::fs::remove_file(part).is_ok()).collect();
    (removed, parts)
}

/// A file that is being written. Dropped unfinished, it keeps its other name.
#[derive(Debug)]
pub struct AtomicFile {
    file: File,
    part: Part,
    path: PathBuf,
}

impl AtomicFile {
    /// Begins the file that [`AtomicFile::finish`] puts at `path`.
    ///
    /// # Errors
    /// Another process that writes the same file; a refusal of the file system.
    pub fn create(path: &Path) -> io::Result<Self> {
        let locked = || Ok::<_, io::Error>((lock(&partial(path))?, partial(path)));
        let (file, part) = Part::begin(locked)?;
        file.set_len(0)?;
        Ok(Self { file, part, path: path.to_owned() })
    }

    /// Forces the file to the disk and renames it.
    ///
    /// # Errors
    /// A refusal of the file system; the old file stays.
    pub fn finish(self) -> io::Result<()> {
        let finished = self.file.sync_all().and_then(|()| std::fs::rename(&self.part.path, &self.path));
        if finished.is_err() {
            self.discard();
        }
        finished
    }

    /// Removes the file; the old one stays.
    fn discard(self) {
        // The user is told why it could not be written.
        let _ = std::fs::remove_file(&self.part.path);
    }
}

impl Write for AtomicFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

/// Why a file cannot be locked.
#[derive(Debug, Error)]
pub enum LockError {
    /// It cannot be opened.
    #[error("{0}")]
    Open(io::Error),
    /// Another process writes it.
    #[error("another process is writing it: wait for that, or choose another folder")]
    Busy,
    /// It cannot be locked.
    #[error("cannot lock it: {0}")]
    Lock(io::Error),
}

impl From<LockError> for io::Error {
    fn from(error: LockError) -> Self {
        match error {
            LockError::Open(cause) => cause,
            LockError::Busy => Self::new(io::ErrorKind::WouldBlock, error),
            LockError::Lock(ref cause) => Self::new(cause.kind(), error),
        }
    }
}

/// Opens and locks `part`, with its content. A file with hard links is refused: a backup may share it.
///
/// # Errors
/// Another process that writes it; a refusal of the file system.
pub fn lock(part: &Path) -> Result<File, LockError> {
    const SHARED: &str =
        "the file has other names (hard links), whose content would change with it; remove it, or replace it by a copy";
    loop {
        let file = open(part, true).map_err(LockError::Open)?;
        if names(&file).map_err(LockError::Open)? > 1 {
            return Err(LockError::Open(io::Error::other(SHARED)));
        }
        // The process that had it locked may have renamed it in between.
        if own(&file, part)? {
            return Ok(file);
        }
    }
}

/// Opens the file at `part` to read and write; `make` makes it if it is missing. A symbolic link is refused: somebody may have put
/// it there to have another file overwritten.
fn open(part: &Path, make: bool) -> io::Result<File> {
    const LINK: &str = "it is a symbolic link, through which nothing is written; remove it";
    let mut options = OpenOptions::new();
    options.read(true).write(true).create(make).truncate(false);
    #[cfg(unix)]
    {
        use std::os::unix::fs::OpenOptionsExt as _;
        options.custom_flags(rustix::fs::OFlags::NOFOLLOW.bits().cast_signed());
    }
    if cfg!(not(unix)) && part.is_symlink() {
        return Err(io::Error::other(LINK));
    }
    let is_link = |cause: io::Error| if part.is_symlink() { io::Error::new(cause.kind(), LINK) } else { cause };
    options.open(part).map_err(is_link)
}

/// Locks `file`, which was opened at `part`; whether it is still there.
///
/// # Errors
/// Another process that has locked it; a refusal of the file system.
pub fn own(file: &File, part: &Path) -> Result<bool, LockError> {
    match file.try_lock() {
        Ok(()) => {}
        Err(TryLockError::WouldBlock) => return Err(LockError::Busy),
        // Some file systems of clusters have no locks: there, two processes may write the same file.
        Err(TryLockError::Error(cause)) if has_no_locks(&cause) => {}
        Err(TryLockError::Error(cause)) => return Err(LockError::Lock(cause)),
    }
    is_at(file, part).map_err(LockError::Lock)
}

/// Removes the file at `part` if no process has it locked: the one that wrote it has ended.
///
/// # Errors
/// A process that writes it; no locks; a refusal of the file system.
pub fn remove_abandoned(part: &Path) -> io::Result<()> {
    let file = open(part, false)?;
    file.try_lock()?;
    if is_at(&file, part)? { std::fs::remove_file(part) } else { Ok(()) }
}

#[cfg(unix)]
fn has_no_locks(cause: &io::Error) -> bool {
    let code = Some(rustix::io::Errno::NOLCK.raw_os_error());
    cause.kind() == io::ErrorKind::Unsupported || cause.raw_os_error() == code
}

#[cfg(not(unix))]
fn has_no_locks(cause: &io::Error) -> bool {
    cause.kind() == io::ErrorKind::Unsupported
}

/// How many names a file has.
#[cfg(unix)]
fn names(file: &File) -> io::Result<u64> {
    Ok(std::os::unix::fs::MetadataExt::nlink(&file.metadata()?))
}

/// How many names a file has: unknown here.
#[cfg(not(unix))]
#[allow(clippy::unnecessary_wraps, reason = "as elsewhere")]
fn names(_file: &File) -> io::Result<u64> {
    Ok(1)
}

/// Whether `file` is the one at `path`.
#[cfg(unix)]
fn is_at(file: &File, path: &Path) -> io::Result<bool> {
    use std::os::unix::fs::MetadataExt as _;
    let identity = |data: std::fs::Metadata| (data.dev(), data.ino());
    let own = identity(file.metadata()?);
    match path.symlink_metadata() {
        Ok(there) => Ok(identity(there) == own),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(false),
        Err(error) => Err(error),
    }
}

/// Whether `file` is the one at `path`: here, an open file cannot be renamed.
#[cfg(not(unix))]
#[allow(clippy::unnecessary_wraps, reason = "as elsewhere")]
fn is_at(_file: &File, _path: &Path) -> io::Result<bool> {
    Ok(true)
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    fn entries(folder: &Path) -> Vec<String> {
        let mut names: Vec<_> =
            fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn a_file_has_its_old_content_until_it_is_finished() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("result.json");
        write(&path, "old").unwrap();
        let mut file = AtomicFile::create(&path).unwrap();
        file.write_all(b"new").unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "old");
        file.finish().unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "new");
        assert_eq!(entries(folder.path()), ["result.json"]);
    }

    #[test]
    fn a_failed_write_leaves_the_old_file_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("result.json");
        write(&path, "old").unwrap();
        let full = |file: &mut AtomicFile| {
            file.write_all(b"half")?;
            Err(io::Error::from(io::ErrorKind::StorageFull))
        };
        assert_eq!(fill(&path, full).unwrap_err().kind(), io::ErrorKind::StorageFull);
        assert_eq!(
            (fs::read_to_string(&path).unwrap().as_str(), entries(folder.path())),
            ("old", vec!["result.json".into()])
        );
    }

    #[test]
    fn a_file_is_known_as_one_to_remove_until_it_is_finished_left_or_discarded() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("result.json");
        let is_known = || parts().contains(&partial(&path));
        let begun = || AtomicFile::create(&path).unwrap();
        for end in [|file: AtomicFile| file.finish().unwrap(), AtomicFile::discard, drop] {
            let file = begun();
            assert!(is_known());
            end(file);
            assert!(!is_known());
        }
    }

    #[test]
    fn an_unfinished_file_of_a_killed_process_is_overwritten() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("result.json");
        fs::write(partial(&path), "a long rest of an attempt that was killed").unwrap();
        write(&path, "new").unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "new");
    }

    #[test]
    fn two_do_not_write_one_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("result.json");
        let first = AtomicFile::create(&path).unwrap();
        let error = AtomicFile::create(&path).unwrap_err();
        assert!(error.to_string().contains("another process is writing it"), "{error}");
        drop(first);
        assert!(AtomicFile::create(&path).is_ok());
    }

    #[test]
    #[cfg(unix)]
    fn nothing_is_written_through_a_link_that_somebody_has_put_there() {
        let folder = tempfile::tempdir().unwrap();
        let [path, other] = ["result.json", "other"].map(|name| folder.path().join(name));
        fs::write(&other, "of somebody else").unwrap();
        std::os::unix::fs::symlink(&other, partial(&path)).unwrap();
        let said = write(&path, "new").unwrap_err().to_string();
        assert_eq!(said, "it is a symbolic link, through which nothing is written; remove it");
        assert!(remove_abandoned(&partial(&path)).is_err());
        // One that leads nowhere makes no file there.
        fs::remove_file(partial(&path)).unwrap();
        std::os::unix::fs::symlink(folder.path().join("nothing"), partial(&path)).unwrap();
        write(&path, "new").unwrap_err();
        assert_eq!(entries(folder.path()), ["other", "result.json.part"]);
        assert_eq!(fs::read_to_string(&other).unwrap(), "of somebody else");
        // Under the last name, the link goes and what it leads to stays.
        fs::remove_file(partial(&path)).unwrap();
        std::os::unix::fs::symlink(&other, &path).unwrap();
        write(&path, "new").unwrap();
        assert_eq!(fs::read_to_string(&other).unwrap(), "of somebody else");
    }

    #[test]
    #[cfg(unix)]
    fn nothing_is_written_into_a_file_that_a_backup_shares() {
        let folder = tempfile::tempdir().unwrap();
        let [path, backup] = ["result.json", "backup"].map(|name| folder.path().join(name));
        fs::write(partial(&path), "half").unwrap();
        fs::hard_link(partial(&path), &backup).unwrap();
        let said = write(&path, "new").unwrap_err().to_string();
        assert!(said.starts_with("the file has other names (hard links)"), "{said}");
        assert_eq!(fs::read_to_string(&backup).unwrap(), "half");
        // Under the last name, the backup keeps what was there.
        fs::remove_file(partial(&path)).unwrap();
        fs::hard_link(&backup, &path).unwrap();
        write(&path, "new").unwrap();
        assert_eq!(fs::read_to_string(&backup).unwrap(), "half");
    }

    #[test]
    #[cfg(unix)]
    fn a_file_that_got_its_last_name_is_not_the_one_that_is_locked() {
        let folder = tempfile::tempdir().unwrap();
        let [part, renamed] = ["sweep.csv.part", "sweep.csv"].map(|name| folder.path().join(name));
        let file = lock(&part).unwrap();
        assert!(is_at(&file, &part).unwrap());
        fs::rename(&part, &renamed).unwrap();
        assert!(!is_at(&file, &part).unwrap());
        fs::write(&part, "").unwrap();
        assert!(!is_at(&file, &part).unwrap());
        assert!(has_no_locks(&io::Error::from(rustix::io::Errno::NOLCK)));
    }
}
