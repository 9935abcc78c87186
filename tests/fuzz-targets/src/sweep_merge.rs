//! The document and the shards of a sweep that comes from other machines: put together they are the lines of the shards
//! one after the other, or it is said why not. The parts of an input have a zero byte between them.

use std::fs;

use videg::sweep::{SweepFile, Vary, merge};

use crate::{Target, sweeps};

pub(crate) const TARGET: Target = Target { name: "sweep_merge", check, seeds };

/// Most shards of an input.
const MOST: usize = 3;

fn check(bytes: &[u8]) -> bool {
    let folder = tempfile::tempdir().unwrap();
    let mut parts = bytes.splitn(MOST + 1, |byte| *byte == 0);
    fs::write(folder.path().join("sweep.json"), of_this_version(parts.next().unwrap_or_default())).unwrap();
    let shards: Vec<_> = parts.collect();
    for (index, shard) in shards.iter().enumerate() {
        fs::write(folder.path().join(format!("sweep.{}-of-{}.csv", index + 1, shards.len())), shard).unwrap();
    }
    let output = folder.path().join("merged");
    let Ok(report) = merge(&[folder.path().to_owned()], &output) else { return false };
    let results = fs::read(output.join("sweep.csv")).unwrap();
    let heading = shards[0].iter().position(|byte| *byte == b'\n').unwrap() + 1;
    let lines = shards.iter().flat_map(|shard| &shard[heading..]);
    assert!(shards[0][..heading].iter().chain(lines).eq(&results), "other lines than those of the shards");
    let count = results.split_inclusive(|byte| *byte == b'\n').count() as u64;
    assert!(report.is_complete() && report.runs + 1 == count && report.failed <= report.runs, "{report:?}");
    assert_eq!(sweeps::rows(&results) as u64, report.runs, "a line is not a row");
    assert_eq!(fs::read_dir(&output).unwrap().count(), 3, "results, document and table");
    true
}

/// The document as this program writes it: an input is not to be refused, as it would be, because it is older.
fn of_this_version(document: &[u8]) -> Vec<u8> {
    const BEFORE: &[u8] = b"\"videg\": \"";
    let Some(at) = document.windows(BEFORE.len()).position(|bytes| bytes == BEFORE) else { return document.to_vec() };
    let (before, rest) = document.split_at(at + BEFORE.len());
    let version = rest.iter().position(|byte| *byte == b'"').unwrap_or(rest.len());
    [before, env!("CARGO_PKG_VERSION").as_bytes(), &rest[version..]].concat()
}

#[test]
fn an_input_of_another_version_is_taken() {
    let seed = String::from_utf8(seeds().remove(0)).unwrap();
    let version = concat!("\"videg\": \"", env!("CARGO_PKG_VERSION"), "\"");
    let older = seed.replace(version, "\"videg\": \"0.0.7\"");
    assert!(older != seed && check(older.as_bytes()));
}

/// A sweep of three runs, one of which failed, in one, two and three shards.
fn seeds() -> Vec<Vec<u8>> {
    let vary = vec![Vary::parse("membrane.restitution=0.3,1.5,0.7").unwrap()];
    let sweep = sweeps::resolve(SweepFile { vary, ..SweepFile::default() }, Vec::new()).unwrap();
    let heading = sweep.columns().iter().map(|column| column.name.as_str()).collect::<Vec<_>>().join(",") + "\n";
    let rows = ["0,0,0,0.3,1234.5,0.01,200,\n", "1,1,0,1.5,,,,too large\n", "2,2,0,0.7,inf,-1e-3,0,\n"];
    [&[&rows[..]][..], &[&rows[..1], &rows[1..]], &[&rows[..1], &rows[1..2], &rows[2..]]]
        .into_iter()
        .map(|shards| {
            let shards = shards.iter().map(|rows| format!("\0{heading}{}", rows.concat()));
            (sweep.document().to_owned() + &shards.collect::<String>()).into_bytes()
        })
        .collect()
}
