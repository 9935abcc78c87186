//! Licences of a Cargo package, where FMI has them in an FMU.

use std::path::{Path, PathBuf};

use super::entries::Entries;
use super::error::{PackageError, Result};

/// How names of files with licences begin, in small letters.
const BEGINNINGS: [&str; 4] = ["license", "licence", "copying", "unlicense"];

/// Adds the files with licences of the first of `folders` that has some, under their names, and the one that is `named`;
/// `license.txt`, where FMI has importers look first; and the SPDX expression, if there is one. Entries that are there stay.
///
/// # Errors
/// When a file cannot be read.
pub(crate) fn add(folders: &[&Path], named: Option<&Path>, spdx: Option<&str>, entries: &mut Entries) -> Result<()> {
    let mut files = Vec::new();
    for folder in folders {
        files = texts(folder)?;
        if !files.is_empty() {
            break;
        }
    }
    let named = named.map(Path::to_path_buf).filter(|named| !files.contains(named));
    files.extend(named);
    let mut names = Vec::new();
    for file in &files {
        let name = super::resources::resource_name(file)
            .map_err(|reason| PackageError::File { path: file.clone(), reason })?;
        let text = videg_input::read(file).map_err(PackageError::io("read", file))?;
        entries.add_new(&format!("documentation/licenses/{name}"), text);
        names.push(name);
    }
    if let Some(spdx) = spdx {
        entries.add_new("documentation/licenses/spdx.txt", format!("SPDX-License-Identifier: {spdx}\n"));
    }
    if !names.is_empty() || spdx.is_some() {
        let licence = spdx.map_or_else(|| "Licence".to_owned(), |spdx| format!("Licence: {spdx}"));
        let texts = if names.is_empty() { String::new() } else { format!(". Its text: {}", names.join(", ")) };
        entries.add_new("documentation/licenses/license.txt", format!("{licence}{texts}\n"));
    }
    Ok(())
}

/// The files with licences in a folder, in the order of their names.
fn texts(folder: &Path) -> Result<Vec<PathBuf>> {
    let read = || -> std::io::Result<Vec<PathBuf>> {
        let mut files = Vec::new();
        for entry in std::fs::read_dir(folder)? {
            let entry = entry?;
            let name = entry.file_name().to_string_lossy().to_lowercase();
            if BEGINNINGS.iter().any(|beginning| name.starts_with(beginning)) && entry.path().is_file() {
                files.push(entry.path());
            }
        }
        files.sort();
        Ok(files)
    };
    read().map_err(PackageError::io("read", folder))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_of_the_package_come_before_those_of_its_workspace() {
        let workspace = tempfile::tempdir().unwrap();
        let package = workspace.path().join("lag");
        std::fs::create_dir_all(package.join("licenses")).unwrap();
        for name in ["LICENSE-MIT", "License-Apache", "other.txt"] {
            std::fs::write(workspace.path().join(name), name).unwrap();
        }
        let added = |spdx| {
            let mut entries = Entries::default();
            add(&[&package, workspace.path()], None, spdx, &mut entries).unwrap();
            let text = |name: &str| String::from_utf8(entries.bytes(name).unwrap().to_vec()).unwrap();
            entries
                .names()
                .map(|name| (name.trim_start_matches("documentation/licenses/").to_owned(), text(name)))
                .collect::<Vec<_>>()
        };
        let pair = |name: &str, text: &str| (name.to_owned(), text.to_owned());
        assert_eq!(
            added(Some("MIT OR Apache-2.0")),
            [
                pair("LICENSE-MIT", "LICENSE-MIT"),
                pair("License-Apache", "License-Apache"),
                pair("license.txt", "Licence: MIT OR Apache-2.0. Its text: LICENSE-MIT, License-Apache\n"),
                pair("spdx.txt", "SPDX-License-Identifier: MIT OR Apache-2.0\n"),
            ]
        );
        std::fs::write(package.join("LICENSE.txt"), "mine").unwrap();
        assert_eq!(added(None), [pair("LICENSE.txt", "mine")], "license.txt would be the same file on Windows");
    }
}
