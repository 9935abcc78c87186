//! How points are chosen and how often each is run, as options and sweep files say it.

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

/// Points and samples of a sweep. The comments are the help texts of the options.
#[derive(Debug, Clone, Default, clap::Args, Deserialize)]
pub struct Sampling {
    /// How points are chosen [default: grid]
    #[arg(long, value_enum, value_name = "DESIGN")]
    pub design: Option<Design>,
    /// Number of points of lhs and random; a grid has those of its values
    #[arg(long, value_name = "N")]
    pub points: Option<u64>,
    /// Runs of each point, each with its own noise [default: 1]
    #[arg(long, value_name = "N")]
    pub samples: Option<u64>,
    /// Seed of the design, and of the noise of the first run; each further run takes the next [default: 1]
    #[arg(long, value_name = "N")]
    pub seed: Option<u64>,
    /// Give sample i the same seed in all points (common random numbers)
    #[arg(long)]
    #[serde(default)]
    pub common_seeds: bool,
    /// The variable that takes the seed [default: excitation.seed]
    #[arg(long, value_name = "VARIABLE")]
    pub seed_variable: Option<String>,
}

impl Sampling {
    /// These values, and those of `other` where there are none.
    #[must_use]
    pub fn or(self, other: Self) -> Self {
        Self {
            design: self.design.or(other.design),
            points: self.points.or(other.points),
            samples: self.samples.or(other.samples),
            seed: self.seed.or(other.seed),
            common_seeds: self.common_seeds || other.common_seeds,
            seed_variable: self.seed_variable.or(other.seed_variable),
        }
    }

    pub(super) fn design(&self) -> Design {
        self.design.unwrap_or_default()
    }

    /// Runs of each point.
    pub(super) fn samples(&self) -> u64 {
        self.samples.unwrap_or(1)
    }

    pub(super) fn seed(&self) -> u64 {
        self.seed.unwrap_or(1)
    }
}
