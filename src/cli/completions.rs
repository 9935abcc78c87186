//! `videg completions`: what a shell needs to complete the command line.

use clap::Args;
use clap_complete::Shell;

use super::{Verdict, command};

/// Arguments of the verb.
#[derive(Args)]
pub struct Arguments {
    /// The shell
    shell: Shell,
}

/// Prints the completions.
pub fn run(arguments: &Arguments) -> anyhow::Result<Verdict> {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut command(), "videg", &mut script);
    std::io::Write::write_all(&mut std::io::stdout(), &script)?;
    Ok(Verdict::Passed)
}
