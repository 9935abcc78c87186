//! Sweeps on a disk that fails, killed at any call, with results spoilt in between.

use std::path::{Path, PathBuf};
use std::process::Command;

use fastrand::Rng;

use crate::disk::{self, End, Fault, Files, files, is_partial};
use crate::extent;

/// A sweep of as many points, two seconds each.
fn sweep(folder: &Path, points: u32, more: &[&str]) -> Command {
    let points = points.to_string();
    let mut command = disk::videg(&["sweep", "--design", "lhs", "--points", &points, "--until", "2", "--jobs", "2"]);
    command.args(["--vary", "membrane.restitution=0.2:0.9", "--set", "excitation.phaseNoise=0.5"]);
    command.args(["--set", "excitation.noiseHold=1e-3"]).args(more).arg("--output").arg(folder);
    command
}

fn undisturbed(folder: &Path, points: u32, more: &[&str]) -> Files {
    let output = sweep(folder, points, more).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    files(folder)
}

/// That whatever stands under a final name is what an undisturbed run leaves there, or the document of results that are not
/// complete, which holds no checksums.
fn assert_whole(folder: &Path, expected: &Files, what: &str) {
    for (name, bytes) in files(folder) {
        let is_expected = expected.get(&name).is_some_and(|whole| *whole == bytes || begun(whole) == bytes);
        assert!(is_partial(&name) || is_expected, "{what}: {name} is not whole");
    }
}

/// A document as it is before the checksums; any other file as it is.
fn begun(whole: &[u8]) -> Vec<u8> {
    const SUMS: &[u8] = b",\n  \"results\": {";
    let found = whole.windows(SUMS.len()).position(|bytes| bytes == SUMS);
    found.map_or_else(|| whole.to_vec(), |place| [&whole[..place], b"\n}\n"].concat())
}

/// Spoils what is being written, as a power cut or a bad disk does: cuts it, or overwrites some bytes of its second half.
fn spoil(part: &Path, random: &mut Rng) {
    let Ok(mut bytes) = std::fs::read(part) else { return };
    let place = random.usize(0..=bytes.len());
    if random.bool() {
        bytes.truncate(place);
    } else {
        // What is overwritten with zeroes is seen; digits that look like others are not, in any file without a checksum.
        bytes[place..].fill(0);
    }
    std::fs::write(part, bytes).unwrap();
}

/// Goes on with a sweep under one fault after the other, until `faults` have hit it or it is complete; how many have.
fn disturbed(folder: &Path, command: impl Fn() -> Command, expected: &Files, faults: u32, seed: u64) -> u32 {
    let mut random = Rng::with_seed(seed);
    let mut hits = 0;
    while hits < faults {
        let seed = random.u64(..);
        let fault = match random.u8(0..4) {
            0 | 1 => Fault::Failing { seed, one_in: random.u64(2..40) },
            _ => Fault::Killed { seed, at: random.u64(1..40) },
        };
        let end = disk::run(&mut command(), folder, fault);
        let what = format!("{fault:?} after {hits} faults, {end:?}");
        assert_whole(folder, expected, &what);
        disk::assert_names_a_file(&end, folder, &what);
        if end == End::Done {
            break;
        }
        hits += 1;
        if random.u8(0..3) == 0 {
            for name in ["sweep.csv.part", "sweep.csv.unfinished"] {
                spoil(&folder.join(name), &mut random);
            }
        }
    }
    hits
}

#[test]
#[ignore = "slow"]
fn a_sweep_that_is_disturbed_again_and_again_loses_nothing_and_ends_in_the_same_bytes() {
    let (points, faults) = extent((400, 40), (10_000, 100));
    let guard = tempfile::tempdir().unwrap();
    let [whole, broken] = ["whole", "broken"].map(|name| guard.path().join(name));
    let expected = undisturbed(&whole, points, &[]);
    let (mut hits, mut completed, mut seed) = (0, 0, 1);
    while hits < faults {
        std::fs::create_dir_all(&broken).unwrap();
        hits += disturbed(&broken, || sweep(&broken, points, &[]), &expected, faults - hits, seed);
        assert!(undisturbed(&broken, points, &[]) == expected, "other bytes after {hits} faults, seed {seed}");
        std::fs::remove_dir_all(&broken).unwrap();
        (completed, seed) = (completed + 1, seed + 1);
    }
    println!("{points} points: {hits} faults in {completed} sweeps, each ended in the bytes of an undisturbed one");
}

#[test]
#[ignore = "slow"]
fn a_sweep_killed_at_each_call_that_changes_a_file_goes_on_to_the_same_bytes() {
    let guard = tempfile::tempdir().unwrap();
    let [whole, counted, broken] = ["whole", "counted", "broken"].map(|name| guard.path().join(name));
    let expected = undisturbed(&whole, 20, &[]);
    std::fs::create_dir(&counted).unwrap();
    let calls = disk::calls(&mut sweep(&counted, 20, &[]), &counted);
    for (at, seed) in (1..=calls).flat_map(|at| [(at, 1), (at, 2)]) {
        std::fs::create_dir(&broken).unwrap();
        let end = disk::run(&mut sweep(&broken, 20, &[]), &broken, Fault::Killed { seed, at });
        assert_whole(&broken, &expected, &format!("killed at call {at} of {calls}, {end:?}"));
        assert!(undisturbed(&broken, 20, &[]) == expected, "killed at call {at}");
        std::fs::remove_dir_all(&broken).unwrap();
    }
    println!("killed before and after each of {calls} calls");
}

/// Three shards of a sweep, complete, and how they are merged.
fn shards(folder: &Path, points: u32) -> [PathBuf; 3] {
    ["1/3", "2/3", "3/3"].map(|shard| {
        let path = folder.join(shard.replace('/', "-"));
        undisturbed(&path, points, &["--shard", shard]);
        path
    })
}

fn merge(shards: &[PathBuf], output: &Path) -> Command {
    let mut command = disk::videg(&["sweep", "merge"]);
    command.args(shards).arg("--output").arg(output);
    command
}

#[test]
fn a_merge_on_a_full_disk_names_the_file_and_gives_the_same_bytes_once_there_is_room() {
    let guard = tempfile::tempdir().unwrap();
    let expected = undisturbed(&guard.path().join("whole"), 60, &[]);
    let (shards, merged) = (shards(guard.path(), 60), guard.path().join("merged"));
    let before: Vec<_> = shards.iter().map(|shard| files(shard)).collect();
    let mut hits = 0;
    for seed in 0..extent(20, 200) {
        std::fs::create_dir_all(&merged).unwrap();
        for fault in [Fault::Failing { seed, one_in: 4 }, Fault::Killed { seed, at: 1 + seed % 16 }] {
            let end = disk::run(&mut merge(&shards, &merged), &merged, fault);
            let what = format!("{fault:?}, {end:?}");
            assert_whole(&merged, &expected, &what);
            disk::assert_names_a_file(&end, &merged, &what);
            hits += u32::from(end != End::Done);
        }
        let output = merge(&shards, &merged).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        assert!(files(&merged) == expected, "after the faults of seed {seed}");
        std::fs::remove_dir_all(&merged).unwrap();
    }
    assert!(hits > 10, "{hits} faults");
    assert!(shards.iter().map(|shard| files(shard)).eq(before), "the shards were changed");
    println!("{hits} merges failed or were killed");
}
