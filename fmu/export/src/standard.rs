//! The versions of FMI.

use core::fmt;

/// A version of FMI. One library serves both: their C functions have names of their own.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Standard {
    /// FMI 2.0 (2.0.4)
    Fmi2,
    /// FMI 3.0 (3.0.2)
    Fmi3,
}

impl fmt::Display for Standard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Fmi2 => "FMI 2.0",
            Self::Fmi3 => "FMI 3.0",
        })
    }
}
