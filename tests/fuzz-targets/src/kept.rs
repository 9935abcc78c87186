//! The inputs in git: those to start from, `TARGET/NAME` in the archive `fuzz/seeds.zip`, and those that once showed a
//! fault, files in `fuzz/regressions/TARGET`.

use std::collections::{BTreeMap, BTreeSet};
use std::fs::{self, File};
use std::io::{self, Read as _, Write as _};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};

use zip::write::SimpleFileOptions;
use zip::{ZipArchive, ZipWriter};

use crate::Target;

/// Bounds on the inputs of a target: number and bytes.
const MOST_FILES: usize = 60;
const MOST_BYTES: usize = 200_000;
/// Inputs that the target makes itself are called so, with a number behind.
const SEED: &str = "seed-";
/// Writes those inputs; if it names a folder, replaces the others by what stands in its folder of the target.
const UPDATE: &str = "UPDATE_FUZZ_SEEDS";

/// Inputs by target and name.
type Inputs = BTreeMap<String, Vec<u8>>;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz")
}

/// Files in a folder, which need not be there.
fn files(folder: &Path, target: &str) -> Inputs {
    let entries = fs::read_dir(folder.join(target)).into_iter().flatten().flatten();
    let input = |path: PathBuf| (key(target, path.file_name().unwrap().to_str().unwrap()), fs::read(path).unwrap());
    entries.map(|entry| input(entry.path())).collect()
}

fn key(target: &str, name: &str) -> String {
    format!("{target}/{name}")
}

fn is_of(key: &str, target: &str) -> bool {
    key.split('/').next() == Some(target)
}

fn read_archive(path: &Path) -> io::Result<Inputs> {
    let mut archive = ZipArchive::new(File::open(path)?)?;
    let mut inputs = Inputs::new();
    for index in 0..archive.len() {
        let mut entry = archive.by_index(index)?;
        let (name, mut input) = (entry.name()?.into_owned(), Vec::new());
        entry.read_to_end(&mut input)?;
        inputs.insert(name, input);
    }
    Ok(inputs)
}

/// The same inputs have the same bytes.
fn write_archive(path: &Path, inputs: &Inputs) -> io::Result<()> {
    let mut archive = ZipWriter::new(File::create(path)?);
    for (key, input) in inputs {
        archive.start_file(key, SimpleFileOptions::default().unix_permissions(0o644))?;
        archive.write_all(input)?;
    }
    archive.finish()?.sync_all()
}

/// Runs all kept inputs through the targets.
///
/// # Panics
/// If one fails, if a seed of the target's own is not taken, or if there are too many.
pub fn replay(targets: &[Target]) {
    let archive = root().join("seeds.zip");
    let mut seeds = read_archive(&archive).unwrap();
    if let Some(found) = std::env::var_os(UPDATE) {
        for target in targets {
            update(&mut seeds, target, Path::new(&found));
        }
        write_archive(&archive, &seeds).unwrap();
    }
    for target in targets {
        let kept: Inputs = seeds.clone().into_iter().filter(|(key, _)| is_of(key, target.name)).collect();
        let bytes: usize = kept.values().map(Vec::len).sum();
        assert!(kept.len() <= MOST_FILES && bytes <= MOST_BYTES, "{}: {} files, {bytes} B", target.name, kept.len());
        let mut own = 0;
        for (key, input) in kept.iter().chain(&files(&root().join("regressions"), target.name)) {
            let taken = catch_unwind(AssertUnwindSafe(|| (target.check)(input)));
            let taken = taken.unwrap_or_else(|_| panic!("{key} fails"));
            let is_own = is_own(key);
            assert!(taken || !is_own, "{key} is refused: has what it is made of changed? {UPDATE}=1 writes it anew");
            own += usize::from(is_own);
        }
        assert_eq!(own, (target.seeds)().len(), "{}: {UPDATE}=1 writes the inputs to start from", target.name);
    }
}

fn is_own(key: &str) -> bool {
    key.split('/').nth(1).is_some_and(|name| name.starts_with(SEED))
}

/// Writes the target's own inputs, and replaces the others if there is a folder of what was found.
fn update(seeds: &mut Inputs, target: &Target, found: &Path) {
    let others = files(found, target.name);
    seeds.retain(|key, _| !is_of(key, target.name) || (!is_own(key) && others.is_empty()));
    seeds.extend(others.into_iter().filter(|(key, _)| !is_own(key)));
    let own = (target.seeds)().into_iter().enumerate();
    seeds.extend(own.map(|(number, seed)| (key(target.name, &format!("{SEED}{number:02}")), seed)));
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
