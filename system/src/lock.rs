//! Locks on files that are being written: two processes do not write one.

use std::fs::{File, OpenOptions, TryLockError};
use std::io;
use std::path::Path;

use thiserror::Error;

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
