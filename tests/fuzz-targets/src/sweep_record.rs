//! Results of a sweep that was interrupted, cut or damaged: no line is thrown away but what a torn write leaves, which is
//! part of a line, or zero bytes and what follows them. The sweep goes on behind the lines before, and what it adds is what a
//! fresh sweep has there; or, where they are not those of the runs due, it says so and leaves them as they are.

use std::fs;
use std::path::Path;
use std::sync::LazyLock;

use videg::scenario::CaseFile;
use videg::sweep::{self, BuiltIn, Engine, Options, Report, Sweep, SweepError, SweepFile, Vary};

use crate::{Target, sweeps};

pub(crate) const TARGET: Target = Target { name: "sweep_record", check, seeds };

/// Four short runs, the third of which fails.
const VARY: &str = "membrane.restitution=0.3,0.5,1.5,0.7";

struct Own {
    sweep: Sweep,
    engine: Engine,
    /// The results, lines with their ends.
    lines: Vec<Vec<u8>>,
}

static OWN: LazyLock<Own> = LazyLock::new(|| {
    let case = CaseFile { until: Some(0.5), ..CaseFile::default() };
    let file = SweepFile { case, vary: vec![Vary::parse(VARY).unwrap()], ..SweepFile::default() };
    let sweep = sweeps::resolve(file, Vec::new()).unwrap();
    let engine = Engine::BuiltIn(Box::new(BuiltIn::new(&sweep).unwrap()));
    let folder = tempfile::tempdir().unwrap();
    run(folder.path(), &sweep, &engine).unwrap();
    let lines = lines(&fs::read(folder.path().join("sweep.csv")).unwrap());
    Own { sweep, engine, lines }
});

fn run(folder: &Path, sweep: &Sweep, engine: &Engine) -> Result<Report, SweepError> {
    sweep::run(&Options { jobs: 1, ..Options::new(sweep, engine, folder) }, &())
}

fn lines(bytes: &[u8]) -> Vec<Vec<u8>> {
    bytes.split_inclusive(|byte| *byte == b'\n').map(<[u8]>::to_vec).collect()
}

fn check(bytes: &[u8]) -> bool {
    let Own { sweep, engine, lines: whole } = &*OWN;
    let folder = tempfile::tempdir().unwrap();
    let [part, kept, path] =
        ["sweep.csv.part", "sweep.csv.unfinished", "sweep.csv"].map(|name| folder.path().join(name));
    fs::write(folder.path().join("sweep.json"), sweep.document()).unwrap();
    fs::write(&part, bytes).unwrap();
    let outcome = run(folder.path(), sweep, engine);
    let results = lines(&fs::read(if path.exists() { &path } else { &kept }).unwrap());
    let kept = results.iter().zip(lines(bytes)).take_while(|(one, other)| **one == *other).count();
    let is_torn = |line: &Vec<u8>| !line.ends_with(b"\n") || line.contains(&0);
    let due = lines(bytes).iter().take_while(|line| !is_torn(line)).count();
    assert!(kept >= due, "{due} whole lines were there, {kept} are as they were");
    match outcome {
        Ok(report) => {
            let resumed = usize::try_from(report.resumed_from).unwrap();
            assert!(report.is_complete() && results.len() == whole.len(), "{report:?}");
            assert_eq!(resumed, due.saturating_sub(1), "whole lines were made again");
            assert_eq!(results[0], whole[0]);
            assert_eq!(sweeps::rows(&results.concat()), whole.len() - 1, "a line is not a row");
            assert_eq!(results[resumed + 1..], whole[resumed + 1..]);
            for (number, line) in results[1..].iter().enumerate() {
                assert!(line.starts_with(format!("{number},").as_bytes()), "line {number}");
            }
            resumed > 0
        }
        // Of another build of the model, or no lines of this sweep.
        Err(SweepError::Content { .. }) => kept > 1,
        Err(error) => panic!("{error}"),
    }
}

/// Whole results, and results cut between and within lines.
fn seeds() -> Vec<Vec<u8>> {
    let all = OWN.lines.concat();
    let heading = OWN.lines[0].len();
    let two = heading + OWN.lines[1].len() + OWN.lines[2].len();
    [two - 1, two, two + 5, all.len() - 1, all.len()].map(|length| all[..length].to_vec()).to_vec()
}
