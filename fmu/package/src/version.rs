//! The versions of FMI.

use std::fmt;

/// A version of FMI.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum FmiVersion {
    /// FMI 2.0
    #[default]
    Fmi2,
    /// FMI 3.0
    Fmi3,
}

impl fmt::Display for FmiVersion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if *self == Self::Fmi2 { "FMI 2.0" } else { "FMI 3.0" })
    }
}
