//! The gap between ball and membranes while the ball is free, and the first contact, which cannot be missed.
//!
//! Under a harmonic force plus a force linear in time, dz = `z_M` - `z_m` is a cubic polynomial minus a cosine, here
//! counted from the start of the flight, so that it keeps its digits where the cylinder swings much farther than the gap.
//! It is searched in windows of one excitation period, counted from the start of the flight and not from the steps of a
//! caller, so that the result does not depend on them. Within a window the zeros of a high derivative are known in
//! closed form; between them the next lower derivative is monotone, its zeros are bracketed, and so on down to the
//! extrema of dz. Between two extrema dz is monotone and meets a membrane at most once. Most flights are simpler than that
//! ([`Flight::simple_contact`]).

pub(super) mod angle;
mod crossing;
mod curved;
pub(super) mod piece;
mod simple;
mod zeros;

use core::f64::consts::TAU;

use self::angle::{Angle, Swept};
use self::zeros::Knot;
use crate::motion::cylinder::{CylinderMotion, CylinderState};
use crate::motion::mount::Mount;
use crate::motion::side::Side;
use crate::numerics::product::cycle_fraction;
use crate::paper::gap::gap;

/// Where the ball meets a membrane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Crossing {
    /// Time since the start of the flight, s.
    pub elapsed: f64,
    /// The membrane that it meets.
    pub side: Side,
    /// Relative speed, m/s, at which it does.
    pub speed: f64,
}

/// How a flight ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum End {
    /// The ball meets a membrane.
    Contact(Crossing),
    /// dz' is zero, `elapsed`, s, after the start, where friction changes.
    Turn {
        /// s.
        elapsed: f64,
    },
}

/// Penetration, in units of s/2, beyond which a ball is outside the gap (a start there) and not on the membrane
/// (rounding).
const OUTSIDE: f64 = 1e-9;

/// Free flight: dz as a function of the time tau since `start`.
///
/// dz = dz0 + tau (w + tau (c2 + tau c3)) + swing (cos a (1 - cos phi) - sin a (phi - sin phi)), where w is the relative
/// velocity and a the angle of the force at the start, and phi = omega tau. Each term is small while tau is: what the ball
/// does between two impacts keeps its digits however far the cylinder swings and however fast both move.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Flight {
    /// Time at which tau = 0, s.
    pub start: f64,
    /// dz at that time, m.
    pub dz: f64,
    /// Its rate at that time, m/s.
    pub rate: f64,
    /// c2, m/s^2, and c3, m/s^3: half and a sixth of external force and rate over M.
    external: [f64; 2],
    swing: f64,
    frequency: f64,
    period: f64,
    /// The angle at the start, in turns, and its sine and cosine.
    turns: f64,
    sine: [f64; 2],
    half_travel: f64,
    /// What gravity and friction add to dz'', m/s^2, by the ball's own motion.
    relative: f64,
    /// Time, s, for which the series of a suspended cylinder holds; infinite if the cylinder is free.
    piece: f64,
}

impl Flight {
    /// Free flight from `start`, when dz and its rate are `dz`, m, and `rate`, m/s, of a ball that has the acceleration
    /// -`relative`, m/s^2.
    pub fn new(
        cylinder: &CylinderMotion,
        start: &CylinderState,
        [dz, rate]: [f64; 2],
        half_travel: f64,
        relative: f64,
    ) -> Self {
        let (drive, swing) = (&cylinder.drive, cylinder.swing);
        // One by one: as a copy of both, sine and cosine would arrive late.
        let CylinderState { time, turns, sine: [sin, cos], .. } = *start;
        let sine = [sin, cos];
        let [external, external_rate] = cylinder.external_at(time);
        let external = [0.5 * (external + relative), external_rate / 6.0];
        let (frequency, period) = (drive.frequency, 1.0 / drive.frequency);
        let piece = cylinder.piece();
        Self { start: time, dz, rate, external, swing, frequency, period, turns, sine, half_travel, relative, piece }
    }

    /// s/2, m.
    pub fn half_travel(&self) -> f64 {
        self.half_travel
    }

    fn omega(&self) -> f64 {
        TAU * self.frequency
    }

    /// Length of a search window, s: one period of the excitation.
    pub fn window_length(&self) -> f64 {
        self.period
    }

