//! How points are chosen.

use std::fmt;

use serde::{Deserialize, Serialize};

/// How points are chosen.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum Design {
    /// Every combination of values, the last variable fastest.
    #[default]
    Grid,
    /// Latin hypercube: each variable has one point in each of as many strata as there are points.
    Lhs,
    /// Independent and uniform.
    Random,
}

impl fmt::Display for Design {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(match self {
            Self::Grid => "grid",
            Self::Lhs => "lhs",
            Self::Random => "random",
        })
    }
}
