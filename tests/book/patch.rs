//! Changes of the sources that a page proposes.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::root;

/// Packages by the folder of their sources.
const PACKAGES: [(&str, &str); 3] =
    [("model/", "videg-model"), ("circuit/", "videg-circuit"), ("fmu/harvester/", "videg-fmu-harvester")];

/// Applies `diff` to a copy of the sources and compiles the packages that it changes, or runs the test that it adds to one.
pub fn applies_and_passes(diff: &str) -> Result<(), String> {
    // Always the same folder, so that Cargo knows what it has compiled before.
    let folder = root().join("target/book/source");
    std::fs::create_dir_all(&folder).map_err(|error| error.to_string())?;
    copy_sources(&folder).map_err(|error| format!("cannot copy the sources: {error}"))?;
    run(git_apply(diff).map_err(|error| error.to_string())?.current_dir(&folder))?;
    for (package, test) in packages(diff) {
        let mut check = Command::new(std::env::var_os("CARGO").unwrap_or("cargo".into()));
        let task = test.map_or(vec!["check"], |test| vec!["test", "--test", test]);
        check.args(task).args(["--quiet", "--offline", "--package", package]).current_dir(&folder);
        // A folder of its own: for Cargo, packages of a copy are those of the original, and what is compiled of the one
        // would be taken for the other.
        run(check.env("CARGO_TARGET_DIR", root().join("target/book/build")))?;
    }
    Ok(())
}

/// Whether `diff` fits the sources.
pub fn applies(diff: &str) -> Result<(), String> {
    run(git_apply(diff).map_err(|error| error.to_string())?.arg("--check").current_dir(root()))
}

/// The command, to be run in the folder of the sources.
fn git_apply(diff: &str) -> std::io::Result<Command> {
    let folder = root().join("target/book");
    std::fs::create_dir_all(&folder)?;
    let file = folder.join("change.diff");
    std::fs::write(&file, diff)?;
    let mut apply = Command::new("git");
    apply.arg("apply").arg(file).env("GIT_CEILING_DIRECTORIES", folder);
    Ok(apply)
}

fn run(command: &mut Command) -> Result<(), String> {
    let output = command.output().map_err(|error| format!("{command:?}: {error}"))?;
    let printed = [&output.stdout[..], &output.stderr[..]].concat();
    output.status.success().then_some(()).ok_or_else(|| format!("{command:?}\n{}", String::from_utf8_lossy(&printed)))
}

/// The packages that `diff` changes, each with the test that it adds to it.
fn packages(diff: &str) -> BTreeMap<&'static str, Option<&str>> {
    let mut found = BTreeMap::new();
    for file in diff.lines().filter_map(|line| line.strip_prefix("+++ b/")) {
        let Some((folder, package)) = PACKAGES.iter().find(|(folder, _)| file.starts_with(folder)) else { continue };
        let test = file.strip_prefix(folder).and_then(|file| file.strip_prefix("tests/")?.strip_suffix(".rs"));
        let known = found.entry(*package).or_insert(None);
        *known = test.or(*known);
    }
    found
}

/// What Cargo needs of the source tree.
fn copy_sources(to: &Path) -> std::io::Result<()> {
    for name in [
        "Cargo.toml",
        "Cargo.lock",
        "README.md",
        "model",
        "circuit",
        "coupled",
        "spice",
        "explorer",
        "python",
        "data",
        "fmu",
        "input",
        "report",
        "run",
        "src",
        "system",
        "tests",
        "benches",
        "examples",
        "docs",
    ] {
        copy(&root().join(name), &to.join(name))?;
    }
    Ok(())
}

/// Makes `to` what `from` is, but for folders `target`. Files that are there already and equal keep their time.
pub fn copy(from: &Path, to: &Path) -> std::io::Result<()> {
    if !from.is_dir() {
        let (content, there) = (std::fs::read(from)?, std::fs::read(to).ok());
        return if there == Some(content) { Ok(()) } else { std::fs::copy(from, to).map(drop) };
    }
    std::fs::create_dir_all(to)?;
    let names: Vec<PathBuf> =
        std::fs::read_dir(from)?.map(|entry| Ok(entry?.file_name().into())).collect::<Result<_, std::io::Error>>()?;
    for gone in std::fs::read_dir(to)?.filter_map(Result::ok).filter(|entry| !names.contains(&entry.file_name().into()))
    {
        let path = gone.path();
        if path.is_dir() { std::fs::remove_dir_all(path)? } else { std::fs::remove_file(path)? }
    }
    names.iter().filter(|name| name.as_os_str() != "target").try_for_each(|name| copy(&from.join(name), &to.join(name)))
}