    /// Time, s, for which the series of a suspended cylinder holds; none if the cylinder is free.
    pub fn piece(&self) -> Option<f64> {
        (self.piece < f64::INFINITY).then_some(self.piece)
    }

    /// When that ends, s.
    pub fn end_of_series(&self) -> f64 {
        self.start + self.piece
    }

    /// The angle at `tau`, s, in turns.
    fn turns_at(&self, tau: f64) -> f64 {
        self.turns + self.turns_since_start(tau)
    }

    /// The angle passed through since the start, in turns, but for whole ones.
    #[inline]
    fn turns_since_start(&self, tau: f64) -> f64 {
        let turns = self.frequency * tau;
        // Only of many turns the fraction must be formed with care.
        if turns < 4.0 { turns } else { cycle_fraction(self.frequency, tau) }
    }

    /// The angle at `tau`, s.
    #[allow(clippy::inline_always)] // called in the innermost loops, and not inlined everywhere otherwise
    #[inline(always)]
    fn angle(&self, tau: f64) -> Angle {
        Angle::new(self.sine, self.omega() * tau, self.turns_since_start(tau))
    }

    /// The start.
    fn first_knot(&self) -> Knot {
        Knot { tau: 0.0, value: 0.0, angle: Angle { sine: self.sine, swept: Swept::default() } }
    }

    /// What `tau`, s, in which the force passes through this angle, add to dz, m.
    #[inline]
    fn change(&self, tau: f64, swept: &Swept) -> f64 {
        let ([c2, c3], [sin, cos]) = (self.external, self.sine);
        tau * (self.rate + tau * (c2 + tau * c3)) + self.swing * (cos * swept.versine - sin * swept.lag)
    }

    /// The rate of dz, m/s, after `tau`, s, in which the force passes through this angle.
    #[inline]
    fn slope(&self, tau: f64, swept: &Swept) -> f64 {
        let ([c2, c3], [sin, cos]) = (self.external, self.sine);
        let harmonic = self.swing * self.omega() * (cos * swept.sine - sin * swept.versine);
        self.rate + (tau * (2.0 * c2 + tau * 3.0 * c3) + harmonic)
    }

    /// The change of dz since the start, m, and its first seven derivatives at `tau`, s, where the angle is this one.
    #[inline]
    fn derivatives(&self, tau: f64, angle: &Angle) -> [f64; 8] {
        let [c2, c3] = self.external;
        let square = self.omega() * self.omega();
        let [sin, cos] = angle.sine;
        let [sin2, cos2] = [self.swing * self.omega() * square * sin, self.swing * square * cos];
        let [sin4, cos4] = [square * sin2, square * cos2];
        [
            self.change(tau, &angle.swept),
            self.slope(tau, &angle.swept),
            2.0 * c2 + tau * 6.0 * c3 + cos2,
            6.0 * c3 - sin2,
            -cos4,
            sin4,
            square * cos4,
            -square * sin4,
        ]
    }

    /// dz, m, and its rate, m/s, at `tau`, s, over a free cylinder.
    #[inline]
    pub fn at(&self, tau: f64) -> [f64; 2] {
        let Angle { swept, .. } = self.angle(tau);
        [self.dz + self.change(tau, &swept), self.slope(tau, &swept)]
    }

    /// dz, m, and its rate, m/s, at `tau`, s, over a suspended cylinder to which that adds this.
    pub fn after(&self, tau: f64, [farther, faster]: [f64; 2]) -> [f64; 2] {
        let by_ball = self.relative * tau;
        [self.dz + (tau * (self.rate + 0.5 * by_ball) + farther), self.rate + (by_ball + faster)]
    }

    /// The acceleration of dz, m/s^2, at `tau`, s.
    fn acceleration(&self, tau: f64) -> f64 {
        self.derivatives(tau, &self.angle(tau))[2]
    }

    /// Rounding error of a gap near `tau`, m.
    pub fn rounding(&self, tau: f64) -> f64 {
        let [polynomial, harmonic] = self.sizes_of_change(tau);
        8.0 * f64::EPSILON * (self.half_travel + (self.dz.abs() + polynomial) + harmonic)
    }

    /// The same at the start.
    #[inline]
    pub fn rounding_at_start(&self) -> f64 {
        8.0 * f64::EPSILON * (self.half_travel + self.dz.abs())
    }

