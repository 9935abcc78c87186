//! Files and folders that go into an FMU as they are.

use std::path::{Path, PathBuf};

use super::entries::Entries;
use super::error::{PackageError, Result};

/// Largest file, in bytes.
const LARGEST: u64 = 256 << 20;

/// Deepest folder within a folder.
const DEEPEST: usize = 16;

/// Adds `files` to the folder `resources` of an archive, each under its own name.
///
/// # Errors
/// A file that cannot be read, is no regular one or too large; a name that is none on some system, or that two have.
pub fn add_resources(files: &[PathBuf], entries: &mut Entries) -> Result<()> {
    files.iter().try_for_each(|path| add_into("resources", path, entries))
}

/// Adds a folder with all that is in it, if it is there, under the name `into`. Names that begin with a dot are left out.
///
/// # Errors
/// As [`add_resources`], and if folders are too deep.
pub(crate) fn add_folder(folder: &Path, into: &str, entries: &mut Entries) -> Result<()> {
    if !folder.is_dir() {
        return Ok(());
    }
    let refuse = |reason: String| PackageError::File { path: folder.to_owned(), reason };
    if into.split('/').count() > DEEPEST {
        return Err(refuse(format!("it is more than {DEEPEST} folders deep")));
    }
    let read = || std::fs::read_dir(folder)?.map(|entry| Ok(entry?.path())).collect::<std::io::Result<Vec<_>>>();
    for path in read().map_err(PackageError::io("read", folder))? {
        let hidden = path.file_name().is_some_and(|name| name.to_string_lossy().starts_with('.'));
        if hidden {
            continue;
        }
        if path.is_dir() {
            let name = resource_name(&path).map_err(|reason| PackageError::File { path: path.clone(), reason })?;
            add_folder(&path, &format!("{into}/{name}"), entries)?;
        } else {
            add_into(into, &path, entries)?;
        }
    }
    Ok(())
}

/// Adds a file to a folder of the archive.
fn add_into(folder: &str, path: &Path, entries: &mut Entries) -> Result<()> {
    let refuse = |reason: String| PackageError::File { path: path.to_owned(), reason };
    let name = format!("{folder}/{}", resource_name(path).map_err(refuse)?);
    let is_twin = |other: &str| other.to_lowercase() == name.to_lowercase();
    if entries.names().any(is_twin) {
        return Err(refuse(format!("{name} is in the FMU already")));
    }
    let bytes = std::fs::metadata(path).map_err(PackageError::io("read", path))?.len();
    if bytes > LARGEST {
        return Err(refuse(format!("it has {bytes} bytes; at most {LARGEST}")));
    }
    entries.add(&name, videg_input::read(path).map_err(PackageError::io("read", path))?);
    Ok(())
}

/// The name of a file or folder in an archive: that which it has in its own.
///
/// # Errors
/// A name that is none on some system.
pub(crate) fn resource_name(path: &Path) -> std::result::Result<&str, String> {
    let name = path.file_name().and_then(|name| name.to_str()).ok_or("its name is not UTF-8, or it has none")?;
    fmu_import::check_name(name).map_err(|reason| format!("{reason}; rename the file"))?;
    Ok(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_added_under_their_names_once() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        std::fs::create_dir(path("other")).unwrap();
        for name in ["walk.csv", "other/Walk.csv"] {
            std::fs::write(path(name), "time,force\n").unwrap();
        }
        let mut entries = Entries::default();
        add_resources(&[path("walk.csv")], &mut entries).unwrap();
        assert_eq!(entries.bytes("resources/walk.csv"), Some(&b"time,force\n"[..]));
        for (name, said) in [
            ("other/Walk.csv", "resources/Walk.csv is in the FMU already"),
            ("nul.csv", "its name is that of a device on Windows; rename the file"),
            ("a:b", "its name begins with a drive letter; rename the file"),
            ("missing.csv", "cannot read"),
            ("other", "is a directory"),
            ("..", "it has none"),
        ] {
            let error = add_resources(&[path(name)], &mut entries).unwrap_err().to_string();
            assert!(error.to_lowercase().contains(&said.to_lowercase()), "{name}: {error}");
        }
    }

    #[test]
    fn a_folder_is_added_with_its_folders_and_without_what_is_hidden() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        std::fs::create_dir_all(path("tables/deep")).unwrap();
        for name in ["tables/a.csv", "tables/deep/b.csv", "tables/.hidden"] {
            std::fs::write(path(name), name).unwrap();
        }
        let mut entries = Entries::default();
        add_folder(&path("tables"), "resources", &mut entries).unwrap();
        assert_eq!(entries.names().collect::<Vec<_>>(), ["resources/a.csv", "resources/deep/b.csv"]);
        add_folder(&path("missing"), "resources", &mut entries).unwrap();
        std::fs::write(path("tables/aux.txt"), "").unwrap();
        let error = add_folder(&path("tables"), "documentation", &mut entries).unwrap_err().to_string();
        assert!(error.contains("its name is that of a device on Windows"), "{error}");
    }

    #[test]
    #[cfg(unix)]
    fn a_folder_that_holds_itself_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        std::os::unix::fs::symlink(folder.path(), folder.path().join("self")).unwrap();
        let error = add_folder(folder.path(), "resources", &mut Entries::default()).unwrap_err().to_string();
        assert!(error.ends_with("it is more than 16 folders deep"), "{error}");
    }
}
