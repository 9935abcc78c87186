//! Where dz crosses a membrane.
//!
//! One sine and cosine give all derivatives. So the gap is taken as its Taylor series about a place near the crossing, whose
//! root costs no more sines; there the next series is taken, until one more step from its root, with the gap to all digits,
//! is the last. The first place is one where sine and cosine are known beforehand.

#![allow(clippy::inline_always)] // what is taken at each event, and not inlined everywhere otherwise

use super::zeros::Knot;
use super::{Angle, Crossing, Flight};
use crate::motion::side::Side;
use crate::numerics::elementary::fraction;

/// Bisection alone needs at most some 110 to exhaust the digits of a double.
const MAX_SERIES: u32 = 200;

/// Most steps to a rough root.
pub(super) const ROUGH_STEPS: u32 = 8;

/// Whether this last `change` of a `step` is small enough: a root of the first series need not be better than what that leaves out.
#[inline]
pub(super) fn is_rough_root(step: f64, change: f64) -> bool {
    const ROUGH: f64 = 0.3;
    change.abs() <= ROUGH * step.abs()
}

/// The gap about a place: coefficients of the powers of the time since then, s.
pub(super) struct Series([f64; 8]);

impl Series {
    /// Series of a gap that is `level` where these, a value and its derivatives, are zero.
    #[inline(always)]
    pub(super) fn new(level: f64, [d0, d1, d2, d3, d4, d5, d6, d7]: [f64; 8]) -> Self {
        let [c2, c3, c4] = [d2 * (1.0 / 2.0), d3 * (1.0 / 6.0), d4 * (1.0 / 24.0)];
        Self([level + d0, d1, c2, c3, c4, d5 * (1.0 / 120.0), d6 * (1.0 / 720.0), d7 * (1.0 / 5040.0)])
    }

    /// Value at the place itself.
    #[inline]
    pub(super) fn value(&self) -> f64 {
        self.0[0]
    }

    /// First derivative at the place itself.
    #[inline]
    pub(super) fn slope(&self) -> f64 {
        self.0[1]
    }

    /// Value, first and half the second derivative.
    #[inline(always)]
    pub(super) fn at(&self, x: f64) -> [f64; 3] {
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

    /// The step of Halley's method from where the series has this value, slope and half the second derivative; none if
    /// that is not on the way down.
    #[inline(always)]
    pub(super) fn halley([value, slope, half_curvature]: [f64; 3]) -> Option<f64> {
        (slope < 0.0).then(|| -value * slope / (slope * slope - value * half_curvature))
    }

    /// The step of Halley's method from the place itself.
    #[inline(always)]
    pub(super) fn first_step(&self) -> Option<f64> {
        let Self([c0, c1, c2, ..]) = *self;
        Self::halley([c0, c1, c2])
    }

    /// The root of the first three terms ahead, where the gap is still open; none if they have none.
    #[inline]
    fn root_of_parabola(&self) -> Option<f64> {
        let Self([c0, c1, c2, ..]) = *self;
        let discriminant = c1 * c1 - 4.0 * c0 * c2;
        let sum = discriminant.max(0.0).sqrt() - c1;
        let is_ahead = discriminant >= 0.0 && sum > 0.0;
        // A host may trap divisions by zero, also those whose result is not used.
        let step = 2.0 * c0 / if is_ahead { sum } else { 1.0 };
        (is_ahead && step > 0.0).then_some(step)
    }

    /// About the root that Halley's method finds from `start` on.
    #[inline]
    fn rough_root(&self, start: f64) -> Option<f64> {
        let mut step = start;
        for _ in 0..ROUGH_STEPS {
            let change = Self::halley(self.at(step))?;
            step += change;
            if is_rough_root(step, change) {
                return Some(step);
            }
        }
        None
    }
}

impl Flight {
    /// When, and how fast, dz comes to be `beyond`, m, outside of the membrane at `side`, on a piece on which it rises or
    /// falls all the way to there.
    pub(super) fn crossing(&self, side: Side, from: &Knot, to: &Knot, beyond: f64) -> Crossing {
        let (gap_to, level) = (self.seen_from(side), self.room(side) + beyond);
        let (mut low, mut high) = (from.tau, to.tau);
        let (begin, angle) = self.steepest(side, from, to).unwrap_or((from.tau, from.angle));
        let first = gap_to.series(begin, &angle, level);
        let start = if begin == from.tau { first.root_of_parabola() } else { first.first_step() };
        let rough = start.and_then(|start| first.rough_root(start)).map(|step| begin + step);
        let mut tau = rough.filter(|tau| *tau > low && *tau < high).unwrap_or(0.5 * (low + high));
        for _ in 0..MAX_SERIES {
            let angle = self.angle(tau);
            let series = gap_to.series(tau, &angle, level);
            if series.value() > 0.0 {
                low = tau;
            } else {
                high = tau;
            }
            if high - low <= f64::EPSILON * high {
                return self.contact(side, high);
            }
            let Some(step) = series.first_step().filter(|step| (low..=high).contains(&(tau + step))) else {
                tau = 0.5 * (low + high);
                continue;
            };
            let [_, slope, half_curvature] = series.at(step);
            // With all digits: in the series, the straight part of the flight would carry the rounding of `tau` along.
            let there = angle.swept.further(self.omega() * step);
            let gap = level + gap_to.change(tau + step, &there);
            let change = Series::halley([gap, slope, half_curvature]);
            if let Some(change) = change.filter(|_| self.is_found(tau, step, gap / slope, slope)) {
                let elapsed = (tau + (step + change)).clamp(low, high);
                let there = angle.swept.further(self.omega() * (step + change));
                let speed = -gap_to.slope(elapsed, &there);
                return Crossing { elapsed, side, speed: speed.max(0.0) };
            }
            let next = tau + step;
            tau = if next > low && next < high { next } else { 0.5 * (low + high) };
        }
        self.contact(side, tau)
    }

