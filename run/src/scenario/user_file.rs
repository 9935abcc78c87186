//! Variables whose value is the name of a file. Whoever reads the file may stand elsewhere than the user: the process of an isolated
//! FMU does. So it gets an absolute name.

use std::borrow::Cow;
use std::path::{Path, PathBuf};

use super::{Origin, Setting};

/// Names of these variables.
const VARIABLES: [&str; 2] = ["excitation.file", "membrane.file"];

/// Whether a value of the variable called `name` is the name of a file.
pub fn is_file(name: &str) -> bool {
    VARIABLES.contains(&name)
}

/// The file called `value`, which the user gave at `origin`: beside the case or sweep file, or else where the user stands. None if
/// there is no such file: an FMU may have one in its resources.
pub fn find(value: &str, origin: &Origin) -> Option<PathBuf> {
    let beside = if let Origin::File(path) = origin { path.parent() } else { None };
    let places = beside.into_iter().chain([Path::new("")]);
    let found = places.map(|folder| folder.join(value)).find(|path| !value.is_empty() && path.exists())?;
    std::path::absolute(found).ok()
}

/// The value of the variable called `name` as an FMU gets it: with the absolute name of a file that is there.
pub fn absolute<'a>(name: &str, value: &'a str, origin: &Origin) -> Cow<'a, str> {
    let found = if is_file(name) { find(value, origin) } else { None };
    found.and_then(|path| path.into_os_string().into_string().ok()).map_or(Cow::Borrowed(value), Cow::Owned)
}

impl Setting {
    /// The value as an FMU gets it.
    pub fn value_for_fmu(&self) -> Cow<'_, str> {
        absolute(&self.name, &self.value, &self.origin)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_looked_for_beside_the_case_file_and_then_where_the_user_stands() {
        let folder = tempfile::tempdir().unwrap();
        let beside = folder.path().join("shaker.csv");
        std::fs::write(&beside, "").unwrap();
        let in_file = Origin::File(folder.path().join("case.toml"));
        for (name, value, origin, found) in [
            ("excitation.file", "shaker.csv", &in_file, beside.to_str().unwrap()),
            ("excitation.file", "shaker.csv", &Origin::Option, "shaker.csv"),
            ("excitation.file", beside.to_str().unwrap(), &Origin::Option, beside.to_str().unwrap()),
            ("excitation.file", "", &in_file, ""),
            ("excitation.kind", "shaker.csv", &in_file, "shaker.csv"),
        ] {
            assert_eq!(absolute(name, value, origin), found, "{value} at {origin:?}");
        }
        // Tests stand in the folder of the package.
        let here = std::env::current_dir().unwrap().join("Cargo.toml");
        assert_eq!(absolute("excitation.file", "Cargo.toml", &in_file), here.to_str().unwrap());
    }
}
