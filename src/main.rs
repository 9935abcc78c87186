//! The command-line tool `videg`.

use std::process::ExitCode;

fn main() -> ExitCode {
    videg::cli::main()
}
