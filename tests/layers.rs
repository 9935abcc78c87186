//! The order of the code: packages and modules import downwards only, and files do not import each other in circles.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a panic is how a test fails")]

mod sources;

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

use sources::{Imports, root_module};

/// Packages of the workspace, each with those of ours that it may import.
const PACKAGES: [(&str, &[&str]); 21] = [
    ("model", &[]),
    ("circuit", &[]),
    ("coupled", &["circuit", "model"]),
    ("spice", &[]),
    ("input", &[]),
    ("data", &["input", "model"]),
    ("system", &[]),
    ("report", &["system"]),
    ("fmu/abi", &[]),
    ("fmu/derive", &[]),
    ("fmu/export", &["fmu/abi", "fmu/derive"]),
    ("fmu/import", &["fmu/abi", "input", "system"]),
    ("fmu/package", &["fmu/abi", "fmu/import", "input", "system"]),
    ("fmu/cargo", &["fmu/package"]),
    ("fmu/harvester", &["data", "fmu/export", "model"]),
    ("fmu/circuit", &["fmu/export", "circuit"]),
    ("run", &["circuit", "coupled", "data", "fmu/import", "input", "model", "spice", "system"]),
    ("explorer", &["circuit", "coupled", "data", "model", "spice"]),
    ("explorer/bundle", &[]),
    (
        ".",
        &[
            "circuit",
            "coupled",
            "data",
            "fmu/import",
            "fmu/package",
            "input",
            "model",
            "report",
            "run",
            "spice",
            "system",
        ],
    ),
    ("python", &[".", "fmu/import", "model"]),
];

/// Dependencies that serve the command line, and have no place in a shared library.
const OF_THE_COMMAND_LINE: [&str; 8] =
    ["anstream", "anyhow", "clap", "clap_complete", "comfy-table", "indicatif", "signal-hook", "terminal_size"];

/// Modules of the two large packages, each above all that it may import.
const DOWNWARDS: [(&str, &[&str]); 2] = [
    (
        "src",
        &[
            "cli",
            "paper",
            "dynamics",
            "crosscheck",
            "map",
            "explorer",
            "sweep",
            "package",
            "export",
            "artefact",
            "statistics",
            "differences",
            "threads",
        ],
    ),
    ("run/src", &["simulate", "cosim", "ngspice", "scenario", "progress"]),
];

fn repository() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn manifest(folder: &str) -> toml::Table {
    fs::read_to_string(repository().join(folder).join("Cargo.toml")).unwrap().parse().unwrap()
}

/// Names of the packages that a package links, on any system.
fn dependencies(folder: &str) -> BTreeSet<String> {
    let manifest = manifest(folder);
    let targets = manifest.get("target").and_then(|it| it.as_table()).into_iter().flat_map(|it| it.values());
    let tables = targets.filter_map(toml::Value::as_table).chain([&manifest]);
    let names = tables.filter_map(|table| table.get("dependencies")?.as_table()).flat_map(|it| it.keys().cloned());
    names.collect()
}

fn package_name(folder: &str) -> String {
    manifest(folder)["package"]["name"].as_str().unwrap().to_owned()
}

#[test]
fn packages_import_only_those_below_them() {
    let names: BTreeMap<String, &str> = PACKAGES.iter().map(|(folder, _)| (package_name(folder), *folder)).collect();
    for (folder, allowed) in PACKAGES {
        for other in dependencies(folder).iter().filter_map(|name| names.get(name)) {
            assert!(allowed.contains(other), "package {folder} imports {other}");
        }
    }
}

#[test]
fn every_package_has_its_place() {
    let workspace = manifest(".");
    let members = workspace["workspace"]["members"].as_array().unwrap().iter().map(|it| it.as_str().unwrap());
    for member in members.filter(|it| !it.starts_with("tests/")) {
        assert!(PACKAGES.iter().any(|(folder, _)| *folder == member), "package {member} has no place in PACKAGES");
    }
}

