//! Folders for results. Those that this process has made and that stay empty go when it ends, also by a signal.

use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// The folders that this process has made, each before those in it.
static MADE: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// Makes the folder at `path` and those above it, as far as they are missing.
///
/// # Errors
/// A refusal of the file system.
pub fn make(path: &Path) -> io::Result<()> {
    // Locked, so that `remove_empty` comes before or after.
    let mut made = MADE.lock().unwrap_or_else(PoisonError::into_inner);
    let missing: Vec<_> =
        path.ancestors().take_while(|folder| !folder.as_os_str().is_empty() && !folder.exists()).collect();
    std::fs::create_dir_all(path)?;
    made.extend(missing.into_iter().rev().map(Path::to_owned));
    Ok(())
}

/// Removes the folders that this process has made, as far as nothing is in them.
pub fn remove_empty() {
    let mut made = MADE.lock().unwrap_or_else(PoisonError::into_inner);
    for folder in made.drain(..).rev() {
        // One that has content is refused, and stays.
        let _ = std::fs::remove_dir(folder);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_folders_made_here_in_which_nothing_is_are_removed() {
        let guard = tempfile::tempdir().unwrap();
        let at = |name: &str| guard.path().join(name);
        std::fs::create_dir(at("there")).unwrap();
        for name in ["there", "there/a/b", "used/a"] {
            make(&at(name)).unwrap();
        }
        std::fs::write(at("used/result.json"), "{}").unwrap();
        remove_empty();
        assert_eq!(["there", "there/a", "used", "used/a"].map(|name| at(name).exists()), [true, false, true, false]);
    }
}
