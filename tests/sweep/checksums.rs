//! Complete results carry their lengths and checksums.

use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};

use crate::command::{assert_same_results, done, folder, refused, sweep, videg};

/// The two folders of shards, and the whole, of one sweep.
fn whole_and_shards(folder: &Path) -> (PathBuf, [PathBuf; 2]) {
    let what = ["--vary", "membrane.restitution=0.2:0.9:6"];
    let [whole, one, other] = ["whole", "one", "other"].map(|name| folder.join(name));
    done(&mut sweep(&whole, &what));
    done(sweep(&one, &what).args(["--shard", "1/2"]));
    done(sweep(&other, &what).args(["--shard", "2/2"]));
    (whole, [one, other])
}

/// Turns the last bit of a digit in the middle of the file, and of a table not of a run's number: it is as long as before, and reads as well.
fn flip(path: &Path) {
    let mut bytes = fs::read(path).unwrap();
    let middle = bytes.len() / 2;
    let is_digit = |place: usize| bytes[place].is_ascii_digit();
    let among_digits = (middle..bytes.len()).find(|place| (place - 2..=*place).all(is_digit));
    let place = among_digits.or_else(|| (middle..bytes.len()).find(|place| is_digit(*place))).unwrap();
    bytes[place] ^= 1;
    fs::write(path, bytes).unwrap();
}

fn sha256(path: &Path) -> String {
    videg::sweep::fingerprint(path).unwrap()
}

#[test]
fn a_flipped_bit_in_complete_results_is_told_with_file_expected_and_found() {
    let (_guard, folder) = folder();
    let (whole, shards) = whole_and_shards(&folder);
    let document: Value = serde_json::from_slice(&fs::read(whole.join("sweep.json")).unwrap()).unwrap();
    for name in ["sweep.csv", "sweep.parquet"] {
        let (path, said) = (whole.join(name), &document["results"][name]);
        let sound = fs::read(&path).unwrap();
        let expected = sha256(&path);
        assert_eq!((&said["sha256"], &said["bytes"]), (&expected.clone().into(), &sound.len().into()));
        flip(&path);
        let found = sha256(&path);
        let (code, message) = refused(&mut sweep(&whole, &["--vary", "membrane.restitution=0.2:0.9:6"]));
        let named = format!("{name}: its SHA-256 is {found}, and sweep.json expects {expected}");
        assert!(code == Some(2) && message.contains(&named), "{message}");
        fs::write(&path, sound).unwrap();
    }
    done(&mut sweep(&whole, &["--vary", "membrane.restitution=0.2:0.9:6"]));
    let merged = folder.join("merged");
    done(videg(&["sweep", "merge"]).args(&shards).arg("--output").arg(&merged));
    assert_same_results(&whole, &merged);
    flip(&shards[1].join("sweep.2-of-2.csv"));
    let (code, message) = refused(videg(&["sweep", "merge"]).args(&shards).arg("--output").arg(folder.join("again")));
    let named = "sweep.2-of-2.csv: its SHA-256 is ";
    assert!(code == Some(2) && message.contains(named) && message.contains("sweep.json expects"), "{message}");
}

#[test]
fn results_without_checksums_get_them_and_fresh_ones_replace_them() {
    let (_guard, folder) = folder();
    let (whole, _) = whole_and_shards(&folder);
    let path = whole.join("sweep.json");
    let sealed = fs::read_to_string(&path).unwrap();
    let what = ["--vary", "membrane.restitution=0.2:0.9:6"];
    fs::write(&path, sealed.split_once(",\n  \"results\"").unwrap().0.to_owned() + "\n}\n").unwrap();
    done(&mut sweep(&whole, &what));
    assert_eq!(fs::read_to_string(&path).unwrap(), sealed);
    flip(&whole.join("sweep.csv"));
    done(sweep(&whole, &what).arg("--fresh"));
    assert_eq!(fs::read_to_string(&path).unwrap(), sealed);
    done(&mut sweep(&whole, &what));
}

#[test]
fn results_that_were_replaced_are_never_compared_with_the_checksums_of_those_before() {
    let (_guard, folder) = folder();
    let what = ["--vary", "membrane.restitution=0.2:0.9:3"];
    let document = || serde_json::from_slice::<Value>(&fs::read(folder.join("sweep.json")).unwrap()).unwrap();
    done(&mut sweep(&folder, &what));
    assert!(document()["results"]["sweep.csv"].is_object());
    // New results are complete, but their table cannot be made: as if it had ended in between.
    fs::create_dir(folder.join("sweep.parquet.part")).unwrap();
    refused(sweep(&folder, &what).arg("--fresh"));
    assert!(folder.join("sweep.csv").exists());
    assert_eq!(document()["results"], serde_json::json!({}));
    fs::remove_dir(folder.join("sweep.parquet.part")).unwrap();
    done(&mut sweep(&folder, &what));
    assert_eq!(document()["results"]["sweep.csv"]["sha256"], sha256(&folder.join("sweep.csv")));
    assert!(document()["results"]["sweep.parquet"].is_object());
}
