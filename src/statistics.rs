//! Statistics of samples: their mean with an interval, standard deviation and quantiles. docs/sweep.md has the coverage of the
//! interval.

use std::f64::consts::{FRAC_2_PI, FRAC_PI_2};

/// The shares of the samples that lie below the quantiles.
pub const QUANTILES: [f64; 3] = [0.05, 0.5, 0.95];

/// Probability with which an interval contains the mean, unless the user asks for another.
pub const CONFIDENCE: f64 = 0.95;

/// What samples come to. NaN is what they do not give: all of none, an interval and a deviation of one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Statistics {
    /// Mean and its interval.
    pub mean: Mean,
    /// Standard deviation, with n - 1.
    pub deviation: f64,
    /// The values below which the shares [`QUANTILES`] lie, linear between neighbours.
    pub quantiles: [f64; 3],
}

/// A mean and the ends of its interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mean {
    /// The mean.
    pub value: f64,
    /// Ends of the interval that contains the mean of all possible samples with the asked probability.
    pub interval: [f64; 2],
}

impl Mean {
    /// Half the width of the interval over the mean.
    pub fn precision(&self) -> f64 {
        let [low, high] = self.interval;
        let half = 0.5 * (high - low);
        if half == 0.0 { 0.0 } else { half / self.value.abs() }
    }
}

/// Makes intervals of one probability.
#[derive(Debug, Clone)]
pub struct Intervals {
    probability: f64,
    /// Number of samples and quantile of Student's distribution of the last interval: points mostly have as many samples each.
    last: (usize, f64),
}

impl Intervals {
    /// Intervals that contain the mean with this `probability`, such as 0.95.
    pub fn new(probability: f64) -> Self {
        Self { probability, last: (0, f64::NAN) }
    }

    /// The statistics of `values`.
    pub fn statistics(&mut self, values: &[f64]) -> Statistics {
        let moments = Moments::of(values);
        let mut sorted = values.to_vec();
        sorted.sort_by(f64::total_cmp);
        let is_finite = values.iter().all(|value| value.is_finite());
        let quantiles = QUANTILES.map(|share| if is_finite { quantile(&sorted, share) } else { f64::NAN });
        Statistics { mean: self.interval(values.len(), &moments), deviation: moments.deviation, quantiles }
    }

    /// The mean of `values` and its interval: Student's t, transformed so that it has no skewness to first order (Hall,
    /// J. R. Statist. Soc. B 54 (1992) 221-228). It leans to the side of a heavy tail, and needs no random draws.
    pub fn mean(&mut self, values: &[f64]) -> Mean {
        self.interval(values.len(), &Moments::of(values))
    }

    fn interval(&mut self, samples: usize, &Moments { mean, deviation, skewness }: &Moments) -> Mean {
        let root = (samples as f64).sqrt();
        if self.last.0 != samples {
            self.last = (samples, student(samples, self.probability));
        }
        // The inverse of the transformation, times the root: 3 / g (cbrt(1 + a) - 1) without the division by g.
        let end = |t: f64| {
            let linear = t - skewness / (6.0 * root);
            let c = (1.0 + skewness * linear / root).cbrt();
            mean - 3.0 * linear / (c * c + c + 1.0) * deviation / root
        };
        Mean { value: mean, interval: [end(self.last.1), end(-self.last.1)] }
    }
}

/// Moments of samples.
struct Moments {
    mean: f64,
    deviation: f64,
    /// Without bias for a normal distribution; 0 for fewer than three samples.
    skewness: f64,
}

impl Moments {
    fn of(values: &[f64]) -> Self {
        let n = values.len() as f64;
        let is_constant = values.iter().all(|value| *value == values[0]);
        // Of equal values, rounding would make a deviation.
        let mean = if is_constant { values.first().copied().unwrap_or(f64::NAN) } else { mean(values.iter().copied()) };
        let power = |k: i32| values.iter().map(|value| (value - mean).powi(k)).sum::<f64>();
        let (square, cube) = (power(2), power(3));
        let known = values.len() > 2 && square > 0.0;
        let skewness = if known { cube / square.powf(1.5) * n * (n - 1.0).sqrt() / (n - 2.0) } else { 0.0 };
        Self { mean, deviation: if n > 1.0 { (square / (n - 1.0)).sqrt() } else { f64::NAN }, skewness }
    }
}

/// Arithmetic mean; NaN of nothing.
pub fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0), |(sum, count), value| (sum + value, count + 1.0));
    sum / count
}

/// The value that a `share` from 0 to 1 of all `sorted` ones lies below, linear between neighbours; NaN of nothing.
pub fn quantile(sorted: &[f64], share: f64) -> f64 {
    let last = sorted.len().saturating_sub(1);
    let place = share.clamp(0.0, 1.0) * last as f64;
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // not negative, at most a length
    let below = place as usize;
    let at = |index: usize| sorted.get(index).copied().unwrap_or(f64::NAN);
    at(below) + (place - below as f64) * (at((below + 1).min(last)) - at(below))
}

