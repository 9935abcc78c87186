//! Files that several processes may write at once, atomically; unfinished files of killed processes are removed.

use std::ffi::OsStr;
use std::fs;
use std::io::{self, Write as _};
use std::path::Path;

use tempfile::NamedTempFile;

use super::error::{PackageError, Result};
use videg_system::atomic_file::{self, LockError, Part};

/// Name of an unfinished file: these around the name of the file and random letters.
const PREFIX: &str = ".fmu-package-";
const SUFFIX: &str = ".part";
/// Number of the letters.
const LETTERS: usize = 6;

/// Writes a file under another name and renames it, atomically. Of several processes that do so at once, the last one wins.
///
/// # Errors
/// When the folder cannot be made or the file not be written.
pub fn write_shared(path: &Path, bytes: &[u8]) -> Result<()> {
    let folder = path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
    fs::create_dir_all(folder).map_err(PackageError::io("create", folder))?;
    let prefix = format!("{PREFIX}{}-", path.file_name().unwrap_or_default().to_string_lossy());
    // First, since a full disk needs their room.
    remove_abandoned(folder, &prefix);
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

/// Removes the unfinished files with this prefix whose processes have ended: they held locks. A file that cannot be removed is left.
fn remove_abandoned(folder: &Path, prefix: &str) {
    let Ok(entries) = fs::read_dir(folder) else { return };
    for entry in entries.flatten().filter(|entry| is_unfinished(&entry.file_name(), prefix)) {
        let _ = atomic_file::remove_abandoned(&entry.path());
    }
}

/// Whether this is the name of an unfinished file; that of another archive may begin with the same prefix.
fn is_unfinished(name: &OsStr, prefix: &str) -> bool {
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
            // Before it was locked, another process took it for an abandoned one.
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
    fn unfinished_files_of_killed_processes_are_removed_and_all_others_stay() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("Toy.fmu");
        let file = |name: &str| -> PathBuf {
            let path = folder.path().join(name);
            fs::write(&path, "half").unwrap();
            path
        };
        let abandoned = [".fmu-package-Toy.fmu-abc123.part", ".fmu-package-Toy.fmu-XYZ789.part"].map(file);
        let at_work = file(".fmu-package-Toy.fmu-def456.part");
        let held = atomic_file::lock(&at_work).unwrap();
        let others = [
            ".fmu-package-Toys.fmu-abc123.part",
            ".fmu-package-Toy.fmu-2-abc123.part",
            ".fmu-package-Toy.fmu-abc1234.part",
            "Toy.fmu.part",
            ".fmu-package-Toy.fmu-abc123",
        ]
        .map(file);
        write_shared(&path, b"first").unwrap();
        assert!(abandoned.iter().all(|file| !file.exists()));
        assert!(at_work.exists() && others.iter().all(|other| other.exists()));
        assert_eq!(fs::read(&path).unwrap(), b"first");
        drop(held);
        write_shared(&path, b"again").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"again");
        assert!(!at_work.exists());
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1 + others.len());
    }

    #[test]
    fn an_unfinished_file_is_locked_so_that_others_leave_it() {
        let folder = tempfile::tempdir().unwrap();
        let file = new_file(folder.path(), ".fmu-package-Toy.fmu-").unwrap();
        assert!(is_unfinished(file.path().file_name().unwrap(), ".fmu-package-Toy.fmu-"));
        remove_abandoned(folder.path(), ".fmu-package-Toy.fmu-");
        assert!(file.path().exists());
    }
}
