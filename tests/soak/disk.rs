//! A disk that fails under one folder: `faults.c`, loaded into the program under test.

use std::collections::BTreeMap;
use std::os::unix::process::ExitStatusExt as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::LazyLock;

/// The library, compiled once.
static LIBRARY: LazyLock<PathBuf> = LazyLock::new(|| {
    let library = Path::new(env!("CARGO_TARGET_TMPDIR")).join("libfaults.so");
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/soak/faults.c");
    let mut compiler = Command::new("cc");
    compiler.args(["-std=c11", "-O2", "-Wall", "-Wextra", "-Werror", "-shared", "-fPIC", "-o"]);
    let compiled = compiler.arg(&library).arg(source).args(["-ldl", "-lpthread"]).status().unwrap();
    assert!(compiled.success(), "{compiler:?}");
    library
});

/// What befalls the calls of a program that change files under a folder.
#[derive(Debug, Clone, Copy)]
pub enum Fault {
    /// One in so many fails; a disk that is full stays so.
    Failing { seed: u64, one_in: u64 },
    /// The call with this number, from 1, is the last.
    Killed { seed: u64, at: u64 },
}

/// How a program ended.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum End {
    Done,
    Killed,
    /// With an exit code, and what it said.
    Failed(i32, String),
}

/// `videg` with these arguments.
pub fn videg(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_videg"));
    command.args(arguments);
    command
}

/// Runs `command` on a disk that fails under `folder`.
pub fn run(command: &mut Command, folder: &Path, fault: Fault) -> End {
    command.env("LD_PRELOAD", &*LIBRARY).env("FAULTS_FOLDER", folder);
    match fault {
        Fault::Failing { seed, one_in } => {
            command.env("FAULTS_SEED", seed.to_string()).env("FAULTS_RATE", one_in.to_string())
        }
        Fault::Killed { seed, at } => {
            command.env("FAULTS_SEED", seed.to_string()).env("FAULTS_KILL_AT", at.to_string())
        }
    };
    end(&command.output().unwrap())
}

/// How many calls of `command`, which must be done, change files under `folder`.
pub fn calls(command: &mut Command, folder: &Path) -> u64 {
    let count = tempfile::NamedTempFile::new().unwrap();
    command.env("LD_PRELOAD", &*LIBRARY).env("FAULTS_FOLDER", folder).env("FAULTS_COUNT", count.path());
    assert_eq!(end(&command.output().unwrap()), End::Done);
    std::fs::read_to_string(count.path()).unwrap().trim().parse().unwrap()
}

fn end(output: &Output) -> End {
    match (output.status.code(), output.status.signal()) {
        (Some(0), _) => End::Done,
        (Some(code), _) => End::Failed(code, String::from_utf8_lossy(&output.stderr).into_owned()),
        (None, signal) => {
            assert_eq!(signal, Some(9), "{}", String::from_utf8_lossy(&output.stderr));
            End::Killed
        }
    }
}

/// Files in a folder and their bytes.
pub type Files = BTreeMap<String, Vec<u8>>;

pub fn files(folder: &Path) -> Files {
    let Ok(entries) = std::fs::read_dir(folder) else { return Files::new() };
    let entries = entries.map(|entry| entry.unwrap().path());
    entries.map(|path| (name(&path), std::fs::read(&path).unwrap())).collect()
}

fn name(path: &Path) -> String {
    path.file_name().unwrap().to_string_lossy().into_owned()
}

/// Whether a file is one that is not complete, by its name.
pub fn is_partial(name: &str) -> bool {
    Path::new(name).extension().is_some_and(|extension| ["part", "unfinished"].contains(&&*extension.to_string_lossy()))
}

/// That a program which failed names a file in `folder` and what is wrong with the disk, in its last line.
pub fn assert_names_a_file(end: &End, folder: &Path, what: &str) {
    let End::Failed(code, said) = end else { return };
    // Progress may stand before it.
    let last = said.lines().last().unwrap_or_default();
    let cause = ["No space left on device", "Input/output error"].iter().any(|cause| last.contains(cause));
    let named = last.starts_with("videg: cannot ") && last.contains(&*folder.to_string_lossy());
    assert!(*code == 2 && cause && named, "{what}: exit code {code}, {said:?}");
}

#[test]
fn the_faults_are_seen() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("file");
    let script = format!("with open({:?}, 'w') as file: file.write('content')", path.display().to_string());
    let python = || {
        let mut command = Command::new("python3");
        command.args(["-c", &script]);
        command
    };
    assert_eq!(calls(&mut python(), folder.path()), 1);
    assert_eq!(run(&mut python(), folder.path(), Fault::Killed { seed: 1, at: 1 }), End::Killed);
    let failed = run(&mut python(), folder.path(), Fault::Failing { seed: 1, one_in: 1 });
    assert!(matches!(&failed, End::Failed(1, said) if said.contains("Error")), "{failed:?}");
}
