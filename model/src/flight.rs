//! The gap between ball and membranes while the ball is free, and the first contact, which cannot be missed.
//!
//! Under a harmonic force plus a force linear in time, dz = `z_M` - `z_m` is a cubic polynomial minus a cosine. It is
//! searched in windows of one excitation period, counted from the start of the flight and not from the steps of a
//! caller, so that the result does not depend on them. Within a window the zeros of a high derivative are known in
//! closed form; between them the next lower derivative is monotone, its zeros are bracketed, and so on down to the
//! extrema of dz. Between two extrema dz is monotone and meets a membrane at most once.

mod crossing;
mod zeros;

pub(crate) use self::zeros::bracketed_root;

use core::f64::consts::TAU;

use self::zeros::Knot;
use crate::cylinder::{CylinderMotion, CylinderState, cycle_fraction};
use crate::elementary::sin_cos;

/// End of the cylinder.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// The end that the ball meets at `z_M` - `z_m` = +s/2.
    Left,
    /// The end that the ball meets at `z_M` - `z_m` = -s/2.
    Right,
}

impl Side {
    /// Sign of `z_M` - `z_m` at this end.
    pub fn sign(self) -> f64 {
        match self {
            Self::Left => 1.0,
            Self::Right => -1.0,
        }
    }

    /// 0 for left, 1 for right.
    pub fn index(self) -> usize {
        match self {
            Self::Left => 0,
            Self::Right => 1,
        }
    }
}

/// Where the ball meets a membrane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    /// Time since the start of the flight, s.
    pub elapsed: f64,
    /// The membrane that it meets.
    pub side: Side,
}

/// Penetration, in units of s/2, beyond which a ball is outside the gap (a start there) and not on the membrane
/// (rounding).
const OUTSIDE: f64 = 1e-9;

/// dz = c0 + c1 tau + c2 tau^2 + c3 tau^3 - swing cos(angle + omega tau), tau counted from `start`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Flight {
    /// Time at which tau = 0, s.
    pub start: f64,
    /// dz at that time, m.
    pub dz: f64,
    coefficients: [f64; 4],
    swing: f64,
    frequency: f64,
    period: f64,
    /// The angle at the start, in turns, and its sine and cosine.
    turns: f64,
    sine: [f64; 2],
    half_travel: f64,
}

