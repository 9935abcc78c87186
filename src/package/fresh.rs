//! Whether a library is as new as its sources, so that Cargo need not run.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// True if no source in the dep-info file that Cargo leaves beside `library`, nor a manifest of theirs, the lock file or Cargo's
/// configuration, is newer than `asked`, when Cargo was asked for it, or than the library where that is not known. In doubt, false.
pub(super) fn is_fresh(library: &Path, asked: Option<SystemTime>, workspace: &Path) -> bool {
    let check = || {
        let built = asked.or_else(|| modified(library))?;
        let sources = sources(&std::fs::read_to_string(library.with_extension("d")).ok()?)?;
        let manifests = ["Cargo.toml", "Cargo.lock"].map(|name| workspace.join(name));
        let mut all = sources.iter().chain(&manifests);
        let is_old = |path: &Path| modified(path).is_some_and(|changed| changed <= built);
        let settings = settings(&sources, workspace);
        Some(all.all(|path| is_old(path)) && settings.iter().all(|path| !path.exists() || is_old(path)))
    };
    check().unwrap_or(false)
}

/// Name of the file that tells by its time when Cargo was last asked for the libraries in a folder.
const ASKED: &str = "fmus.asked";

/// Writes down that Cargo was asked at `time` for what lies in `folder`: a source saved while it was built may be newer than what was
/// compiled and older than the library. Where nothing can be written, Cargo is asked each time.
pub(super) fn note(folder: &Path, time: SystemTime) {
    let _ = std::fs::File::create(folder.join(ASKED)).and_then(|file| file.set_modified(time));
}

/// When Cargo was last asked for what lies in `folder`.
pub(super) fn asked(folder: &Path) -> Option<SystemTime> {
    modified(&folder.join(ASKED))
}

/// Files that may be there: the manifests of the packages that the sources belong to, and Cargo's configuration.
fn settings(sources: &[PathBuf], workspace: &Path) -> BTreeSet<PathBuf> {
    let folders = sources.iter().flat_map(|source| source.ancestors().skip(1));
    let manifests = folders.filter(|folder| folder.starts_with(workspace)).map(|folder| folder.join("Cargo.toml"));
    manifests.chain([workspace.join(".cargo").join("config.toml")]).collect()
}

/// When a file last changed.
pub(super) fn modified(path: &Path) -> Option<SystemTime> {
    std::fs::metadata(path).ok()?.modified().ok()
}

/// The sources in a dep-info file: one line, `library: source source`, with blanks inside names escaped.
fn sources(dep_info: &str) -> Option<Vec<PathBuf>> {
    const BLANK: &str = "\u{0}";
    let line = dep_info.lines().next()?.replace("\\ ", BLANK);
    let (_, sources) = line.split_once(": ")?;
    Some(sources.split_whitespace().map(|source| source.replace(BLANK, " ").into()).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_library_older_than_one_of_its_sources_is_not_fresh() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        std::fs::create_dir(path("x")).unwrap();
        for name in ["Cargo.toml", "Cargo.lock", "a b.rs", "x/c.rs", "x/Cargo.toml", "libx.so"] {
            std::fs::write(path(name), "").unwrap();
        }
        let escaped = path("a b.rs").display().to_string().replace(' ', "\\ ");
        let dep_info = format!("{}: {escaped} {}\n", path("libx.so").display(), path("x/c.rs").display());
        assert!(!is_fresh(&path("libx.so"), None, folder.path()), "no dep-info");
        std::fs::write(path("libx.d"), dep_info).unwrap();
        assert!(is_fresh(&path("libx.so"), None, folder.path()));
        for name in ["a b.rs", "Cargo.lock", "x/Cargo.toml"] {
            let old = modified(&path(name)).unwrap();
            let file = std::fs::File::options().write(true).open(path(name)).unwrap();
            file.set_modified(SystemTime::now() + std::time::Duration::from_secs(5)).unwrap();
            assert!(!is_fresh(&path("libx.so"), None, folder.path()), "{name} is newer");
            file.set_modified(old).unwrap();
        }
        // Saved while the library was built.
        let before = modified(&path("a b.rs")).unwrap() - std::time::Duration::from_secs(1);
        note(folder.path(), before);
        assert_eq!(asked(folder.path()), Some(before));
        assert!(!is_fresh(&path("libx.so"), Some(before), folder.path()));
        // Cargo saw a newer lock file.
        let later = modified(&path("libx.so")).unwrap() + std::time::Duration::from_secs(10);
        let lock = std::fs::File::options().write(true).open(path("Cargo.lock")).unwrap();
        lock.set_modified(later - std::time::Duration::from_secs(5)).unwrap();
        assert!(!is_fresh(&path("libx.so"), None, folder.path()));
        assert!(is_fresh(&path("libx.so"), Some(later), folder.path()));
        std::fs::remove_file(path("x/c.rs")).unwrap();
        assert!(!is_fresh(&path("libx.so"), None, folder.path()), "a source is gone");
    }
}