    /// A contact `elapsed`, s, after the start.
    fn contact(&self, side: Side, elapsed: f64) -> Crossing {
        let [_, rate] = self.at(elapsed);
        Crossing { elapsed, side, speed: (side.sign() * rate).max(0.0) }
    }

    /// This flight with the sign with which it adds to the gap to the membrane at `side`.
    #[inline]
    fn seen_from(&self, side: Side) -> Self {
        let sign = -side.sign();
        let external = self.external.map(|part| sign * part);
        Self { external, swing: sign * self.swing, rate: sign * self.rate, ..*self }
    }

    /// The gap about `tau`, s, where the angle is this one, of a flight that is seen from the membrane.
    #[inline]
    fn series(&self, tau: f64, angle: &Angle, level: f64) -> Series {
        Series::new(level, self.derivatives(tau, angle))
    }

    /// Whether the `step`, s, of Halley's method from `tau` and one more of that method lead to the crossing, if Newton's method
    /// would put that off by `rest`, s, from there.
    ///
    /// An error e becomes K e^3 by a step. The first step has left K step^3 = rest, so that the next leaves rest^4 / step^3.
    /// Where the method crawls along a flat gap, the rest is larger than the step.
    #[inline(always)]
    pub(super) fn is_found(&self, tau: f64, step: f64, rest: f64, slope: f64) -> bool {
        let allowed = 0.25 * f64::EPSILON * tau;
        let square = (self.omega() * step).powi(2);
        let left_out = self.swing * (square * square) * (square * square) * (1.0 / 40_320.0);
        let is_complete = left_out <= allowed * slope.abs();
        let (rest, step) = (rest.abs(), step.abs());
        is_complete && (rest <= allowed || (rest <= 0.01 * step && rest.powi(4) <= allowed * step.powi(3)))
    }

    /// Where on the way from one extremum to the next the harmonic part is steepest: sine and cosine are known there. It
    /// is counted from the begin of the flight, so that nobody waits for the extrema.
    #[inline]
    fn steepest(&self, side: Side, from: &Knot, to: &Knot) -> Option<(f64, Angle)> {
        let first = fraction(0.25 * side.sign() - self.turns) * self.period;
        let tau = if first >= from.tau {
            first
        } else {
            from.tau + fraction(0.25 * side.sign() - self.turns_at(from.tau)) * self.period
        };
        (tau < to.tau).then(|| (tau, Angle::known(self.sine, [side.sign(), 0.0], self.omega() * tau)))
    }
}
