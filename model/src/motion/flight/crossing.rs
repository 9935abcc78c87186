//! Where dz crosses a membrane.
//!
//! One sine and cosine give all derivatives. So the gap is taken as its Taylor series about a place near the crossing, whose
//! root costs no more sines; there the next series is taken, until a step to its root is so short that it is known to all digits. The
//! first place is one where sine and cosine are known beforehand.

#![allow(clippy::inline_always)] // what is taken at each event, and not inlined everywhere otherwise

use super::zeros::Knot;
use super::{Angle, Crossing, Flight};
use crate::motion::side::Side;
use crate::numerics::elementary::fraction;

/// Bisection alone needs at most some 110 to exhaust the digits of a double.
const MAX_SERIES: u32 = 200;

/// Most steps to a rough root.
pub(super) const ROUGH_STEPS: u32 = 8;

/// Whether this last `change` of a step, s, is small enough at `omega`, rad/s: what its third power leaves is for the last step.
#[inline(always)]
pub(super) fn is_rough_root(omega: f64, change: f64) -> bool {
    const ROUGH: f64 = 0.08;
    omega * change.abs() <= ROUGH
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

    /// The step from the place itself, at `tau`, s, to a root close by, s, and how much the slope grows on it, m/s; none if the slope is no
    /// fall, or if the step may not have all digits. Derivatives number k of the gap are at most `speed` `omega`^(k - 1), k > 1.
    ///
    /// Householder's method of the third order. With y = -c0 / c1, it leaves (2 a2 a3 - a4 - a2^3) y^4, where ak = ck / c1 is at most
    /// R omega^(k - 1) / k! and R the speed over -c1; so (omega (1 + R) y)^3 y, if that is small.
    #[inline(always)]
    pub(super) fn last_step(&self, tau: f64, speed: f64, omega: f64) -> Option<(f64, f64)> {
        let Self([c0, c1, c2, c3, c4, ..]) = *self;
        let (bend, square) = (c0 * c2, c1 * c1);
        let divisor = c1 * (square - 2.0 * bend) + c0 * (c0 * c3);
        let step = (c1 < 0.0 && divisor < 0.0).then(|| -c0 * (square - bend) / divisor)?;
        let change = step * (2.0 * c2) + (step * step) * (3.0 * c3 + step * (4.0 * c4));
        let small = (omega * step) * (speed - c1);
        let left_out = (small * small) * (small * step);
        let is_exact = left_out.abs() <= 0.25 * f64::EPSILON * tau * (square * -c1);
        is_exact.then_some((step, change))
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
    fn rough_root(&self, omega: f64, start: f64) -> Option<f64> {
        let mut step = start;
        for _ in 0..ROUGH_STEPS {
            let change = Self::halley(self.at(step))?;
            step += change;
            if is_rough_root(omega, change) {
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
        let (gap_to, level, omega) = (self.seen_from(side), self.room(side) + beyond, self.omega());
        let (mut low, mut high) = (from.tau, to.tau);
        let (begin, angle) = self.steepest(side, from, to).unwrap_or((from.tau, from.angle));
        let first = gap_to.series(begin, &angle, level);
        let start = if begin == from.tau { first.root_of_parabola() } else { first.first_step() };
        let rough = start.and_then(|start| first.rough_root(omega, start)).map(|step| begin + step);
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
            let is_between = |step: f64| (low..=high).contains(&(tau + step));
            let last = series.last_step(tau, self.swiftness(tau), omega).filter(|(step, _)| is_between(*step));
            if let Some((step, change)) = last {
                let slope = series.slope() + change;
                return Crossing { elapsed: tau + step, side, speed: (-slope).max(0.0) };
            }
            let step =
                series.first_step().and_then(|step| series.rough_root(omega, step)).filter(|step| is_between(*step));
            let next = step.map_or(low, |step| tau + step);
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

    /// A speed, m/s, that times omega^(k - 1) is no smaller than derivative number k of dz about `tau`, s, k > 1.
    fn swiftness(&self, tau: f64) -> f64 {
        let ([c2, c3], omega) = (self.external.map(f64::abs), self.omega());
        self.swing * omega + (2.0 * c2 + 6.0 * c3 * (tau + 1.0 / omega)) / omega
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
