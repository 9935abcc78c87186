//! Where dz crosses a membrane.
//!
//! One sine and cosine give all derivatives. So the gap is taken as its Taylor series about a place near the crossing, whose
//! root costs no more sines; there the next series is taken, until the step is so short that nothing is missing. The first
//! place is one where sine and cosine are known beforehand.

use super::zeros::Knot;
use super::{Flight, Side};
use crate::elementary::fraction;

/// Bisection alone needs at most some 110 to exhaust the digits of a double.
const MAX_SERIES: u32 = 200;

/// Halley's method triples the digits. Once a change is as small as this relative to the step, the next one is small beside
/// what the first series leaves out, or beside the last correction.
const ROUGH: f64 = 0.3;
const FINE: f64 = 1e-3;

/// The gap about a place: coefficients of the powers of the time since then, s.
struct Series([f64; 8]);

/// A root of a series.
struct Root {
    step: f64,
    /// Slope of the series near the root.
    slope: f64,
}

impl Series {
    /// Series of `gap` less `sign` times what dz adds to it.
    #[inline]
    fn new(gap: f64, sign: f64, [_, d1, d2, d3, d4, d5, d6, d7]: [f64; 8]) -> Self {
        let [c1, c2, c3] = [-sign * d1, -sign * d2 * (1.0 / 2.0), -sign * d3 * (1.0 / 6.0)];
        let [c4, c5] = [-sign * d4 * (1.0 / 24.0), -sign * d5 * (1.0 / 120.0)];
        Self([gap, c1, c2, c3, c4, c5, -sign * d6 * (1.0 / 720.0), -sign * d7 * (1.0 / 5040.0)])
    }

    /// Value, first and half the second derivative.
    #[inline]
    fn at(&self, x: f64) -> [f64; 3] {
        let Self([c0, c1, c2, c3, c4, c5, c6, c7]) = self;
        let square = x * x;
        let four = square * square;
        [
            ((c0 + x * c1) + square * (c2 + x * c3)) + four * ((c4 + x * c5) + square * (c6 + x * c7)),
            ((c1 + x * (2.0 * c2)) + square * (3.0 * c3 + x * (4.0 * c4)))
                + four * ((5.0 * c5 + x * (6.0 * c6)) + square * (7.0 * c7)),
            ((c2 + x * (3.0 * c3)) + square * (6.0 * c4 + x * (10.0 * c5))) + four * (15.0 * c6 + x * (21.0 * c7)),
        ]
    }

    /// The root that Halley's method finds from where the series has been taken; none if it is not on the way down.
    #[inline]
    fn root(&self, tolerance: f64) -> Option<Root> {
        const MAX_STEPS: u32 = 8;
        let mut step = 0.0;
        let [mut value, mut slope, mut half_curvature] = [self.0[0], self.0[1], self.0[2]];
        for _ in 0..MAX_STEPS {
            let change = -value * slope / (slope * slope - value * half_curvature);
            step += change;
            if slope >= 0.0 {
                return None;
            }
            if change.abs() <= tolerance * step.abs() {
                return Some(Root { step, slope });
            }
            [value, slope, half_curvature] = self.at(step);
        }
        None
    }
}

impl Flight {
    /// When dz is `beyond`, m, outside of the membrane at `side`, s since the start, on a piece on which it rises or falls
    /// all the way to there.
    pub(super) fn crossing(&self, side: Side, from: &Knot, to: &Knot, beyond: f64) -> f64 {
        let (sign, level) = (side.sign(), self.half_travel + beyond);
        let (mut low, mut high) = (from.tau, to.tau);
        let (mut tau, mut sine) = self.steepest(side, from, to).unwrap_or((from.tau, from.sine));
        let mut tolerance = ROUGH;
        for _ in 0..MAX_SERIES {
            let derivatives = self.derivatives(tau, sine);
            let gap = level - sign * derivatives[0];
            if gap > 0.0 {
                low = tau;
            } else {
                high = tau;
            }
            let root = Series::new(gap, sign, derivatives).root(tolerance);
            match root.filter(|root| tau + root.step > low && tau + root.step < high) {
                Some(root) if tolerance == FINE && self.is_complete(&root, tau) => {
                    let gap = level - sign * self.beside(tau, sine, root.step);
                    return tau + root.step - gap / root.slope;
                }
                Some(root) => tau += root.step,
                None if high - low <= f64::EPSILON * high => return high,
                None => tau = 0.5 * (low + high),
            }
            (sine, tolerance) = (self.sine_at(tau), FINE);
        }
        tau
    }

    /// Where on the way from one extremum to the next the harmonic part is steepest: sine and cosine are known there.
    #[inline]
    fn steepest(&self, side: Side, from: &Knot, to: &Knot) -> Option<(f64, [f64; 2])> {
        let tau = from.tau + fraction(0.25 * side.sign() - self.turns_at(from.tau)) * self.period;
        (tau < to.tau).then_some((tau, [side.sign(), 0.0]))
    }

    /// Whether the first term that the series about `tau` leaves out is too small to move its root.
    #[inline]
    fn is_complete(&self, root: &Root, tau: f64) -> bool {
        let square = (self.omega() * root.step).powi(2);
        let left_out = self.swing * (square * square) * (square * square) * (1.0 / 40_320.0);
        left_out <= 0.25 * f64::EPSILON * tau * root.slope.abs()
    }

    /// dz, m, a short `step`, s, beside `tau`, with all digits: in a series about `tau`, the straight part of the flight would
    /// carry the rounding of `tau` along.
    #[inline]
    fn beside(&self, tau: f64, [sin, cos]: [f64; 2], step: f64) -> f64 {
        let [c0, c1, c2, c3] = self.coefficients;
        let (there, angle) = (tau + step, self.omega() * step);
        let square = angle * angle;
        let sine = 1.0 - square * (1.0 / 6.0 - square * (1.0 / 120.0 - square * (1.0 / 5040.0)));
        let versine = 0.5 - square * (1.0 / 24.0 - square * (1.0 / 720.0));
        let cosine = cos - (sin * (angle * sine) + cos * (square * versine));
        c0 + there * (c1 + there * (c2 + there * c3)) - self.swing * cosine
    }
}
