//! Checksums of complete results, at the end of the document: they reveal a file that changed later on a disk or on the way
//! to another machine.

use std::fs::File;
use std::io::{self, Read as _};
use std::path::Path;
use std::time::{Duration, Instant};

use sha2::{Digest as _, Sha256};

use super::SweepError;
use super::document::{DOCUMENT, Sum, Sums, hexadecimal, sums, with_sums};
use super::files::{lock, remove, rename, write_synced};
use super::folder::{self, RESULTS};
use videg_system::atomic_file::{self, Part};

/// The process that has this file locked writes the checksums.
const LOCK: &str = "sweep.json.lock.part";
/// How long to wait for another shard that writes its own.
const PATIENCE: Duration = Duration::from_secs(60);

/// Checks a complete file of results against `sweep.json` beside it; false if that has no checksum of it.
pub(super) fn check(path: &Path) -> Result<bool, SweepError> {
    let Some(expected) = read(&path.with_file_name(DOCUMENT))?.remove(&name(path)) else { return Ok(false) };
    let found = Sum::of(path)?;
    let changed = |what: String| {
        let anew = if folder::derived_from(&path.with_file_name(RESULTS)).iter().any(|it| it == path) {
            "removed, it is made again"
        } else {
            "--fresh makes it anew"
        };
        let reason = format!("{what}; it was changed after it was complete: {anew}");
        Err(SweepError::content(path, reason))
    };
    if found.bytes != expected.bytes {
        return changed(format!("it has {} bytes, and {DOCUMENT} expects {}", found.bytes, expected.bytes));
    }
    if found.sha256 != expected.sha256 {
        return changed(format!("its SHA-256 is {}, and {DOCUMENT} expects {}", found.sha256, expected.sha256));
    }
    Ok(true)
}

/// Adds the checksums of complete `results` to their `document` in the folder.
pub(super) fn record(folder: &Path, document: &str, results: &[&Path]) -> Result<(), SweepError> {
    let Some(first) = results.first() else { return Ok(()) };
    // Before its turn: others wait for the end of that, and large results take long.
    let new: Vec<_> =
        results.iter().map(|result| Ok((name(result), Sum::of(result)?))).collect::<Result<_, SweepError>>()?;
    change(folder, document, first, |sums| sums.extend(new))
}

/// Removes files that a killed process left in [`record`].
pub(super) fn clear(folder: &Path) {
    // It blocks nothing.
    let _ = atomic_file::remove_abandoned(&folder.join(LOCK));
}

/// Takes out the checksums of `results`, which are about to be replaced.
pub(super) fn forget(folder: &Path, document: &str, results: &[impl AsRef<Path>]) -> Result<(), SweepError> {
    let Some(first) = results.first() else { return Ok(()) };
    let sums = read(&folder.join(DOCUMENT))?;
    if results.iter().all(|result| !sums.contains_key(&name(result.as_ref()))) {
        return Ok(());
    }
    change(folder, document, first.as_ref(), |sums| {
        sums.retain(|of, _| results.iter().all(|result| name(result.as_ref()) != *of));
    })
}

/// Changes the checksums in the `document` of the folder, on behalf of the result at `first`.
fn change(folder: &Path, document: &str, first: &Path, change: impl FnOnce(&mut Sums)) -> Result<(), SweepError> {
    let own = folder.join(LOCK);
    let turn = wait_for(&own)?;
    let written = write(folder, document, first, change);
    let removed = remove(&own);
    drop(turn);
    written.and(removed)
}

/// Writes the `document` of the folder with other checksums.
fn write(folder: &Path, document: &str, first: &Path, change: impl FnOnce(&mut Sums)) -> Result<(), SweepError> {
    let path = folder.join(DOCUMENT);
    folder::check_document(folder, document)?;
    let mut sums = read(&path)?;
    change(&mut sums);
    let text = with_sums(document, &sums).map_err(|error| SweepError::content(&path, error.to_string()))?;
    // Under another name first: where the file system has no locks, the sums of a shard may get lost, and no more.
    let part = first.with_extension("json.part");
    let _begun = write_synced(&part, text.as_bytes()).map_err(SweepError::file("write", &part))?;
    rename(&part, &path)
}

