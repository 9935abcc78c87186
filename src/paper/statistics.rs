//! Statistics of a sample: mean with its confidence interval, median, rank correlation, slope.

use super::ensemble::Ensemble;
pub use crate::statistics::mean;

/// Samples drawn anew for an interval of confidence.
const RESAMPLES: usize = 2000;
/// Seed of those draws.
const SEED: u64 = 1;
/// Standard errors on either side that 95 % of a normal distribution take.
pub const TWO_SIDED: f64 = 1.96;

/// Summary of a sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Summary {
    /// Mean.
    pub mean: f64,
    /// Bootstrap percentile interval of the mean, 95 %: it leans to the side of a heavy tail.
    pub interval: [f64; 2],
    /// Standard error of the mean.
    pub standard_error: f64,
    /// Median.
    pub median: f64,
}

impl Summary {
    /// Sums up `values`; all NaN without any, an interval without width for one.
    pub fn new(values: &[f64]) -> Self {
        let mut random = fastrand::Rng::with_seed(SEED);
        let resample = |_| mean((0..values.len()).map(|_| values[random.usize(..values.len())]));
        let means = Ensemble::new((0..RESAMPLES).map(resample).collect());
        Self {
            mean: mean(values.iter().copied()),
            interval: [means.quantile(0.025), means.quantile(0.975)],
            standard_error: standard_error(values),
            median: Ensemble::new(values.to_vec()).quantile(0.5),
        }
    }
}

/// Spearman's rank correlation of `(x, y)` pairs, -1 to 1: 1 where y always rises with x. NaN if either is constant.
pub fn rank_correlation(points: &[(f64, f64)]) -> f64 {
    let rank = |of: fn(&(f64, f64)) -> f64, value: f64| {
        let count = |is: fn(&f64, &f64) -> bool| points.iter().filter(|point| is(&of(point), &value)).count() as f64;
        count(f64::lt) + f64::midpoint(count(f64::eq), 1.0)
    };
    let ranks: Vec<_> = points.iter().map(|point| (rank(|it| it.0, point.0), rank(|it| it.1, point.1))).collect();
    let [xx, xy, yy] = moments(ranks.iter().copied());
    xy / (xx * yy).sqrt()
}

/// Slope of the straight line through `(x, y)` pairs by least squares, and its standard error from the scatter about
/// the line.
pub fn slope(points: &[(f64, f64)]) -> (f64, f64) {
    let [xx, xy, yy] = moments(points.iter().copied());
    let slope = xy / xx;
    let scatter = (yy - slope * xy).max(0.0) / (points.len() as f64 - 2.0);
    (slope, (scatter / xx).sqrt())
}

/// Sums of squares and products about the means.
fn moments(points: impl Iterator<Item = (f64, f64)> + Clone) -> [f64; 3] {
    let (x, y) = (mean(points.clone().map(|point| point.0)), mean(points.clone().map(|point| point.1)));
    points
        .fold([0.0; 3], |[xx, xy, yy], (a, b)| [xx + (a - x) * (a - x), xy + (a - x) * (b - y), yy + (b - y) * (b - y)])
}

fn standard_error(values: &[f64]) -> f64 {
    let [_, _, square] = moments(values.iter().map(|&value| (0.0, value)));
    let n = values.len() as f64;
    (square / (n * (n - 1.0).max(1.0))).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn the_interval_of_a_mean_has_the_width_of_its_standard_error_and_leans_with_a_tail() {
        let even: Vec<f64> = (0..100).map(f64::from).collect();
        let sum = Summary::new(&even);
        assert_relative_eq!(sum.mean, 49.5);
        assert_relative_eq!(sum.median, 49.5);
        assert_relative_eq!(sum.standard_error, (101.0_f64 / 12.0).sqrt(), max_relative = 1e-12);
        let width = (sum.interval[1] - sum.interval[0]) / (2.0 * TWO_SIDED * sum.standard_error);
        assert!((width - 1.0).abs() < 0.05, "{width}");
        let tail: Vec<f64> = (0..100).map(|k| if k < 95 { 0.0 } else { 100.0 }).collect();
        let sum = Summary::new(&tail);
        assert!(sum.interval[1] - sum.mean > 1.1 * (sum.mean - sum.interval[0]), "{sum:?}");
        assert_eq!(Summary::new(&[3.0]).interval, [3.0, 3.0]);
    }

    #[test]
    fn what_rises_always_has_rank_correlation_1_however_it_rises() {
        let cubes: Vec<_> = (-3..4).map(|k| (f64::from(k), f64::from(k * k * k))).collect();
        assert_relative_eq!(rank_correlation(&cubes), 1.0, max_relative = 1e-12);
        // By hand: ranks 1 2 3 4 against 1 3 2 4, 1 - 6 * 2 / (4 * 15).
        let swapped = [(1.0, 1.0), (2.0, 9.0), (3.0, 5.0), (4.0, 11.0)];
        assert_relative_eq!(rank_correlation(&swapped), 0.8, max_relative = 1e-12);
    }

    /// By hand: y = 2 x + 1 with residuals 1, -1, -1, 1 on x = 0, 1, 2, 3; sum of squares 4, of x 5.
    #[test]
    fn a_slope_comes_with_its_standard_error() {
        let (found, error) = slope(&[(0.0, 2.0), (1.0, 2.0), (2.0, 4.0), (3.0, 8.0)]);
        assert_relative_eq!(found, 2.0, max_relative = 1e-12);
        assert_relative_eq!(error, (2.0_f64 / 5.0).sqrt(), max_relative = 1e-12);
    }
}
