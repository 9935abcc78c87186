//! Sweeps in shards, and their merging.

use std::fs;
use std::path::PathBuf;

use crate::command::{NOISY, assert_same_results, done, folder, json, refused, sweep, videg};

#[test]
fn shards_in_one_folder_or_many_merge_to_the_bytes_of_the_whole() {
    let (_guard, folder) = folder();
    let [whole, shared, merged, again] = ["whole", "shared", "merged", "again"].map(|name| folder.join(name));
    let what = [&["--vary", "membrane.restitution=0.2:1.1:10", "--samples", "3"][..], &NOISY].concat();
    done(&mut sweep(&whole, &what));
    let apart: Vec<_> = (1..=4).map(|number| folder.join(format!("shard{number}"))).collect();
    for (number, apart) in (1..=4).rev().zip(apart.iter().rev()) {
        for folder in [&shared, apart] {
            let said = json(sweep(folder, &what).args(["--shard", &format!("{number}/4")]));
            assert_eq!(said["shard"], format!("{number}/4"));
            assert!([7, 8].contains(&said["runs"].as_u64().unwrap()));
        }
    }
    let said = json(videg(&["sweep", "merge", "--output"]).arg(&merged).arg(&shared));
    assert_eq!((&said["runs"], &said["failed"]), (&30.into(), &3.into()));
    done(videg(&["sweep", "merge"]).args(&apart).arg("--output").arg(&again));
    assert_same_results(&whole, &merged);
    assert_same_results(&whole, &again);
}

#[test]
fn shards_that_do_not_make_a_whole_are_refused() {
    let (_guard, folder) = folder();
    let part = |name: &str, what: &[&str]| {
        let folder = folder.join(name);
        done(&mut sweep(&folder, what));
        folder
    };
    let vary = ["--vary", "membrane.restitution=0.2:0.9:8"];
    let with = |shard: &'static str| [&vary[..], &["--shard", shard]].concat();
    let [one, two, three] = ["1/3", "2/3", "3/3"].map(|shard| part(&shard.replace('/', "-"), &with(shard)));
    let twice = part("twice", &with("2/3"));
    let other_division = part("halves", &with("2/2"));
    let foreign = part("foreign", &[&with("3/3")[..], &["--seed", "9"]].concat());
    let empty = folder.join("empty");
    fs::create_dir(&empty).unwrap();
    let output = folder.join("merged");
    let refused = |folders: &[&PathBuf]| {
        let (code, message) = refused(videg(&["sweep", "merge", "--output"]).arg(&output).args(folders));
        assert_eq!(code, Some(2));
        assert!(!output.join("sweep.csv").exists());
        message
    };
    let message = refused(&[&one, &three]);
    assert!(message.contains("1 of 3 shards are missing or not complete, the first of them 2/3"), "{message}");
    let message = refused(&[&one, &two, &three, &twice]);
    assert!(message.contains("shard 2/3 is there twice, as "), "{message}");
    let message = refused(&[&one, &other_division]);
    assert!(message.contains("shards, others are of "), "{message}");
    let message = refused(&[&one, &two, &foreign]);
    assert!(
        message.contains("it belongs to another sweep than ") && message.contains("--seed is 9, not 1"),
        "{message}"
    );
    let message = refused(&[&one, &empty]);
    assert!(message.contains("cannot read") && message.contains("sweep.json"), "{message}");
    let document = fs::read_to_string(foreign.join("sweep.json")).unwrap();
    let version = concat!("\"videg\": \"", env!("CARGO_PKG_VERSION"), "\"");
    fs::write(foreign.join("sweep.json"), document.replace(version, "\"videg\": \"0.0.9\"")).unwrap();
    let message = refused(&[&foreign]);
    let versions = concat!("it is of videg 0.0.9, and this is ", env!("CARGO_PKG_VERSION"), "; merge it with that");
    assert!(message.contains(versions), "{message}");
    let text = fs::read_to_string(two.join("sweep.2-of-3.csv")).unwrap();
    fs::write(two.join("sweep.2-of-3.csv"), text.replace("\n3,", "\n4,")).unwrap();
    let message = refused(&[&one, &two, &three]);
    assert!(message.contains("sweep.2-of-3.csv: line 3 is not run 3 of runs 2 to 4"), "{message}");
}
