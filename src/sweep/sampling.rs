//! How points are chosen and how often each is run, as options and sweep files say it.

use std::fmt;

use serde::{Deserialize, Serialize};

use super::column::Column;
use super::{SweepError, order};
use crate::statistics::CONFIDENCE;

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
    /// Runs of each point, each with its own noise; with --until-precision at most [default: 1, or 10000]
    #[arg(long, value_name = "N")]
    pub samples: Option<u64>,
    /// Probability with which the interval of a mean in statistics.csv contains the mean of all possible samples [default: 0.95]
    #[arg(long, value_name = "P")]
    pub confidence: Option<f64>,
    /// Run each point until half the interval of a mean is at most this part of the mean, e.g. 0.02
    #[arg(long, value_name = "P")]
    pub until_precision: Option<f64>,
    /// The column whose mean that is [default: `net_power` if it is recorded, else `average_voltage_gain`]
    #[arg(long, value_name = "COLUMN")]
    pub precision_of: Option<String>,
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
            confidence: self.confidence.or(other.confidence),
            until_precision: self.until_precision.or(other.until_precision),
            precision_of: self.precision_of.or(other.precision_of),
            seed: self.seed.or(other.seed),
            common_seeds: self.common_seeds || other.common_seeds,
            seed_variable: self.seed_variable.or(other.seed_variable),
        }
    }

    pub(super) fn design(&self) -> Design {
        self.design.unwrap_or_default()
    }

    /// Runs of each point, at most.
    pub(super) fn samples(&self) -> u64 {
        self.samples.unwrap_or(if self.until_precision.is_some() { order::MOST } else { 1 })
    }

    /// Which of `columns` has the mean that decides how many samples a point gets, if one does.
    pub(super) fn precision_of<'a>(&self, columns: &'a [Column]) -> Result<Option<&'a str>, SweepError> {
        const BOUNDS: std::ops::RangeInclusive<f64> = 1e-6..=1.0;
        let asked = self.precision_of.as_deref();
        let Some(precision) = self.until_precision else {
            let refuse = |of| SweepError::option("precision-of", of, "it says of which mean; give --until-precision");
            return asked.map_or(Ok(None), |of| Err(refuse(of)));
        };
        if !BOUNDS.contains(&precision) {
            return Err(SweepError::option("until-precision", precision.to_string(), "must lie from 1e-6 to 1"));
        }
        if self.samples() < order::FIRST {
            let reason =
                format!("with --until-precision it is at least {}, as many as the first decision takes", order::FIRST);
            return Err(SweepError::option("samples", self.samples().to_string(), reason));
        }
        let names = asked.map_or(vec!["net_power", "average_voltage_gain"], |of| vec![of]);
        let quantities =
            || columns.iter().filter(|column| order::is_quantity(column)).map(|column| column.name.as_str());
        let found = names.iter().find_map(|of| quantities().find(|name| name == of));
        found.map(Some).ok_or_else(|| {
            let reason =
                format!("no such column of numbers; there are: {}", quantities().collect::<Vec<_>>().join(", "));
            SweepError::option("precision-of", asked.unwrap_or_default(), reason)
        })
    }

    /// Probability of the intervals, if it is not the usual one.
    pub(super) fn confidence(&self) -> Result<Option<f64>, SweepError> {
        const BOUNDS: std::ops::RangeInclusive<f64> = 0.5..=0.999;
        let Some(confidence) = self.confidence else { return Ok(None) };
        let refuse = |reason: &str| Err(SweepError::option("confidence", confidence.to_string(), reason));
        if !BOUNDS.contains(&confidence) {
            return refuse("must lie from 0.5 to 0.999");
        }
        if self.samples() < 2 {
            return refuse("a point has one sample, so its mean has no interval; give --samples");
        }
        Ok(Some(confidence).filter(|confidence| *confidence != CONFIDENCE))
    }

    pub(super) fn seed(&self) -> u64 {
        self.seed.unwrap_or(1)
    }
}
