//! Names of entries: each stays inside the folder, and no two name one file, on any operating system.

use std::collections::HashMap;
use std::collections::hash_map::Entry;

/// Longest name, bytes: of a whole path, macOS takes 1024.
const LONGEST: usize = 1000;
/// Deepest path, parts.
const DEEPEST: usize = 32;
/// What Windows takes for a device in every folder, whatever the extension; and COM0 to LPT9.
const DEVICES: [&str; 6] = ["con", "prn", "aux", "nul", "conin$", "conout$"];

/// Paths so far, as file systems see them that do not tell case apart.
#[derive(Debug)]
pub(super) struct Names {
    known: HashMap<String, Known>,
    /// How many files and folders there may be.
    allowed: usize,
}

#[derive(Debug, PartialEq)]
struct Known {
    path: String,
    is_folder: bool,
}

impl Names {
    /// None yet, of at most `allowed` files and folders: a few long names come to very many folders.
    pub fn new(allowed: usize) -> Self {
        Self { known: HashMap::new(), allowed }
    }

    /// Takes the name of a further entry; a folder's ends with a slash.
    pub fn add(&mut self, name: &str) -> Result<(), String> {
        let parts: Vec<_> = name.split('/').filter(|part| !part.is_empty() && *part != ".").collect();
        let too_deep = (parts.len() > DEEPEST).then_some("its name has more than 32 parts");
        if let Some(why) = fault(name).or(too_deep) {
            let shown: String = name.chars().take(100).collect();
            return Err(format!("entry \"{}\" may leave the folder: {why}", shown.escape_debug()));
        }
        for end in 1..=parts.len() {
            let path = parts[..end].join("/");
            let key = path.to_lowercase();
            let found = Known { path, is_folder: end < parts.len() || name.ends_with('/') };
            let is_full = self.known.len() >= self.allowed;
            match self.known.entry(key) {
                Entry::Vacant(_) if is_full => {
                    return Err(format!("the archive has more than {} files and folders", self.allowed));
                }
                Entry::Vacant(place) => {
                    place.insert(found);
                }
                // Many entries share their folders.
                Entry::Occupied(known) if found.is_folder && *known.get() == found => {}
                Entry::Occupied(known) => {
                    let (entry, other) = (name.escape_debug(), known.get().path.escape_debug());
                    return Err(format!("entry \"{entry}\" would take the place of \"{other}\""));
                }
            }
        }
        Ok(())
    }
}

/// Checks the `name` of a file, without folders, for an archive that every system can unpack.
///
/// # Errors
/// Why it is none.
pub fn check_name(name: &str) -> Result<(), &'static str> {
    if name.contains('/') { Err("its name holds a slash") } else { fault(name).map_or(Ok(()), Err) }
}

/// Checks the `names` of all entries of an archive: each stays inside the folder, and no two are one file, on any system.
///
/// # Errors
/// The first that is none, or takes the place of another.
pub fn check_names<'a>(names: impl IntoIterator<Item = &'a str>) -> Result<(), String> {
    let mut known = Names::new(usize::MAX);
    names.into_iter().try_for_each(|name| known.add(name))
}

/// Why a name does not stay inside the folder, or is not a name everywhere.
fn fault(name: &str) -> Option<&'static str> {
    let bytes = name.as_bytes();
    if name.is_empty() || name.contains('\0') {
        Some("its name is empty or holds a zero byte")
    } else if name.len() > LONGEST {
        Some("its name has more than 1000 bytes")
    } else if name.contains('\\') {
        Some("its name holds a backslash; FMI uses forward slashes")
    } else if name.starts_with('/') {
        Some("its name is absolute")
    } else if bytes.get(1) == Some(&b':') && bytes.first().is_some_and(u8::is_ascii_alphabetic) {
        Some("its name begins with a drive letter")
    } else if name.split('/').any(|part| part == "..") {
        Some("its name holds \"..\"")
    } else if name.contains(|c: char| c.is_control() || c == ':') {
        Some("its name holds a control character or a colon")
    } else if name.split('/').any(is_device) {
        Some("its name is that of a device on Windows")
    } else if name.split('/').any(|part| part != "." && part.ends_with(['.', ' '])) {
        Some("its name ends in a dot or blank, which Windows drops")
    } else {
        None
    }
}

fn is_device(part: &str) -> bool {
    let stem = part.split('.').next().unwrap_or_default().trim_end().to_ascii_lowercase();
    // Windows takes superscript digits for digits there.
    let is_port =
        |rest: &str| matches!(rest, "\u{b9}" | "\u{b2}" | "\u{b3}") || matches!(rest.as_bytes(), [b'0'..=b'9']);
    DEVICES.contains(&stem.as_str()) || ["com", "lpt"].iter().any(|port| stem.strip_prefix(port).is_some_and(is_port))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refusal(names: &[&str]) -> Option<String> {
        let mut all = Names::new(100);
        names.iter().find_map(|name| all.add(name).err())
    }

    #[test]
    fn usual_names_are_taken() {
        let names =
            ["a/", "a/b/", "a/b/c.txt", "a/b/d", "e.f/g", "./h", "console.c", "com10", "a.b..c", "\u{e4}\u{301}"];
        assert_eq!(refusal(&names), None);
    }

    #[test]
    fn two_entries_for_one_file_are_refused() {
        for (names, told) in [
            (["a/Read.me", "a/read.ME"], "entry \"a/read.ME\" would take the place of \"a/Read.me\""),
            (["\u{c4}", "\u{e4}"], "would take the place of \"\u{c4}\""),
            (["a", "a/b"], "entry \"a/b\" would take the place of \"a\""),
            (["a/b", "a"], "entry \"a\" would take the place of \"a\""),
            (["a/b", "A/c"], "entry \"A/c\" would take the place of \"a\""),
            (["a/b", "a//b"], "entry \"a//b\" would take the place of \"a/b\""),
            (["b", "./b"], "entry \"./b\" would take the place of \"b\""),
        ] {
            let found = refusal(&names).unwrap_or_default();
            assert!(found.contains(told), "{names:?}: {found}");
        }
    }

    #[test]
    fn deep_names_and_many_folders_are_refused() {
        assert_eq!(refusal(&[&"x/".repeat(32)]), None);
        assert!(refusal(&[&"x/".repeat(33)]).unwrap().ends_with("its name has more than 32 parts"));
        let names: Vec<_> = (0..4).map(|k| format!("{k}/{}", "x/".repeat(29))).collect();
        let names: Vec<_> = names.iter().map(String::as_str).collect();
        assert_eq!(refusal(&names[..3]), None, "90 folders");
        let found = refusal(&names).unwrap_or_default();
        assert_eq!(found, "the archive has more than 100 files and folders");
    }

    #[test]
    fn names_that_are_none_on_some_system_are_refused() {
        let ports = ["Com1", "a/LPT9.log", "COM\u{b9}", "com\u{b2}.txt", "lpt\u{b3}"];
        for name in ["NUL", "a/con.txt", "aux .h", "a.", "a /b", "a:stream", "a\nb", "a\u{7f}"].into_iter().chain(ports)
        {
            assert!(refusal(&[name]).is_some(), "{name:?}");
        }
        assert!(refusal(&[&"x/".repeat(501)]).unwrap().ends_with("its name has more than 1000 bytes"));
    }
}
