//! Checks which sweep owns a folder of results: its document says so, and results of no other sweep stand beside it.

use std::io;
use std::path::{Path, PathBuf};

use super::document::{DOCUMENT, identity};
use super::files::{remove, rename, write_synced};
use super::unfinished::{Unfinished, complete_name, unfinished};
use super::{Shard, Sweep, SweepError, statistics, table};
use crate::differences::{digest, told};
use videg_system::atomic_file::partial;

/// Name of the results of a whole sweep.
pub(super) const RESULTS: &str = "sweep.csv";
/// Longest part of a name of a case in that of a folder, characters.
const LONGEST: usize = 80;
/// Advice for a folder of another sweep.
const WAY_OUT: &str = "type the command with another --output to keep both, or with --fresh to replace what is there";

/// All files that may follow from the results at `csv`.
pub(super) fn derived_from(csv: &Path) -> Vec<PathBuf> {
    [table::path(csv)].into_iter().chain(statistics::paths(csv)).collect()
}

/// Takes the folder for the sweep of `document`, whose results go to `path`: locks them, and writes the document. With
/// `fresh` whatever was there goes.
pub(super) fn claim(folder: &Path, document: &str, path: &Path, fresh: bool) -> Result<Unfinished, SweepError> {
    check(folder, document, path, fresh)?;
    let results = Unfinished::take(path)?;
    // Before the lock, another process may have been at it.
    check(folder, document, path, fresh)?;
    if fresh {
        // Results go before the document that says whose they are: killed in between, none are taken for another's.
        remove(path)?;
        derived_from(path).iter().try_for_each(|file| remove(file))?;
        results.file.set_len(0).map_err(SweepError::file("empty", &results.part()))?;
        if read_document(folder)?.is_some_and(|there| there != document) {
            remove(&folder.join(DOCUMENT))?;
        }
    }
    write_document(folder, document, path)?;
    Ok(results)
}

/// That the folder holds this sweep or none; with `fresh`, that no other shard of another sweep would be orphaned.
fn check(folder: &Path, document: &str, path: &Path, fresh: bool) -> Result<(), SweepError> {
    let there = read_document(folder)?;
    if there.as_deref() == Some(document) {
        return Ok(());
    }
    let own = [path.to_owned(), partial(path), unfinished(path)];
    let obstacle = match there {
        _ if fresh => results(folder)?.into_iter().find(|other| !own.contains(other)).map(|other| {
            SweepError::content(&other, "results of another sweep; remove them, or choose another --output")
        }),
        Some(there) => Some(foreign(folder, &there, document, WAY_OUT)),
        None => results(folder)?.first().map(|found| {
            let reason = format!("{DOCUMENT}, which says what sweep it belongs to, is not there; {WAY_OUT}");
            SweepError::content(found, reason)
        }),
    };
    match obstacle {
        // A shard of this sweep that has begun meanwhile has written the document first, then results.
        Some(obstacle) if read_document(folder)?.as_deref() != Some(document) => Err(obstacle),
        _ => Ok(()),
    }
}

/// That the document in the folder is `document`, if there is one.
pub(super) fn check_document(folder: &Path, document: &str) -> Result<(), SweepError> {
    match read_document(folder)? {
        Some(there) if there != document => Err(foreign(folder, &there, document, "choose another --output")),
        _ => Ok(()),
    }
}

/// The folder at `path`, or if another sweep is in it the one beside it that has the digest of `sweep` in its name. Results that are
/// in the latter already stay there.
///
/// # Errors
/// A refusal of the file system.
pub fn free_folder(sweep: &Sweep, path: &Path) -> Result<PathBuf, SweepError> {
    let document = sweep.document();
    let name = |c: char| if c.is_ascii_alphanumeric() || "._-".contains(c) { c } else { '_' };
    let case: String = sweep.name().chars().take(LONGEST).map(name).collect();
    let mut beside = path.as_os_str().to_owned();
    // The name may have the case already.
    if !path.to_string_lossy().ends_with(&case) {
        beside.push(format!("-{case}"));
    }
    beside.push(format!("-{}", digest(document)));
    let is_own = match read_document(path)? {
        Some(there) => there == document,
        None => !path.exists() || results(path)?.is_empty(),
    };
    let beside = PathBuf::from(beside);
    Ok(if is_own && !beside.exists() { path.to_owned() } else { beside })
}

fn foreign(folder: &Path, there: &str, here: &str, way_out: &str) -> SweepError {
    let differences = told(there, here, |[what, was, is]| format!("{what} was {was}, is {is}"));
    let reason = format!("it belongs to another sweep: {differences}; {way_out}");
    SweepError::content(&folder.join(DOCUMENT), reason)
}

/// The document in the folder, if there is one, without checksums.
fn read_document(folder: &Path) -> Result<Option<String>, SweepError> {
    let path = folder.join(DOCUMENT);
    match videg_input::read_text(&path) {
        Ok(there) => Ok(Some(identity(&there))),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
        Err(error) => Err(SweepError::file("read", &path)(error)),
    }
}

