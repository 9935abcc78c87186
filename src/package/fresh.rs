//! Whether a library is as new as its sources, so that Cargo need not run.

use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// True if no source in the dep-info file that Cargo leaves beside `library`, nor the workspace's manifest or lock file, is newer.
/// In doubt, false.
pub(super) fn is_fresh(library: &Path, workspace: &Path) -> bool {
    let check = || {
        let built = modified(library)?;
        let sources = sources(&std::fs::read_to_string(library.with_extension("d")).ok()?)?;
        let manifests = ["Cargo.toml", "Cargo.lock"].map(|name| workspace.join(name));
        let mut all = sources.iter().chain(&manifests);
        Some(all.all(|path| modified(path).is_some_and(|changed| changed <= built)))
    };
    check().unwrap_or(false)
}

fn modified(path: &Path) -> Option<SystemTime> {
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
        for name in ["Cargo.toml", "Cargo.lock", "a b.rs", "c.rs", "libx.so"] {
            std::fs::write(path(name), "").unwrap();
        }
        let escaped = path("a b.rs").display().to_string().replace(' ', "\\ ");
        let dep_info = format!("{}: {escaped} {}\n", path("libx.so").display(), path("c.rs").display());
        assert!(!is_fresh(&path("libx.so"), folder.path()), "no dep-info");
        std::fs::write(path("libx.d"), dep_info).unwrap();
        assert!(is_fresh(&path("libx.so"), folder.path()));
        for name in ["a b.rs", "Cargo.lock"] {
            let old = modified(&path(name)).unwrap();
            let file = std::fs::File::options().write(true).open(path(name)).unwrap();
            file.set_modified(SystemTime::now() + std::time::Duration::from_secs(5)).unwrap();
            assert!(!is_fresh(&path("libx.so"), folder.path()), "{name} is newer");
            file.set_modified(old).unwrap();
        }
        std::fs::remove_file(path("c.rs")).unwrap();
        assert!(!is_fresh(&path("libx.so"), folder.path()), "a source is gone");
    }
}
