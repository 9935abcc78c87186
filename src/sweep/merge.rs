//! Putting shards together: the same bytes as those of a sweep that was never divided.

use std::collections::BTreeMap;
use std::io::{self, BufReader, BufWriter, Seek as _, Write as _};
use std::path::{Path, PathBuf};

use super::document::{self, DOCUMENT, Kept};
use super::folder::{self, RESULTS};
use super::run::Report;
use super::unfinished::Unfinished;
use super::{Shard, SweepError, column, derived, files, lines, sums};
use crate::differences::told;
use videg_system::atomic_file::{self, Part};

/// Version of this program: tables that another one writes may have other bytes.
const VERSION: &str = env!("CARGO_PKG_VERSION");

/// Merges the shards in `folders` into `output`.
///
/// # Errors
/// Shards that are missing, there twice, of other sweeps or of other divisions; a refusal of the file system.
pub fn merge(folders: &[PathBuf], output: &Path) -> Result<Report, SweepError> {
    let document = common_document(folders)?;
    let kept = Kept::read(&document, &folders[0])?;
    if kept.videg != VERSION {
        let reason = format!("it is of videg {}, and this is {VERSION}; merge it with that", kept.videg);
        return Err(SweepError::content(&folders[0].join(DOCUMENT), reason));
    }
    let shards = collect(folders)?;
    std::fs::create_dir_all(output).map_err(SweepError::file("make the folder", output))?;
    folder::check_document(output, &document)?;
    let path = output.join(RESULTS);
    let (mut results, _begun) =
        Part::begin(|| Unfinished::take(&path).map(|results| (results, atomic_file::partial(&path))))?;
    let is_new = !output.join(DOCUMENT).exists();
    folder::write_document(output, &document, &path)?;
    let joined = join(&shards, &kept, &results).and_then(|counts| {
        sums::forget(output, &document, &[vec![path.clone()], folder::derived_from(&path)].concat())?;
        results.finish()?;
        Ok(counts)
    });
    let (runs, failed) = match joined {
        Ok(counts) => counts,
        Err(error) => {
            leave(output, results, is_new);
            return Err(error);
        }
    };
    let derived = derived::write(&path, &document, true, false)?;
    let files = [vec![path, output.join(DOCUMENT)], derived.files].concat();
    Ok(Report { runs, done: runs, failed, resumed_from: 0, files, statistics: derived.statistics })
}

/// Removes what a merge that failed has written: the document only if it `is_new`.
fn leave(output: &Path, results: Unfinished, is_new: bool) {
    // The user gets the first error; a document without results only blocks another sweep.
    if results.discard().is_ok() && is_new {
        let _ = files::remove(&output.join(DOCUMENT));
    }
}

/// The document of the first folder, which the others have as well, without checksums.
fn common_document(folders: &[PathBuf]) -> Result<String, SweepError> {
    let mut first = None;
    for folder in folders {
        let path = folder.join(DOCUMENT);
        let text = document::identity(&videg_input::read_text(&path).map_err(SweepError::file("read", &path))?);
        match &first {
            None => first = Some(text),
            Some(first) if *first == text => {}
            Some(first) => {
                let differences = told(first, &text, |[what, there, here]| format!("{what} is {here}, not {there}"));
                let other = folders[0].display();
                let reason = format!("it belongs to another sweep than {other}: {differences}");
                return Err(SweepError::content(&path, reason));
            }
        }
    }
    first.ok_or_else(|| SweepError::Merge { reason: "no folder is given; at least 1 is needed".to_owned() })
}

/// The files of all shards, in their order.
fn collect(folders: &[PathBuf]) -> Result<Vec<(Shard, PathBuf)>, SweepError> {
    let mut found: BTreeMap<String, (Shard, PathBuf)> = BTreeMap::new();
    for folder in folders {
        let entries = std::fs::read_dir(folder).map_err(SweepError::file("read", folder))?;
        let mut paths: Vec<_> = entries.flatten().map(|entry| entry.path()).collect();
        paths.sort();
        for path in paths {
            let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            let Some(shard) = Shard::of_file_name(&name) else { continue };
            if let Some((_, other)) = found.insert(name, (shard, path.clone())) {
                let reason = format!("shard {shard} is there twice, as {} and {}", other.display(), path.display());
                return Err(SweepError::Merge { reason });
            }
        }
    }
    let names: Vec<_> = folders.iter().map(|folder| folder.display().to_string()).collect();
    let Some((first, _)) = found.values().next().cloned() else {
        return Err(SweepError::Merge {
            reason: format!("no complete shard (sweep.i-of-n.csv) in {}", names.join(", ")),
        });
    };
    if let Some((other, path)) = found.values().find(|(shard, _)| shard.of() != first.of()) {
        let reason = format!("{} is of {} shards, others are of {}", path.display(), other.of(), first.of());
        return Err(SweepError::Merge { reason });
    }
    let missing: Vec<_> = Shard::all(first.of()).filter(|shard| !found.contains_key(&shard.file_name())).collect();
    if let Some(one) = missing.first() {
        let (count, of) = (missing.len(), first.of());
        let reason =
            format!("{count} of {of} shards are missing or not complete, the first of them {one}; run it to the end");
        return Err(SweepError::Merge { reason });
    }
    Ok(Shard::all(first.of()).filter_map(|shard| found.remove(&shard.file_name())).collect())
}

/// At which end a copy broke.
enum Broken {
    Read(io::Error),
    Written(io::Error),
}

impl From<io::Error> for Broken {
    fn from(cause: io::Error) -> Self {
        Self::Read(cause)
    }
}

/// Writes the lines of all shards one after the other; how many runs there are, and how many of them failed.
fn join(shards: &[(Shard, PathBuf)], kept: &Kept, results: &Unfinished) -> Result<(u64, u64), SweepError> {
    let heading = column::heading(&kept.columns);
    let (mut runs, mut failed, file) = (0, 0, &results.file);
    let written = |cause| SweepError::file("write", &results.part())(cause);
    let mut out = BufWriter::new(file);
    out.rewind().and_then(|()| file.set_len(0)).and_then(|()| out.write_all(&heading)).map_err(written)?;
    for (shard, path) in shards {
        let mut order = kept.order(Some(*shard));
        let from = BufReader::new(videg_input::open_regular(path).map_err(SweepError::file("open", path))?);
        let extent =
            lines::follow(from, &kept.columns, &mut order, |line| out.write_all(line).map_err(Broken::Written));
        let extent = extent.map_err(|broken| match broken {
            Broken::Read(cause) => SweepError::file("read", path)(cause),
            Broken::Written(cause) => written(cause),
        })?;
        let length = std::fs::metadata(path).map_err(SweepError::file("read", path))?.len();
        extent.check_complete(length, &order).map_err(|reason| SweepError::content(path, reason))?;
        sums::check(path)?;
        runs += extent.lines;
        failed += extent.failed;
    }
    out.flush().and_then(|()| file.sync_all()).map_err(written)?;
    Ok((runs, failed))
}