/// Files of results in the folder. An empty one that is not complete holds none: its document comes first.
fn results(folder: &Path) -> Result<Vec<PathBuf>, SweepError> {
    let entries = std::fs::read_dir(folder).map_err(SweepError::file("read", folder))?;
    let is_result = |path: &PathBuf| {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let complete = complete_name(&name);
        let is_named = |name: &str| name == RESULTS || Shard::of_file_name(name).is_some();
        is_named(complete.unwrap_or(&name)) && (complete.is_none() || path.metadata().is_ok_and(|file| file.len() > 0))
    };
    Ok(entries.flatten().map(|entry| entry.path()).filter(is_result).collect())
}

/// Writes the document beside `results`, which the caller has locked, unless it is there.
pub(super) fn write_document(folder: &Path, document: &str, results: &Path) -> Result<(), SweepError> {
    let path = folder.join(DOCUMENT);
    // Under a name of its own first, so that a reader never sees half of it.
    let part = results.with_extension("json.part");
    if read_document(folder)?.is_some() {
        remove(&part)?; // of an attempt that was killed
    } else {
        let _begun = write_synced(&part, document.as_bytes()).map_err(SweepError::file("write", &part))?;
        match std::fs::hard_link(&part, &path) {
            // Some file systems have no hard links, and a rename replaces what another process wrote just now: it is
            // compared again once the results are complete.
            Err(error) if error.kind() != io::ErrorKind::AlreadyExists && !path.exists() => {
                rename(&part, &path)?;
            }
            _ => remove(&part)?,
        }
    }
    check_document(folder, document)
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::io::Write as _;

    use super::*;

    const ONE: &str = "{\"seed\": 1}\n";
    const OTHER: &str = "{\"seed\": 2}\n";

    fn claimed(folder: &Path, document: &str, fresh: bool) -> Result<Unfinished, String> {
        claim(folder, document, &folder.join(RESULTS), fresh).map_err(|error| error.to_string())
    }

    fn document(folder: &Path) -> String {
        fs::read_to_string(folder.join(DOCUMENT)).unwrap()
    }

    #[test]
    fn what_cannot_be_removed_stays_with_its_document() {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join(DOCUMENT), ONE).unwrap();
        fs::create_dir(folder.path().join(RESULTS)).unwrap();
        assert!(claimed(folder.path(), OTHER, true).unwrap_err().contains("cannot remove"));
        assert_eq!(document(folder.path()), ONE);
    }

    #[test]
    fn results_that_another_process_writes_keep_their_document() {
        let folder = tempfile::tempdir().unwrap();
        let at_work = claimed(folder.path(), ONE, false).unwrap();
        let message = claimed(folder.path(), OTHER, true).unwrap_err();
        assert!(message.contains("sweep.csv.part is being written by another process"), "{message}");
        assert_eq!(document(folder.path()), ONE);
        drop(at_work);
        claimed(folder.path(), OTHER, true).unwrap();
        assert_eq!(document(folder.path()), OTHER);
    }

    #[test]
    #[cfg(unix)]
    fn documents_and_results_are_not_written_through_links() {
        use std::os::unix::fs::symlink;
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::write(at("other"), "of somebody else").unwrap();
        symlink(at("other"), at("sweep.json.part")).unwrap();
        drop(claimed(folder.path(), ONE, false).unwrap());
        assert_eq!(document(folder.path()), ONE);
        assert!(!at(DOCUMENT).is_symlink());
        symlink(at("other"), at("sweep.csv.part")).unwrap();
        let message = claimed(folder.path(), ONE, true).unwrap_err();
        assert!(message.contains("sweep.csv.part: it is a symbolic link"), "{message}");
        assert_eq!(fs::read_to_string(at("other")).unwrap(), "of somebody else");
    }

    #[test]
    fn an_empty_file_holds_no_results_of_another_sweep() {
        let folder = tempfile::tempdir().unwrap();
        let part = folder.path().join("sweep.csv.part");
        fs::write(&part, "").unwrap();
        claimed(folder.path(), ONE, false).unwrap();
        fs::remove_file(folder.path().join(DOCUMENT)).unwrap();
        fs::write(&part, "run,").unwrap();
        let message = claimed(folder.path(), ONE, false).unwrap_err();
        assert!(
            message.contains("sweep.csv.part: sweep.json, which says what sweep it belongs to, is not"),
            "{message}"
        );
    }

    #[test]
    fn shards_that_begin_at_once_do_not_take_each_other_for_another_sweep() {
        for _ in 0..50 {
            let folder = tempfile::tempdir().unwrap();
            std::thread::scope(|scope| {
                for number in 1..=8 {
                    let folder = folder.path();
                    scope.spawn(move || {
                        let results = folder.join(format!("sweep.{number}-of-8.csv"));
                        let mut results = claim(folder, ONE, &results, number % 2 == 0).unwrap();
                        results.file.write_all(b"run,").unwrap();
                    });
                }
            });
        }
    }

    #[test]
    fn of_two_sweeps_that_begin_at_once_one_has_the_folder() {
        let folder = tempfile::tempdir().unwrap();
        let [one, other] = ["sweep.1-of-2.csv", "sweep.2-of-2.csv"].map(|name| folder.path().join(name));
        write_document(folder.path(), ONE, &one).unwrap();
        let message = write_document(folder.path(), OTHER, &other).unwrap_err().to_string();
        assert!(message.contains("it belongs to another sweep: --seed was 1, is 2;"), "{message}");
        write_document(folder.path(), ONE, &other).unwrap();
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }
}
