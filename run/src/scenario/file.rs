//! Case files (TOML).
//!
//! ```toml
//! case = "fig14"                 # start from a published case
//! name = "softer"                # optional: name of the run
//! description = "softer membrane"
//! until = 60.0
//! step = 1e-3
//! window = [30.0, 60.0]
//!
//! [set]                          # FMU variables, dotted as they are
//! membrane.stiffness = 2e5
//! contact.law = "impulsive"
//! load.resistance = inf
//! ```

use std::io::Read as _;
use std::path::{Path, PathBuf};

use serde::Deserialize;
use toml::{Table, Value};

use super::{Origin, ScenarioError, Setting, characters};

/// Content of a case file.
#[derive(Debug, Clone, Default)]
pub struct CaseFile {
    /// Where it was read from, if it was.
    pub path: Option<PathBuf>,
    /// Published case to start from.
    pub case: Option<String>,
    /// Name of the run.
    pub name: Option<String>,
    /// Description in one line.
    pub description: Option<String>,
    /// End of the run, s.
    pub until: Option<f64>,
    /// Communication step, s.
    pub step: Option<f64>,
    /// Averaging window, s.
    pub window: Option<[f64; 2]>,
    /// Variables to set.
    pub settings: Vec<Setting>,
}

/// Layout of the file; any other key is an error.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Layout {
    case: Option<String>,
    name: Option<String>,
    description: Option<String>,
    until: Option<f64>,
    step: Option<f64>,
    window: Option<[f64; 2]>,
    #[serde(default)]
    set: Table,
}

/// The text of the file at `path` as `parse` reads it, and the name of that file without its ending.
///
/// # Errors
/// An unreadable file; an error of `parse`.
pub fn read_file<T>(
    path: &Path,
    parse: impl FnOnce(&str) -> Result<T, String>,
) -> Result<(T, Option<String>), ScenarioError> {
    let shown = path.display().to_string();
    let text = read_text(path)?;
    let content = parse(&text).map_err(|reason| ScenarioError::BadFile { path: shown, reason })?;
    let stem = path.file_stem().map(|stem| characters::replaced(&stem.to_string_lossy()));
    Ok((content, stem))
}

impl CaseFile {
    /// Reads the file at `path`. The run has the name of the file unless it gives another.
    ///
    /// # Errors
    /// An unreadable file; no TOML; an unknown key; a value that no variable can have.
    pub fn read(path: &Path) -> Result<Self, ScenarioError> {
        let (mut file, stem) = read_file(path, Self::parse)?;
        file.name = file.name.or(stem);
        Ok(file.at(path))
    }

    /// Reads the text of a case file.
    ///
    /// # Errors
    /// No TOML, an unknown key, a value that no variable can have, a control character; with its place.
    pub fn parse(text: &str) -> Result<Self, String> {
        let said = |error: toml::de::Error| toml_error(&error);
        let text = &characters::with_plain_ends(text);
        let layout = toml::from_str(text).map_err(said)?;
        characters::check(&toml::from_str(text).map_err(said)?)?;
        Self::of(layout)
    }

    /// Reads a table with the layout of a case file.
    ///
    /// # Errors
    /// An unknown key; a value that no variable can have.
    pub fn from_table(table: Table) -> Result<Self, String> {
        Self::of(table.try_into().map_err(|error| toml_error(&error))?)
    }

    /// The same, read from the file at `path`.
    #[must_use]
    pub fn at(mut self, path: &Path) -> Self {
        self.settings.iter_mut().for_each(|setting| setting.origin = Origin::File(path.to_owned()));
        self.path = Some(path.to_owned());
        self
    }

    /// Where a key was given: in the file, unless an option gives it.
    #[must_use]
    pub fn origin(&self, is_option: bool) -> Origin {
        self.path.clone().filter(|_| !is_option).map_or(Origin::Option, Origin::File)
    }

    fn of(layout: Layout) -> Result<Self, String> {
        let set = dotted("", &layout.set, |_| false).into_iter();
        let settings = set.map(|(name, value)| Ok(Setting::new(&*name, value_text(&name, value)?)));
        let settings = settings.collect::<Result<_, String>>()?;
        let Layout { case, name, description, until, step, window, .. } = layout;
        Ok(Self { path: None, case, name, description, until, step, window, settings })
    }
}

