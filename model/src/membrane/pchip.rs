//! Monotone cubic interpolation after Fritsch and Butland 1984, with three-point slopes at the ends: that of scipy's
//! `PchipInterpolator`. The interpolant is continuous with its slope, rises where the values rise, and is flat where they are.

/// Values and slopes at the points of an interpolation.
#[derive(Debug, PartialEq)]
pub(super) struct Pchip {
    values: Vec<f64>,
    slopes: Vec<f64>,
}

/// One cubic: value, slope and the two higher coefficients at its begin.
pub(super) struct Cubic(pub [f64; 4]);

impl Cubic {
    /// Value and slope at the distance `s` from the begin.
    pub(super) fn at(&self, s: f64) -> [f64; 2] {
        let [a, b, c, d] = self.0;
        [a + s * (b + s * (c + s * d)), b + s * (2.0 * c + 3.0 * s * d)]
    }

    /// Integral from the begin to the distance `s`.
    pub(super) fn integral(&self, s: f64) -> f64 {
        let [a, b, c, d] = self.0;
        s * (a + s * (b / 2.0 + s * (c / 3.0 + s * d / 4.0)))
    }

    /// The same cubic from the distance `s` on, backwards.
    pub(super) fn backwards(&self, s: f64) -> Self {
        let [a, b, c, d] = self.0;
        Self([a + s * (b + s * (c + s * d)), -(b + s * (2.0 * c + 3.0 * s * d)), c + 3.0 * s * d, -d])
    }
}

impl Pchip {
    /// The interpolation of `values`, which do not fall, at rising places `x`, at least three.
    pub(super) fn new(x: &[f64], values: Vec<f64>) -> Self {
        let last = x.len() - 1;
        let width = |k: usize| x[k + 1] - x[k];
        let secant = |k: usize| (values[k + 1] - values[k]) / width(k);
        let inner = |k: usize| mean([width(k - 1), width(k)], [secant(k - 1), secant(k)]);
        let slopes = (0..=last)
            .map(|k| match k {
                0 => end([width(0), width(1)], [secant(0), secant(1)]),
                k if k == last => end([width(last - 1), width(last - 2)], [secant(last - 1), secant(last - 2)]),
                k => inner(k),
            })
            .collect();
        Self { values, slopes }
    }

    /// The cubic from point `k` to the next, `width` farther; a straight line from the last point on.
    pub(super) fn piece(&self, k: usize, width: f64) -> Cubic {
        let (value, slope) = (self.values[k], self.slopes[k]);
        let (Some(next), Some(end)) = (self.values.get(k + 1), self.slopes.get(k + 1)) else {
            return Cubic([value, slope, 0.0, 0.0]);
        };
        let secant = (next - value) / width;
        let (square, cube) =
            ((3.0 * secant - 2.0 * slope - end) / width, (slope + end - 2.0 * secant) / (width * width));
        Cubic([value, slope, square, cube])
    }
}

/// Slope between two intervals: the weighted harmonic mean of their secants.
fn mean([before, after]: [f64; 2], [left, right]: [f64; 2]) -> f64 {
    if left <= 0.0 || right <= 0.0 {
        return 0.0;
    }
    let (by_left, by_right) = (2.0 * after + before, after + 2.0 * before);
    (by_left + by_right) / (by_left / left + by_right / right)
}

/// Slope at an end, from the two intervals next to it, limited so that the interpolant keeps its direction.
fn end([near, far]: [f64; 2], [first, second]: [f64; 2]) -> f64 {
    let slope = ((2.0 * near + far) * first - near * second) / (near + far);
    if slope <= 0.0 {
        0.0
    } else if second <= 0.0 && slope > 3.0 * first {
        3.0 * first
    } else {
        slope
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn slopes_are_those_of_scipy() {
        // PchipInterpolator([0, 1, 3, 4, 7, 8], [0, 1, 2, 8, 8, 9]).derivative()(x), scipy 1.17.
        let x = [0.0, 1.0, 3.0, 4.0, 7.0, 8.0];
        let pchip = Pchip::new(&x, vec![0.0, 1.0, 2.0, 8.0, 8.0, 9.0]);
        let expected = [1.166_666_666_666_666_7, 0.692_307_692_307_692_3, 1.018_867_924_528_301_9, 0.0, 0.0, 1.25];
        for (slope, expected) in pchip.slopes.iter().zip(expected) {
            assert_relative_eq!(*slope, expected, max_relative = 1e-14);
        }
        for (k, (place, value)) in
            [(0, (0.5, 0.559_294_871_794_871_8)), (2, (3.25, 3.080_778_301_886_792_5)), (4, (7.75, 8.667_968_75))]
        {
            let cubic = pchip.piece(k, x[k + 1] - x[k]);
            assert_relative_eq!(cubic.at(place - x[k])[0], value, max_relative = 1e-14);
            let back = cubic.backwards(x[k + 1] - x[k]);
            assert_relative_eq!(back.at(x[k + 1] - place)[0], value, max_relative = 1e-14);
        }
    }
}