    /// The same of the change of dz since the start.
    fn rounding_of_change(&self, tau: f64) -> f64 {
        let [polynomial, harmonic] = self.sizes_of_change(tau);
        8.0 * f64::EPSILON * (polynomial + harmonic)
    }

    /// Sizes of the polynomial and the harmonic part of the change of dz from the start to near `tau`, m.
    fn sizes_of_change(&self, tau: f64) -> [f64; 2] {
        let ([c2, c3], phi) = (self.external.map(f64::abs), self.omega() * tau);
        // The harmonic part of the acceleration is at most swing omega^2, that of the rate 2 swing omega.
        let harmonic = self.swing * (0.5 * phi * phi).min(2.0 * phi);
        [tau * (self.rate.abs() + tau * (c2 + tau * c3)), harmonic]
    }

    /// First window, at or after `window`, in which a contact is possible; none if there will never be one.
    ///
    /// Without an external force dz stays within `swing` of a straight line, so that all windows can be passed over in
    /// which the line is farther than that from both membranes.
    pub fn skip(&self, window: u64) -> Option<u64> {
        let [sin, cos] = self.sine;
        let middle = self.dz + self.swing * cos;
        let reach = self.half_travel - self.swing - self.rounding_at_start();
        let [c2, c3] = self.external; // one by one: a comparison of arrays is a call
        if c2 != 0.0 || c3 != 0.0 || middle.abs() >= reach {
            return Some(window);
        }
        let drift = self.rate - self.swing * self.omega() * sin;
        if drift == 0.0 {
            return None;
        }
        let elapsed = (reach - middle * drift.signum()) / drift.abs();
        // Beyond 2^53 windows time itself has no digits left; a ball that slow never arrives.
        let windows = elapsed * self.frequency;
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // bounded by the guard
        (windows < 9.0e15).then(|| window.max((windows as u64).saturating_sub(1)))
    }

    /// The first contact inside window number `window`, which ends at `limit`, s since the start, at the latest.
    #[inline]
    pub fn contact_in_window(&self, window: u64, limit: f64) -> Option<Crossing> {
        self.first_in_window(window, limit, true, |from, to| self.contact_in_piece(from, to))
    }

    /// The first contact, or before it the first place where dz' no longer has the sign `slip`, inside window number `window`,
    /// which ends at `limit`, s since the start, at the latest.
    #[inline(never)] // what a ball without friction does stays small
    pub fn end_in_window(&self, window: u64, limit: f64, slip: f64) -> Option<End> {
        self.first_in_window(window, limit, false, |from, to| self.end_in_piece(from, to, slip))
    }

    /// What `find` finds first in the pieces of window number `window` on which dz is monotone; if it looks for contacts only, where
    /// the ball comes near a membrane.
    #[inline]
    fn first_in_window<T>(
        &self,
        window: u64,
        limit: f64,
        contacts_only: bool,
        find: impl Fn(&Knot, &Knot) -> Option<T>,
    ) -> Option<T> {
        let (begin, end) = self.window_bounds(window, limit);
        let mut from = if begin == 0.0 { self.first_knot() } else { self.knot(0, begin, self.angle(begin)) };
        if contacts_only && end == limit && !self.within_reach(&from, end) {
            return None;
        }
        // After one period the angle is what it was; of many periods the end is not that exact.
        let is_first_period = begin == 0.0 && end == self.period;
        let at_end = || if is_first_period { self.first_knot().angle.after_a_turn() } else { self.angle(end) };
        if self.has_curvature_only() {
            return self.first_between_inflections(from, end, || self.knot(0, end, at_end()), contacts_only, find);
        }
        for zero in self.zeros(1, begin, end).iter() {
            let to = self.knot_at(0, zero);
            let found = find(&from, &to);
            if found.is_some() {
                return found;
            }
            from = to;
        }
        let last = self.knot(0, end, at_end());
        find(&from, &last)
    }

    /// The end in a piece on which dz is monotone: it begins with a turn if it leads back, by more than rounding, as it may where
    /// the ball has just set out.
    #[inline]
    fn end_in_piece(&self, from: &Knot, to: &Knot, slip: f64) -> Option<End> {
        // Not by that of dz itself, however far the ball is: what is left out here is as much of the relative velocity as it took.
        if slip * (to.value - from.value) < -self.rounding_of_change(to.tau) {
            return Some(End::Turn { elapsed: from.tau });
        }
        self.contact_in_piece(from, to).map(End::Contact)
    }

