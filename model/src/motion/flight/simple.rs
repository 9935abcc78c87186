//! The contact of a simple flight, as most are: under the harmonic force alone the ball goes straight to a membrane, or turns back
//! once, in the open, and then goes straight to the membrane behind it.
//!
//! The force without the harmonic part is a line, so that the slope of dz oscillates by `speed` about its `drift`. If the drift is
//! larger, dz has no extremum at all. If the slope grows from the start to where it is steepest, dz is convex there, and lies inside of
//! the tangents at both ends: they show that the ball turns back in the open. It then meets what it goes to before the slope is zero
//! again. What is found so is, to the last bit, what the search from extremum to extremum finds, but no extremum is worked out, and the
//! series about the steepest place has odd terms only. Where anything is in doubt, that search decides.

#![allow(clippy::inline_always)] // one straight piece of code for each side, which is known where it is called

use core::f64::consts::TAU;

use super::angle::{Angle, Swept};
use super::crossing::{ROUGH_STEPS, Series, is_rough_root};
use super::{Crossing, Flight};
use crate::motion::side::Side;
use crate::numerics::elementary::fraction;

/// What may be rounding, as a part.
const CLEAR: f64 = 1e-9;

/// The gap to the membrane that the ball comes to.
struct Approach {
    /// At the start, m.
    level: f64,
    /// Its rate there, m/s.
    rate: f64,
    /// Amplitudes of the harmonic part of it, m, and of its rate, m/s.
    swing: f64,
    speed: f64,
    omega: f64,
    /// Sine and cosine of the angle at the start.
    sine: [f64; 2],
}

impl Approach {
    /// What `tau`, s, in which the force passes through this angle, add to the gap, m.
    #[inline(always)]
    fn change(&self, tau: f64, swept: &Swept) -> f64 {
        let [sin, cos] = self.sine;
        tau * self.rate + self.swing * (cos * swept.versine - sin * swept.lag)
    }

    /// The rate of the gap, m/s, after the force has passed through this angle.
    #[inline(always)]
    fn slope(&self, swept: &Swept) -> f64 {
        let [sin, cos] = self.sine;
        self.rate + self.speed * (cos * swept.sine - sin * swept.versine)
    }

    /// The gap about `tau`, s, where the angle is this one.
    #[inline(always)]
    fn series(&self, tau: f64, angle: &Angle) -> Series {
        let square = self.omega * self.omega;
        let [sin, cos] = angle.sine;
        let [sin2, cos2] = [self.speed * square * sin, self.swing * square * cos];
        let [sin4, cos4] = [square * sin2, square * cos2];
        let (change, slope) = (self.change(tau, &angle.swept), self.slope(&angle.swept));
        Series::new(self.level, [change, slope, cos2, -sin2, -cos4, sin4, square * cos4, -square * sin4])
    }
}

/// The gap about a place where the harmonic part is steepest: coefficients of the powers 0, 1, 3, 5 and 7 of the time since then, s.
struct OddSeries([f64; 5]);

impl OddSeries {
    /// The same as [`Series::at`] of a series without the other powers.
    #[inline(always)]
    fn at(&self, x: f64) -> [f64; 3] {
        let Self([c0, c1, c3, c5, c7]) = self;
        let square = x * x;
        let four = square * square;
        [
            ((c0 + x * c1) + square * (x * c3)) + four * (x * c5 + square * (x * c7)),
            (c1 + square * (3.0 * c3)) + four * (5.0 * c5 + square * (7.0 * c7)),
            (x * (3.0 * c3) + square * (x * (10.0 * c5))) + four * (x * (21.0 * c7)),
        ]
    }

    /// As [`Series::rough_root`], from the place itself.
    #[inline(always)]
    fn rough_root(&self) -> Option<f64> {
        let Self([c0, c1, ..]) = *self;
        let mut step = (c1 < 0.0).then(|| -c0 * c1 / (c1 * c1))?; // without curvature
        for _ in 0..ROUGH_STEPS {
            let change = Series::halley(self.at(step))?;
            step += change;
            if is_rough_root(step, change) {
                return Some(step);
            }
        }
        None
    }
}

impl Flight {
    /// The contact within the first period, if there is one and the flight is simple.
    #[inline(always)]
    pub fn simple_contact(&self) -> Option<Crossing> {
        let [c2, c3] = self.external; // one by one: a comparison of arrays is a call
        if c2 != 0.0 || c3 != 0.0 {
            return None;
        }
        let speed = self.swing * self.omega();
        let drift = self.rate - speed * self.sine[0];
        let turns = drift.abs() <= speed * (1.0 + CLEAR);
        // Two branches, of which a processor guesses one before it knows the drift.
        match Side::of(if turns { -self.rate } else { drift }) {
            Side::Left => self.simple_contact_at(Side::Left, turns),
            Side::Right => self.simple_contact_at(Side::Right, turns),
        }
    }