impl Flight {
    /// Free flight from `start`, when dz is `dz`, m, and the ball has this `velocity`, m/s.
    pub fn new(cylinder: &CylinderMotion, start: &CylinderState, dz: f64, velocity: f64, half_travel: f64) -> Self {
        let (drive, swing) = (&cylinder.drive, cylinder.swing());
        let CylinderState { time, turns, sine, .. } = *start;
        let external = drive.external + drive.external_rate * (time - cylinder.start);
        let coefficients = [
            dz + swing * sine[1],
            start.velocity - velocity - swing * drive.omega() * sine[0],
            external / 2.0,
            drive.external_rate / 6.0,
        ];
        let (frequency, period) = (drive.frequency, 1.0 / drive.frequency);
        Self { start: time, dz, coefficients, swing, frequency, period, turns, sine, half_travel }
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

    /// The angle at `tau`, s, in turns.
    fn turns_at(&self, tau: f64) -> f64 {
        let turns = self.frequency * tau;
        // Only of many turns the fraction must be formed with care.
        self.turns + if turns < 4.0 { turns } else { cycle_fraction(self.frequency, tau) }
    }

    /// Sine and cosine of the angle at `tau`, s.
    fn sine_at(&self, tau: f64) -> [f64; 2] {
        sin_cos(4.0 * self.turns_at(tau))
    }

    /// dz, m, at `tau`, s, where the angle has this sine and cosine.
    #[inline]
    fn value(&self, tau: f64, [_, cos]: [f64; 2]) -> f64 {
        let [c0, c1, c2, c3] = self.coefficients;
        c0 + tau * (c1 + tau * (c2 + tau * c3)) - self.swing * cos
    }

    /// dz, m, and its first seven derivatives at `tau`, s, where the angle has this sine and cosine.
    #[inline]
    fn derivatives(&self, tau: f64, [sin, cos]: [f64; 2]) -> [f64; 8] {
        let [c0, c1, c2, c3] = self.coefficients;
        let omega = self.omega();
        let square = omega * omega;
        let [sin, cos] = [self.swing * omega * sin, self.swing * cos];
        let [sin2, cos2] = [square * sin, square * cos];
        let [sin4, cos4] = [square * sin2, square * cos2];
        [
            c0 + tau * (c1 + tau * (c2 + tau * c3)) - cos,
            c1 + tau * (2.0 * c2 + tau * 3.0 * c3) + sin,
            2.0 * c2 + tau * 6.0 * c3 + cos2,
            6.0 * c3 - sin2,
            -cos4,
            sin4,
            square * cos4,
            -square * sin4,
        ]
    }

    /// Derivative number `order` (0 to 7) of dz at `tau`, s.
    pub fn derivative(&self, order: usize, tau: f64) -> f64 {
        self.derivatives(tau, self.sine_at(tau))[order]
    }

    /// Rounding error of a gap near `tau`, m.
    pub fn rounding(&self, tau: f64) -> f64 {
        let [c0, c1, c2, c3] = self.coefficients.map(f64::abs);
        8.0 * f64::EPSILON * (self.half_travel + self.swing + c0 + tau * (c1 + tau * (c2 + tau * c3)))
    }

    /// First window, at or after `window`, in which a contact is possible; none if there will never be one.
    ///
    /// Without an external force dz stays within `swing` of a straight line, so that all windows can be passed over in
    /// which the line is farther than that from both membranes.
    pub fn skip(&self, window: u64) -> Option<u64> {
        let [c0, c1, c2, c3] = self.coefficients;
        let reach = self.half_travel - self.swing - self.rounding(0.0);
        if c2 != 0.0 || c3 != 0.0 || c0.abs() >= reach {
            return Some(window);
        }
        if c1 == 0.0 {
            return None;
        }
        let elapsed = (reach - c0 * c1.signum()) / c1.abs();
        // Beyond 2^53 windows time itself has no digits left; a ball that slow never arrives.
        let windows = elapsed * self.frequency;
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // bounded by the guard
        (windows < 9.0e15).then(|| window.max((windows as u64).saturating_sub(1)))
    }

    /// The first contact inside window number `window`, which ends at `limit`, s since the start, at the latest.
    pub fn contact_in_window(&self, window: u64, limit: f64) -> Option<Contact> {
        let (begin, end) = self.window_bounds(window, limit);
        let mut from = if begin == 0.0 {
            Knot { tau: 0.0, value: self.dz, sine: self.sine }
        } else {
            self.knot(0, begin, self.sine_at(begin))
        };
        if end == limit && !self.within_reach(&from, end) {
            return None;
        }
        for to in self.zeros(1, begin, end).iter() {
            let contact = self.contact_in_piece(&from, &to);
            if contact.is_some() {
                return contact;
            }
            from = to;
        }
        // After one period the angle is what it was; of many periods the end is not that exact.
        let is_first_period = begin == 0.0 && end == self.period;
        let last = self.knot(0, end, if is_first_period { self.sine } else { self.sine_at(end) });
        self.contact_in_piece(&from, &last)
    }

    fn window_bounds(&self, window: u64, limit: f64) -> (f64, f64) {
        let length = self.window_length();
        (window as f64 * length, ((window + 1) as f64 * length).min(limit))
    }

    /// False if speed and acceleration are too small to reach a membrane from `begin` to `end`: a quick test that decides
    /// nearly all of the short windows of a force with phase noise.
    fn within_reach(&self, begin: &Knot, end: f64) -> bool {
        let length = end - begin.tau;
        let [.., c2, c3] = self.coefficients;
        let omega = self.omega();
        let acceleration = 2.0 * c2.abs() + 6.0 * c3.abs() * end + self.swing * omega * omega;
        let speed = self.derivatives(begin.tau, begin.sine)[1].abs();
        begin.value.abs() + length * (speed + 0.5 * length * acceleration) + self.rounding(end) >= self.half_travel
    }

    /// Contact in a piece on which dz is monotone.
    fn contact_in_piece(&self, from: &Knot, to: &Knot) -> Option<Contact> {
        let side = if to.value > from.value { Side::Left } else { Side::Right };
        let [gap_from, gap_to] = [from, to].map(|knot| self.half_travel - side.sign() * knot.value);
        if gap_to > 0.0 || from.value == to.value {
            return None;
        }
        let rounding = self.rounding(to.tau);
        if gap_from > rounding {
            return Some(Contact { elapsed: self.crossing(side, from, to, 0.0), side });
        }
        // The piece starts on the membrane, to rounding, and presses on. The contact is put where the penetration exceeds
        // rounding, so that time has gone on when the ball is next looked at. A start beyond the membrane is no contact
        // (OutsideGap::Free), and neither is a piece that stays within rounding, as after a release.
        let on_membrane = gap_from > -(OUTSIDE * self.half_travel).max(1e3 * rounding);
        let presses_on = on_membrane && gap_to < -rounding;
        presses_on.then(|| Contact { elapsed: self.crossing(side, from, to, rounding), side })
    }

    /// The first time in window number `window` from which on the acceleration no longer presses the ball against
    /// `side`, s since the start.
    pub fn release_in_window(&self, side: Side, window: u64, limit: f64) -> Option<f64> {
        let (begin, end) = self.window_bounds(window, limit);
        let zeros = self.zeros(2, begin, end);
        let begins = core::iter::once(begin).chain(zeros.iter().map(|knot| knot.tau));
        let ends = zeros.iter().map(|knot| knot.tau).chain(core::iter::once(end));
        let receding = |&(from, to): &(f64, f64)| side.sign() * self.derivative(2, 0.5 * (from + to)) < 0.0;
        begins.zip(ends).find(receding).map(|(from, _)| from)
    }
}

#[cfg(test)]
mod tests;
