//! The command-line tool: one verb a file.
//!
//! Data goes to stdout, messages and progress to stderr. Exit codes: 0 done; 1 checked, and a check failed; 2 could not
//! run, with one line on stderr that says why; 128 and its number: ended early and in order by a signal. A closed stdout or
//! stderr changes none of them.
// `output` and `message` write on both: these macros panic if the reader has closed them.
#![deny(clippy::print_stdout, clippy::print_stderr)]

mod candidates;
mod cases;
mod completions;
mod cosim;
mod cosim_report;
mod crosscheck;
mod crosscheck_report;
mod drawn;
mod dynamics;
mod dynamics_report;
mod energy_flow;
mod excitation;
mod explore;
mod export;
mod fmu;
mod fmu_check;
mod fmu_check3;
mod format;
mod interruption;
mod isolation;
mod map;
mod map_report;
mod message;
mod options;
mod output;
mod packaging;
mod parameter_table;
mod picture;
mod progress;
mod reproduce;
mod reproduce_files;
mod reproduce_report;
mod results;
mod run_output;
mod simulate;
mod ssp;
mod sweep;
mod sweep_cases;
mod sweep_options;
mod sweep_statistics;
mod terminal;
mod time_series;
mod worker;

use std::io::ErrorKind;
use std::process::ExitCode;

pub use options::Window;
pub use sweep_options::{Common as SweepCommon, What as SweepOptions};

use clap::{CommandFactory as _, Parser, Subcommand};
use interruption::Interruption;

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
    /// Compare the closed forms of the paper, the embedded solver and ngspice on the same C(t)
    Crosscheck(crosscheck::Arguments),
    /// Run the harvester FMU alone: mechanics, C(t) and the gains of the paper
    Simulate(simulate::Arguments),
    /// Run many simulations over parameters and seeds, on all cores; resumes interrupted sweeps, merges shards
    Sweep(Box<sweep::Arguments>),
    /// Map the net power, or another result, over two variables of harvester and circuit, with its best point and the limits of the film
    Map(Box<map::Arguments>),
    /// Bifurcation diagram, Poincare section, Lyapunov exponent, periodic orbits and basins of attraction of any case
    Dynamics(dynamics::Arguments),
    /// Reproduce the tables and figures of the paper as data, pictures and one report
    Reproduce(reproduce::Arguments),
    /// Export C(t) for other programs: netlists for simulators of circuits, tables
    Export(export::Arguments),
    /// Write a page that computes the device live in a browser: in motion, with its circuit and maps; and open it
    Explore(explore::Arguments),
    /// List the published cases; print all start values of one as TOML, JSON or Python
    Cases(cases::Arguments),
    /// Build, describe and check FMUs
    Fmu(fmu::Arguments),
    /// Package both FMUs, connected and with the parameters of a case, as Harvester.ssp (SSP 1.0)
    Ssp(ssp::Arguments),
    /// Print shell completions
    Completions(completions::Arguments),
    /// Run the shared library of ngspice for another process
    #[command(name = crate::ngspice::live::WORKER_VERB, hide = true)]
    NgspiceWorker,
    /// Run an instance of an FMU for another process
    #[command(name = fmu_import::isolated::WORKER_VERB, hide = true)]
    FmuWorker,
}

/// How a verb ended.
pub(crate) enum Exit {
    /// Done, or all checks passed.
    Passed,
    /// A check failed; the findings are printed.
    Failed,
    /// Ended early and in order by a signal of this number.
    Stopped(u8),
}

impl Verb {
    fn run(&self) -> anyhow::Result<Exit> {
        let interruption = Interruption::default();
        // These end with the process that they work for.
        if !matches!(self, Self::NgspiceWorker | Self::FmuWorker) {
            interruption.watch()?;
        }
        let result = match self {
            Self::Cosim(arguments) => cosim::run(arguments, &interruption),
            Self::Crosscheck(arguments) => crosscheck::run(arguments, &interruption),
            Self::Simulate(arguments) => simulate::run(arguments, &interruption),
            Self::Sweep(arguments) => sweep::run(arguments, &interruption),
            Self::Map(arguments) => map::run(arguments, &interruption),
            Self::Dynamics(arguments) => dynamics::run(arguments, &interruption),
            Self::Reproduce(arguments) => reproduce::run(arguments, &interruption),
            Self::Export(arguments) => export::run(arguments, &interruption),
            Self::Explore(arguments) => explore::run(arguments),
            Self::Cases(arguments) => cases::run(arguments),
            Self::Fmu(arguments) => fmu::run(arguments),
            Self::Ssp(arguments) => ssp::run(arguments),
            Self::Completions(arguments) => completions::run(arguments),
            Self::NgspiceWorker => worker::run_ngspice(),
            Self::FmuWorker => worker::run_fmu(),
        };
        interruption.settle();
        videg_system::folders::remove_empty();
        result
    }
}

/// The command line as it is parsed: every verb with its options and their help.
pub fn command() -> clap::Command {
    Cli::command()
}

/// Runs the tool with the arguments of the process.
pub fn main() -> ExitCode {
    if completions::answer() {
        return ExitCode::SUCCESS;
    }
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => return usage(&error),
    };
    let result = cli.verb.run();
    match result {
        Ok(Exit::Passed) => ExitCode::SUCCESS,
        Ok(Exit::Failed) => ExitCode::from(1),
        // As shells say it.
        Ok(Exit::Stopped(signal)) => ExitCode::from(128 + signal),
        Err(error) => {
            message::fail(&format!("{error:#}"));
            ExitCode::from(2)
        }
    }
}

/// Help and version go out as they are; a mistake becomes one line, as every other error here.
fn usage(error: &clap::Error) -> ExitCode {
    if !error.use_stderr() || error.kind() == clap::error::ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand {
        let is_shown = error.print().map_or_else(|error| error.kind() == ErrorKind::BrokenPipe, |()| true);
        return if is_shown && !error.use_stderr() { ExitCode::SUCCESS } else { ExitCode::from(2) };
    }
    let text = error.to_string();
    let lines = text.lines().take_while(|line| !line.starts_with("Usage:") && !line.starts_with("For more"));
    let message: Vec<_> = lines.map(str::trim).filter(|line| !line.is_empty()).collect();
    let message = message::one_line(&message.join(" "));
    message::fail(&format!("{} (see --help)", message.trim_start_matches("error: ")));
    ExitCode::from(2)
}
