//! Files that are written under another name first, locked, renamed and removed.

use std::fs::File;
use std::io::{self, Write as _};
use std::path::Path;

use super::SweepError;
use videg_system::atomic_file::{self, LockError, Part};

/// Writes a new file at `path`, forced to the disk. A file that is there is removed: a killed attempt left it, or it is a link
/// through which another file would be written. A failed write leaves nothing.
pub(super) fn write_synced(path: &Path, content: &[u8]) -> io::Result<Part> {
    match std::fs::remove_file(path) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(error),
        _ => {}
    }
    let (mut file, part) = Part::begin(|| File::create_new(path).map(|file| (file, path.to_owned())))?;
    let written = file.write_all(content).and_then(|()| file.sync_all());
    written.map(|()| part).inspect_err(|_| drop(std::fs::remove_file(path)))
}

/// Gives what was written at `part` its name, or removes it.
pub(super) fn rename(part: &Path, path: &Path) -> Result<(), SweepError> {
    let renamed = std::fs::rename(part, path).inspect_err(|_| drop(std::fs::remove_file(part)));
    renamed.map_err(SweepError::file("write", path))
}

/// Opens `part`, which no other process has open to write.
pub(super) fn lock(part: &Path) -> Result<File, SweepError> {
    atomic_file::lock(part).map_err(|error| match error {
        LockError::Open(cause) => SweepError::file("open", part)(cause),
        LockError::Busy => SweepError::Locked { path: part.to_owned() },
        LockError::Lock(cause) => SweepError::file("lock", part)(cause),
    })
}

/// Removes a file, which need not be there.
pub(super) fn remove(path: &Path) -> Result<(), SweepError> {
    match std::fs::remove_file(path) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(SweepError::file("remove", path)(error)),
        _ => Ok(()),
    }
}
