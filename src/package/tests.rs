use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::process::Command;

use tempfile::TempDir;

use super::{FMUS, Fmu, Options, PackageError, build_all, content, described, locate};
use fmu_import::Archive;
use fmu_package::Platform;

const DESCRIPTION: &str = include_str!("../../fmu/import/src/testdata/good.xml");

/// A tree with the files that packaging reads, but nothing to build.
fn tree() -> TempDir {
    let tree = TempDir::new().unwrap();
    fs::write(tree.path().join("Toy.xml"), DESCRIPTION).unwrap();
    tree
}

fn packed(tree: &Path) -> Fmu {
    let mut fmu = described("Toy", &tree.join("Toy.xml")).unwrap();
    fmu.add_library(Platform::of_folder("linux64").unwrap(), b"library").unwrap();
    content::add(&mut fmu).unwrap();
    fmu
}

#[test]
fn an_archive_holds_what_fmi_wants_where_it_wants_it() {
    let tree = tree();
    let path = packed(tree.path()).write(&tree.path().join("out/deep")).unwrap();
    let mut archive = Archive::open(&path).unwrap();
    let wanted = [
        "binaries/linux64/Toy.so",
        "documentation/licenses/LICENSE-APACHE",
        "documentation/licenses/LICENSE-MIT",
        "documentation/licenses/license.txt",
        "documentation/licenses/spdx.txt",
        "modelDescription.xml",
    ];
    assert_eq!(archive.entries(), wanted);
    assert_eq!(archive.description().unwrap().model_name, "Toy <model>");
    let unpacked = archive.unpack().unwrap();
    assert_eq!(fs::read(unpacked.path().join("binaries/linux64/Toy.so")).unwrap(), b"library");
}

#[test]
fn a_description_of_another_model_is_refused() {
    let tree = tree();
    let error = described("Other", &tree.path().join("Toy.xml")).unwrap_err().to_string();
    assert!(error.ends_with("modelIdentifier is \"Toy\", allowed is \"Other\""), "{error}");
}

#[test]
fn without_libraries_the_error_says_where_it_looked_and_why_nothing_was_built() {
    // A target that no other test builds, so that no library of it exists.
    let targets = vec!["i586-pc-windows-msvc".to_owned()];
    let options = Options { build: false, targets, ..Options::default() };
    let error = build_all(&options).unwrap_err();
    assert!(matches!(error, PackageError::NoLibrary { .. }), "{error}");
    let text = error.to_string();
    assert!(text.contains("building is switched off") && text.contains("VibroImpactHarvester.dll"), "{text}");
}

#[test]
fn the_source_tree_is_found_and_lists_the_same_packages() {
    let workspace = locate::workspace().unwrap();
    assert!(workspace.join("fmu/harvester/Cargo.toml").is_file());
    for fmu in FMUS {
        let manifest = fs::read_to_string(workspace.join(fmu.folder).join("Cargo.toml")).unwrap();
        assert!(manifest.contains(&format!("name = \"{}\"", fmu.package)), "{manifest}");
        assert!(manifest.contains(&format!("name = \"{}\"", fmu.identifier)), "{manifest}");
    }
}

/// Cargo would compile them anew by turns if others were wanted by `cargo build`.
#[test]
fn alone_the_fmus_have_the_dependencies_of_cargo_build() {
    let dependencies = |packages: &[&str]| -> BTreeSet<String> {
        let mut tree = Command::new(env!("CARGO"));
        tree.args(["tree", "--edges", "normal,build", "--prefix", "none", "--no-dedupe", "--format", "{p} with {f}"]);
        let done = tree.args(packages).current_dir(env!("CARGO_MANIFEST_DIR")).output().unwrap();
        assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
        String::from_utf8(done.stdout).unwrap().lines().map(str::to_owned).collect()
    };
    let alone = dependencies(&FMUS.map(|fmu| ["-p", fmu.package]).concat());
    let with_others = dependencies(&[]);
    assert!(alone.iter().any(|package| package.starts_with("serde_core v")), "{alone:?}");
    assert_eq!(alone.difference(&with_others).collect::<Vec<_>>(), Vec::<&String>::new());
}

#[test]
fn two_targets_for_one_platform_are_refused_before_anything_is_built() {
    let targets = vec!["linux64".to_owned(), "aarch64-unknown-linux-gnu".to_owned()];
    let error = build_all(&Options { targets, ..Options::default() }).unwrap_err().to_string();
    let both = "x86_64-unknown-linux-gnu.2.17 and aarch64-unknown-linux-gnu";
    assert_eq!(error, format!("two targets for the platform linux64: {both}; an FMU holds one"));
}
