//! Files in git, and parts of pages between markers, that follow from the code: tests hold them against what the code
//! gives, and write them where an environment variable asks for it.

#![allow(clippy::missing_panics_doc, clippy::panic, reason = "a panic is how a test fails")]

use std::fs;
use std::ops::Range;
use std::path::Path;

/// How many lines of a difference are shown, of either side.
const SHOWN: usize = 20;

/// How what is kept is written anew.
pub struct Golden {
    /// Environment variable: where it is set, files are written.
    variable: &'static str,
    /// The command that runs the tests, without the variable.
    command: &'static str,
}

impl Golden {
    /// What `VARIABLE=1 COMMAND` writes.
    pub const fn new(variable: &'static str, command: &'static str) -> Self {
        Self { variable, command }
    }

    /// Whether to write rather than to compare.
    pub fn updating(&self) -> bool {
        std::env::var_os(self.variable).is_some()
    }

    /// Holds a file against what it must be, or writes it.
    pub fn file(&self, path: impl AsRef<Path>, expected: &str) {
        let path = path.as_ref();
        if self.updating() {
            write(path, expected);
        } else {
            // A file that is not there differs; a checkout may have other ends of lines.
            let found = fs::read_to_string(path).unwrap_or_default().replace("\r\n", "\n");
            self.compare(path, &found, expected, |found, expected| found == expected);
        }
    }

    /// Holds what stands between `<!-- NAME: begin ... -->` and `<!-- NAME: end -->` against what it must be, or writes it.
    /// Blank lines around it stay as they are.
    pub fn section(&self, path: impl AsRef<Path>, name: &str, expected: &str) {
        self.section_as(path, name, expected, |found, expected| found == expected);
    }

    /// The same, where `agree(found, expected)` says whether the part of the page is right.
    pub fn section_as(&self, path: impl AsRef<Path>, name: &str, expected: &str, agree: impl Fn(&str, &str) -> bool) {
        let (path, expected) = (path.as_ref(), expected.trim());
        let text = fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        let text = text.replace("\r\n", "\n");
        let Some(part) = between(&text, name) else { panic!("{} has no markers of {name}", path.display()) };
        if self.updating() {
            write(path, &format!("{}{expected}{}", &text[..part.start], &text[part.end..]));
        } else {
            self.compare(path, &text[part], expected, agree);
        }
    }

    fn compare(&self, path: &Path, found: &str, expected: &str, agree: impl Fn(&str, &str) -> bool) {
        let (path, Self { variable, command }) = (path.display(), self);
        let difference = || format!("{}{}", lines("-", found, expected), lines("+", expected, found));
        let remedy = format!("run `{variable}=1 {command}`");
        assert!(agree(found, expected), "{path} is out of date: {remedy}, which changes\n{}", difference());
    }
}

/// Holds the model description of an FMU against what its table gives. Run with `UPDATE_MODEL_DESCRIPTION=1` to write the file
/// after a change of the table. Value references that are known stay, of which `changed` tells from what is kept and what is
/// made now: to move them nevertheless, which breaks masters, takes `UPDATE_VALUE_REFERENCES=1` as well.
pub fn model_description(path: &str, made: &str, changed: impl Fn(&str, &str) -> Vec<String>) {
    if std::env::var_os("UPDATE_VALUE_REFERENCES").is_none() {
        let changed = changed(&fs::read_to_string(path).unwrap_or_default(), made);
        let advice = "a new variable goes into a group of its own at the end of VARIABLES, docs/releasing.md";
        assert!(changed.is_empty(), "{advice}:\n{}", changed.join("\n"));
    }
    Golden::new("UPDATE_MODEL_DESCRIPTION", "cargo test --workspace").file(path, made);
}

/// Whether words are equal, and numbers within a relative `tolerance`. A number before `%` is a deviation: the difference of two
/// numbers.
pub fn agree(written: &str, now: &str, tolerance: f64) -> bool {
    let (written, now): (Vec<_>, Vec<_>) = (written.split_whitespace().collect(), now.split_whitespace().collect());
    let equal = |k: usize| match (written[k].parse::<f64>(), now[k].parse::<f64>()) {
        (Ok(a), Ok(b)) if written.get(k + 1) == Some(&"%") => (a - b).abs() <= 100.0 * tolerance,
        (Ok(a), Ok(b)) => (a - b).abs() <= tolerance * a.abs(),
        _ => written[k] == now[k],
    };
    written.len() == now.len() && (0..written.len()).all(equal)
}

