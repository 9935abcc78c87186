//! The cards of a netlist: logical lines, with included files in their place.

use std::path::{Path, PathBuf};
use std::rc::Rc;

use thiserror::Error;

/// Largest netlist, files included, bytes.
pub const LARGEST: u64 = 1 << 20;
/// Deepest nesting of included files.
const DEEPEST: usize = 16;

/// Why a netlist is not taken.
#[derive(Debug, Error)]
#[error("{place}: {reason}")]
pub struct NetlistError {
    /// File, and line if there is one.
    place: String,
    reason: String,
}

/// A logical line: with its continuations, without comment at its end.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Card {
    /// The text.
    pub text: String,
    file: Rc<Path>,
    line: usize,
}

impl Card {
    /// The first word, in small letters.
    pub fn first(&self) -> String {
        self.text.split_whitespace().next().unwrap_or_default().to_ascii_lowercase()
    }

    /// File and line.
    pub fn place(&self) -> String {
        format!("{}, line {}", self.file.display(), self.line)
    }

    /// An error that says why it is refused.
    pub fn refused(&self, reason: &str) -> NetlistError {
        const WIDTH: usize = 60;
        let shown: String = self.text.chars().take(WIDTH).collect();
        let dots = if shown.len() < self.text.len() { "..." } else { "" };
        NetlistError { place: self.place(), reason: format!("{shown}{dots}: {reason}") }
    }
}

