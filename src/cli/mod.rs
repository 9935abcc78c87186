//! The command-line tool: one verb a file.
//!
//! Data goes to stdout, messages and progress to stderr. Exit codes: 0 done; 1 checked, and a check failed; 2 could not
//! run, with one line on stderr that says why.

mod completions;
mod cosim;
mod cosim_report;
mod fmu;
mod format;
mod options;
mod output;
mod packaging;
mod picture;
mod progress;
mod simulate;

use std::process::ExitCode;

use clap::error::ErrorKind;
use clap::{Parser, Subcommand};

/// Vibro-impact dielectric elastomer generator: co-simulate the harvester FMU with a harvesting circuit.
#[derive(Parser)]
#[command(name = "videg", version, about, max_term_width = 110)]
struct Cli {
    #[command(subcommand)]
    verb: Verb,
}

#[derive(Subcommand)]
enum Verb {
    /// Co-simulate the harvester FMU with a harvesting circuit
    Cosim(cosim::Arguments),
    /// Run the harvester FMU alone: the mechanics, C(t), and the gains that the paper counts
    Simulate(simulate::Arguments),
    /// Build, describe and check FMUs
    Fmu(fmu::Arguments),
    /// Print shell completions
    Completions(completions::Arguments),
}

/// Whether everything that was checked holds.
pub(crate) enum Verdict {
    /// Done, or checked and found right.
    Passed,
    /// A check failed; what was found is printed.
    #[allow(dead_code)]
    Failed,
}

/// Runs the tool with the arguments of the process.
pub fn main() -> ExitCode {
    let verb = match Cli::try_parse() {
        Ok(cli) => cli.verb,
        Err(error) => return refuse(&error),
    };
    let result = match verb {
        Verb::Cosim(arguments) => cosim::run(&arguments),
        Verb::Simulate(arguments) => simulate::run(&arguments),
        Verb::Fmu(arguments) => fmu::run(&arguments),
        Verb::Completions(arguments) => completions::run(&arguments),
    };
    match result {
        Ok(Verdict::Passed) => ExitCode::SUCCESS,
        Ok(Verdict::Failed) => ExitCode::from(1),
        // A reader that has seen enough (`videg ... | head`) is no failure.
        Err(error) if is_broken_pipe(&error) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("videg: {error:#}");
            ExitCode::from(2)
        }
    }
}

/// Says on one line what is wrong with the arguments; prints what is no error (`--help`, `--version`) as it is.
fn refuse(error: &clap::Error) -> ExitCode {
    if !error.use_stderr() || error.kind() == ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand {
        // Nobody is left to tell if not even this can be printed.
        let _ = error.print();
        return ExitCode::from(u8::try_from(error.exit_code()).unwrap_or(2));
    }
    let text = error.render().to_string();
    let message = ["\n\nUsage:", "\n\nFor more information"]
        .iter()
        .fold(text.as_str(), |text, end| text.split_once(end).map_or(text, |(message, _)| message));
    let line = message.split_whitespace().collect::<Vec<_>>().join(" ");
    eprintln!("videg: {}", line.trim_start_matches("error: "));
    ExitCode::from(2)
}

fn is_broken_pipe(error: &anyhow::Error) -> bool {
    let kind = error.downcast_ref::<std::io::Error>().map(std::io::Error::kind);
    kind == Some(std::io::ErrorKind::BrokenPipe)
}
