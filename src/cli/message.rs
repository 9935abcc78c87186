//! Text of others for a terminal: without characters that control it, reorder or hide text; an error is one readable line.

use std::io::Write as _;

use super::terminal;

/// Longest error that is shown, characters.
const LONGEST: usize = 2000;

/// `text` as one line of readable length.
pub fn one_line(text: &str) -> String {
    let lines: Vec<_> = text.lines().map(str::trim).filter(|line| !line.is_empty()).collect();
    let line = plain(&lines.join(" | "));
    let count = line.chars().count();
    if count <= LONGEST {
        return line;
    }
    let begin: String = line.chars().take(LONGEST).collect();
    format!("{begin}... (and {} more characters)", count - LONGEST)
}

/// `text` with the characters that [`is_hidden`] finds spelled out, except ends of lines.
pub fn plain(text: &str) -> String {
    let spell = |c: char| if is_hidden(c) && c != '\n' { c.escape_default().to_string() } else { c.to_string() };
    text.chars().map(spell).collect()
}

/// Whether a character controls the terminal or the text around it: ends a line, changes the direction, has no width.
fn is_hidden(c: char) -> bool {
    // Not U+200C and U+200D, which are letters of some scripts and stand in emoji.
    let formats = ['\u{61c}', '\u{180e}', '\u{200b}', '\u{200e}', '\u{200f}', '\u{feff}'];
    let ranges = ['\u{fff9}'..='\u{fffb}', '\u{2028}'..='\u{202e}', '\u{2060}'..='\u{206f}'];
    c.is_control() || formats.contains(&c) || ranges.iter().any(|range| range.contains(&c))
}

/// The same for a JSON document, which stays valid: of these characters it contains only ends of lines itself.
pub fn plain_json(json: &str) -> String {
    let spell = |c: char| if is_hidden(c) && c != '\n' { format!("\\u{:04x}", u32::from(c)) } else { c.to_string() };
    json.chars().map(spell).collect()
}

/// Writes `message` on stderr, in one line unless a terminal is narrower. A closed stderr is no failure.
pub fn say(message: &str) {
    let shown = fitted(message);
    let warning = shown.strip_prefix("videg: warning:");
    show(&match warning {
        Some(rest) => format!("videg: {}{rest}", terminal::warning_prefix("warning:")),
        None => shown,
    });
}

/// The same for an error that ends the program.
pub fn fail(message: &str) {
    let shown = fitted(message);
    show(&shown.replacen("videg:", &terminal::error_prefix("videg:"), 1));
}

fn fitted(message: &str) -> String {
    let line = format!("videg: {}", one_line(message));
    match terminal::width_of_stderr() {
        columns @ Some(_) => terminal::wrapped(&line, columns),
        None => line,
    }
}

/// Writes a line of this program on stderr, as it is.
fn show(line: &str) {
    let _ = writeln!(terminal::stderr(), "{line}");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_is_one_line_without_control_characters() {
        assert_eq!(one_line("a\n  b\r\n\n\u{1b}[2Jc\u{7}"), "a | b | \\u{1b}[2Jc\\u{7}");
        let long = one_line(&"x".repeat(LONGEST + 7));
        assert!(long.ends_with("x... (and 7 more characters)"), "{long}");
    }

    #[test]
    fn what_reorders_or_hides_text_is_spelled_out() {
        for c in "\u{180e}\u{200b}\u{200e}\u{200f}\u{2028}\u{2029}\u{202a}\u{202e}\u{2066}\u{2069}\u{feff}".chars() {
            assert_eq!(one_line(&format!("a{c}b")), format!("a{}b", c.escape_default()));
        }
        let (letters, emoji) = ("\u{645}\u{6cc}\u{200c}\u{62e}", "\u{1f469}\u{200d}\u{1f527}");
        assert_eq!((one_line(letters).as_str(), one_line(emoji).as_str()), (letters, emoji));
    }

    #[test]
    fn a_document_without_control_characters_says_the_same() {
        let text = "a\u{7f}\u{9b}2J\u{1b}\n\u{202e}b";
        let json = serde_json::to_string_pretty(&[text]).unwrap();
        assert!(json.contains('\u{9b}'), "the writer spells them itself by now");
        let shown = plain_json(&json);
        assert!(!shown.contains(|c: char| is_hidden(c) && c != '\n'), "{shown:?}");
        assert_eq!(serde_json::from_str::<[String; 1]>(&shown).unwrap(), [text]);
    }

    #[test]
    fn lines_and_letters_stay_as_they_are() {
        assert_eq!(plain("gr\u{fc}n\nblau\t"), "gr\u{fc}n\nblau\\t");
    }
}
