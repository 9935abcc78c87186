//! Modules of the harness import downwards only, so that none takes part in a cycle.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a panic is how a test fails")]

use std::fs;
use std::path::{Path, PathBuf};

/// Modules of `src/`, each above all that it may import.
const DOWNWARDS: [&str; 11] = [
    "cli",
    "paper",
    "crosscheck",
    "sweep",
    "package",
    "cosim",
    "ngspice",
    "scenario",
    "circuit_sample",
    "threads",
    "progress",
];

/// Place of a module from the top.
fn level(module: &str) -> usize {
    let found = DOWNWARDS.iter().position(|it| *it == module);
    found.unwrap_or_else(|| panic!("src/{module} has no place among {DOWNWARDS:?}"))
}

/// Modules that a text imports, leaving comments out.
fn imported(text: &str) -> Vec<String> {
    let code: String = text.lines().map(|line| line.split("//").next().unwrap()).collect();
    let name = |path: &str| path.trim().split(|c: char| c != '_' && !c.is_alphanumeric()).next().unwrap().to_owned();
    let paths = code.split("crate::").skip(1);
    paths
        .flat_map(|path| match path.strip_prefix('{') {
            Some(list) => list.split('}').next().unwrap().split(',').map(name).collect(),
            None => vec![name(path)],
        })
        .collect()
}

fn sources(path: &Path) -> Vec<PathBuf> {
    if path.is_file() {
        return vec![path.to_owned()];
    }
    fs::read_dir(path).unwrap().flat_map(|entry| sources(&entry.unwrap().path())).collect()
}

#[test]
fn no_module_imports_one_above_it() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut imports = 0;
    for module in DOWNWARDS {
        let folder = root.join(module);
        let place = if folder.is_dir() { folder } else { root.join(format!("{module}.rs")) };
        for file in sources(&place).iter().filter(|file| file.extension().is_some_and(|it| it == "rs")) {
            let text = fs::read_to_string(file).unwrap();
            for other in imported(&text).into_iter().filter(|other| *other != module) {
                assert!(level(&other) > level(module), "{} imports {other}, which is above {module}", file.display());
                imports += 1;
            }
        }
    }
    assert!(imports > 50, "only {imports} imports are found: are they written in another way?");
}

#[test]
fn every_module_of_the_library_has_its_place() {
    let library = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("src/lib.rs")).unwrap();
    let declared = library
        .lines()
        .filter_map(|line| line.trim_start_matches("pub ").trim_start_matches("pub(crate) ").strip_prefix("mod "));
    for module in declared.map(|name| name.trim_end_matches(';')).filter(|name| *name != "book") {
        level(module);
    }
}

#[test]
fn imports_are_found_alone_and_in_lists() {
    assert_eq!(
        imported("use crate::cosim::Master;\n// crate::cli\nuse crate::{paper,\n sweep};"),
        ["cosim", "paper", "sweep"]
    );
}
