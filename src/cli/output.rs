//! The folder into which a verb writes, what it writes there, and what it prints.

use std::io::Write as _;
use std::path::{Path, PathBuf};

use anyhow::Context as _;

use super::message::one_line;
use crate::scenario::Scenario;
use crate::whole;

/// The folder for the results of `verb`, made if it is not there.
pub fn folder(asked: Option<&Path>, verb: &str, scenario: &Scenario) -> anyhow::Result<PathBuf> {
    // A case file may have any name; what goes into a path is letters, digits, dot, dash and underscore.
    let safe = |c: char| if c.is_alphanumeric() || "._-".contains(c) { c } else { '_' };
    let name: String = scenario.name.chars().map(safe).collect();
    let folder = asked.map_or_else(|| Path::new("out").join(format!("{verb}-{name}")), Path::to_owned);
    std::fs::create_dir_all(&folder).with_context(|| format!("cannot make the output folder {}", folder.display()))?;
    Ok(folder)
}

/// Writes a file that appears whole or not at all.
pub fn write(path: &Path, content: impl AsRef<[u8]>) -> anyhow::Result<()> {
    whole::write(path, content).with_context(|| format!("cannot write {}", path.display()))
}

/// Prints `text` and an end of line on stdout.
pub fn print(text: &str) -> std::io::Result<()> {
    writeln!(std::io::stdout(), "{text}")
}

/// The command as a user would type it.
pub fn command_line() -> String {
    let arguments = std::env::args().skip(1).map(|argument| {
        let plain = argument.chars().all(|c| c.is_alphanumeric() || "-_.,=/:+".contains(c));
        if plain { argument } else { format!("'{}'", argument.replace('\'', "'\\''")) }
    });
    std::iter::once("videg".to_owned()).chain(arguments).collect::<Vec<_>>().join(" ")
}

/// Shows warnings on stderr, one line each.
pub fn warn(warnings: &[String]) {
    for warning in warnings {
        eprintln!("videg: warning: {}", one_line(warning));
    }
}
