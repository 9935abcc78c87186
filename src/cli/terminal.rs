//! The terminal behind stdout or stderr: its width, lines that fit in it, and colours where it has them. A reader that is no terminal
//! gets the same lines whatever the window.

use std::io::{self, Write};

use anstyle::{AnsiColor, Style};
use terminal_size::{Width, terminal_size_of};
use unicode_width::UnicodeWidthStr as _;

/// Longest line of prose, and the longest that is left as it is where there is no terminal; columns.
const PROSE: usize = 100;
const LEFT: usize = 110;
/// Narrowest window that lines are made for; columns.
const NARROWEST: usize = 20;

/// Columns of the terminal of stdout; none if it is no terminal.
pub fn width() -> Option<usize> {
    width_of(&io::stdout())
}

/// The same of stderr.
pub fn width_of_stderr() -> Option<usize> {
    width_of(&io::stderr())
}

#[cfg(unix)]
fn width_of(stream: &(impl std::os::fd::AsFd + io::IsTerminal)) -> Option<usize> {
    columns(stream.is_terminal(), || terminal_size_of(stream))
}

#[cfg(windows)]
fn width_of(stream: &(impl std::os::windows::io::AsHandle + io::IsTerminal)) -> Option<usize> {
    columns(stream.is_terminal(), || terminal_size_of(stream))
}

fn columns(is_terminal: bool, size: impl FnOnce() -> Option<(Width, terminal_size::Height)>) -> Option<usize> {
    /// Width of a terminal that does not tell it.
    const USUAL: usize = 80;
    is_terminal.then(|| match size() {
        Some((Width(columns @ 1..), _)) => usize::from(columns).max(NARROWEST),
        _ => USUAL,
    })
}

/// Columns that `text` takes.
pub fn columns_of(text: &str) -> usize {
    text.width()
}

/// `text` with its prose broken at spaces for a terminal of these columns, or for none. Tables stay as they are: lines from one rule
/// to the third, and without a terminal each line whose cells stand two columns apart, which a program reads.
pub fn wrapped(text: &str, terminal: Option<usize>) -> String {
    let limit = terminal.map_or(PROSE, |columns| columns.min(PROSE));
    let left = terminal.map_or(LEFT, |_| limit);
    let mut rules = 0;
    let lines = text.split('\n').map(|line| {
        let is_rule = is_rule(line);
        rules += usize::from(is_rule);
        let is_row = is_rule || rules % RULES != 0 || terminal.is_none() && line.trim().contains("  ");
        if is_row || line.width() <= left { line.to_owned() } else { broken(line, limit) }
    });
    lines.collect::<Vec<_>>().join("\n")
}

/// Rules of a table: above, below the heading and below the table.
const RULES: usize = 3;
/// The character that a rule consists of.
pub const RULE: char = '\u{2500}';

fn is_rule(line: &str) -> bool {
    !line.is_empty() && line.chars().all(|c| c == RULE)
}

/// A line in lines of at most `limit` columns, as far as its words allow, with its indentation.
pub fn broken(line: &str, limit: usize) -> String {
    let indentation = &line[..line.len() - line.trim_start().len()];
    let (mut lines, mut last) = (Vec::new(), indentation.to_owned());
    for word in line.split_whitespace() {
        let is_first = last.len() == indentation.len();
        if !is_first && last.width() + 1 + word.width() > limit {
            lines.push(std::mem::replace(&mut last, format!("{indentation}{word}")));
        } else {
            last.extend([if is_first { "" } else { " " }, word]);
        }
    }
    lines.push(last);
    lines.join("\n")
}

/// How a verdict is shown.
const GOOD: Style = AnsiColor::Green.on_default();
const MIXED: Style = AnsiColor::Yellow.on_default();
const BAD: Style = AnsiColor::Red.on_default().bold();

/// Verdicts in the last column of a table, or at the begin of a line, with how they are shown. Longer ones come first.
const VERDICTS: [(&str, Style); 12] = [
    ("agrees", GOOD),
    ("agree", GOOD),
    ("holds", GOOD),
    ("passed", GOOD),
    ("ok", GOOD),
    ("within ensemble", GOOD),
    ("in the tail", MIXED),
    ("explained", MIXED),
    ("differs", BAD),
    ("does not hold", BAD),
    ("FAILED", BAD),
    ("failed", BAD),
];

/// `text` with its verdicts in colour. Who writes it removes the colours for a reader that has none.
pub fn coloured(text: &str) -> String {
    text.split('\n').map(coloured_line).collect::<Vec<_>>().join("\n")
}

fn coloured_line(line: &str) -> String {
    // Cells stand two columns apart.
    let last = line.trim_end().rfind("  ").map_or(0, |at| at + 2);
    let at = |start: usize| {
        let found = VERDICTS.iter().find(|(word, _)| {
            let rest = line[start..].strip_prefix(word);
            rest.is_some_and(|rest| rest.trim().is_empty() || rest.starts_with(':') || rest.starts_with("  "))
        });
        found.map(|(word, style)| format!("{}{}{}", &line[..start], painted(word, *style), &line[start + word.len()..]))
    };
    at(last).or_else(|| at(0)).unwrap_or_else(|| line.to_owned())
}

fn painted(text: &str, style: Style) -> String {
    format!("{style}{text}{style:#}")
}

/// The name of the program before an error, and the word warning.
pub fn error_prefix(name: &str) -> String {
    painted(name, BAD)
}

/// As above.
pub fn warning_prefix(word: &str) -> String {
    painted(word, MIXED)
}

/// Stdout that keeps colours where they are wanted: `NO_COLOR`, `CLICOLOR_FORCE` and `TERM=dumb` count.
pub fn stdout() -> impl Write {
    anstream::stdout()
}

/// The same for stderr.
pub fn stderr() -> impl Write {
    anstream::stderr()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn prose_is_broken_at_spaces_and_tables_and_long_words_are_not() {
        let prose = "word ".repeat(30);
        let rule = "\u{2500}".repeat(130);
        let row = format!(" a  {}", "b ".repeat(60));
        let text = format!("  {prose}\n{rule}\n{row}\n{rule}\n{row}\n{rule}\n{}", "x".repeat(120));
        let piped = wrapped(&text, None);
        assert_eq!(piped.lines().filter(|line| line.width() > PROSE).count(), 6, "{piped}");
        assert!(piped.lines().take(2).all(|line| line.starts_with("  word")), "{piped}");
        let narrow = wrapped(&prose, Some(60));
        assert!(narrow.lines().all(|line| line.width() <= 60) && narrow.lines().count() == 3, "{narrow}");
        assert_eq!(narrow.split_whitespace().count(), 30);
        let checked = format!("FAILED  {prose}");
        assert_eq!([None, Some(90)].map(|columns| wrapped(&checked, columns).lines().count()), [1, 2]);
        // Where there is no terminal, lines of up to 110 columns stay.
        let almost = "word ".repeat(21);
        assert_eq!((wrapped(&almost, None).lines().count(), wrapped(&almost, Some(200)).lines().count()), (1, 2));
    }

    #[test]
    fn verdicts_are_coloured_where_they_stand_last() {
        let shown = |line: &str| anstream::adapter::strip_str(&coloured(line)).to_string();
        for (line, is_coloured) in [
            (" U_DE4   V   8079   agrees ", true),
            (" q       C   agree: 1e-9 of 1e-6 ", true),
            ("FAILED  library loads: no such file", true),
            ("ok      library loads", true),
            (" that it differs is told ", false),
            (" a   agreed ", false),
        ] {
            assert_eq!((coloured(line) != line, shown(line).as_str()), (is_coloured, line));
        }
    }
}
