//! The curve of periodic orbits over the state and the parameter: tangents, and the way back to it from a point beside it
//! (pseudo-arclength continuation). Coordinates are the state in units of its scale, and the parameter in units of its range.

use nalgebra::{DMatrix, DVector};

use super::flow::{Change, Flow, Point};
use super::orbit::{inside, less_identity, scaled};

/// Most steps of the corrector.
const STEPS: u32 = 12;
/// A step below which it has arrived.
const SMALL: f64 = 1e-9;
/// Longest step.
const LONGEST: f64 = 0.1;

/// Orbits that come back after some periods, as a curve.
#[derive(Debug, Clone)]
pub(super) struct Arc<'a> {
    pub flow: Flow<'a>,
    pub period: u32,
    /// Smallest and largest value of the parameter.
    pub range: [f64; 2],
    scale: DVector<f64>,
}

impl<'a> Arc<'a> {
    pub fn new(flow: Flow<'a>, range: [f64; 2], period: u32) -> Self {
        let scale = flow.scale(0.5 * (range[0] + range[1]));
        Self { flow, period, range, scale }
    }

    fn span(&self) -> f64 {
        self.range[1] - self.range[0]
    }

    fn size(&self) -> usize {
        self.scale.len()
    }

    /// `point` moved by `step` along the `tangent`.
    pub fn along(&self, point: &Point, tangent: &DVector<f64>, step: f64) -> Point {
        let n = self.size();
        let state = &point.state + tangent.rows(0, n).component_mul(&self.scale) * step;
        Point { value: point.value + tangent[n] * step * self.span(), state, phase: point.phase }
    }

    /// A direction of the state alone.
    pub fn of_state(&self, direction: &DVector<f64>) -> DVector<f64> {
        direction.clone().insert_row(self.size(), 0.0)
    }

    /// The direction of the parameter alone.
    pub fn of_value(&self) -> DVector<f64> {
        let mut direction = DVector::zeros(self.size() + 1);
        direction[self.size()] = 1.0;
        direction
    }

    /// Whether the parameter of `point` is in the range.
    pub fn has(&self, point: &Point) -> bool {
        (self.range[0]..=self.range[1]).contains(&point.value)
    }

    /// `point` with the parameter at the nearest end of the range, if it is beyond.
    pub fn clamped(&self, point: Point) -> Point {
        Point { value: point.value.clamp(self.range[0], self.range[1]), ..point }
    }

    /// The step along `tangent` from `point` to the end of the range.
    pub fn rest(&self, point: &Point, tangent: &DVector<f64>) -> f64 {
        let rate = tangent[self.size()] * self.span();
        let end = if rate > 0.0 { self.range[1] } else { self.range[0] };
        if rate == 0.0 { f64::INFINITY } else { (end - point.value) / rate }
    }

    /// Distance of two points of one section.
    pub fn distance(&self, a: &Point, b: &Point) -> f64 {
        let state = (&a.state - &b.state).component_div(&self.scale).norm();
        state.hypot((a.value - b.value) / self.span())
    }

    /// Derivatives of the defect with respect to state and parameter, above `border`.
    fn bordered(&self, change: &Change, border: &DVector<f64>) -> DMatrix<f64> {
        let n = self.size();
        let mut matrix = DMatrix::zeros(n + 1, n + 1);
        matrix.view_mut((0, 0), (n, n)).copy_from(&scaled(&less_identity(change), &self.scale));
        let by_value = change.by_value.component_div(&self.scale) * self.span();
        matrix.view_mut((0, n), (n, 1)).copy_from(&by_value);
        matrix.view_mut((n, 0), (1, n + 1)).copy_from(&border.transpose());
        matrix
    }

    /// Tangent where the return map has this `change`, in the direction of `border`.
    pub fn tangent(&self, change: &Change, border: &DVector<f64>) -> Option<DVector<f64>> {
        let mut unit = DVector::zeros(self.size() + 1);
        unit[self.size()] = 1.0;
        let tangent = self.bordered(change, border).lu().solve(&unit)?;
        let length = tangent.norm();
        (length.is_finite() && length > 0.0).then(|| tangent / length)
    }

    /// Tangent without a direction: of larger values of the parameter, unless the curve turns there.
    pub fn first_tangent(&self, change: &Change) -> Option<DVector<f64>> {
        let rows = self.bordered(change, &DVector::zeros(self.size() + 1));
        let eigen = nalgebra::SymmetricEigen::try_new(rows.transpose() * &rows, f64::EPSILON, 10_000)?;
        let smallest = eigen.eigenvalues.imin();
        let direction: DVector<f64> = eigen.eigenvectors.column(smallest).into_owned();
        let sign = if direction[self.size()] < 0.0 { -1.0 } else { 1.0 };
        self.tangent(change, &(direction * sign))
    }

    /// The `tangent` at `from` after the motion has gone on for `periods`.
    pub fn carried(&self, from: &Point, tangent: &DVector<f64>, periods: f64) -> Option<DVector<f64>> {
        let n = self.size();
        let change = self.flow.change(from, periods).ok()?;
        let state = tangent.rows(0, n).component_mul(&self.scale);
        let moved = change.by_state * state + change.by_value * (tangent[n] * self.span());
        Some(moved.component_div(&self.scale).insert_row(n, tangent[n]))
    }

    /// The point of the curve in the plane through `guess` at right angles to `normal`, and the return map there.
    pub fn correct(&self, guess: &Point, normal: &DVector<f64>) -> Option<(Point, Change)> {
        let n = self.size();
        let mut point = guess.clone();
        let mut before = f64::INFINITY;
        for _ in 0..STEPS {
            let change = self.flow.change(&point, f64::from(self.period)).ok()?;
            let defect = (&change.end - &point.state).component_div(&self.scale);
            let offset = (&point.state - &guess.state).component_div(&self.scale);
            let off_plane = normal.rows(0, n).dot(&offset) + normal[n] * (point.value - guess.value) / self.span();
            let right = -defect.insert_row(n, off_plane);
            let mut step = self.bordered(&change, normal).lu().solve(&right)?;
            let length = step.norm();
            if !length.is_finite() {
                return None;
            }
            if length < SMALL && length >= 0.5 * before || length < 1e-15 {
                return Some((point, change));
            }
            before = length;
            if length > LONGEST {
                step *= LONGEST / length;
            }
            point.value += step[n] * self.span();
            point.state = inside(self.flow, &point, step.rows(0, n).component_mul(&self.scale))?;
        }
        None
    }
}
