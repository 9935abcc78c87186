//! The folder into which a verb writes, and files that appear whole or not at all.

use std::io::Write as _;
use std::path::{Path, PathBuf};

use anyhow::Context as _;

use super::message::one_line;
use crate::scenario::Scenario;

/// The folder for the results of `verb`, made if it is not there.
pub fn folder(asked: Option<&Path>, verb: &str, scenario: &Scenario) -> anyhow::Result<PathBuf> {
    // A case file may have any name; what goes into a path is letters, digits, dot, dash and underscore.
    let safe = |c: char| if c.is_alphanumeric() || "._-".contains(c) { c } else { '_' };
    let name: String = scenario.name.chars().map(safe).collect();
    let folder = asked.map_or_else(|| Path::new("out").join(format!("{verb}-{name}")), Path::to_owned);
    std::fs::create_dir_all(&folder).with_context(|| format!("cannot make the output folder {}", folder.display()))?;
    Ok(folder)
}

/// Writes a file under another name first, so that a reader never sees half of it.
pub fn write(path: &Path, content: impl AsRef<[u8]>) -> anyhow::Result<()> {
    let part = partial(path);
    let written = std::fs::write(&part, content).and_then(|()| std::fs::rename(&part, path));
    written.with_context(|| format!("cannot write {}", path.display()))
}

/// Name under which a file is written before it is complete.
pub fn partial(path: &Path) -> PathBuf {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(".part");
    path.with_file_name(name)
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
