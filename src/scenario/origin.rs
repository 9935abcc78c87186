//! Where what a user asks for was said, so that an error can send him there.

use std::path::PathBuf;

/// Where something was said.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub enum Origin {
    /// Nowhere: it is that of a case of the paper, or of this program.
    #[default]
    Program,
    /// On the command line.
    Option,
    /// In this case or sweep file.
    File(PathBuf),
}

impl Origin {
    /// What is called `option` on the command line, as it is called where it was said: `--seed-variable`, or
    /// `my.toml: seed_variable`. What nobody said can be said by the option.
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

    /// The same of what is said once for each variable: `--set ball.mass`, or `my.toml: set.ball.mass`.
    #[must_use]
    pub fn entry(&self, option: &str, variable: &str) -> String {
        let separator = if matches!(self, Self::File(_)) { '.' } else { ' ' };
        format!("{}{separator}{variable}", self.key(option))
    }
}
