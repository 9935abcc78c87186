//! `cargo fmu`: FMUs from Rust models that are exported with `fmu-export`.

mod new;

use std::io::{ErrorKind, Write as _};
use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Args, Parser, Subcommand, ValueEnum};
use fmu_package::{AddedBinary, FmiVersion, PackageError, Project, Request};

/// The command line, as Cargo gives it to a subcommand.
#[derive(Parser)]
#[command(name = "cargo", bin_name = "cargo")]
enum Cargo {
    /// FMUs from Rust models
    #[command(version, arg_required_else_help = true)]
    Fmu {
        #[command(subcommand)]
        task: Task,
    },
}

#[derive(Subcommand)]
enum Task {
    /// Make a package with a model, to begin with
    New(new::Arguments),
    /// Build the FMU of a package and print its path
    ///
    /// In it are the libraries of all platforms named, the model description, a page about the variables, and from beside Cargo.toml:
    /// licences (LICENSE*, COPYING*), the folders documentation, extra and resources without hidden files, and the picture model.png.
    /// Cargo builds the library twice, once to ask it for its model description.
    Build {
        #[command(flatten)]
        what: What,
        /// Build for these platforms, all into the same FMU, instead of this machine: linux64 (runs with glibc 2.17 and
        /// later; needs cargo-zigbuild and zig), win64 (needs mingw-w64), darwin64 (on a Mac), or Rust triples
        #[arg(long = "target", value_name = "PLATFORM", value_delimiter = ',')]
        targets: Vec<String>,
        /// Add a library of the same model built elsewhere, e.g. darwin64=libmodel.dylib. May be repeated
        #[arg(long = "add-binary", value_name = "PLATFORM=FILE")]
        added: Vec<String>,
        /// Folder for the FMU [default: fmu in the folder in which Cargo builds, for FMI 3.0 fmu/fmi3]
        #[arg(long, value_name = "DIR")]
        output: Option<PathBuf>,
    },
    /// Print the model description of a package
    Describe {
        #[command(flatten)]
        what: What,
    },
}

/// Which model, and for which version of FMI.
#[derive(Args)]
struct What {
    /// Package [default: that around the working folder]
    #[arg(short, long)]
    package: Option<String>,
    /// One of its examples in place of its library
    #[arg(long)]
    example: Option<String>,
    /// Version of FMI
    #[arg(long, value_enum, default_value = "2")]
    fmi: Fmi,
    /// Cargo.toml of the package or its workspace [default: that around the working folder]
    #[arg(long, value_name = "FILE")]
    manifest_path: Option<PathBuf>,
    /// Further arguments of cargo build: -- --features fast --locked
    #[arg(last = true, value_name = "ARGUMENTS")]
    cargo: Vec<String>,
}

/// A version of FMI.
#[derive(Clone, Copy, ValueEnum)]
enum Fmi {
    #[value(name = "2")]
    Two,
    #[value(name = "3")]
    Three,
}

impl What {
    fn request(self) -> Request {
        Request {
            manifest: self.manifest_path,
            package: self.package,
            example: self.example,
            fmi: match self.fmi {
                Fmi::Two => FmiVersion::Fmi2,
                Fmi::Three => FmiVersion::Fmi3,
            },
            cargo: self.cargo,
            ..Request::default()
        }
    }
}

fn main() -> ExitCode {
    let Cargo::Fmu { task } = Cargo::parse();
    match run(task) {
        Ok(printed) => match writeln!(std::io::stdout(), "{}", printed.trim_end()) {
            // Nobody reads on.
            Err(error) if error.kind() != ErrorKind::BrokenPipe => failed(&format!("cannot write to stdout: {error}")),
            _ => ExitCode::SUCCESS,
        },
        Err(error) => failed(&error.to_string()),
    }
}

fn failed(why: &str) -> ExitCode {
    // Without stderr there is nobody to tell.
    let _ = writeln!(std::io::stderr(), "error: {why}");
    ExitCode::FAILURE
}

/// Does the task, and gives what to print.
fn run(task: Task) -> Result<String, PackageError> {
    match task {
        Task::New(arguments) => new::run(&arguments),
        Task::Build { what, targets, added, output } => {
            let request = what.request();
            let added = added.iter().map(|text| AddedBinary::parse(text, request.fmi)).collect::<Result<_, _>>()?;
            let fmu = Project::find(&Request { targets, added, output, ..request })?.build()?;
            // As a user would name it from here.
            let here = std::env::current_dir().ok();
            let shown = here.as_deref().and_then(|here| fmu.strip_prefix(here).ok()).unwrap_or(&fmu);
            Ok(shown.display().to_string())
        }
        Task::Describe { what } => Project::find(&what.request())?.description(),
    }
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory as _;

    use super::*;

    #[test]
    fn the_command_line_is_consistent() {
        Cargo::command().debug_assert();
    }
}
