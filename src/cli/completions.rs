//! `videg completions`: what a shell needs to complete the command line.

use clap::Args;
use clap_complete::Shell;

use super::{Exit, command, output};

/// Arguments of the verb.
#[derive(Args)]
pub struct Arguments {
    /// The shell
    shell: Shell,
}

/// Prints the completions.
pub fn run(arguments: &Arguments) -> anyhow::Result<Exit> {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut command(), "videg", &mut script);
    output::put(&String::from_utf8_lossy(&script))?;
    Ok(Exit::Passed)
}
