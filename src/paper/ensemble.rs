//! Many starts beside one: how they are nudged, and how they are spread.

use super::excitation::set;
use super::{PaperError, Run, Study};
use crate::scenario::Setting;
use crate::statistics;

/// Largest nudge of the ball's velocity at the start, m/s: a millionth of its usual speed.
pub(super) const NUDGE: f64 = 1e-7;

/// Seed of the nudges.
const SEED: u64 = 2026;

/// Nudges of `count` starts, m/s: uniform between -`largest` and `largest`, the same in every run.
pub(super) fn nudges(count: usize, largest: f64) -> Vec<f64> {
    let mut random = fastrand::Rng::with_seed(SEED);
    (0..count).map(|_| largest * (2.0 * random.f64() - 1.0)).collect()
}

/// `settings` with the ball's velocity at the start nudged by each of `nudges`, m/s. The velocity: a ball that is
/// nudged out of the gap would be put back.
pub(super) fn nearby(study: &Study<'_>, settings: &[Setting], nudges: &[f64]) -> Result<Vec<Vec<Setting>>, PaperError> {
    const NUDGED: &str = "initial.ballVelocity";
    let [velocity] = study.reals(&study.start(settings)?, [NUDGED])?;
    let nudged = |nudge: &f64| settings.iter().cloned().chain([set(NUDGED, velocity + nudge)]).collect();
    Ok(nudges.iter().map(nudged).collect())
}

/// `<U>`, V/s, of each run over `window`, s, through the FMU.
pub(super) fn voltage_gains(
    study: &Study<'_>,
    starts: Vec<Vec<Setting>>,
    window: [f64; 2],
) -> Result<Vec<f64>, PaperError> {
    let runs: Vec<_> = starts.into_iter().map(|settings| Run { settings, window }).collect();
    Ok(study.averages(&runs)?.iter().map(|average| average.voltage_gain).collect())
}

/// Values by ascending order; at least one.
#[derive(Debug, Clone)]
pub(super) struct Ensemble {
    sorted: Vec<f64>,
}

impl Ensemble {
    pub(super) fn new(mut values: Vec<f64>) -> Self {
        values.sort_by(f64::total_cmp);
        Self { sorted: values }
    }

    pub(super) fn len(&self) -> usize {
        self.sorted.len()
    }

    /// By ascending order.
    pub(super) fn values(&self) -> &[f64] {
        &self.sorted
    }

    pub(super) fn mean(&self) -> f64 {
        self.sorted.iter().sum::<f64>() / self.sorted.len() as f64
    }

    /// The value that a `share` from 0 to 1 of all lies below, linear between neighbours; NaN of nothing.
    pub(super) fn quantile(&self, share: f64) -> f64 {
        statistics::quantile(&self.sorted, share)
    }

    /// Smallest and largest value.
    pub(super) fn range(&self) -> [f64; 2] {
        [self.quantile(0.0), self.quantile(1.0)]
    }

    pub(super) fn contains(&self, value: f64) -> bool {
        let [low, high] = self.range();
        (low..=high).contains(&value)
    }

    /// How many values lie below `value`.
    pub(super) fn below(&self, value: f64) -> usize {
        self.sorted.partition_point(|other| *other < value)
    }

    /// The distribution function: each value and the share of values up to it.
    pub(super) fn distribution(&self) -> Vec<(f64, f64)> {
        let count = self.sorted.len() as f64;
        self.sorted.iter().enumerate().map(|(index, value)| (*value, (index + 1) as f64 / count)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_lie_between_the_neighbours_that_they_fall_between() {
        let ensemble = Ensemble::new(vec![4.0, 1.0, 2.0, 3.0, 5.0]);
        assert_eq!([0.0, 0.5, 0.625, 1.0].map(|share| ensemble.quantile(share)), [1.0, 3.0, 3.5, 5.0]);
        assert_eq!((ensemble.mean(), ensemble.range()), (3.0, [1.0, 5.0]));
        assert_eq!((ensemble.below(3.0), ensemble.below(9.0)), (2, 5));
        assert!(ensemble.contains(1.0) && !ensemble.contains(0.9));
        assert_eq!(ensemble.distribution()[1], (2.0, 0.4));
    }

    #[test]
    fn nudges_are_small_of_both_signs_and_always_the_same() {
        let all = nudges(200, NUDGE);
        assert!(all.iter().all(|nudge| nudge.abs() <= NUDGE));
        assert!(all.iter().any(|nudge| *nudge > 0.5 * NUDGE) && all.iter().any(|nudge| *nudge < -0.5 * NUDGE));
        assert_eq!(all[..40], nudges(40, NUDGE)[..]);
    }
}
