//! Runs of a sweep at values that are none of its points.

use fmu_import::Value;

use super::plan::Run;
use super::{Engine, Sweep, SweepError};

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
}
