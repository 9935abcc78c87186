//! Output of a verb: its folder, its files, and stdout.

use std::ffi::OsString;
use std::io;
use std::path::Path;

use anyhow::Context as _;
use serde::Serialize;

use super::message::{plain, plain_json, say};
use super::terminal;
use videg_report::Report;
use videg_system::atomic_file;

/// The name of a case as a part of a path: letters, digits, dot, dash and underscore. A case file may have any name.
pub fn safe(name: &str) -> String {
    name.chars().map(|c| if c.is_alphanumeric() || "._-".contains(c) { c } else { '_' }).collect()
}

/// Writes a file atomically.
pub fn write(path: &Path, content: impl AsRef<[u8]>) -> anyhow::Result<()> {
    atomic_file::write(path, content).with_context(|| format!("cannot write {}", path.display()))
}

/// Prints `text` and an end of line on stdout, with control characters spelled out, lines that fit and verdicts in colour.
pub fn print(text: &str) -> io::Result<()> {
    let text = terminal::wrapped(&plain(text), terminal::width());
    print_to(terminal::stdout(), &(terminal::coloured(&text) + "\n"))
}

/// Prints the document `json` and an end of line on stdout.
pub fn print_json(json: &str) -> io::Result<()> {
    print_as_is(&(plain_json(json) + "\n"))
}

/// Prints `value` as a JSON document, or else its `text`.
pub fn show(is_json: bool, value: &impl Serialize, text: impl FnOnce() -> String) -> anyhow::Result<()> {
    let shown = if is_json { print_json(&serde_json::to_string_pretty(value)?) } else { print(&text()) };
    Ok(shown?)
}

/// Writes `text` on stdout as it is. A reader that closes early (`videg ... | head`) is no failure.
pub fn print_as_is(text: &str) -> io::Result<()> {
    print_to(io::stdout(), text)
}

fn print_to(mut stdout: impl io::Write, text: &str) -> io::Result<()> {
    match stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        other => other,
    }
}

/// An HTML report, with nothing but its heading.
pub fn report(title: impl Into<String>, subtitle: impl Into<String>) -> Report {
    Report::new(title, subtitle)
        .command(typed(std::env::args_os().skip(1)))
        .generated_by(concat!("videg ", env!("CARGO_PKG_VERSION")))
}

/// These arguments as a user would type them. A file name may be no valid text.
fn typed(arguments: impl Iterator<Item = OsString>) -> String {
    let arguments = arguments.map(|argument| {
        let argument = plain(&argument.to_string_lossy());
        let is_bare = argument.chars().all(|c| c.is_alphanumeric() || "-_.,=/:+".contains(c));
        if is_bare { argument } else { format!("'{}'", argument.replace('\'', "'\\''")) }
    });
    std::iter::once("videg".to_owned()).chain(arguments).collect::<Vec<_>>().join(" ")
}

/// Shows warnings on stderr, one line each.
pub fn warn(warnings: &[String]) {
    for warning in warnings {
        say(&format!("warning: {warning}"));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[cfg(unix)]
    fn arguments_are_typed_as_they_were_given_even_those_that_are_no_text() {
        use std::os::unix::ffi::OsStringExt as _;
        let no_text = OsString::from_vec(b"k\xff.toml".to_vec());
        let arguments = ["simulate", "--set", "a b=1", "it's", "\u{1b}[2J"].map(OsString::from);
        let shown = typed(arguments.into_iter().chain([no_text]));
        assert_eq!(shown, "videg simulate --set 'a b=1' 'it'\\''s' '\\u{1b}[2J' 'k\u{fffd}.toml'");
    }
}
