//! The end of a flight under a constant force besides the harmonic one, as gravity and friction are.
//!
//! The extrema of dz have no closed form then, but its inflections have. Between two of these dz is convex or concave: it has one
//! extremum at most, which lies within its tangents. Only where these leave a doubt the extremum is worked out.

use super::Flight;
use super::zeros::{Knot, Zero};
use crate::motion::side::Side;
use crate::numerics::roots::short_root_near;

/// How far on the way to an extremum a contact is looked for first. Most of the way is made by there.
const EARLY: f64 = 0.8;

/// How far on the way from one on, after which a contact on the way back is looked for.
const LATE: f64 = 0.2;

impl Flight {
    /// Whether the acceleration of dz has a constant part, and nothing else beside the harmonic one.
    pub(super) fn has_curvature_only(&self) -> bool {
        let [c2, c3] = self.external;
        c3 == 0.0 && c2 != 0.0
    }

    /// What `find` finds first in the pieces between these places of one window, the last at `end`, s; if it looks for contacts only, where the ball comes
    /// near a membrane.
    #[inline(never)] // what a level, free capsule does stays small
    pub(super) fn first_between_inflections<T>(
        &self,
        mut from: Knot,
        end: f64,
        last: impl Fn() -> Knot,
        contacts_only: bool,
        find: impl Fn(&Knot, &Knot) -> Option<T>,
    ) -> Option<T> {
        let mut slope = self.slope(from.tau, &from.angle.swept);
        let inflections = self.zeros(2, from.tau, end);
        for number in 0..=inflections.len() {
            let to = inflections.get(number).map_or_else(&last, |zero| self.knot_at(0, zero));
            let slope_to = self.slope(to.tau, &to.angle.swept);
            let found = if slope * slope_to >= 0.0 {
                find(&from, &to)
            } else {
                self.first_about_extremum((&from, slope), (&to, slope_to), contacts_only, &find)
            };
            if found.is_some() {
                return found;
            }
            (from, slope) = (to, slope_to);
        }
        None
    }

    /// The same between two places with these slopes of other signs, between which dz is convex or concave.
    fn first_about_extremum<T>(
        &self,
        (from, slope): (&Knot, f64),
        (to, slope_to): (&Knot, f64),
        contacts_only: bool,
        find: impl Fn(&Knot, &Knot) -> Option<T>,
    ) -> Option<T> {
        let ahead = if slope > 0.0 { Side::Left } else { Side::Right };
        let behind = if slope > 0.0 { Side::Right } else { Side::Left };
        // Where the tangents meet, dz is farther than it comes.
        let elapsed = (to.value - from.value - slope_to * (to.tau - from.tau)) / (slope - slope_to);
        let farthest = from.value + slope * elapsed;
        let is_open = |side: Side, value: f64| self.room(side) - side.sign() * value > self.rounding(to.tau);
        let turns_back = contacts_only && is_open(ahead, farthest);
        if turns_back && is_open(behind, to.value) {
            return None;
        }
        let sign = slope.signum();
        // Where a straight slope would be zero.
        let guess = from.tau + (to.tau - from.tau) * slope / (slope - slope_to);
        if turns_back {
            // Most contacts on the way back come well after the extremum, which need not be known then, either.
            let late = guess + LATE * (to.tau - guess);
            let late = self.knot(0, late, self.angle(late));
            if sign * self.slope(late.tau, &late.angle.swept) < 0.0 && is_open(behind, late.value) {
                return find(&late, to);
            }
        }
        // Most contacts come well before the extremum, which need not be known then.
        let early = from.tau + EARLY * (guess - from.tau);
        let early = self.knot(0, early, self.angle(early));
        let is_monotone = sign * self.slope(early.tau, &early.angle.swept) > 0.0;
        if is_monotone && let Some(found) = find(from, &early) {
            return Some(found);
        }
        let from = if is_monotone { &early } else { from };
        let tau = short_root_near(guess, from.tau, to.tau, |tau| {
            let [_, slope, curvature, ..] = self.derivatives(tau, &self.angle(tau));
            (sign * slope, sign * curvature)
        });
        let extremum = self.knot_at(0, Zero::new(tau, self.angle(tau).sine));
        find(from, &extremum).or_else(|| find(&extremum, to))
    }
}
