//! Where a user gave a value, so that an error can name the place.

use std::path::PathBuf;

/// Where a value was given.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub enum Origin {
    /// In a published case, or in this program.
    #[default]
    Program,
    /// On the command line.
    Option,
    /// In this case or sweep file.
    File(PathBuf),
}

impl Origin {
    /// Name of the value where it was given; `option` is its name on the command line: `--seed-variable`, or
    /// `my.toml: seed_variable`. A value that nobody gave has the name of its option.
    #[must_use]
    pub fn key(&self, option: &str) -> String {
        match self {
            Self::Program | Self::Option => format!("--{option}"),
            Self::File(path) => format!("{}: {}", path.display(), option.replace('-', "_")),
        }
    }

    /// The same with its `value`: `--points 0`, or `my.toml: points = 0`.
    #[must_use]
    pub fn value(&self, option: &str, value: &str) -> String {
        let separator = if matches!(self, Self::File(_)) { " = " } else { " " };
        format!("{}{separator}{value}", self.key(option))
    }

    /// The same for an entry of a variable: `--set ball.mass`, or `my.toml: set.ball.mass`.
    #[must_use]
    pub fn entry(&self, option: &str, variable: &str) -> String {
        let separator = if matches!(self, Self::File(_)) { '.' } else { ' ' };
        format!("{}{separator}{variable}", self.key(option))
    }
}