fn write(path: &Path, text: &str) {
    fs::write(path, text).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
}

/// Where in a page the part of that name stands, without blanks around it.
fn between(text: &str, name: &str) -> Option<Range<usize>> {
    let begin = text.find(&format!("<!-- {name}: begin"))?;
    let start = begin + text[begin..].find("-->\n")? + "-->\n".len();
    let part = &text[start..start + text[start..].find(&format!("<!-- {name}: end"))?];
    let before = part.len() - part.trim_start().len();
    Some(start + before..start + before + part.trim().len())
}

/// The first lines of one text that the other has not.
fn lines(mark: &str, of: &str, other: &str) -> String {
    let only = of.lines().filter(|line| other.lines().all(|there| there != *line));
    only.take(SHOWN).flat_map(|line| [mark, " ", line, "\n"]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const COMPARES: Golden = Golden::new("VIDEG_GOLDEN_IS_NEVER_SET", "cargo test --test rows");
    /// Set wherever a program runs.
    const WRITES: Golden = Golden::new("PATH", "cargo test");
    const PAGE: &str = "# A\n\n<!-- rows: begin (made) -->\n\n| 1 |\n| 2 |\n\n<!-- rows: end -->\n\nB\n";

    fn page() -> tempfile::NamedTempFile {
        let file = tempfile::NamedTempFile::new().unwrap();
        write(file.path(), PAGE);
        file
    }

    #[test]
    fn a_part_of_a_page_is_replaced_and_nothing_else() {
        let file = page();
        WRITES.section(&file, "rows", "\n| 1 |\n| 3 |\n");
        assert_eq!(fs::read_to_string(&file).unwrap(), PAGE.replace("| 2 |", "| 3 |"));
        WRITES.section(&file, "rows", "| 1 |\n| 2 |");
        assert_eq!(fs::read_to_string(&file).unwrap(), PAGE);
        COMPARES.section(&file, "rows", "| 1 |\n| 2 |\n");
    }

    #[test]
    #[should_panic(
        expected = "run `VIDEG_GOLDEN_IS_NEVER_SET=1 cargo test --test rows`, which changes\n- | 2 |\n+ | 3 |\n"
    )]
    fn a_part_that_is_out_of_date_is_told_with_its_lines_and_the_command() {
        COMPARES.section(page(), "rows", "| 1 |\n| 3 |\n");
    }

    #[test]
    #[should_panic(expected = "has no markers of columns")]
    fn a_page_without_the_markers_is_told() {
        COMPARES.section(page(), "columns", "");
    }

    #[test]
    fn a_file_is_written_and_then_right_whatever_ends_its_lines() {
        let file = page();
        WRITES.file(&file, "one\ntwo\n");
        COMPARES.file(&file, "one\ntwo\n");
        write(file.path(), "one\r\ntwo\r\n");
        COMPARES.file(&file, "one\ntwo\n");
    }

    #[test]
    #[should_panic(expected = "which changes\n+ one\n")]
    fn a_file_that_is_not_there_is_out_of_date() {
        COMPARES.file("no/such/file", "one\n");
    }

    #[test]
    #[should_panic(expected = "docs/releasing.md:\nx moved")]
    fn a_value_reference_that_moves_is_told() {
        model_description("no/such/file", "one\n", |_, _| vec!["x moved".to_owned()]);
    }

    #[test]
    fn a_number_that_changed_and_a_word_that_changed_are_seen() {
        let agree = |now| agree("| fig14 | 8078.9 | -0.00 % |", now, 1e-3);
        assert!(agree("| fig14 | 8079.0 | +0.00 % |"));
        for other in ["| fig14 | 8100.0 | -0.00 % |", "| fig14 | 8078.9 | -0.20 % |", "| fig13 | 8078.9 | -0.00 % |"] {
            assert!(!agree(other), "{other}");
        }
    }

    #[test]
    fn what_agrees_by_another_measure_is_left_alone() {
        COMPARES.section_as(page(), "rows", "anything", |found, expected| {
            found.starts_with("| 1") && expected == "anything"
        });
    }
}