/// The t within which Student's distribution for `samples` has a `probability`, by bisection of the angle atan(t / sqrt(n)).
fn student(samples: usize, probability: f64) -> f64 {
    /// Halvings until the angle is one of neighbouring numbers.
    const HALVINGS: usize = 60;
    let Some(freedom @ 1..) = samples.checked_sub(1) else { return f64::NAN };
    let (mut low, mut high) = (0.0, FRAC_PI_2);
    for _ in 0..HALVINGS {
        let middle = f64::midpoint(low, high);
        if within(middle, freedom) < probability {
            low = middle;
        } else {
            high = middle;
        }
    }
    (freedom as f64).sqrt() * f64::midpoint(low, high).tan()
}

/// The probability that atan(t / sqrt(freedom)) lies between -`angle` and `angle` (Abramowitz and Stegun 26.7.3 and 26.7.4).
fn within(angle: f64, freedom: usize) -> f64 {
    let (sine, cosine) = angle.sin_cos();
    let is_odd = freedom % 2 == 1;
    let (mut term, mut sum) = if is_odd { (cosine, 0.0) } else { (1.0, 0.0) };
    let mut power = usize::from(is_odd);
    while power + 2 <= freedom && term > 0.0 {
        sum += term;
        power += 2;
        term *= cosine * cosine * (power - 1) as f64 / power as f64;
    }
    if is_odd { FRAC_2_PI * (angle + sine * sum) } else { sine * sum }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;

    #[test]
    fn quantiles_of_students_distribution_are_those_of_tables() {
        // scipy.stats.t.ppf((1 + p) / 2, n - 1) of SciPy 1.17.1.
        for (samples, probability, expected) in [
            (2, 0.95, 12.706_204_736_174_694),
            (3, 0.95, 4.302_652_729_749_462),
            (4, 0.99, 5.840_909_309_733_355),
            (10, 0.95, 2.262_157_162_798_205),
            (11, 0.5, 0.699_812_061_312_431_7),
            (50, 0.95, 2.009_575_237_129_239_2),
            (10_000, 0.95, 1.960_201_263_621_357),
        ] {
            assert_relative_eq!(student(samples, probability), expected, max_relative = 1e-10);
        }
    }

    #[test]
    fn few_or_equal_samples_have_what_they_can_have() {
        let mut intervals = Intervals::new(0.95);
        let none = intervals.statistics(&[]);
        assert!([none.mean.value, none.deviation, none.quantiles[1]].iter().all(|value| value.is_nan()));
        let one = intervals.statistics(&[3.0]);
        assert_eq!((one.mean.value, one.quantiles), (3.0, [3.0; 3]));
        assert!(one.mean.interval[0].is_nan() && one.deviation.is_nan());
        let equal = intervals.statistics(&[0.1; 3]);
        assert_eq!((equal.mean, equal.deviation), (Mean { value: 0.1, interval: [0.1; 2] }, 0.0));
        assert_eq!((equal.mean.precision(), intervals.mean(&[0.0; 4]).precision()), (0.0, 0.0));
        let wrong = intervals.statistics(&[1.0, f64::NAN, 3.0]);
        assert!(wrong.mean.value.is_nan() && wrong.deviation.is_nan() && wrong.quantiles[0].is_nan());
    }

    /// Two samples have no skewness: Student's interval, whose t is tan(0.95 pi / 2).
    #[test]
    fn without_skewness_the_interval_is_that_of_student() {
        let pair = Intervals::new(0.95).mean(&[1.0, 3.0]);
        let half = (0.95 * FRAC_PI_2).tan();
        assert_relative_eq!(pair.interval[..], [2.0 - half, 2.0 + half][..], max_relative = 1e-9);
        assert_relative_eq!(pair.precision(), half / 2.0, max_relative = 1e-9);
        let even = Intervals::new(0.9).statistics(&[4.0, 1.0, 2.0, 3.0, 5.0]);
        assert_eq!((even.mean.value, even.quantiles[1]), (3.0, 3.0));
        assert_relative_eq!(even.quantiles[0], 1.2, max_relative = 1e-12);
        assert_relative_eq!(even.deviation, 2.5_f64.sqrt(), max_relative = 1e-12);
        assert_relative_eq!(even.mean.interval[1] - 3.0, 3.0 - even.mean.interval[0], max_relative = 1e-12);
    }

    #[test]
    fn the_interval_leans_to_a_heavy_tail_and_contains_the_mean_of_its_samples() {
        let mut tail = [0.0; 20];
        tail[7] = 1.0;
        for probability in [0.5, 0.8, 0.95, 0.999] {
            let Mean { value, interval: [low, high] } = Intervals::new(probability).mean(&tail);
            assert!(low <= value && value <= high && high - value > 1.2 * (value - low), "{low} {high}");
        }
    }
}
