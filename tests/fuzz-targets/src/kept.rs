//! The inputs in git: `fuzz/seeds/TARGET` to start from, `fuzz/regressions/TARGET` that once showed a fault.

use std::collections::BTreeSet;
use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};

use crate::Target;

/// Bounds on the inputs of a target: number and bytes.
const MOST_FILES: usize = 60;
const MOST_BYTES: usize = 200_000;
/// Inputs that the target makes itself are called so, with a number behind.
const SEED: &str = "seed-";
/// Writes those inputs, where it is set.
const UPDATE: &str = "UPDATE_FUZZ_SEEDS";

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz")
}

/// Files in a folder, which need not be there, by name.
fn files(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let mut files: Vec<_> = entries
        .map(|entry| (entry.file_name().to_string_lossy().into_owned(), fs::read(entry.path()).unwrap()))
        .collect();
    files.sort();
    files
}

/// Runs all kept inputs through the targets.
///
/// # Panics
/// If one fails, if a seed of the target's own is not taken, or if there are too many.
pub fn replay(targets: &[Target]) {
    for target in targets {
        let [seeds, regressions] = ["seeds", "regressions"].map(|kind| root().join(kind).join(target.name));
        if std::env::var_os(UPDATE).is_some() {
            write_seeds(target, &seeds);
        }
        let kept = files(&seeds);
        let bytes: usize = kept.iter().map(|(_, input)| input.len()).sum();
        assert!(kept.len() <= MOST_FILES && bytes <= MOST_BYTES, "{}: {} files, {bytes} B", target.name, kept.len());
        let mut own = 0;
        for (name, input) in kept.iter().chain(&files(&regressions)) {
            let case = format!("{}/{name}", target.name);
            let taken = catch_unwind(AssertUnwindSafe(|| (target.check)(input)));
            let taken = taken.unwrap_or_else(|_| panic!("{case} fails"));
            let is_own = name.starts_with(SEED);
            assert!(taken || !is_own, "{case} is refused: has what it is made of changed? {UPDATE}=1 writes it anew");
            own += usize::from(is_own);
        }
        assert_eq!(own, (target.seeds)().len(), "{}: {UPDATE}=1 writes the inputs to start from", target.name);
    }
}

fn write_seeds(target: &Target, folder: &Path) {
    fs::create_dir_all(folder).unwrap();
    for (name, _) in files(folder).iter().filter(|(name, _)| name.starts_with(SEED)) {
        fs::remove_file(folder.join(name)).unwrap();
    }
    for (number, seed) in (target.seeds)().iter().enumerate() {
        fs::write(folder.join(format!("{SEED}{number:02}")), seed).unwrap();
    }
}

/// That `fuzz/` has a program for each of these targets, and of those that `is_one` says are theirs no other.
///
/// # Panics
/// If it does not.
pub fn programs(targets: &[Target], is_one: impl Fn(&str) -> bool) {
    let manifest = fs::read_to_string(root().join("Cargo.toml")).unwrap();
    let programs = manifest.split("[[bin]]").skip(1).map(|text| text.split('"').nth(1).unwrap_or_default());
    let programs: BTreeSet<_> = programs.filter(|name| is_one(name)).collect();
    assert_eq!(programs, targets.iter().map(|target| target.name).collect());
}
