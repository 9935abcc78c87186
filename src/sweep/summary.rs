//! Statistics of a sweep that stay in memory: those of the main quantities of not too many points.

use super::by_point::Samples;
use super::document::Kept;
use crate::statistics::Statistics;

/// Statistics of a sweep with several samples.
#[derive(Debug, Clone, PartialEq)]
pub struct Summary {
    /// Probability with which an interval contains the mean.
    pub confidence: f64,
    /// Varied variables.
    pub varied: Vec<String>,
    /// Main quantities.
    pub quantities: Vec<String>,
    /// Points whose samples did not become as precise as asked.
    pub unreached: u64,
    /// The points, or none if there are more than a figure shows.
    pub points: Vec<Point>,
    /// Main quantities of the samples of a sweep of one point.
    pub(super) only: Option<Vec<Vec<f64>>>,
}

/// A point and its statistics.
#[derive(Debug, Clone, PartialEq)]
pub struct Point {
    /// Its number.
    pub number: u64,
    /// Values of the varied variables.
    pub given: Vec<String>,
    /// Runs that succeeded.
    pub succeeded: u64,
    /// Runs that failed.
    pub failed: u64,
    /// Of the main quantities.
    pub statistics: Vec<Statistics>,
}

impl Summary {
    pub(super) fn new(kept: &Kept, quantities: &[&str]) -> Self {
        Self {
            confidence: kept.confidence,
            varied: kept.vary.iter().map(|varied| varied.name.clone()).collect(),
            quantities: quantities.iter().map(|&name| name.to_owned()).collect(),
            unreached: 0,
            points: Vec::new(),
            only: None,
        }
    }

    pub(super) fn add(&mut self, samples: Samples, statistics: &[Statistics], main: &[usize], is_only: bool) {
        let Samples { point: number, given, succeeded, failed, mut values } = samples;
        let statistics = main.iter().map(|&index| statistics[index]).collect();
        self.points.push(Point { number, given, succeeded, failed, statistics });
        self.only = is_only.then(|| main.iter().map(|&index| std::mem::take(&mut values[index])).collect());
    }
}
