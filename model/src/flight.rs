//! The gap between ball and membranes while the ball is free, and the first contact, which cannot be missed.
//!
//! Under a harmonic force plus a force linear in time, dz = `z_M` - `z_m` is a cubic polynomial minus a cosine. It is
//! searched in windows of one excitation period, counted from the start of the flight and not from the steps of a
//! caller, so that the result does not depend on them. Within a window the zeros of a high derivative are known in
//! closed form; between them the next lower derivative is monotone, its zeros are bracketed, and so on down to the
//! extrema of dz. Between two extrema dz is monotone and meets a membrane at most once.

use core::f64::consts::{FRAC_PI_2, PI, TAU};

use crate::cylinder::{CylinderMotion, cycle_fraction};

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
    angle: f64,
    half_travel: f64,
}

/// At most a few instants in increasing order: zeros of a derivative inside a window.
#[derive(Debug, Clone, Copy, Default)]
struct Instants {
    times: [f64; 8],
    len: usize,
}

impl Instants {
    fn push(&mut self, time: f64) {
        if self.len < self.times.len() {
            self.times[self.len] = time;
            self.len += 1;
        }
    }

    fn as_slice(&self) -> &[f64] {
        &self.times[..self.len]
    }

    /// The pieces into which the instants cut the window from `begin` to `end`.
    fn pieces(&self, begin: f64, end: f64) -> impl Iterator<Item = (f64, f64)> {
        let starts = core::iter::once(begin).chain(self.as_slice().iter().copied());
        let ends = self.as_slice().iter().copied().chain(core::iter::once(end));
        starts.zip(ends)
    }
}

impl Flight {
    /// Flight from `start`, s, where `z_M` - `z_m` is `dz`, m, of a ball with constant `velocity`, m/s, in a cylinder that
    /// moves as `cylinder` says; the membranes are `half_travel` = s/2, m, away from the middle.
    pub fn new(cylinder: &CylinderMotion, start: f64, dz: f64, velocity: f64, half_travel: f64) -> Self {
        let drive = &cylinder.drive;
        let omega = drive.omega();
        let swing = drive.amplitude / (omega * omega);
        let angle = drive.angle(start);
        let external = drive.external + drive.external_rate * (start - cylinder.start);
        let coefficients = [
            dz + swing * angle.cos(),
            cylinder.velocity(start) - velocity - swing * omega * angle.sin(),
            external / 2.0,
            drive.external_rate / 6.0,
        ];
        Self { start, dz, coefficients, swing, frequency: drive.frequency, angle, half_travel }
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
        1.0 / self.frequency
    }

    /// Derivative number `order` (0 to 3) of dz at `tau`, s.
    pub fn derivative(&self, order: usize, tau: f64) -> f64 {
        let [c0, c1, c2, c3] = self.coefficients;
        let omega = self.omega();
        let (sin, cos) = (self.angle + TAU * cycle_fraction(self.frequency, tau)).sin_cos();
        match order {
            0 => c0 + tau * (c1 + tau * (c2 + tau * c3)) - self.swing * cos,
            1 => c1 + tau * (2.0 * c2 + tau * 3.0 * c3) + self.swing * omega * sin,
            2 => 2.0 * c2 + tau * 6.0 * c3 + self.swing * omega * omega * cos,
            _ => 6.0 * c3 - self.swing * omega * omega * omega * sin,
        }
    }

    /// Gap to the membrane at `side`, m; negative when the ball is beyond it.
    fn gap(&self, side: Side, tau: f64) -> f64 {
        self.half_travel - side.sign() * self.derivative(0, tau)
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
        let elapsed = (reach - c0 * c1.signum()) / c1.abs();
        // Beyond 2^53 windows time itself has no digits left; a ball that slow never arrives.
        let windows = elapsed * self.frequency;
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // bounded by the guard
        (windows < 9.0e15).then(|| window.max((windows as u64).saturating_sub(1)))
    }

    /// The first contact inside window number `window`, which ends at `limit`, s since the start, at the latest.
    pub fn contact_in_window(&self, window: u64, limit: f64) -> Option<Contact> {
        let (begin, end) = self.window_bounds(window, limit);
        if !self.within_reach(begin, end) {
            return None;
        }
        self.zeros(1, begin, end).pieces(begin, end).find_map(|(from, to)| self.contact_in_piece(from, to))
    }

    fn window_bounds(&self, window: u64, limit: f64) -> (f64, f64) {
        let length = self.window_length();
        (window as f64 * length, ((window + 1) as f64 * length).min(limit))
    }

    /// False if speed and acceleration are too small to reach a membrane between `begin` and `end`: a quick test that
    /// decides nearly all of the short windows of a force with phase noise.
    fn within_reach(&self, begin: f64, end: f64) -> bool {
        let length = end - begin;
        let [.., c2, c3] = self.coefficients;
        let omega = self.omega();
        let acceleration = 2.0 * c2.abs() + 6.0 * c3.abs() * end + self.swing * omega * omega;
        let farthest =
            self.derivative(0, begin).abs() + length * (self.derivative(1, begin).abs() + 0.5 * length * acceleration);
        farthest + self.rounding(end) >= self.half_travel
    }

