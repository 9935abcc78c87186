//! Means of the samples of a sweep, for people and for programs.

use indexmap::IndexMap;
use serde::Serialize;

use super::format::{Sheet, significant};
use crate::statistics::Mean;
use crate::sweep::{PointStatistics, Summary};

/// Most points that are shown.
const MOST: usize = 10;

/// Of few points, their means.
#[derive(Serialize)]
pub struct Output<'a> {
    confidence: f64,
    points: Vec<Shown<'a>>,
}

#[derive(Serialize)]
struct Shown<'a> {
    point: u64,
    /// By varied variable.
    given: IndexMap<&'a str, Given>,
    succeeded: u64,
    failed: u64,
    /// By quantity.
    means: IndexMap<&'a str, Interval>,
}

/// A value of a varied variable.
#[derive(Serialize)]
#[serde(untagged)]
enum Given {
    Number(f64),
    Text(String),
}

impl Given {
    fn new(text: &str) -> Self {
        text.parse().map_or_else(|_| Self::Text(text.to_owned()), Self::Number)
    }

    /// In few digits.
    fn short(&self) -> String {
        match self {
            Self::Number(number) => significant(*number, 6).parse::<f64>().unwrap_or(*number).to_string(),
            Self::Text(text) => text.clone(),
        }
    }
}

/// Numbers that are not finite are null.
#[derive(Serialize)]
struct Interval {
    mean: f64,
    low: f64,
    high: f64,
}

impl<'a> Output<'a> {
    /// The means of a sweep of few points.
    pub fn of(summary: &'a Summary) -> Option<Self> {
        let is_short = (1..=MOST).contains(&summary.points.len());
        let points = summary.points.iter().map(|point| Shown::new(summary, point));
        is_short.then(|| Self { confidence: summary.confidence, points: points.collect() })
    }

    /// A table for each quantity.
    pub fn text(&self) -> String {
        let Some(first) = self.points.first() else { return String::new() };
        let probability = significant(100.0 * self.confidence, 3);
        let probability = probability.trim_end_matches('0').trim_end_matches('.');
        let table = |name: &&str| {
            let headings = first.given.keys().copied().chain(["samples", "mean", "low", "high"]);
            let rows = self.points.iter().map(|point| point.row(name)).collect();
            format!("{name}: mean and its {probability} % interval\n{}", Sheet::new(headings, &[], rows).text())
        };
        first.means.keys().map(table).collect::<Vec<_>>().join("\n\n")
    }
}

impl<'a> Shown<'a> {
    fn new(summary: &'a Summary, point: &'a PointStatistics) -> Self {
        let names = |names: &'a [String]| names.iter().map(String::as_str);
        let means = point.statistics.iter().map(|it| {
            let Mean { value: mean, interval: [low, high] } = it.mean;
            Interval { mean, low, high }
        });
        Self {
            point: point.number,
            given: names(&summary.varied).zip(point.given.iter().map(|text| Given::new(text))).collect(),
            succeeded: point.succeeded,
            failed: point.failed,
            means: names(&summary.quantities).zip(means).collect(),
        }
    }

    fn row(&self, quantity: &str) -> Vec<String> {
        let given = self.given.values().map(Given::short).chain([self.succeeded.to_string()]);
        let numbers = self.means.get(quantity).map(|it| [it.mean, it.low, it.high]);
        given.chain(numbers.into_iter().flatten().map(|number| significant(number, 6))).collect()
    }
}
