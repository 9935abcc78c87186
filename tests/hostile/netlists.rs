//! Netlists can run commands of the shell: no text of a user may get into one.

use std::fs;
use std::path::Path;
use std::process::Command;

use videg::ngspice::Ngspice;

use super::sandbox::CANARY;

const EVIL: &str =
    "name = \".control; shell touch CANARY; $(touch CANARY)\"\ndescription = \"*\\n.control\\nshell touch CANARY\"\n";

#[test]
fn commands_in_the_name_of_a_case_reach_no_netlist() {
    if Ngspice::find(None).is_err() && std::env::var_os("VIDEG_ALL_TOOLS").is_none() {
        return;
    }
    super::sandbox::build();
    let folder = tempfile::tempdir().unwrap();
    let canary = folder.path().canonicalize().unwrap().join("canary");
    let evil = EVIL.replace(CANARY, &canary.display().to_string());
    fs::write(folder.path().join("evil.toml"), evil).unwrap();
    let words = ["crosscheck", "--case-file", "evil.toml", "--until", "2", "--output", "out", "--export", "exported"];
    let output = Command::new(env!("CARGO_BIN_EXE_videg")).args(words).current_dir(folder.path()).output().unwrap();
    assert!(matches!(output.status.code(), Some(0 | 1)), "{output:?}");
    let netlists = netlists(&folder.path().join("exported"));
    assert!(netlists.iter().any(|text| text.contains("\ntran ")), "{} netlists", netlists.len());
    assert!(!netlists.iter().any(|text| text.contains("canary")), "{netlists:?}");
    assert!(!canary.exists());
}

/// The netlists in a folder and below.
fn netlists(folder: &Path) -> Vec<String> {
    let paths = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let all = paths.flat_map(|path| match path.extension() {
        _ if path.is_dir() => netlists(&path),
        Some(extension) if extension == "cir" => vec![fs::read_to_string(&path).unwrap()],
        _ => Vec::new(),
    });
    all.collect()
}
