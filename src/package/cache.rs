//! FMUs in the user's cache folder, for a read-only source tree. Their folder is named after a hash of their content, so that each
//! program has its own.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use sha2::{Digest as _, Sha256};

use super::error::{PackageError, Result};
use super::write;

/// Packaged FMUs.
#[derive(Debug)]
pub struct Placed {
    /// In the order of [`super::FMUS`].
    pub archives: Vec<PathBuf>,
    /// Why they are in the cache, if they are.
    pub refused: Option<PackageError>,
}

/// Writes the archives into `folder`, or else into a folder of their own in the cache.
///
/// # Errors
/// When neither can be written.
pub(super) fn place(archives: &[Vec<u8>], folder: &Path, caches: Option<PathBuf>) -> Result<Placed> {
    let refused = match write(archives, folder) {
        Ok(archives) => return Ok(Placed { archives, refused: None }),
        Err(refused) => refused,
    };
    let Some(caches) = caches else { return Err(PackageError::NoPlace { refused: refused.into(), cached: None }) };
    match write(archives, &caches.join("videg").join(name(archives))) {
        Ok(archives) => Ok(Placed { archives, refused: Some(refused) }),
        Err(cached) => Err(PackageError::NoPlace { refused: refused.into(), cached: Some(cached.into()) }),
    }
}

/// The folder of the archives: version, and the beginning of a SHA-256 of all their bytes.
fn name(archives: &[Vec<u8>]) -> String {
    let hash = Sha256::digest(archives.concat());
    let beginning = hash.iter().take(8).fold(0_u64, |number, byte| number << 8 | u64::from(*byte));
    format!("{}-{beginning:016x}", env!("CARGO_PKG_VERSION"))
}

/// The user's cache folder: `XDG_CACHE_HOME`, or that of the system.
pub(super) fn folder() -> Option<PathBuf> {
    folder_of(|name| std::env::var_os(name), std::env::home_dir())
}

fn folder_of(variable: impl Fn(&str) -> Option<OsString>, home: Option<PathBuf>) -> Option<PathBuf> {
    // The XDG specification wants relative paths to be ignored.
    let absolute = |name| variable(name).map(PathBuf::from).filter(|path| path.is_absolute());
    let of_system = || match std::env::consts::OS {
        "windows" => absolute("LOCALAPPDATA"),
        "macos" => home.map(|home| home.join("Library/Caches")),
        _ => home.map(|home| home.join(".cache")),
    };
    absolute("XDG_CACHE_HOME").or_else(of_system)
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    #[test]
    fn where_neither_can_be_written_both_are_named() {
        let guard = tempfile::tempdir().unwrap();
        let [tree, caches] = ["tree", "caches"].map(|name| guard.path().join(name));
        for path in [&tree, &caches] {
            fs::write(path, "no folder").unwrap();
        }
        for (asked, named) in [(Some(caches.clone()), "caches"), (None, "there is no folder of caches")] {
            let archives = [b"harvester".to_vec(), b"circuit".to_vec()];
            let said = place(&archives, &tree, asked).unwrap_err().to_string();
            assert!(said.contains("tree") && said.contains(named) && said.contains("set XDG_CACHE_HOME to"), "{said}");
        }
    }

    #[test]
    fn the_folder_of_caches_is_the_one_that_is_named_or_that_of_the_system() {
        let home = std::env::temp_dir();
        let named = home.join("named").into_os_string();
        let of = |value: Option<OsString>| {
            folder_of(|name| if name == "XDG_CACHE_HOME" { value.clone() } else { None }, Some(home.clone()))
        };
        assert_eq!(of(Some(named.clone())), Some(named.into()));
        if cfg!(target_os = "linux") {
            assert_eq!(of(Some("relative".into())), Some(home.join(".cache")));
            assert_eq!(of(None), Some(home.join(".cache")));
        }
    }
}
