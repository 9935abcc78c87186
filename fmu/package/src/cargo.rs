//! Runs Cargo, which knows whether libraries are fresh and where they are.

use std::collections::VecDeque;
use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};
use std::process::{ChildStdout, Command, Stdio};
use std::thread::Builder;

use serde::Deserialize;

use super::error::{PackageError, Result};
use super::platform::Platform;
use super::target::Target;
use super::tools;
use fmu_import::library_extension;
use videg_system::processes::ProcessGroup;

/// Lines of Cargo's output that an error shows.
const TAIL: usize = 40;

/// One line of `cargo build --message-format=json`.
#[derive(Deserialize)]
struct Message {
    target: Option<Artifact>,
    #[serde(default)]
    filenames: Vec<PathBuf>,
}

#[derive(Deserialize)]
struct Artifact {
    name: String,
}

/// A build of libraries.
#[derive(Debug, Clone, Copy)]
pub struct Build<'a> {
    /// Where Cargo is run.
    pub folder: &'a Path,
    /// What is built, and how: arguments behind `build`.
    pub arguments: &'a [String],
    /// For which machine; none means this one.
    pub target: Option<&'a Target>,
    /// What becomes of Cargo's messages.
    pub messages: Messages,
}

/// What becomes of Cargo's messages.
#[derive(Debug, Clone, Copy, Default)]
pub enum Messages {
    /// Cargo writes them to stderr, and a signal from the terminal reaches it.
    #[default]
    Shown,
    /// Lines about work are handed on; if Cargo fails, the last of the others stand in the error. Cargo runs in a process group of its
    /// own, which [`videg_system::processes`] can end.
    Taken(fn(&str)),
}

/// The libraries that a build has made.
#[derive(Debug)]
pub struct Libraries {
    /// Name and file of each.
    found: Vec<(String, PathBuf)>,
    /// The command line, for errors.
    command: String,
}

impl Libraries {
    /// The one with this name.
    ///
    /// # Errors
    /// When there is none.
    pub fn named(&self, name: &str) -> Result<PathBuf> {
        // Older versions of Cargo tell the name of the package where newer ones tell that of the library.
        let same = |other: &str| other.replace('-', "_") == name.replace('-', "_");
        let found = self.found.iter().find(|(other, _)| same(other)).map(|(_, path)| path.clone());
        let missing = || PackageError::NotBuilt { command: self.command.clone(), identifier: name.to_owned() };
        found.ok_or_else(missing)
    }
}

/// Builds shared libraries.
///
/// This may run inside `cargo run` and `cargo test`, which no longer lock the build folder.
///
/// # Errors
/// When a tool is missing, or Cargo fails.
pub fn libraries(build: &Build<'_>) -> Result<Libraries> {
    if let Some(target) = build.target {
        tools::check(build.folder, target)?;
    }
    let platform = build.target.map_or(Platform::HOST, |target| target.platform);
    let arguments = arguments(build);
    let shown = format!("cargo {}", arguments.join(" "));
    let mut command = command(build.folder);
    command.args(arguments).arg("--message-format=json-render-diagnostics");
    let found = execute(command, &shown, build.messages, |stdout| read_artifacts(stdout, platform))?;
    Ok(Libraries { found, command: shown })
}

/// Runs Cargo with these arguments in a folder.
///
/// # Errors
/// When it fails.
pub fn run(folder: &Path, arguments: &[&str], messages: Messages) -> Result<()> {
    output_of(folder, arguments, messages).map(drop)
}

/// The same, and gives what it prints.
pub(crate) fn output(folder: &Path, arguments: &[&str]) -> Result<Vec<u8>> {
    output_of(folder, arguments, Messages::Taken(|_| {}))
}

fn output_of(folder: &Path, arguments: &[&str], messages: Messages) -> Result<Vec<u8>> {
    let mut command = command(folder);
    command.args(arguments);
    execute(command, &format!("cargo {}", arguments.join(" ")), messages, |mut stdout| {
        let mut text = Vec::new();
        // If the program ends early, its status reports it.
        let _ = stdout.read_to_end(&mut text);
        text
    })
}

