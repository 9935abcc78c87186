//! Runs of a sweep at values that are none of its points.

use fmu_import::Value;

use super::plan::{Results, Run};
use super::{Engine, Sweep, SweepError};
use crate::cosim::Averages;
use crate::progress::Progress;
use crate::threads::{self, Sharing};

/// Most results that wait for an earlier one.
const AHEAD: u64 = 4096;

/// The numbers that a run gives, in the order of [`Sweep::numbers`], or why it failed.
pub type Numbers = Result<Vec<f64>, String>;

impl Sweep {
    /// Sample number `sample` at these `values` of the varied variables, all of them Real.
    pub(super) fn run_at(&self, values: &[f64], sample: u64) -> Run {
        let seed = self.seeds.as_ref().map(|seeds| Value::Integer(seeds.of(0, sample)));
        Run { number: 0, point: 0, sample, values: values.iter().copied().map(Value::Real).collect(), seed }
    }

    /// The line of results of sample number `sample` at these `values` of the varied variables, all of them Real; with
    /// common seeds it is the line of a point there, but for the numbers of run and point.
    ///
    /// # Errors
    /// An FMU that is beyond use.
    pub fn line_at(&self, engine: &Engine, values: &[f64], sample: u64) -> Result<Vec<u8>, SweepError> {
        let run = self.run_at(values, sample);
        engine.run(self, &run).map(|outcome| self.line(&run, &outcome))
    }

    /// Names of the numbers that a run gives: averages, if there are any, and what is recorded.
    pub fn numbers(&self) -> Vec<&str> {
        let averages = if self.averages { &["average_voltage_gain", "average_power_eq13", "impacts"][..] } else { &[] };
        averages.iter().copied().chain(self.record.iter().map(|variable| variable.name.as_str())).collect()
    }

    /// All samples at each of `points`, values of the varied variables, all of them Real: the samples of the first point, then those of
    /// the next. Sample i has the same seed at all points. If the observer stops the work, results are missing at the end.
    ///
    /// # Errors
    /// An FMU that is beyond use.
    pub fn evaluate(
        &self,
        engine: &Engine,
        points: &[Vec<f64>],
        jobs: usize,
        observer: &dyn Progress,
    ) -> Result<Vec<Numbers>, SweepError> {
        let samples = self.samples();
        let runs = points.len() as u64 * samples;
        let at = |number: u64| {
            #[allow(clippy::cast_possible_truncation)] // below the number of points
            let values = &points[(number / samples) as usize];
            engine.run(self, &self.run_at(values, number % samples)).map(|outcome| outcome.map(|it| numbers(&it)))
        };
        let is_stopped = || observer.is_stopped();
        let sharing = Sharing { threads: engine.at_once(jobs), ahead: AHEAD, is_stopped: &is_stopped };
        let mut found = Vec::new();
        threads::in_order(0..runs, sharing, at, |results| {
            found.extend(results);
            observer.advance(found.len() as u64, runs, &[]);
            Ok::<_, SweepError>(())
        })?;
        Ok(found)
    }
}

fn numbers(results: &Results) -> Vec<f64> {
    let averages =
        results.averages.map(|Averages { voltage_gain, power, impacts }| [voltage_gain, power, impacts.into()]);
    let recorded = results.recorded.iter().map(|value| match value {
        Value::Real(value) => *value,
        Value::Integer(value) | Value::Enumeration { value, .. } => f64::from(*value),
        Value::Boolean(on) => f64::from(u8::from(*on)),
        Value::String(_) => f64::NAN,
    });
    averages.into_iter().flatten().chain(recorded).collect()
}
