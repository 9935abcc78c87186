//! Files in the folder `resources` of an FMU, each under its own name.

use std::path::{Path, PathBuf};

use super::FmuPackage;
use super::entries::Entries;
use super::error::{PackageError, Result};

/// The FMU that reads files.
const READER: &str = "VibroImpactHarvester";

/// Largest file, in bytes: the FMU reads no more.
const LARGEST: u64 = 256 << 20;

/// Adds `files` to an archive, if it is that of the FMU that reads them.
///
/// # Errors
/// A file that cannot be read, is no regular one or too large; a name that is none on some system, or that two have.
pub(super) fn add(fmu: &FmuPackage, files: &[PathBuf], entries: &mut Entries) -> Result<()> {
    if fmu.identifier == READER { add_all(files, entries) } else { Ok(()) }
}

/// The same to any archive.
pub(super) fn add_all(files: &[PathBuf], entries: &mut Entries) -> Result<()> {
    files.iter().try_for_each(|path| {
        let refuse = |reason: String| PackageError::Resource { path: path.clone(), reason };
        let name = format!("resources/{}", name(path).map_err(refuse)?);
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
    })
}

/// The name of a file in the folder: that which it has in its own.
///
/// # Errors
/// A name that is none on some system.
pub(super) fn name(path: &Path) -> std::result::Result<&str, String> {
    let name = path.file_name().and_then(|name| name.to_str()).ok_or("its name is not UTF-8, or it has none")?;
    fmu_import::check_name(name).map_err(|reason| format!("{reason}; rename the file"))?;
    Ok(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_added_under_their_names_once_and_to_their_fmu_only() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        std::fs::create_dir(path("other")).unwrap();
        for name in ["walk.csv", "other/Walk.csv"] {
            std::fs::write(path(name), "time,force\n").unwrap();
        }
        let mut entries = Entries::default();
        add(&super::super::FMUS[1], &[path("walk.csv")], &mut entries).unwrap();
        assert_eq!(entries.names().count(), 0, "the circuit reads no files");
        add(&super::super::FMUS[0], &[path("walk.csv")], &mut entries).unwrap();
        assert_eq!(entries.bytes("resources/walk.csv"), Some(&b"time,force\n"[..]));
        for (name, said) in [
            ("other/Walk.csv", "resources/Walk.csv is in the FMU already"),
            ("nul.csv", "its name is that of a device on Windows; rename the file"),
            ("a:b", "its name begins with a drive letter; rename the file"),
            ("missing.csv", "cannot read"),
            ("other", "is a directory"),
            ("..", "it has none"),
        ] {
            let error = add_all(&[path(name)], &mut entries).unwrap_err().to_string();
            assert!(error.to_lowercase().contains(&said.to_lowercase()), "{name}: {error}");
        }
    }
}
