//! Changes of the sources that a page proposes.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::root;

/// Packages by the folder of their sources.
const PACKAGES: [(&str, &str); 3] =
    [("model/", "videg-model"), ("circuit/", "videg-circuit"), ("fmu/harvester/", "videg-fmu-harvester")];

/// Applies `diff` to a copy of the sources and runs the unit tests of the packages that it changes.
pub fn applies_and_passes(diff: &str) -> Result<(), String> {
    // Always the same folder, so that Cargo knows what it has compiled before.
    let folder = root().join("target/book/source");
    copy_sources(&folder).map_err(|error| format!("cannot copy the sources: {error}"))?;
    let file = root().join("target/book/change.diff");
    std::fs::write(&file, diff).map_err(|error| error.to_string())?;
    let mut apply = Command::new("git");
    apply.arg("apply").arg(&file).env("GIT_CEILING_DIRECTORIES", root().join("target/book"));
    run(apply.current_dir(&folder))?;
    for package in packages(diff) {
        let mut test = Command::new(std::env::var_os("CARGO").unwrap_or("cargo".into()));
        test.args(["test", "--quiet", "--offline", "--lib", "--package", package]).current_dir(&folder);
        run(test.env("CARGO_TARGET_DIR", root().join("target")))?;
    }
    Ok(())
}

fn run(command: &mut Command) -> Result<(), String> {
    let output = command.output().map_err(|error| format!("{command:?}: {error}"))?;
    let printed = [&output.stdout[..], &output.stderr[..]].concat();
    output.status.success().then_some(()).ok_or_else(|| format!("{command:?}\n{}", String::from_utf8_lossy(&printed)))
}

fn packages(diff: &str) -> BTreeSet<&'static str> {
    let files = diff.lines().filter_map(|line| line.strip_prefix("+++ b/"));
    let of = |file: &str| PACKAGES.iter().find(|(folder, _)| file.starts_with(folder)).map(|(_, package)| *package);
    files.filter_map(of).collect()
}

/// What Cargo needs of the source tree. Files that are there already and equal keep their time.
fn copy_sources(to: &Path) -> std::io::Result<()> {
    for name in ["Cargo.toml", "Cargo.lock", "README.md", "model", "circuit", "fmu", "src", "tests", "benches", "examples", "docs"] {
        copy(&root().join(name), &to.join(name))?;
    }
    Ok(())
}

fn copy(from: &Path, to: &Path) -> std::io::Result<()> {
    if !from.is_dir() {
        let (content, there) = (std::fs::read(from)?, std::fs::read(to).ok());
        return if there.as_ref() == Some(&content) { Ok(()) } else { std::fs::write(to, content) };
    }
    std::fs::create_dir_all(to)?;
    let names: Vec<PathBuf> = std::fs::read_dir(from)?.map(|entry| Ok(entry?.file_name().into())).collect::<Result<_, std::io::Error>>()?;
    for gone in std::fs::read_dir(to)?.filter_map(Result::ok).filter(|entry| !names.contains(&entry.file_name().into())) {
        let path = gone.path();
        if path.is_dir() { std::fs::remove_dir_all(path)? } else { std::fs::remove_file(path)? }
    }
    names.iter().filter(|name| name.as_os_str() != "target").try_for_each(|name| copy(&from.join(name), &to.join(name)))
}
