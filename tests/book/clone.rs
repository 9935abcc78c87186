//! A folder that looks like a fresh clone with the tool installed, for the commands of one chapter.

use std::os::unix::fs::{PermissionsExt as _, symlink};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use tempfile::TempDir;

use crate::{patch, python, root};

/// `cargo run` becomes the tool that was built for the tests, `videg` or `cargo fmu`; the rest of Cargo works in the source tree
/// itself, where its `target` is.
const CARGO: &str = r#"#!/bin/sh
if [ "$1 $2 $3" = "run --release --" ]; then
    shift 3
    exec videg "$@"
fi
if [ "$1 $2 $3 $4 $5 $6" = "run --quiet --release -p cargo-fmu --" ] && [ -x "$CARGO_FMU" ]; then
    shift 6
    cd "$VIDEG_ROOT" && exec "$CARGO_FMU" "$@"
fi
cd "$VIDEG_ROOT" && exec "$VIDEG_CARGO" "$@"
"#;

/// Not copied: Cargo's own folder and the Python of the tests are links, so that nothing is built or installed twice;
/// results and history are left out.
const LINKED: [&str; 2] = ["target", ".venv"];
const LEFT_OUT: [&str; 2] = ["out", ".git"];

/// The folder. What commands write there is gone with it, but for what is built into `target`.
pub struct Clone {
    folder: TempDir,
    programs: TempDir,
}

impl Clone {
    /// A folder with everything of the source tree in it but results, and the files that the chapter has.
    pub fn new<'a>(files: impl Iterator<Item = (&'a str, &'a str)>) -> Self {
        let (folder, programs) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
        for entry in std::fs::read_dir(root()).unwrap() {
            let entry = entry.unwrap();
            let (name, copy) = (entry.file_name(), folder.path().join(entry.file_name()));
            if LINKED.iter().any(|linked| name == *linked) {
                symlink(entry.path(), copy).unwrap();
            } else if !LEFT_OUT.iter().any(|left_out| name == *left_out) {
                patch::copy(&entry.path(), &copy).unwrap();
            }
        }
        for (name, text) in files {
            let file = folder.path().join(name);
            std::fs::create_dir_all(file.parent().unwrap()).unwrap();
            std::fs::write(file, text).unwrap();
        }
        symlink(env!("CARGO_BIN_EXE_videg"), programs.path().join("videg")).unwrap();
        // Equal figures, equal bytes.
        std::fs::write(programs.path().join("matplotlibrc"), "svg.hashsalt: videg\n").unwrap();
        let cargo = programs.path().join("cargo");
        std::fs::write(&cargo, CARGO).unwrap();
        std::fs::set_permissions(&cargo, std::fs::Permissions::from_mode(0o755)).unwrap();
        Self { folder, programs }
    }

    /// Where the commands run.
    pub fn path(&self) -> &Path {
        self.folder.path()
    }

    /// A program that runs there, with the tool and the Python of the tests on the PATH, and no screen.
    pub fn command(&self, program: &str) -> Command {
        let mut places: Vec<PathBuf> = vec![self.programs.path().to_owned()];
        places.extend(python().and_then(|python| Some(python.parent()?.to_owned())));
        places.extend(std::env::split_paths(&std::env::var_os("PATH").unwrap_or_default()));
        let mut command = Command::new(program);
        command.current_dir(self.path()).stdin(Stdio::null()).env("PATH", std::env::join_paths(places).unwrap());
        command.env("VIDEG_ROOT", root()).env("VIDEG_CARGO", std::env::var_os("CARGO").unwrap_or(env!("CARGO").into()));
        // It is there if its own package's tests were built, too.
        command.env("CARGO_FMU", Path::new(env!("CARGO_BIN_EXE_videg")).with_file_name("cargo-fmu"));
        // What a reader has: a terminal of this width, and no variables of `cargo test`.
        command.env("COLUMNS", "100").env("NO_COLOR", "1").env("MPLBACKEND", "Agg").env("FIGURES", "figures");
        command
            .env("TMPDIR", self.programs.path())
            .env("MATPLOTLIBRC", self.programs.path())
            .env("SOURCE_DATE_EPOCH", "0");
        command.env_remove("RUSTFLAGS").env_remove("UPDATE_BOOK");
        command
    }

    /// Runs a line of shell; returns whether it ended with 0, and all that it printed.
    pub fn shell(&self, line: &str) -> (bool, String) {
        let output = self.command("bash").args(["-c", &format!("exec 2>&1\n{line}")]).output().unwrap();
        let printed = String::from_utf8_lossy(&output.stdout).into_owned();
        let here = self.path().to_string_lossy().into_owned();
        let printed = printed.replace(&here, "...").replace(&*root().to_string_lossy(), "...");
        (output.status.success(), printed)
    }
}

#[test]
fn what_commands_write_stays_out_of_the_source_tree() {
    let clone = Clone::new(std::iter::empty());
    let (done, printed) =
        clone.shell("echo changed > docs/SUMMARY.md && echo new > model/new.txt && cat docs/SUMMARY.md");
    assert!(done && printed == "changed\n", "{printed}");
    assert!(!root().join("model/new.txt").exists());
    assert!(std::fs::read_to_string(root().join("docs/SUMMARY.md")).unwrap().starts_with("# Summary"));
}
