//! Chebyshev series: smooth functions on an interval, known from their values at the extrema of a Chebyshev polynomial.
//!
//! Collocation at these points needs no tables: nodes, integrals and zeros follow from formulas (Clenshaw and Curtis
//! 1960).

use core::f64::consts::PI;
use std::sync::LazyLock;

use super::roots::bracketed_root;

/// Degree of the series that is fitted to values.
pub const DEGREE: usize = 12;

/// Number of nodes.
pub const NODES: usize = DEGREE + 1;

/// Terms of a series: room for two integrations.
const TERMS: usize = NODES + 2;

/// One value for each node, the end of the interval first.
pub type Values = [f64; NODES];

/// Nodes and what follows from them. Intervals are [-1, 1].
pub struct Grid {
    pub nodes: Values,
    /// cos(j k pi / DEGREE).
    cosines: [Values; NODES],
    /// Values at the nodes of the integral from -1, one row a node, against the values of the function.
    pub integral: [Values; NODES],
    /// The same of the double integral.
    pub double_integral: [Values; NODES],
    /// What a series is on [-1, 0] and on [0, 1].
    halves: [Half; 2],
}

pub static GRID: LazyLock<Grid> = LazyLock::new(Grid::new);

impl Grid {
    fn new() -> Self {
        let cosines = core::array::from_fn(|j| {
            core::array::from_fn(|k| (((j * k) % (2 * DEGREE)) as f64 * PI / DEGREE as f64).cos())
        });
        let nodes = core::array::from_fn(|j| (j as f64 * PI / DEGREE as f64).cos());
        let (integral, double_integral) = ([[0.0; NODES]; NODES], [[0.0; NODES]; NODES]);
        let mut grid = Self { nodes, cosines, integral, double_integral, halves: [half(-1.0), half(1.0)] };
        for k in 0..NODES {
            let unit = core::array::from_fn(|j| if j == k { 1.0 } else { 0.0 });
            let integral = grid.fit(&unit).integral(1.0, 0.0);
            let double = integral.integral(1.0, 0.0);
            for (j, node) in nodes.into_iter().enumerate() {
                grid.integral[j][k] = integral.value(node);
                grid.double_integral[j][k] = double.value(node);
            }
        }
        grid
    }

    /// The matrix that turns the values at the nodes of y + `rate` times the integral of y from -1 into those of y.
    pub fn relaxing(&self, rate: f64) -> [Values; NODES] {
        let mut rows = self.integral.map(|row| row.map(|weight| rate * weight));
        let mut inverse = [[0.0; NODES]; NODES];
        for j in 0..NODES {
            rows[j][j] += 1.0;
            inverse[j][j] = 1.0;
        }
        // Gauss and Jordan, with the largest pivot of the column.
        for k in 0..NODES {
            let largest = (k..NODES).max_by(|a, b| rows[*a][k].abs().total_cmp(&rows[*b][k].abs())).unwrap_or(k);
            rows.swap(k, largest);
            inverse.swap(k, largest);
            let pivot = 1.0 / rows[k][k];
            for row in [&mut rows[k], &mut inverse[k]] {
                for value in row {
                    *value *= pivot;
                }
            }
            let (of_rows, of_inverse) = (rows[k], inverse[k]);
            for j in (0..NODES).filter(|j| *j != k) {
                let factor = rows[j][k];
                for m in 0..NODES {
                    rows[j][m] -= factor * of_rows[m];
                    inverse[j][m] -= factor * of_inverse[m];
                }
            }
        }
        inverse
    }

    /// The series that has these values at the nodes.
    pub fn fit(&self, values: &Values) -> Series {
        let mut series = Series::default();
        for (k, cosines) in self.cosines.iter().enumerate() {
            let ends = 0.5 * (values[0] * cosines[0] + values[DEGREE] * cosines[DEGREE]);
            let sum = (1..DEGREE).fold(ends, |sum, j| sum + values[j] * cosines[j]);
            series.coefficients[k] = sum * if k == 0 || k == DEGREE { 1.0 } else { 2.0 } / DEGREE as f64;
        }
        series
    }
}

