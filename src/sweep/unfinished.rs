//! Results that are not complete. While they are written, they have the name of what is being written; when the sweep ends
//! before they are complete, one of their own, under which the same sweep finds them. A process that is killed leaves the
//! first name, which does as well.

use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};

use super::SweepError;
use super::files::{lock, remove};
use videg_system::atomic_file::partial;

/// Name of the results for `path` that are not complete and that nobody is writing.
pub(super) fn unfinished(path: &Path) -> PathBuf {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(".unfinished");
    path.with_file_name(name)
}

/// The file with this name, if that is one of results that are not complete, under the name of complete ones.
pub(super) fn complete_name(name: &str) -> Option<&str> {
    name.strip_suffix(".part").or_else(|| name.strip_suffix(".unfinished"))
}

/// Results that this process is writing. Dropped before they are complete, they get their other name; empty ones go.
#[derive(Debug)]
pub(super) struct Unfinished {
    pub file: File,
    path: PathBuf,
    has_ended: bool,
}

impl Unfinished {
    /// Takes the results for `path`: those of a sweep that ended early, or new ones.
    pub fn take(path: &Path) -> Result<Self, SweepError> {
        let (part, kept) = (partial(path), unfinished(path));
        loop {
            let file = lock(&part)?;
            let length = file.metadata().map_err(SweepError::file("read", &part))?.len();
            // Of two, those that are being written are the newer ones.
            match if length == 0 { std::fs::rename(&kept, &part) } else { Err(io::ErrorKind::NotFound.into()) } {
                Ok(()) => {} // To be locked in their turn.
                Err(cause) if cause.kind() == io::ErrorKind::NotFound => {
                    return Ok(Self { file, path: path.to_owned(), has_ended: false });
                }
                Err(cause) => return Err(SweepError::file("rename", &kept)(cause)),
            }
        }
    }

    /// Where they are while they are written.
    pub fn part(&self) -> PathBuf {
        partial(&self.path)
    }

    /// Where they are if they do not become complete.
    pub fn kept(&self) -> PathBuf {
        unfinished(&self.path)
    }

    /// Gives complete results their name.
    pub fn finish(&mut self) -> Result<(), SweepError> {
        std::fs::rename(self.part(), &self.path).map_err(SweepError::file("rename", &self.part()))?;
        self.has_ended = true;
        remove(&self.kept())
    }

    /// Removes what there is.
    pub fn discard(mut self) -> Result<(), SweepError> {
        self.has_ended = true;
        remove(&self.part()).and_then(|()| remove(&self.kept()))
    }
}

impl Drop for Unfinished {
    fn drop(&mut self) {
        if self.has_ended {
            return;
        }
        let is_empty = self.file.metadata().is_ok_and(|file| file.len() == 0);
        // If the file system refuses, the file stays as a killed process leaves it.
        let _ = if is_empty { std::fs::remove_file(self.part()) } else { std::fs::rename(self.part(), self.kept()) };
    }
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::io::Write as _;

    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap();
        entries.map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned()).collect()
    }

    #[test]
    fn results_that_are_not_complete_get_a_name_of_their_own_and_are_taken_again() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("sweep.csv");
        drop(Unfinished::take(&path).unwrap());
        assert!(names(folder.path()).is_empty(), "nothing was written");
        let mut results = Unfinished::take(&path).unwrap();
        results.file.write_all(b"run,").unwrap();
        assert_eq!(names(folder.path()), ["sweep.csv.part"]);
        assert!(Unfinished::take(&path).is_err(), "another one is writing them");
        drop(results);
        assert_eq!(names(folder.path()), ["sweep.csv.unfinished"]);
        let mut results = Unfinished::take(&path).unwrap();
        assert_eq!((results.file.metadata().unwrap().len(), names(folder.path())), (4, vec!["sweep.csv.part".into()]));
        results.finish().unwrap();
        assert_eq!(names(folder.path()), ["sweep.csv"]);
    }

    #[test]
    fn what_a_killed_process_left_comes_before_what_is_older() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("sweep.csv");
        fs::write(partial(&path), "newer").unwrap();
        fs::write(unfinished(&path), "older").unwrap();
        let results = Unfinished::take(&path).unwrap();
        assert_eq!(results.file.metadata().unwrap().len(), 5);
        assert_eq!(fs::read_to_string(results.part()).unwrap(), "newer");
        results.discard().unwrap();
        assert!(names(folder.path()).is_empty());
    }
}
