//! `videg explore`: the device in a browser.

use std::io::IsTerminal as _;
use std::path::{Path, PathBuf};

use anyhow::Context as _;
use clap::Args;
use serde::Serialize;

use super::options::{TimedCaseOptions, Window, parse_window};
use super::progress::Spinner;
use super::{Exit, output};
use crate::explorer;
use crate::package::Options;
use videg_system::folders;

/// Arguments of the verb.
#[derive(Args)]
pub struct Arguments {
    #[command(flatten)]
    case: TimedCaseOptions,
    /// Averaging window, s [default: 50,100, or the second half of a shorter run]
    #[arg(long, value_name = "S,S", value_parser = parse_window, allow_hyphen_values = true)]
    window: Option<Window>,
    /// File to write
    #[arg(long, value_name = "FILE", default_value = "out/explorer.html")]
    output: PathBuf,
    /// Do not open the page; without a terminal it is never opened
    #[arg(long)]
    no_open: bool,
    /// Print one JSON object on stdout
    #[arg(long)]
    json: bool,
}

/// What was written. Field names are the keys of `--json`.
#[derive(Serialize)]
struct Written<'a> {
    file: &'a Path,
    bytes: usize,
}

/// Runs the verb.
pub fn run(arguments: &Arguments) -> anyhow::Result<Exit> {
    let scenario = arguments.case.scenario_within(arguments.window)?;
    let waiting = Spinner::new("building the page");
    let page = explorer::page(&scenario, &Options { progress: Spinner::tell, ..Options::default() })?;
    drop(waiting);
    let file = &arguments.output;
    let folder = file.parent().unwrap_or(Path::new(""));
    folders::make(folder).with_context(|| format!("cannot make the folder {}", folder.display()))?;
    output::write(file, &page)?;
    let bytes = page.len();
    output::show(arguments.json, &Written { file, bytes }, || {
        format!("written: {}, {} kB, for any browser, without a network", file.display(), bytes / 1000)
    })?;
    if !arguments.no_open
        && std::io::stdout().is_terminal()
        && let Err(error) = std::path::absolute(file).and_then(open::that_detached)
    {
        output::warn(&[format!("no browser could be opened ({error}); open the file yourself")]);
    }
    Ok(Exit::Passed)
}
