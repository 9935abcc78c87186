//! The contact of a simple flight, as most are: under the harmonic force alone the ball goes straight to a membrane, or turns back
//! once, in the open, and then goes straight to the membrane behind it.
//!
//! The force without the harmonic part is a line, so that the slope of dz oscillates by `speed` about its `drift`. If the drift is
//! larger, dz has no extremum at all. If the slope grows from the start to where it is steepest, dz is convex there, and lies inside of
//! the tangents at both ends: they show that the ball turns back in the open. It then meets what it goes to before the slope is zero
//! again. What is found so is, to rounding, what the search from extremum to extremum finds, but no extremum is worked out, and the
//! series about the steepest place has odd terms only. Where anything is in doubt, that search decides.

#![allow(clippy::inline_always)] // one straight piece of code for each side, which is known where it is called

use super::angle::{Angle, Swept};
use super::crossing::{ROUGH_STEPS, Series, is_rough_root};
use super::{Crossing, Flight};
use crate::motion::side::Side;
use crate::numerics::elementary::fraction;
use crate::numerics::product::product_error;

/// What may be rounding, as a part.
const CLEAR: f64 = 1e-9;

/// The gap to the membrane that the ball comes to.
struct Approach {
    /// At the start, m.
    level: f64,
    /// Its rate there, and that without the harmonic part, m/s.
    rate: f64,
    drift: f64,
    /// Amplitudes of the harmonic part of it, m, and of its rate, m/s.
    swing: f64,
    speed: f64,
    omega: f64,
    /// Sine and cosine of the angle at the start.
    sine: [f64; 2],
}

impl Approach {
    /// The gap about the steepest place, which comes `first`, s, after the start.
    #[inline(always)]
    fn steepest(&self, side: Side, first: f64) -> OddSeries {
        let square = self.omega * self.omega;
        let sin2 = self.speed * square * side.sign();
        let sin4 = square * sin2;
        let [sin6, sin8] = [square * sin4, (square * square) * sin4];
        let [c0, c1] =
            [self.level + self.swing * self.sine[1] + first * self.drift, self.drift + self.speed * side.sign()];
        let [c3, c5] = [-sin2 * (1.0 / 6.0), sin4 * (1.0 / 120.0)];
        let [c7, c9] = [-sin6 * (1.0 / 5040.0), sin8 * (1.0 / 362_880.0)];
        OddSeries([c0, c1, c3, c5, c7, c9])
    }

    /// The gap about `tau`, s, where the angle is this one.
    #[inline(always)]
    fn series(&self, tau: f64, Angle { sine, swept }: &Angle) -> Series {
        let square = self.omega * self.omega;
        let [sin, cos] = *sine;
        let [sin2, cos2] = [self.speed * square * sin, self.swing * square * cos];
        let [sin4, cos4] = [square * sin2, square * cos2];
        let [sin, cos] = self.sine;
        let straight = tau * self.rate;
        let rest = product_error(self.rate, tau, straight) + self.swing * cos * swept.versine;
        // The lag comes last.
        let gap = (self.level + straight + rest) - self.swing * sin * swept.lag;
        let slope = self.rate + self.slope_change(swept);
        Series::new(gap, [0.0, slope, cos2, -sin2, -cos4, sin4, square * cos4, -square * sin4])
    }

    /// How much the rate of the gap has grown, m/s, after the force has passed through this angle.
    #[inline(always)]
    fn slope_change(&self, swept: &Swept) -> f64 {
        let [sin, cos] = self.sine;
        self.speed * (cos * swept.sine - sin * swept.versine)
    }
}

/// The gap about a place where the harmonic part is steepest: coefficients of the powers 0, 1, 3, 5, 7 and 9 of the time since then, s.
struct OddSeries([f64; 6]);

