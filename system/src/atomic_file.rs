//! Files written atomically: under another name, forced to the disk, then renamed. A crash leaves the old file or the new one,
//! never part of one. A signal that ends the command-line tool removes its unfinished files (`remove_all`).

use std::cell::RefCell;
use std::collections::BTreeSet;
use std::fs::File;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

pub use crate::lock::{LockError, lock, own, remove_abandoned};

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

    /// Forces the file to the disk and renames it, or leaves that to the [`Batch`] of its folder.
    ///
    /// # Errors
    /// A refusal of the file system; the old file stays.
    pub fn finish(self) -> io::Result<()> {
        match self.file.sync_all() {
            Ok(()) => Batch::take(self).map_or(Ok(()), Self::rename),
            Err(error) => {
                self.discard();
                Err(error)
            }
        }
    }

    fn rename(self) -> io::Result<()> {
        let renamed = std::fs::rename(&self.part.path, &self.path);
        if renamed.is_err() {
            self.discard();
        }
        renamed
    }

    /// Removes the file; the old one stays.
    fn discard(self) {
        // The user is told why it could not be written.
        let _ = std::fs::remove_file(&self.part.path);
    }
}

thread_local! {
    /// The folder of the batch of this thread, and its files that are complete.
    static BATCH: RefCell<Option<(PathBuf, Vec<AtomicFile>)>> = const { RefCell::new(None) };
}

/// The files of a folder that this thread finishes get their names together, by [`Batch::commit`]; before, a signal removes all
/// of them. Dropped, it removes them.
#[derive(Debug)]
#[must_use]
pub struct Batch(());

impl Batch {
    /// Begins the batch of `folder`.
    pub fn begin(folder: &Path) -> Self {
        BATCH.set(Some((folder.to_owned(), Vec::new())));
        Self(())
    }

    /// Takes `file` if it belongs to the batch, or gives it back.
    fn take(file: AtomicFile) -> Option<AtomicFile> {
        BATCH.with_borrow_mut(|batch| match batch {
            Some((folder, files)) if file.path.starts_with(&*folder) => {
                files.push(file);
                None
            }
            _ => Some(file),
        })
    }

    /// Gives the files their names. A signal comes before the first or after the last.
    ///
    /// # Errors
    /// A refusal of the file system; files that have their names by then keep them.
    pub fn commit(self) -> io::Result<()> {
        let files = BATCH.take().map(|(_, files)| files).unwrap_or_default();
        let renamed: Vec<_> = {
            let _signals_wait = parts();
            files.iter().map(|file| std::fs::rename(&file.part.path, &file.path)).collect()
        };
        let failed = files.into_iter().zip(renamed).filter_map(|(file, renamed)| {
            let cause = renamed.err()?;
            file.discard();
            Some(cause)
        });
        // All of them, so that each file goes.
        failed.collect::<Vec<_>>().into_iter().next().map_or(Ok(()), Err)
    }
}

impl Drop for Batch {
    fn drop(&mut self) {
        let files = BATCH.take().map(|(_, files)| files).unwrap_or_default();
        files.into_iter().for_each(AtomicFile::discard);
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
    fn the_files_of_a_batch_get_their_names_together_or_go() {
        let folder = tempfile::tempdir().unwrap();
        let [other, own] = ["other", "own"].map(|name| folder.path().join(name));
        fs::create_dir(&own).unwrap();
        let write_both = || {
            write(&own.join("a.csv"), "a").unwrap();
            write(&own.join("b.csv"), "b").unwrap();
            write(&other, "of no batch").unwrap();
        };
        let batch = Batch::begin(&own);
        write_both();
        assert_eq!((entries(&own), other.exists()), (vec!["a.csv.part".into(), "b.csv.part".into()], true));
        drop(batch);
        assert!(entries(&own).is_empty());
        let batch = Batch::begin(&own);
        write_both();
        fs::create_dir(own.join("a.csv")).unwrap();
        assert!(batch.commit().is_err());
        assert_eq!(entries(&own), ["a.csv", "b.csv"]);
        fs::remove_dir(own.join("a.csv")).unwrap();
        let batch = Batch::begin(&own);
        write_both();
        batch.commit().unwrap();
        assert_eq!(entries(&own), ["a.csv", "b.csv"]);
        write(&own.join("c.csv"), "after it").unwrap();
        assert_eq!(entries(&own), ["a.csv", "b.csv", "c.csv"]);
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
}
