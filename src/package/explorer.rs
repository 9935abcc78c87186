//! The page that shows the harvester in a browser: inside the program, or built with Cargo.

use std::path::{Path, PathBuf};

use super::error::{PackageError, Result};
use super::{Options, locate};

/// The page in the file that `VIDEG_EXPLORER` named when the program was compiled.
#[cfg(feature = "embedded-explorer")]
const PAGE: Option<&str> = Some(include_str!(env!(
    "VIDEG_EXPLORER",
    "the feature embedded-explorer needs VIDEG_EXPLORER: the absolute path of what videg-explorer-bundle has written"
)));
#[cfg(not(feature = "embedded-explorer"))]
const PAGE: Option<&str> = None;

/// The page, in which the element `description` may be empty, or say the start values of another machine.
///
/// # Errors
/// When it is not inside the program and cannot be built.
pub fn explorer(options: &Options) -> Result<String> {
    let workspace = locate::workspace();
    if let Some(page) = PAGE.filter(|_| locate::around_program().is_none()) {
        return Ok(page.to_owned());
    }
    let Some(workspace) = workspace else { return Err(PackageError::NoPage { looked: PathBuf::from("explorer") }) };
    let page = locate::build_folder(&workspace).join("explorer").join("page.html");
    if options.build {
        let file = page.display().to_string();
        let arguments = ["run", "--release", "-p", "videg-explorer-bundle", "--", &file];
        fmu_package::cargo::run(&workspace, &arguments, fmu_package::Messages::Taken(options.progress))?;
    }
    read(&page)
}

fn read(page: &Path) -> Result<String> {
    std::fs::read_to_string(page).map_err(|cause| match cause.kind() {
        std::io::ErrorKind::NotFound => PackageError::NoPage { looked: page.to_owned() },
        _ => PackageError::io("read", page)(cause),
    })
}