/// The cards of the netlist at `path`, without its title. Files are included from the folder of the netlist only, unless it `is_trusted`.
pub fn read(path: &Path, is_trusted: bool) -> Result<Vec<Card>, NetlistError> {
    let folder = path.parent().filter(|it| !it.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let root = folder.canonicalize().map_err(|cause| failed(path, &cause))?;
    let mut reader = Reader { root, is_trusted, left: LARGEST, cards: Vec::new() };
    let lines = reader.lines(path)?;
    // The first line is always the title.
    reader.take(&Rc::from(path), lines.into_iter().skip(1), 0)?;
    Ok(reader.cards)
}

fn failed(path: &Path, cause: &dyn std::fmt::Display) -> NetlistError {
    NetlistError { place: path.display().to_string(), reason: cause.to_string() }
}

struct Reader {
    root: PathBuf,
    is_trusted: bool,
    /// Bytes that may still be read.
    left: u64,
    cards: Vec<Card>,
}

impl Reader {
    /// The lines of a file with their numbers.
    fn lines(&mut self, path: &Path) -> Result<Vec<(usize, String)>, NetlistError> {
        use std::io::Read as _;
        let too_large =
            || failed(path, &format!("a netlist has at most {LARGEST} bytes, with the files that it includes"));
        let file = std::fs::File::open(path).map_err(|cause| failed(path, &cause))?;
        if !file.metadata().map_err(|cause| failed(path, &cause))?.is_file() {
            return Err(failed(path, &"is no file"));
        }
        let mut bytes = Vec::new();
        file.take(self.left + 1).read_to_end(&mut bytes).map_err(|cause| failed(path, &cause))?;
        self.left = self.left.checked_sub(bytes.len() as u64).ok_or_else(too_large)?;
        // Comments may be in any language and encoding.
        let text = String::from_utf8_lossy(&bytes);
        let lines: Vec<_> = text.lines().enumerate().map(|(index, line)| (index + 1, line.to_owned())).collect();
        let is_text = |line: &str| line.chars().all(|c| c == '\t' || !c.is_control());
        match lines.iter().find(|(_, line)| !is_text(line)) {
            Some((line, text)) => {
                let found = text.chars().find(|c| c.is_control() && *c != '\t').map_or(0, u32::from);
                let place = format!("{}, line {line}", path.display());
                Err(NetlistError { place, reason: format!("control character {found:#04x}: a netlist is text") })
            }
            None => Ok(lines),
        }
    }

    fn take(
        &mut self,
        file: &Rc<Path>,
        lines: impl Iterator<Item = (usize, String)>,
        depth: usize,
    ) -> Result<(), NetlistError> {
        for card in join(file, lines) {
            let first = card.first();
            match first.as_str() {
                ".include" | ".inc" | ".incl" | ".lib" => self.include(&card, depth)?,
                _ => self.cards.push(card),
            }
        }
        Ok(())
    }

    /// Puts a file, or a section of it, in the place of the card that names it.
    fn include(&mut self, card: &Card, depth: usize) -> Result<(), NetlistError> {
        if depth == DEEPEST {
            return Err(card.refused(&format!("files include each other more than {DEEPEST} deep")));
        }
        let rest = card.text.split_once(char::is_whitespace).map_or("", |(_, rest)| rest.trim());
        let (name, section) = file_and_section(rest);
        let folder = card.file.parent().unwrap_or(Path::new(""));
        let path = folder.join(name);
        let real = path.canonicalize().map_err(|cause| card.refused(&cause.to_string()))?;
        if !self.is_trusted && !real.starts_with(&self.root) {
            return Err(card.refused("is outside the folder of the netlist; allowed with --trust"));
        }
        let lines = self.lines(&path)?;
        let lines = match section {
            Some(name) => section_of(lines, name).ok_or_else(|| card.refused("the file has no such section"))?,
            None => lines,
        };
        self.take(&Rc::from(path.as_path()), lines.into_iter(), depth + 1)
    }
}

/// `"my file.lib" section`, with or without quotes and section.
fn file_and_section(text: &str) -> (&str, Option<&str>) {
    let quote = text.chars().next().filter(|c| "\"'".contains(*c));
    let (name, rest) = match quote {
        Some(quote) => text[1..].split_once(quote).unwrap_or((&text[1..], "")),
        None => text.split_once(char::is_whitespace).unwrap_or((text, "")),
    };
    (name, rest.split_whitespace().next())
}

/// The lines between `.lib name` and `.endl`.
fn section_of(lines: Vec<(usize, String)>, name: &str) -> Option<Vec<(usize, String)>> {
    let is_start = |line: &str| {
        let mut words = line.split_whitespace();
        words.next().is_some_and(|word| word.eq_ignore_ascii_case(".lib"))
            && words.next().is_some_and(|word| word.eq_ignore_ascii_case(name))
            && words.next().is_none()
    };
    let start = lines.iter().position(|(_, line)| is_start(line))? + 1;
    let is_end = |line: &str| line.trim_start().to_ascii_lowercase().starts_with(".endl");
    let length = lines[start..].iter().position(|(_, line)| is_end(line)).unwrap_or(lines.len() - start);
    Some(lines.into_iter().skip(start).take(length).collect())
}

/// Joins lines with their continuations, and cuts off comments behind a card.
fn join(file: &Rc<Path>, lines: impl Iterator<Item = (usize, String)>) -> Vec<Card> {
    let mut cards: Vec<Card> = Vec::new();
    for (line, text) in lines {
        let text = text.trim();
        if text.starts_with('*') && !text.starts_with("*#") || text.is_empty() {
            continue;
        }
        let text = if text.starts_with('*') { text } else { without_comment(text) };
        match (text.strip_prefix('+'), cards.last_mut()) {
            (Some(rest), Some(card)) => card.text = format!("{} {}", card.text, rest.trim()),
            _ => cards.push(Card { text: text.to_owned(), file: Rc::clone(file), line }),
        }
    }
    cards.retain(|card| !card.text.is_empty());
    cards
}

/// ngspice takes `;`, and `$` after a blank, for the begin of a comment.
fn without_comment(text: &str) -> &str {
    let end = text.find(';').into_iter().chain(text.find(" $ ")).chain(text.find("\t$ ")).min();
    text[..end.unwrap_or(text.len())].trim_end()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder(files: &[(&str, &str)]) -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        for (name, text) in files {
            let path = folder.path().join(name);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, text).unwrap();
        }
        folder
    }

    fn texts(files: &[(&str, &str)], is_trusted: bool) -> Result<Vec<String>, String> {
        let folder = folder(files);
        let path = folder.path().join("net/my.cir");
        let shown = format!("{}/", folder.path().display());
        let cards = read(&path, is_trusted).map_err(|error| error.to_string().replace(&shown, ""))?;
        Ok(cards.into_iter().map(|card| card.text).collect())
    }

    #[test]
    fn included_files_and_sections_take_the_place_of_their_cards() {
        let files = [
            (
                "net/my.cir",
                "title\nR1 a 0\n+ 1k ; load\n.include \"my parts.inc\"\n.lib models.lib fast\nR2 b 0 1 $ x\n",
            ),
            ("net/my parts.inc", "* parts\nR3 c 0 1\n.inc deep/more.inc\n"),
            ("net/deep/more.inc", "R4 d 0 1\n"),
            ("net/models.lib", ".lib slow\n.model d1 d\n.endl\n.LIB Fast\n.model d2 d\n.endl fast\n"),
        ];
        let expected = ["R1 a 0 1k", "R3 c 0 1", "R4 d 0 1", ".model d2 d", "R2 b 0 1"];
        assert_eq!(texts(&files, false).unwrap(), expected);
    }

    #[test]
    fn files_outside_circles_giants_and_bytes_are_refused_by_line() {
        let large = format!("t\n{}", "R1 a 0 1\n".repeat(200_000));
        for (netlist, expected) in [
            (
                "t\n.include ../other.inc\n",
                "net/my.cir, line 2: .include ../other.inc: is outside the folder of the netlist",
            ),
            ("t\n\n.include my.cir\n", "files include each other more than 16 deep"),
            ("t\n.include none.inc\n", "net/my.cir, line 2: .include none.inc: No such file"),
            ("t\n.lib my.cir none\n", "the file has no such section"),
            ("t\nR1 a\u{0} 0 1\n", "net/my.cir, line 2: control character 0x00: a netlist is text"),
            ("t\n.include .\n", "is no file"),
            (large.as_str(), "net/my.cir: a netlist has at most 1048576 bytes"),
        ] {
            let error = texts(&[("net/my.cir", netlist), ("other.inc", "R9 a 0 1\n")], false).unwrap_err();
            assert!(error.contains(expected), "{expected}: {error}");
        }
        let outside = [("net/my.cir", "t\n.include ../other.inc\n"), ("other.inc", "R9 a 0 1\n")];
        assert_eq!(texts(&outside, true).unwrap(), ["R9 a 0 1"]);
    }
}