/// Runs Cargo to its end, and gives what `read` makes of its output.
fn execute<T: Default>(
    mut command: Command,
    shown: &str,
    messages: Messages,
    read: impl FnOnce(ChildStdout) -> T,
) -> Result<T> {
    let program = PathBuf::from(command.get_program());
    let failed = |cause| PackageError::Cargo { program: program.clone(), cause };
    let (found, status, tail) = match messages {
        Messages::Shown => {
            let mut cargo = command.stderr(Stdio::inherit()).spawn().map_err(failed)?;
            let found = cargo.stdout.take().map(read).unwrap_or_default();
            (found, cargo.wait().map_err(failed)?, String::new())
        }
        Messages::Taken(progress) => {
            let mut cargo = ProcessGroup::start(&mut command).map_err(failed)?;
            let (stdout, stderr) = (cargo.child.stdout.take(), cargo.child.stderr.take());
            let messages = move || stderr.map(|stderr| follow(stderr, progress)).unwrap_or_default();
            let messages = Builder::new().spawn(messages).map_err(failed)?;
            let found = stdout.map(read).unwrap_or_default();
            let tail = messages.join().unwrap_or_default();
            (found, cargo.wait(None).and_then(|_| cargo.end()).map_err(failed)?, tail)
        }
    };
    if !status.success() {
        let tail = if tail.is_empty() { tail } else { format!(":\n{tail}") };
        return Err(PackageError::Build { command: shown.to_owned(), status: status.to_string(), tail });
    }
    Ok(found)
}

fn command(workspace: &Path) -> Command {
    let mut command = Command::new(tools::cargo());
    command.current_dir(workspace);
    // A relative folder is meant relative to where the user is.
    if let Some(folder) = std::env::var_os("CARGO_TARGET_DIR")
        && let Ok(folder) = std::path::absolute(folder)
    {
        command.env("CARGO_TARGET_DIR", folder);
    }
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

fn arguments(build: &Build<'_>) -> Vec<String> {
    let mut arguments = vec![build.target.map_or("build", Target::subcommand).to_owned()];
    arguments.extend_from_slice(build.arguments);
    if let Some(target) = build.target {
        // A released library needs no symbol table, which is half of a DLL.
        arguments.extend(["--config", "profile.release.strip=\"symbols\"", "--target"].map(ToOwned::to_owned));
        arguments.push(target.argument());
    }
    arguments
}

/// Names and files of the shared libraries that Cargo reports, fresh ones included.
fn read_artifacts(stdout: impl Read, platform: Platform) -> Vec<(String, PathBuf)> {
    let extension = library_extension(platform.folder);
    let mut artifacts = Vec::new();
    for line in BufReader::new(stdout).lines().map_while(std::result::Result::ok) {
        let Ok(message) = serde_json::from_str::<Message>(&line) else { continue };
        let Some(target) = message.target else { continue };
        let library = message.filenames.into_iter().find(|path| path.extension().is_some_and(|it| it == extension));
        artifacts.extend(library.map(|library| (target.name, library)));
    }
    artifacts
}

/// Passes Cargo's messages about work on, and returns the last of the others.
fn follow(stderr: impl Read, progress: fn(&str)) -> String {
    let mut tail = VecDeque::new();
    for line in BufReader::new(stderr).lines().map_while(std::result::Result::ok) {
        let word = line.split_whitespace().next().unwrap_or_default();
        if matches!(word, "Compiling" | "Downloading" | "Downloaded" | "Blocking" | "Updating") {
            progress(line.trim());
            continue;
        }
        if tail.len() == TAIL {
            tail.pop_front();
        }
        tail.push_back(line);
    }
    tail.into_iter().collect::<Vec<_>>().join("\n")
}

#[cfg(test)]
mod tests {
    use super::{Platform, follow, read_artifacts};

    #[test]
    fn libraries_are_picked_from_the_messages() {
        let lines = concat!(
            "{\"reason\":\"compiler-artifact\",\"target\":{\"name\":\"serde\"},\"filenames\":[\"/t/libserde.rlib\"]}\n",
            "{\"reason\":\"compiler-artifact\",\"target\":{\"name\":\"Toy\"},",
            "\"filenames\":[\"/t/libToy.rlib\",\"/t/libToy.so\"],\"fresh\":true}\n",
            "not json\n{\"reason\":\"build-finished\",\"success\":true}\n"
        );
        let linux = Platform::of_triple("x86_64-unknown-linux-gnu").unwrap();
        assert_eq!(read_artifacts(lines.as_bytes(), linux), [("Toy".to_owned(), "/t/libToy.so".into())]);
    }

    #[test]
    fn progress_is_kept_out_of_the_tail() {
        let text = "   Compiling a v1\nerror: no\n    Finished\n";
        assert_eq!(follow(text.as_bytes(), |_| {}), "error: no\n    Finished");
    }
}
