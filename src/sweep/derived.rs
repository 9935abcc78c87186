//! Files that follow from complete results: the table with types and, of several samples, the statistics.

use std::path::{Path, PathBuf};

use super::document::Kept;
use super::summary::Summary;
use super::{SweepError, statistics, sums, table};

/// What follows from results.
pub(super) struct Derived {
    pub files: Vec<PathBuf>,
    pub statistics: Option<Summary>,
}

/// Writes the files that follow from the complete results at `csv`, unless they are there and not to be made `anew`. With
/// `is_summed` the results have their checksum already; the others get it.
pub(super) fn write(csv: &Path, document: &str, anew: bool, is_summed: bool) -> Result<Derived, SweepError> {
    let folder = csv.parent().unwrap_or(Path::new(""));
    let kept = Kept::read(document, folder)?;
    let mut files = vec![table::write(csv, &kept.columns, document, anew)?];
    let made = statistics::has(&kept).then(|| statistics::write(csv, &kept, anew)).transpose()?;
    let statistics = made.map(|(summary, written)| {
        files.extend(written);
        summary
    });
    let mut missing: Vec<&Path> = (!is_summed).then_some(csv).into_iter().collect();
    for file in &files {
        if anew || !sums::check(file)? {
            missing.push(file);
        }
    }
    if missing.is_empty() {
        sums::clear(folder);
    } else {
        sums::record(folder, document, &missing)?;
    }
    Ok(Derived { files, statistics })
}