/// Waits until no other shard of the folder writes its own: they take turns.
fn wait_for(own: &Path) -> Result<(File, Part), SweepError> {
    let end = Instant::now() + PATIENCE;
    loop {
        match Part::begin(|| lock(own).map(|file| (file, own.to_owned()))) {
            Err(SweepError::Locked { .. }) if Instant::now() < end => std::thread::sleep(Duration::from_millis(10)),
            other => return other,
        }
    }
}

/// The checksums in the document at `path`.
fn read(path: &Path) -> Result<Sums, SweepError> {
    let text = std::fs::read_to_string(path).map_err(SweepError::file("read", path))?;
    sums(&text).map_err(|error| SweepError::content(path, error.to_string()))
}

fn name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

impl Sum {
    /// Of the file at `path`, which may be larger than the memory.
    fn of(path: &Path) -> Result<Self, SweepError> {
        let summed = || -> io::Result<Self> {
            let (mut file, mut hash, mut chunk, mut bytes) = (File::open(path)?, Sha256::new(), vec![0; 1 << 16], 0);
            loop {
                let count = file.read(&mut chunk)?;
                if count == 0 {
                    return Ok(Self { bytes, sha256: hexadecimal(&hash.finalize()) });
                }
                hash.update(&chunk[..count]);
                bytes += count as u64;
            }
        };
        summed().map_err(SweepError::file("read", path))
    }
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::path::PathBuf;

    use super::*;
    use crate::sweep::document::identity;

    const DECIDES: &str = "{\n  \"seed\": 1,\n  \"sha256\": \"00\"\n}\n";

    /// A folder with a document, and files of these names and contents at these paths.
    fn folder<const N: usize>(files: [(&str, &str); N]) -> (tempfile::TempDir, [PathBuf; N]) {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join(DOCUMENT), DECIDES).unwrap();
        let paths = files.map(|(name, content)| {
            let path = folder.path().join(name);
            fs::write(&path, content).unwrap();
            path
        });
        (folder, paths)
    }

    #[test]
    fn shards_of_one_folder_add_their_checksums_and_what_decides_stays_the_same() {
        let (folder, [one, other]) = folder([("sweep.1-of-2.csv", "abc"), ("sweep.2-of-2.csv", "")]);
        assert!(!check(&one).unwrap(), "nothing is said of it yet");
        record(folder.path(), DECIDES, &[&one]).unwrap();
        record(folder.path(), DECIDES, &[&other]).unwrap();
        assert!(check(&one).unwrap() && check(&other).unwrap());
        let text = fs::read_to_string(folder.path().join(DOCUMENT)).unwrap();
        assert_eq!(identity(&text), DECIDES);
        let read: serde_json::Value = serde_json::from_str(&text).unwrap();
        // FIPS 180-4, the example of "abc".
        let known = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
        assert_eq!(read["results"]["sweep.1-of-2.csv"]["sha256"], known);
        assert_eq!(read["results"]["sweep.2-of-2.csv"]["bytes"], 0);
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 3);
        fs::write(&one, "abcd").unwrap();
        let message = check(&one).unwrap_err().to_string();
        assert!(
            message.contains("sweep.1-of-2.csv: it has 4 bytes, and sweep.json expects 3; it was changed"),
            "{message}"
        );
    }

    #[test]
    fn what_is_about_to_be_replaced_has_no_checksum() {
        let (folder, [one, other]) = folder([("sweep.csv", "abc"), ("sweep.parquet", "")]);
        forget(folder.path(), DECIDES, &[&one]).unwrap();
        record(folder.path(), DECIDES, &[&one, &other]).unwrap();
        forget(folder.path(), DECIDES, &[&one]).unwrap();
        fs::write(&one, "abd").unwrap();
        assert!(!check(&one).unwrap() && check(&other).unwrap());
        assert_eq!(identity(&fs::read_to_string(folder.path().join(DOCUMENT)).unwrap()), DECIDES);
    }
}