    /// The same where it is known to which membrane the ball goes, and whether it turns before.
    #[inline(always)]
    fn simple_contact_at(&self, side: Side, turns: bool) -> Option<Crossing> {
        let (sign, omega) = (-side.sign(), self.omega());
        let [rate, swing, speed] = [self.rate, self.swing, self.swing * omega].map(|value| sign * value);
        let approach = Approach { level: self.room(side), rate, swing, speed, omega, sine: self.sine };
        let first = fraction(0.25 * side.sign() - self.turns) * self.period;
        let steepest = self.steepest_of(&approach, side, first);
        let limit = if turns {
            (first + 0.5 * self.period, self.turns_in_the_open(&approach, &steepest, first)?)
        } else {
            (self.period, self.goes_straight(&approach, first)?)
        };
        self.simple_crossing(side, &approach, first + steepest.rough_root()?, limit)
    }

    /// The gap about the steepest place, which comes `first`, s, after the start.
    #[inline(always)]
    fn steepest_of(&self, approach: &Approach, side: Side, first: f64) -> OddSeries {
        let [sin, cos] = self.sine;
        let (phi, sine) = (approach.omega * first, side.sign() * cos);
        let swept = Swept { sine, versine: 1.0 - side.sign() * sin, lag: phi - sine };
        let square = approach.omega * approach.omega;
        let sin2 = approach.speed * square * side.sign();
        let sin4 = square * sin2;
        let [c3, c5, c7] = [-sin2 * (1.0 / 6.0), sin4 * (1.0 / 120.0), -square * sin4 * (1.0 / 5040.0)];
        OddSeries([approach.level + approach.change(first, &swept), approach.slope(&swept), c3, c5, c7])
    }

    /// Slopes, m/s, whose square is not larger may be zero by rounding: none of a ball that goes straight to a membrane, which it
    /// meets within a period, by more than rounding.
    #[inline(always)]
    fn goes_straight(&self, approach: &Approach, first: f64) -> Option<f64> {
        let after_a_turn = Swept { lag: TAU, ..Swept::default() };
        let end = approach.level + approach.change(self.period, &after_a_turn);
        let is_ahead = first > 0.0 && first < self.period;
        let is_clear = is_ahead && approach.level > self.rounding_at_start() && end < -self.rounding(self.period);
        is_clear.then_some(0.0)
    }

    /// The same of a ball that turns back before it meets anything, and has left where it turned when the slope is steepest.
    #[inline(always)]
    fn turns_in_the_open(&self, approach: &Approach, steepest: &OddSeries, first: f64) -> Option<f64> {
        let (Approach { level, rate, .. }, OddSeries([gap, slope, ..])) = (approach, steepest);
        // An extremum lies so far from where the slope is this one that the square over twice the largest acceleration is passed on
        // the way at least.
        let doubt = 4.0 * approach.speed.abs() * approach.omega * self.rounding(self.period);
        let is_convex = first < 0.5 * self.period * (1.0 - CLEAR);
        if !is_convex || *level < 0.0 || rate * rate <= doubt || *slope >= 0.0 || slope * slope <= doubt {
            return None;
        }
        // Where the tangents meet, the gap is larger than it becomes.
        let elapsed = (gap - level - slope * first) / (rate - slope);
        let is_open = level + rate * elapsed < 2.0 * self.half_travel * (1.0 - CLEAR) - self.rounding(self.period);
        is_open.then_some(doubt)
    }

    /// The crossing to which Halley's method leads from `tau`, s, on, if it is found at once, as [`Flight::crossing`] would; up to
    /// `end`, s, the gap shrinks where the square of its slope is larger than `doubt`.
    #[inline(always)]
    fn simple_crossing(&self, side: Side, approach: &Approach, tau: f64, (end, doubt): (f64, f64)) -> Option<Crossing> {
        let shrinks =
            |tau: f64, slope: f64| tau > 0.0 && tau < end * (1.0 - CLEAR) && slope < 0.0 && slope * slope > doubt;
        let angle = self.angle(tau);
        let series = approach.series(tau, &angle);
        let step = series.first_step()?;
        let (here, [_, slope, half_curvature]) = (series.slope(), series.at(step));
        if !shrinks(tau, here) || !shrinks(tau + step, slope) {
            return None;
        }
        let there = angle.swept.further(approach.omega * step);
        let gap = approach.level + approach.change(tau + step, &there);
        let change = Series::halley([gap, slope, half_curvature])?;
        let elapsed = tau + (step + change);
        let there = angle.swept.further(approach.omega * (step + change));
        let slope_there = approach.slope(&there);
        let keeps_bracket =
            if series.value() > 0.0 { step >= 0.0 && elapsed >= tau } else { step <= 0.0 && elapsed <= tau };
        let is_found = keeps_bracket && self.is_found(tau, step, gap / slope, slope) && shrinks(elapsed, slope_there);
        is_found.then(|| Crossing { elapsed, side, speed: (-slope_there).max(0.0) })
    }
}
