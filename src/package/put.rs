//! Archives that appear whole, several processes at it or not, and leave nothing of those that were killed.

use std::ffi::OsStr;
use std::fs;
use std::io::{self, Write as _};
use std::path::Path;

use tempfile::NamedTempFile;

use super::error::{PackageError, Result};
use videg_system::atomic_file::{self, LockError, Part};

/// How an archive that is not complete is called: these, its name, and letters that no other process has.
const PREFIX: &str = ".videg-";
const SUFFIX: &str = ".part";
/// How many letters.
const LETTERS: usize = 6;

/// Writes a file beside its place and moves it there, so that nobody ever sees half of it. Several processes may do so at
/// once: the last one has its way. What others began and were killed at goes.
pub(super) fn put(path: &Path, bytes: &[u8]) -> Result<()> {
    let folder = path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
    fs::create_dir_all(folder).map_err(PackageError::io("create", folder))?;
    let prefix = format!("{PREFIX}{}-", path.file_name().unwrap_or_default().to_string_lossy());
    // Before there is anything new: on a full disk they take the room.
    remove_rests(folder, &prefix);
    let begun = Part::begin(|| {
        new_file(folder, &prefix).map(|file| {
            let name = file.path().to_owned();
            (file, name)
        })
    });
    let (mut temporary, _part) = begun.map_err(PackageError::io("write into", folder))?;
    let written = temporary.write_all(bytes).and_then(|()| temporary.as_file().sync_all());
    written.map_err(PackageError::io("write", path))?;
    temporary.persist(path).map_err(|error| PackageError::io("write", path)(error.error))?;
    Ok(())
}

/// Removes what processes began under this prefix that are no more: they held a lock on it. What cannot be removed does not
/// keep anybody from writing anew.
fn remove_rests(folder: &Path, prefix: &str) {
    let Ok(entries) = fs::read_dir(folder) else { return };
    for entry in entries.flatten().filter(|entry| is_rest(&entry.file_name(), prefix)) {
        let _ = atomic_file::remove_abandoned(&entry.path());
    }
}

/// Whether a file is called like one that is not complete: another archive may be called like the beginning of this one.
fn is_rest(name: &OsStr, prefix: &str) -> bool {
    let letters = name.to_str().and_then(|name| name.strip_prefix(prefix)?.strip_suffix(SUFFIX));
    letters.is_some_and(|letters| letters.len() == LETTERS && letters.bytes().all(|c| c.is_ascii_alphanumeric()))
}

/// A temporary file, locked, with the permissions of any new file, not the private ones that are usual for temporary files.
fn new_file(folder: &Path, prefix: &str) -> io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(prefix).suffix(SUFFIX).rand_bytes(LETTERS);
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    loop {
        let file = builder.tempfile_in(folder)?;
        match atomic_file::own(file.as_file(), file.path()) {
            Ok(true) => return Ok(file),
            // Before it was locked, another process took it for a rest.
            Ok(false) | Err(LockError::Busy) => {}
            Err(error) => return Err(error.into()),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use super::*;

    #[test]
    fn rests_of_killed_processes_go_and_what_others_write_and_own_stays() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("Toy.fmu");
        let file = |name: &str| -> PathBuf {
            let path = folder.path().join(name);
            fs::write(&path, "half").unwrap();
            path
        };
        let rests = [".videg-Toy.fmu-abc123.part", ".videg-Toy.fmu-XYZ789.part"].map(file);
        let at_work = file(".videg-Toy.fmu-def456.part");
        let held = atomic_file::lock(&at_work).unwrap();
        let others = [
            ".videg-Toys.fmu-abc123.part",
            ".videg-Toy.fmu-2-abc123.part",
            ".videg-Toy.fmu-abc1234.part",
            "Toy.fmu.part",
            ".videg-Toy.fmu-abc123",
        ]
        .map(file);
        put(&path, b"whole").unwrap();
        assert!(rests.iter().all(|rest| !rest.exists()));
        assert!(at_work.exists() && others.iter().all(|other| other.exists()));
        assert_eq!(fs::read(&path).unwrap(), b"whole");
        drop(held);
        put(&path, b"again").unwrap();
        assert!(!at_work.exists());
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1 + others.len());
    }

    #[test]
    fn what_is_being_written_is_named_and_locked_so_that_others_leave_it() {
        let folder = tempfile::tempdir().unwrap();
        let file = new_file(folder.path(), ".videg-Toy.fmu-").unwrap();
        assert!(is_rest(file.path().file_name().unwrap(), ".videg-Toy.fmu-"));
        remove_rests(folder.path(), ".videg-Toy.fmu-");
        assert!(file.path().exists());
    }
}