    fn window_bounds(&self, window: u64, limit: f64) -> (f64, f64) {
        let (length, number) = (self.window_length(), window as f64);
        (number * length, ((number + 1.0) * length).min(limit))
    }

    /// False if speed and acceleration are too small to reach a membrane from `begin` to `end`: a quick test that decides
    /// nearly all of the short windows of a force with phase noise.
    fn within_reach(&self, begin: &Knot, end: f64) -> bool {
        let length = end - begin.tau;
        let [c2, c3] = self.external;
        let omega = self.omega();
        let acceleration = 2.0 * c2.abs() + 6.0 * c3.abs() * end + self.swing * omega * omega;
        let speed = self.slope(begin.tau, &begin.angle.swept).abs();
        (self.dz + begin.value).abs() + length * (speed + 0.5 * length * acceleration) + self.rounding(end)
            >= self.half_travel
    }

    /// How far dz may move towards `side`, m, from the start until the ball meets the membrane: nothing, to the last bit, if it
    /// has just left that, so that the lowest bounce keeps its digits.
    #[inline]
    fn room(&self, side: Side) -> f64 {
        gap(self.half_travel, side.sign(), self.dz)
    }

    /// Crossing in a piece on which dz is monotone.
    #[inline]
    fn contact_in_piece(&self, from: &Knot, to: &Knot) -> Option<Crossing> {
        let side = if to.value > from.value { Side::Left } else { Side::Right };
        let [gap_from, gap_to] = [from, to].map(|knot| self.room(side) - side.sign() * knot.value);
        if gap_to > 0.0 || from.value == to.value {
            return None;
        }
        let rounding = self.rounding(from.tau);
        if gap_from > rounding {
            return Some(self.crossing(side, from, to, 0.0));
        }
        // The piece starts on the membrane, to rounding, and presses on. The contact is put where the penetration exceeds
        // rounding, so that time has gone on when the ball is next looked at. A start beyond the membrane is no contact
        // (OutsideGap::Free), and neither is a piece that stays within rounding, as after a release.
        let on_membrane = gap_from > -(OUTSIDE * self.half_travel).max(1e3 * rounding);
        let presses_on = on_membrane && gap_to < -rounding && gap_to < -self.rounding(to.tau);
        presses_on.then(|| self.crossing(side, from, to, rounding))
    }

    /// The first time in window number `window` at which the acceleration takes a ball that the cylinder carries away from
    /// `side`, or to any side, against friction, s since the start.
    pub fn departure_in_window(&self, support: Option<Side>, mount: &Mount, window: u64, limit: f64) -> Option<f64> {
        let departure = |side| self.release_in_window(side, mount, window, limit);
        match support {
            Some(side) => departure(side),
            None => Side::BOTH.into_iter().filter_map(departure).min_by(f64::total_cmp),
        }
    }

    /// The first time in window number `window` from which on the acceleration takes the ball away from `side` against friction, s
    /// since the start.
    fn release_in_window(&self, side: Side, mount: &Mount, window: u64, limit: f64) -> Option<f64> {
        let (begin, end) = self.window_bounds(window, limit);
        // Both bodies have this acceleration: friction holds the ball up to its own, without that of the cylinder.
        let [c2, c3] = self.external;
        let size = self.swing * self.omega() * self.omega() + 2.0 * c2.abs() + 6.0 * c3.abs() * end;
        let hold = mount.friction + mount.tolerance(size);
        let held = Self { external: [c2 + 0.5 * side.sign() * hold, c3], ..*self };
        held.release_without_friction(side, begin, end)
    }

    fn release_without_friction(&self, side: Side, begin: f64, end: f64) -> Option<f64> {
        let zeros = self.zeros(2, begin, end);
        let begins = core::iter::once(begin).chain(zeros.iter().map(|zero| zero.tau));
        let ends = zeros.iter().map(|zero| zero.tau).chain(core::iter::once(end));
        let receding = |&(from, to): &(f64, f64)| side.sign() * self.acceleration(0.5 * (from + to)) < 0.0;
        begins.zip(ends).find(receding).map(|(from, _)| from)
    }
}

#[cfg(test)]
mod tests;