/// A function on [-1, 1] as a sum of Chebyshev polynomials.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Series {
    coefficients: [f64; TERMS],
}

impl Series {
    #[must_use]
    pub fn plus(mut self, value: f64) -> Self {
        self.coefficients[0] += value;
        self
    }

    #[must_use]
    pub fn minus(mut self, other: &Self) -> Self {
        self.coefficients.iter_mut().zip(&other.coefficients).for_each(|(c, other)| *c -= other);
        self
    }

    #[must_use]
    pub fn times(mut self, factor: f64) -> Self {
        self.coefficients.iter_mut().for_each(|c| *c *= factor);
        self
    }

    /// Value at `x` (Clenshaw's recurrence).
    pub fn value(&self, x: f64) -> f64 {
        let [first, rest @ ..] = &self.coefficients;
        let (mut b1, mut b2) = (0.0, 0.0);
        for c in rest.iter().rev() {
            (b1, b2) = (c + 2.0 * x * b1 - b2, b1);
        }
        first + x * b1 - b2
    }

    /// The integral that has the value `start` at -1, for an interval of length 2 `half_length`.
    pub fn integral(&self, half_length: f64, start: f64) -> Self {
        let c = |k: usize| self.coefficients.get(k).copied().unwrap_or(0.0);
        let mut integral = Self::default();
        for k in 1..TERMS {
            let below = if k == 1 { 2.0 * c(0) } else { c(k - 1) };
            integral.coefficients[k] = half_length * (below - c(k + 1)) / (2.0 * k as f64);
        }
        let offset = integral.value(-1.0);
        integral.plus(start - offset)
    }

    fn derivative(&self) -> Self {
        let mut derivative = Self::default();
        for k in (0..TERMS - 1).rev() {
            let above = if k + 2 < TERMS { derivative.coefficients[k + 2] } else { 0.0 };
            derivative.coefficients[k] = above + 2.0 * (k + 1) as f64 * self.coefficients[k + 1];
        }
        derivative.coefficients[0] *= 0.5;
        derivative
    }

    /// Bound of the absolute value.
    pub fn bound(&self) -> f64 {
        self.coefficients.iter().map(|c| c.abs()).sum()
    }

    /// The last two coefficients of a fit: what more terms would add is smaller.
    pub fn tail(&self) -> f64 {
        self.coefficients[DEGREE].abs() + self.coefficients[DEGREE - 1].abs()
    }

    /// The function on one half of the interval, as a function on [-1, 1].
    fn on(&self, half: &Half) -> Self {
        let mut part = Self::default();
        for (c, row) in self.coefficients.iter().zip(half) {
            part.coefficients.iter_mut().zip(row).for_each(|(sum, weight)| *sum += c * weight);
        }
        part
    }

    /// Where the function first falls below zero; falls by rounding, of numbers of the size `scale`, do not count.
    ///
    /// Intervals are halved until bounds of the derivatives show that the function has no zero there or is monotone, so
    /// that no zero is missed. The bounds are those of the part looked at: a function that starts as x^k has only one
    /// part in doubt on each level.
    pub fn first_fall(&self, scale: f64) -> Option<f64> {
        const NARROWEST: f64 = 1e-9;
        let rounding = 16.0 * f64::EPSILON * scale;
        if !self.bound().is_finite() {
            return None; // halves would have no end
        }
        let halves = &GRID.halves;
        let mut parts = vec![(self.plus(rounding), -1.0, 1.0)];
        while let Some((part, from, to)) = parts.pop() {
            let slope = part.derivative();
            // A function that is nothing but rounding has no zero worth looking for: halving it would never end.
            if part.value(0.0) + rounding >= slope.bound() {
                continue;
            }
            let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
            if slope.value(0.0).abs() > slope.derivative().bound() || half < NARROWEST {
                if part.value(1.0) < 0.0 {
                    return Some(middle + half * bracketed_root(-1.0, 1.0, |x| (part.value(x), slope.value(x))));
                }
                continue;
            }
            parts.extend([(part.on(&halves[1]), middle, to), (part.on(&halves[0]), from, middle)]);
        }
        None
    }
}