/// The text of a case or sweep file.
///
/// # Errors
/// An unreadable file, or one of more than 16 MiB, which no such file has.
fn read_text(path: &Path) -> Result<String, ScenarioError> {
    const LARGEST: u64 = 16 << 20;
    let shown = path.display().to_string();
    let mut text = String::new();
    let read = videg_input::open_once(path).and_then(|file| file.take(LARGEST + 1).read_to_string(&mut text));
    match read {
        Err(cause) => Err(ScenarioError::Unreadable { path: shown, cause }),
        Ok(_) if text.len() as u64 > LARGEST => {
            Err(ScenarioError::BadFile { path: shown, reason: format!("more than {LARGEST} bytes") })
        }
        Ok(_) => Ok(text),
    }
}

/// The message of the TOML reader in one line: with the line of the file, without the pointer below it.
pub fn toml_error(error: &toml::de::Error) -> String {
    const SHOWN: usize = 80;
    let shown = |line: &str| {
        let drawn = line.trim_start_matches(|c: char| c.is_ascii_digit() || c == ' ').strip_prefix('|');
        let text = drawn.unwrap_or(line).trim();
        let is_pointer = text.chars().all(|c| c == '^' || c == ' ');
        (!is_pointer).then(|| text.chars().take(if drawn.is_some() { SHOWN } else { usize::MAX }).collect::<String>())
    };
    error.to_string().lines().filter_map(shown).collect::<Vec<_>>().join(": ")
}

/// The values in nested tables, by dotted names; tables that are values are known by `is_value`.
pub fn dotted<'a>(prefix: &str, table: &'a Table, is_value: fn(&Table) -> bool) -> Vec<(String, &'a Value)> {
    let entries = table.iter().flat_map(|(key, value)| {
        let name = if prefix.is_empty() { key.clone() } else { format!("{prefix}.{key}") };
        match value {
            Value::Table(inner) if !is_value(inner) => dotted(&name, inner, is_value),
            _ => vec![(name, value)],
        }
    });
    entries.collect()
}

/// A value of the variable called `name`, as a user types it on the command line.
///
/// # Errors
/// If no variable can have it.
pub fn value_text(name: &str, value: &Value) -> Result<String, String> {
    match value {
        Value::String(text) => Ok(text.clone()),
        Value::Integer(number) => Ok(number.to_string()),
        Value::Float(number) => Ok(format!("{number:?}")),
        Value::Boolean(flag) => Ok(flag.to_string()),
        other => {
            let kind = other.type_str();
            Err(format!("{name} is of type {kind}: a variable takes a number, a boolean or a string"))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dotted_and_quoted_names_and_all_types_are_read() {
        let file = CaseFile::parse(
            "case = 'fig15'\nuntil = 60\nwindow = [30.0, 60.0]\n[set]\nmembrane.restitution = 0.25\n\
             'excitation.seed' = 7\ncontact.law = 'impulsive'\ncontact.electrostaticFeedback = false\nload.resistance = inf\n",
        )
        .unwrap();
        assert_eq!((file.case.as_deref(), file.until, file.window), (Some("fig15"), Some(60.0), Some([30.0, 60.0])));
        let mut set: Vec<_> = file.settings.iter().map(|s| format!("{}={}", s.name, s.value)).collect();
        set.sort();
        assert_eq!(
            set,
            [
                "contact.electrostaticFeedback=false",
                "contact.law=impulsive",
                "excitation.seed=7",
                "load.resistance=inf",
                "membrane.restitution=0.25",
            ]
        );
    }

    #[test]
    fn what_a_case_file_cannot_say_is_an_error_that_names_it() {
        for (text, named) in [
            ("untill = 3", "untill"),
            ("until = 'long'", "until"),
            ("window = [1.0]", "window"),
            ("[set]\nball.mass = [1, 2]", "ball.mass"),
            ("[set]\nball.mass = 2026-01-01", "ball.mass"),
            ("case = ", "line 1"),
            ("name = \"a\\u001b[2J\"", "name: the character U+001B"),
        ] {
            let reason = CaseFile::parse(text).unwrap_err();
            assert!(reason.contains(named) && reason.lines().count() == 1, "{text}: {reason}");
        }
    }
}