    /// Contact in a piece on which dz is monotone.
    fn contact_in_piece(&self, from: f64, to: f64) -> Option<Contact> {
        let slope = self.derivative(1, 0.5 * (from + to));
        if slope == 0.0 {
            return None;
        }
        let side = if slope > 0.0 { Side::Left } else { Side::Right };
        let (gap_from, gap_to) = (self.gap(side, from), self.gap(side, to));
        if gap_to > 0.0 {
            return None;
        }
        let rounding = self.rounding(to);
        let gap = |tau| (self.gap(side, tau), -side.sign() * self.derivative(1, tau));
        if gap_from > rounding {
            return Some(Contact { elapsed: bracketed_root(from, to, gap), side });
        }
        // The piece starts on the membrane, to rounding, and presses on. The contact is put where the penetration exceeds
        // rounding, so that time has gone on when the ball is next looked at. A start beyond the membrane is no contact
        // (OutsideGap::Free), and neither is a piece that stays within rounding, as after a release.
        let on_membrane = gap_from > -(OUTSIDE * self.half_travel).max(1e3 * rounding);
        (on_membrane && gap_to < -rounding).then(|| {
            let beyond = |tau| (gap(tau).0 + rounding, gap(tau).1);
            Contact { elapsed: bracketed_root(from, to, beyond), side }
        })
    }

    /// The first time in window number `window` from which on the acceleration no longer presses the ball against
    /// `side`, s since the start.
    pub fn release_in_window(&self, side: Side, window: u64, limit: f64) -> Option<f64> {
        let (begin, end) = self.window_bounds(window, limit);
        let receding = |&(from, to): &(f64, f64)| side.sign() * self.derivative(2, 0.5 * (from + to)) < 0.0;
        self.zeros(2, begin, end).pieces(begin, end).find(receding).map(|(from, _)| from)
    }

    /// Zeros of derivative number `order` strictly between `begin` and `end`.
    fn zeros(&self, order: usize, begin: f64, end: f64) -> Instants {
        let [.., c2, c3] = self.coefficients;
        let constant = match order {
            1 => c2 == 0.0 && c3 == 0.0,
            2 => c3 == 0.0,
            _ => true,
        };
        if constant {
            return self.harmonic_zeros(order, begin, end);
        }
        let mut zeros = Instants::default();
        for (from, to) in self.zeros(order + 1, begin, end).pieces(begin, end) {
            let (value_from, value_to) = (self.derivative(order, from), self.derivative(order, to));
            if value_from.signum() != value_to.signum() {
                let sign = value_from.signum();
                zeros.push(bracketed_root(from, to, |tau| {
                    (sign * self.derivative(order, tau), sign * self.derivative(order + 1, tau))
                }));
            }
        }
        zeros
    }

    /// Zeros of a derivative whose polynomial part is constant: sin(angle + shift) = level, two in a period.
    fn harmonic_zeros(&self, order: usize, begin: f64, end: f64) -> Instants {
        let [_, c1, c2, c3] = self.coefficients;
        let omega = self.omega();
        let (level, shift) = match order {
            1 => (-c1 / (self.swing * omega), 0.0),
            2 => (-2.0 * c2 / (self.swing * omega * omega), FRAC_PI_2),
            _ => (6.0 * c3 / (self.swing * omega * omega * omega), 0.0),
        };
        let mut zeros = Instants::default();
        if level.is_nan() || level.abs() > 1.0 {
            return zeros; // the constant outweighs the harmonic part, or both are zero
        }
        let at_begin = self.angle + TAU * cycle_fraction(self.frequency, begin) + shift;
        let first = level.asin();
        let mut times = [first, PI - first].map(|angle| {
            let turns = (angle - at_begin) / TAU;
            begin + (turns - turns.floor()) * self.window_length()
        });
        times.sort_by(f64::total_cmp);
        times.into_iter().filter(|&time| time > begin && time < end).for_each(|time| zeros.push(time));
        zeros
    }
}

/// Root of a monotone `function` (value and slope) that is positive at `low` and not at `high`: Newton's method, with
/// bisection wherever it would leave the bracket.
pub(crate) fn bracketed_root(low: f64, high: f64, function: impl Fn(f64) -> (f64, f64)) -> f64 {
    const MAX_ITERATIONS: u32 = 200; // bisection alone needs at most some 110 to exhaust the digits of a double
    let (mut low, mut high) = (low, high);
    let mut x = 0.5 * (low + high);
    for _ in 0..MAX_ITERATIONS {
        let (value, slope) = function(x);
        if value > 0.0 {
            low = x;
        } else {
            high = x;
        }
        let newton = x - value / slope;
        let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
        let converged = (next - x).abs() <= f64::EPSILON * x.abs();
        x = next;
        if converged || high - low <= f64::EPSILON * high.abs() {
            break;
        }
    }
    x
}