/// The Chebyshev polynomials `T_k((x - 1)/2)` or `T_k((x + 1)/2)` as series in x, one row a k.
type Half = [[f64; TERMS]; TERMS];

/// `T_k((x + shift)/2)`, by `T_{k+1}(y) = 2 y T_k(y) - T_{k-1}(y)`.
fn half(shift: f64) -> Half {
    let mut half = [[0.0; TERMS]; TERMS];
    half[0][0] = 1.0;
    half[1][..2].copy_from_slice(&[0.5 * shift, 0.5]);
    for k in 1..TERMS - 1 {
        for j in 0..=k + 1 {
            let below = match j {
                0 => 0.0,
                1 => half[k][0],
                _ => 0.5 * half[k][j - 1],
            };
            let above = if j < k { 0.5 * half[k][j + 1] } else { 0.0 };
            half[k + 1][j] = below + above + shift * half[k][j] - half[k - 1][j];
        }
    }
    half
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    fn fit(f: impl Fn(f64) -> f64) -> Series {
        GRID.fit(&GRID.nodes.map(f))
    }

    #[test]
    fn a_function_of_rounding_has_no_fall_and_is_not_searched_for_ever() {
        for f in [Series::default(), fit(|x| 1e-16 * (40.0 * x).sin()), fit(|x| -1e-16 * x)] {
            assert_eq!(f.first_fall(1.0), None);
        }
        assert_eq!(Series::default().first_fall(0.0), None);
    }

    #[test]
    fn a_series_has_the_values_integrals_and_derivatives_of_its_function() {
        let series = fit(|x| (0.7 * x).exp());
        let double = series.integral(0.5, 2.0).integral(0.5, 3.0);
        for k in 0..=20 {
            let x = -1.0 + 0.1 * f64::from(k);
            assert_relative_eq!(series.value(x), (0.7 * x).exp(), max_relative = 1e-14);
            assert_relative_eq!(series.derivative().value(x), 0.7 * (0.7 * x).exp(), max_relative = 1e-11);
            let (start, rate) = ((-0.7_f64).exp(), 0.5 / 0.7);
            let tau = 0.5 * (x + 1.0);
            let expected = 3.0 + 2.0 * tau + rate * (rate * ((0.7 * x).exp() - start) - start * tau);
            assert_relative_eq!(double.value(x), expected, max_relative = 1e-14);
        }
    }

    #[test]
    fn the_halves_of_a_series_are_the_same_function() {
        let series = fit(|x| (0.7 * x).exp()).integral(1.0, 0.0).integral(1.0, 0.0);
        for k in 0..=20 {
            let x = -1.0 + 0.1 * f64::from(k);
            for (half, shift) in GRID.halves.iter().zip([-1.0, 1.0]) {
                assert_relative_eq!(series.on(half).value(x), series.value(0.5 * (x + shift)), epsilon = 1e-14);
            }
        }
    }

    #[test]
    fn functions_that_start_flat_are_not_searched_for_ever() {
        // Few where Miri interprets them.
        for exponent in 1..if cfg!(miri) { 2 } else { 12 } {
            let rising = fit(|x| 1e-6 * (x + 1.0).powi(exponent));
            assert_eq!(rising.first_fall(1.0), None);
            let falling = fit(|x| (x + 1.0).powi(exponent) * (0.5 - x));
            assert_relative_eq!(falling.first_fall(falling.bound()).unwrap(), 0.5, epsilon = 1e-9);
        }
    }

    #[test]
    fn the_first_fall_is_found_next_to_a_graze() {
        for depth in [-1e-9, 1e-9] {
            // Touches zero at 0.3, to `depth`, and falls for good at 0.8.
            let series = fit(|x| ((x - 0.3).powi(2) + depth) * (0.8 - x));
            let expected = if depth < 0.0 { 0.3 - 1e-9_f64.sqrt() } else { 0.8 };
            assert_relative_eq!(series.first_fall(1.0).unwrap(), expected, epsilon = 1e-8);
        }
        assert_eq!(fit(|x| x + 1.0).first_fall(1.0), None);
        assert_eq!(fit(|x| (x + 1.0).powi(2)).first_fall(1.0), None);
    }
}
