//! Characters of the texts in case and sweep files. Names and descriptions are printed, drawn and packaged. Control
//! characters command a terminal, and XML forbids them.

use toml::{Table, Value};

/// Checks that no key and no text of `table` has a control character, except ends of lines and tabs in the description.
///
/// # Errors
/// The first one, by key and number.
pub fn check(table: &Table) -> Result<(), String> {
    table.iter().try_for_each(|(key, value)| check_entry(key, value))
}

/// `text` with ends of lines as editors write them elsewhere than on Windows: TOML keeps those within a text.
pub fn with_plain_ends(text: &str) -> String {
    text.replace("\r\n", "\n")
}

/// Checks a key, whose full `name` contains those of the tables around it, and its `value`.
fn check_entry(name: &str, value: &Value) -> Result<(), String> {
    check_text(name, name, false)?;
    match value {
        Value::String(text) => check_text(name, text, name == "description"),
        Value::Array(values) => values.iter().try_for_each(|value| check_entry(name, value)),
        Value::Table(table) => table.iter().try_for_each(|(key, value)| check_entry(&format!("{name}.{key}"), value)),
        _ => Ok(()),
    }
}

fn check_text(name: &str, text: &str, has_lines: bool) -> Result<(), String> {
    match text.chars().find(|c| is_refused(*c) && !(has_lines && matches!(c, '\n' | '\t'))) {
        None => Ok(()),
        Some(found) => {
            let (name, number) = (replaced(name), u32::from(found));
            let allowed = if has_lines { "but ends of lines and tabs" } else { "or ends of lines" };
            Err(format!(
                "{name}: the character U+{number:04X} in it is not allowed; allowed is text without control \
                         characters {allowed}"
            ))
        }
    }
}

/// Control characters, and the two code points that are no characters.
fn is_refused(c: char) -> bool {
    c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}')
}

/// `text` with a low line in place of each character that is refused.
pub(super) fn replaced(text: &str) -> String {
    text.chars().map(|c| if is_refused(c) { '_' } else { c }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::CaseFile;

    #[test]
    fn a_control_character_anywhere_is_named_with_its_key() {
        for (text, said) in [
            ("name = \"a\\u001b[2J\"", "name: the character U+001B in it is not allowed"),
            ("name = \"a\\nb\"", "name: the character U+000A"),
            ("case = \"a\\u009b\"", "case: the character U+009B"),
            ("description = \"a\\u0001\"", "description: the character U+0001"),
            ("description = \"a\\rb\"", "description: the character U+000D"),
            ("name = \"\\uffff\"", "name: the character U+FFFF"),
            ("[set]\na.\"b\\u0007\" = 1", "set.a.b_: the character U+0007"),
            ("[set]\na.b = \"\\u007f\"", "set.a.b: the character U+007F"),
            ("[vary]\na = [\"x\", \"\\t\"]", "vary.a: the character U+0009"),
        ] {
            let reason = check(&toml::from_str(text).unwrap()).unwrap_err();
            assert!(reason.starts_with(said), "{text}: {reason}");
        }
    }

    #[test]
    fn letters_of_all_languages_and_lines_of_a_description_are_allowed() {
        let text = "name = 'gr\u{fc}n \u{2192} \u{30c6}'\ndescription = \"one\\ntwo\"\n[set]\n'a.b' = 'c d'\n";
        assert_eq!(check(&toml::from_str(text).unwrap()), Ok(()));
    }

    #[test]
    fn a_file_of_an_editor_on_windows_reads_as_any_other() {
        let text = "until = 1.0\ndescription = \"\"\"\none\n\ttwo\"\"\"\n";
        let [plain, other] = [text.to_owned(), text.replace('\n', "\r\n")].map(|text| CaseFile::parse(&text).unwrap());
        assert_eq!(plain.description.as_deref(), Some("one\n\ttwo"));
        assert_eq!(plain.description, other.description);
    }

    #[test]
    fn a_run_called_after_its_file_has_a_name_that_can_be_shown() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a\u{1}b.toml");
        std::fs::write(&path, "until = 1.0\n").unwrap();
        assert_eq!(CaseFile::read(&path).unwrap().name.as_deref(), Some("a_b"));
    }
}
