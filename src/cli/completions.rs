//! `videg completions`: what a shell needs to complete the command line. Its script asks this program, which knows the variables.

use std::ffi::OsString;
use std::io::{self, Write};

use clap::{Args, Command};
use clap_complete::Shell;
use clap_complete::env::{Bash, CompleteEnv, Elvish, EnvCompleter, Fish, Shells, Zsh};

use super::{Exit, candidates, command, output};

/// The variable of the environment by which a script asks.
const ASKED: &str = "VIDEG_COMPLETE";
const NAME: &str = "videg";

/// Arguments of the verb.
#[derive(Args)]
pub struct Arguments {
    /// The shell
    shell: Shell,
}

/// Prints the completions.
pub fn run(arguments: &Arguments) -> anyhow::Result<Exit> {
    let mut script = Vec::new();
    match SHELLS.completer(&arguments.shell.to_string()) {
        Some(shell) => shell.write_registration(ASKED, NAME, NAME, NAME, &mut script)?,
        None => clap_complete::generate(arguments.shell, &mut command(), NAME, &mut script),
    }
    output::print_as_is(&String::from_utf8_lossy(&script))?;
    Ok(Exit::Passed)
}

/// Answers the script of a shell, and says whether one asked. A question that makes no sense has no answer: an error would stand in the
/// line that the user types.
pub fn answer() -> bool {
    // A script asks behind `--`; whatever the environment says, another command is not its question.
    if std::env::args_os().nth(1).is_none_or(|first| first != "--") {
        return false;
    }
    let folder = std::env::current_dir().ok();
    let engine = CompleteEnv::with_factory(|| candidates::of_all(command())).var(ASKED).shells(SHELLS);
    engine.bin(NAME).completer(NAME).try_complete(std::env::args_os(), folder.as_deref()).unwrap_or(true)
}

/// PowerShell is not among them: the engine's script for it runs the line that is typed, redirections and `$(...)` included.
const SHELLS: Shells<'static> = Shells(&[
    // The engine's script leaves words divided at `=`.
    &Asking { engine: &Bash, script: Some(include_str!("completions/videg.bash")) },
    &Asking { engine: &Elvish, script: None },
    &Asking { engine: &Fish, script: None },
    // The engine's script puts a space behind `membrane.restitution=`.
    &Asking { engine: &Zsh, script: Some(include_str!("completions/videg.zsh")) },
]);

/// A shell whose script asks this program.
struct Asking {
    engine: &'static dyn EnvCompleter,
    /// In place of the engine's.
    script: Option<&'static str>,
}

impl EnvCompleter for Asking {
    fn name(&self) -> &'static str {
        self.engine.name()
    }

    fn is(&self, name: &str) -> bool {
        self.engine.is(name)
    }

    fn write_registration(
        &self,
        var: &str,
        name: &str,
        bin: &str,
        completer: &str,
        out: &mut dyn Write,
    ) -> io::Result<()> {
        match self.script {
            Some(script) => out.write_all(script.as_bytes()),
            None => self.engine.write_registration(var, name, bin, completer, out),
        }
    }

    fn write_complete(
        &self,
        command: &mut Command,
        words: Vec<OsString>,
        folder: Option<&std::path::Path>,
        out: &mut dyn Write,
    ) -> io::Result<()> {
        if has_unknown_verb(command, &words) {
            return Ok(());
        }
        self.engine.write_complete(command, words, folder, out)
    }
}

/// Whether a word before the last one is no verb where only a verb can stand. The engine would pass over it.
fn has_unknown_verb(command: &Command, words: &[OsString]) -> bool {
    let mut command = command;
    for word in words.get(1..words.len().saturating_sub(1)).unwrap_or_default() {
        let is_option = word.to_string_lossy().starts_with('-');
        if is_option || !command.has_subcommands() || command.get_positionals().next().is_some() {
            return false;
        }
        match command.find_subcommand(word) {
            Some(verb) => command = verb,
            None => return true,
        }
    }
    false
}