/// Nobody would run them.
#[test]
fn a_library_whose_tests_do_not_run_has_none() {
    let is_tested = |folder: &str| manifest(folder).get("lib").and_then(|it| it.get("test")?.as_bool()).unwrap_or(true);
    let mut read = 0;
    for (folder, _) in PACKAGES.iter().filter(|(folder, _)| !is_tested(folder)) {
        let source = repository().join(folder).join("src");
        for file in Imports::read(&source.join("lib.rs")).files() {
            let text = fs::read_to_string(source.join(file)).unwrap();
            assert!(
                !text.contains("#[cfg(test)]"),
                "{folder}/src/{file} has tests, but {folder}/Cargo.toml says test = false"
            );
            read += 1;
        }
    }
    assert!(read > 10, "only {read} files are read");
}

#[test]
fn a_shared_library_links_nothing_of_the_command_line() {
    let below = |folder: &str| PACKAGES.iter().find(|(it, _)| *it == folder).unwrap().1;
    for library in ["fmu/harvester", "fmu/circuit"] {
        let mut linked = vec![library];
        while let Some(folder) = linked.pop() {
            let found = dependencies(folder);
            let wrong = OF_THE_COMMAND_LINE.iter().find(|name| found.contains(**name));
            assert_eq!(wrong, None, "{folder}, which is part of {library}");
            linked.extend(below(folder));
        }
    }
}

#[test]
fn no_module_imports_one_above_it() {
    for (folder, modules) in DOWNWARDS {
        let mut seen = 0;
        let level = |module: &str| {
            let found = modules.iter().position(|it| *it == module);
            found.unwrap_or_else(|| panic!("{folder}/{module} has no place among {modules:?}"))
        };
        let imports = Imports::read(&repository().join(folder).join("lib.rs"));
        for module in imports.files().filter_map(root_module).filter(|name| *name != "book") {
            level(module);
        }
        for (file, other) in imports.pairs() {
            let (Some(module), Some(imported)) = (root_module(file), root_module(other)) else { continue };
            if module != imported {
                assert!(level(imported) > level(module), "{folder}/{file} imports {folder}/{other}, above {module}");
                seen += 1;
            }
        }
        assert!(seen >= 15, "only {seen} imports are found in {folder}: are they written in another way?");
    }
}

#[test]
fn no_files_import_each_other_in_a_circle() {
    let mut found = BTreeSet::new();
    for (folder, _) in PACKAGES {
        let folder = if folder == "." { "src".to_owned() } else { format!("{folder}/src") };
        let [library, program] = ["lib.rs", "main.rs"].map(|file| repository().join(&folder).join(file));
        let imports = Imports::read(if library.exists() { &library } else { &program });
        for circle in imports.circles() {
            println!("circle in {folder}:");
            for (file, other) in imports.pairs().filter(|(file, other)| circle.contains(file) && circle.contains(other))
            {
                println!("  {file} imports {other}");
            }
            found.extend(circle.iter().map(|file| format!("{folder}/{file}")));
        }
    }
    assert!(found.is_empty(), "part of a circle: {found:#?}");
}

#[test]
fn imports_are_followed_to_the_file_that_defines_the_name() {
    let folder = tempfile::tempdir().unwrap();
    let write = |file: &str, text: &str| fs::write(folder.path().join(file), text).unwrap();
    fs::create_dir(folder.path().join("part")).unwrap();
    write("lib.rs", "mod part; mod top; pub use part::{First as One, third::*};");
    write(
        "top.rs",
        "// crate::part::second\nfn f() { println!(\"{}\", crate::One::new()); } #[cfg(test)] use crate::part::Second;",
    );
    write(
        "part/mod.rs",
        "mod first; mod second; pub mod third; pub use {first::First, second::Second}; pub struct Own;",
    );
    write("part/first.rs", "use super::{Own, Second}; pub struct First;");
    write("part/second.rs", "pub struct Second(crate::Third); impl From<super::First> for Second {}");
    write("part/third.rs", "pub(in crate::part) struct Third; impl Third { fn f(Self: super::Own) {} }");
    let imports = Imports::read(&folder.path().join("lib.rs"));
    let of = |file: &str| imports.pairs().filter(|pair| pair.0 == file).map(|pair| pair.1).collect::<Vec<_>>();
    assert_eq!(of("top.rs"), ["part/first.rs"]);
    assert_eq!(of("part/first.rs"), ["part/mod.rs", "part/second.rs"]);
    assert_eq!(of("part/second.rs"), ["part/first.rs", "part/third.rs"]);
    assert_eq!(imports.circles(), [BTreeSet::from(["part/first.rs", "part/second.rs"])]);
}