impl OddSeries {
    /// The same as [`Series::at`] of a series without the other powers.
    #[inline(always)]
    fn at(&self, x: f64) -> [f64; 3] {
        let Self([c0, c1, c3, c5, c7, c9]) = self;
        let square = x * x;
        let four = square * square;
        [
            (c0 + x * (c1 + square * c3)) + (x * four) * ((c5 + square * c7) + four * c9),
            (c1 + square * (3.0 * c3)) + four * ((5.0 * c5 + square * (7.0 * c7)) + four * (9.0 * c9)),
            x * (((3.0 * c3) + square * (10.0 * c5)) + four * ((21.0 * c7) + square * (36.0 * c9))),
        ]
    }

    /// Close to where the gap closes, s from the place: by steps of Halley's method from where a quotient of polynomials puts it, whose
    /// series in `c0` has the terms up to the fifth power. None if the gap is not on the way down at the place, or on the way.
    ///
    /// With y = -c0 / c1, a = c3 / c1 and w = omega^2 / 20, c5 is -a w c1, and the quotient
    /// y (1 + (2 a + w) y^2) / (1 + (3 a + w) y^2).
    #[inline(always)]
    fn rough_root(&self, omega: f64) -> Option<f64> {
        let Self([c0, c1, c3, ..]) = *self;
        let (square, cube, linear) = (c0 * c0, c1 * (c1 * c1), omega * omega * (1.0 / 20.0) * c1);
        let [above, below] = [2.0, 3.0].map(|share| cube + square * (linear + share * c3));
        let divisor = c1 * below;
        let mut root = (c1 < 0.0 && divisor > 0.0).then(|| -c0 * above / divisor)?;
        for _ in 0..ROUGH_STEPS {
            let change = Series::halley(self.at(root))?;
            root += change;
            if is_rough_root(omega, change) {
                return Some(root);
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
            Side::Left => self.simple_contact_at(Side::Left, drift, turns),
            Side::Right => self.simple_contact_at(Side::Right, drift, turns),
        }
    }

    /// The same where it is known to which membrane the ball goes, and whether it turns before.
    #[inline(always)]
    fn simple_contact_at(&self, side: Side, drift: f64, turns: bool) -> Option<Crossing> {
        let (sign, omega) = (-side.sign(), self.omega());
        let [rate, swing, speed] = [self.rate, self.swing, self.swing * omega].map(|value| sign * value);
        let approach =
            Approach { level: self.room(side), rate, drift: sign * drift, swing, speed, omega, sine: self.sine };
        let first = fraction(0.25 * side.sign() - self.turns) * self.period;
        let steepest = approach.steepest(side, first);
        let limit = if turns {
            (first + 0.5 * self.period, self.turns_in_the_open(&approach, &steepest, first)?)
        } else {
            (self.period, self.goes_straight(&approach, first)?)
        };
        self.simple_crossing(side, &approach, first + steepest.rough_root(omega)?, limit)
    }

    /// Slopes, m/s, whose square is not larger may be zero by rounding: none of a ball that goes straight to a membrane, which it
    /// meets within a period, by more than rounding.
    #[inline(always)]
    fn goes_straight(&self, approach: &Approach, first: f64) -> Option<f64> {
        let end = approach.level + approach.drift * self.period;
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

    /// The crossing close to `tau`, s; up to `end`, s, the gap shrinks where the square of its slope is larger than `doubt`. None where it
    /// may not, or if two steps do not lead there.
    #[inline(always)]
    fn simple_crossing(&self, side: Side, approach: &Approach, tau: f64, (end, doubt): (f64, f64)) -> Option<Crossing> {
        let shrinks =
            |tau: f64, slope: f64| tau > 0.0 && tau < end * (1.0 - CLEAR) && slope < 0.0 && slope * slope > doubt;
        let mut tau = tau;
        for _ in 0..2 {
            let angle = self.angle(tau);
            let series = approach.series(tau, &angle);
            if !shrinks(tau, series.slope()) {
                return None;
            }
            if let Some((step, change)) = series.last_step(tau, approach.speed.abs(), approach.omega) {
                let (elapsed, slope) = (tau + step, approach.rate + (approach.slope_change(&angle.swept) + change));
                return shrinks(elapsed, slope).then(|| Crossing { elapsed, side, speed: (-slope).max(0.0) });
            }
            tau += series.first_step()?;
        }
        None
    }
}
