//! Temporary folders, readable by the user alone and removed when the process ends, also by a signal to the command-line tool.

use std::collections::BTreeSet;
use std::fs;
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// The folders of this process.
static FOLDERS: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

fn folders() -> MutexGuard<'static, BTreeSet<PathBuf>> {
    FOLDERS.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A new folder, which is removed with this value.
#[derive(Debug)]
pub struct TemporaryFolder {
    path: PathBuf,
}

impl TemporaryFolder {
    /// Makes a folder in the system's folder of temporary files; its name begins with `prefix`.
    ///
    /// # Errors
    /// If the system refuses.
    pub fn new(prefix: &str) -> io::Result<Self> {
        let mut builder = tempfile::Builder::new();
        builder.prefix(prefix);
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o700));
        // Locked, so that `remove_all` comes before or after.
        let mut folders = folders();
        let path = builder.tempdir()?.keep();
        folders.insert(path.clone());
        Ok(Self { path })
    }

    /// Its path.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Keeps the folder.
    pub fn keep(self) -> PathBuf {
        folders().remove(&self.path);
        self.path.clone()
    }
}

impl Drop for TemporaryFolder {
    fn drop(&mut self) {
        let mut folders = folders();
        if folders.remove(&self.path) {
            remove(&self.path);
        }
    }
}

/// Removes the temporary folders of this process, which is about to end. While the returned value lives, no others can be made.
pub fn remove_all() -> impl Sized {
    let mut folders = folders();
    while let Some(folder) = folders.pop_first() {
        remove(&folder);
    }
    folders
}

/// Removes a folder with its content, or reports on stderr that it stays.
fn remove(folder: &Path) {
    // Another thread of this process may be writing into it.
    const TRIES: usize = 3;
    let mut result = fs::remove_dir_all(folder);
    for _ in 1..TRIES {
        match &result {
            Ok(()) => return,
            Err(cause) if cause.kind() == io::ErrorKind::NotFound => return,
            Err(_) => {
                open_up(folder);
                result = fs::remove_dir_all(folder);
            }
        }
    }
    if let Err(cause) = result {
        // An error of stderr itself cannot be reported.
        let _ = writeln!(io::stderr(), "videg: cannot remove the temporary folder {}: {cause}", folder.display());
    }
}

/// Gives the owner all rights to a folder and the folders in it, which an FMU may have taken away.
#[cfg(unix)]
fn open_up(folder: &Path) {
    use std::os::unix::fs::PermissionsExt as _;
    let mut folders = vec![folder.to_owned()];
    while let Some(folder) = folders.pop() {
        // The next try to remove it reports what cannot be changed.
        let _ = fs::set_permissions(&folder, fs::Permissions::from_mode(0o700));
        let entries = fs::read_dir(&folder).into_iter().flatten().flatten();
        // A symbolic link is not followed.
        folders.extend(entries.filter(|it| it.file_type().is_ok_and(|kind| kind.is_dir())).map(|it| it.path()));
    }
}

#[cfg(not(unix))]
fn open_up(_: &Path) {}

#[cfg(test)]
#[cfg(unix)]
mod tests {
    use std::os::unix::fs::PermissionsExt as _;

    use super::*;

    fn mode(path: &Path) -> u32 {
        fs::metadata(path).unwrap().permissions().mode() & 0o7777
    }

    #[test]
    fn nobody_else_may_look_into_a_folder() {
        let folder = TemporaryFolder::new("videg-test-").unwrap();
        assert_eq!(mode(folder.path()), 0o700);
        let path = folder.path().to_owned();
        drop(folder);
        assert!(!path.exists());
    }

    #[test]
    fn a_folder_without_rights_is_removed_and_what_links_lead_to_is_not_touched() {
        let outside = tempfile::tempdir().unwrap();
        fs::set_permissions(outside.path(), fs::Permissions::from_mode(0o750)).unwrap();
        let folder = TemporaryFolder::new("videg-test-").unwrap();
        let inner = folder.path().join("a/b");
        fs::create_dir_all(&inner).unwrap();
        std::os::unix::fs::symlink(outside.path(), folder.path().join("a/link")).unwrap();
        for path in [&inner, &folder.path().join("a")] {
            fs::set_permissions(path, fs::Permissions::from_mode(0o0)).unwrap();
        }
        // The tests may run as one whom rights do not concern, so that removing proves nothing.
        open_up(folder.path());
        assert_eq!((mode(&inner), mode(outside.path())), (0o700, 0o750));
        let path = folder.path().to_owned();
        drop(folder);
        assert!(!path.exists() && outside.path().exists());
    }

    #[test]
    fn what_is_kept_stays() {
        let path = TemporaryFolder::new("videg-test-").unwrap().keep();
        assert!(path.exists());
        fs::remove_dir(path).unwrap();
    }
}
