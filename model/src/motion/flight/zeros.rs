//! Zeros of the derivatives of dz inside a window.

use core::f64::consts::TAU;

use super::{Angle, Flight};
use crate::numerics::elementary::fraction;
use crate::numerics::roots::bracketed_root;

/// A place of a flight, an end of a window or a zero of a derivative, and what the next lower derivative is there.
#[derive(Debug, Clone, Copy)]
pub(super) struct Knot {
    /// Time since the start of the flight, s.
    pub(super) tau: f64,
    /// The lower derivative: the change of dz since the start, m, where the slope is zero.
    pub(super) value: f64,
    pub(super) angle: Angle,
}

/// Where a derivative is zero.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Zero {
    /// Time since the start of the flight, s.
    pub(super) tau: f64,
    /// Sine and cosine of the angle there.
    sine: [f64; 2],
}

impl Zero {
    /// A zero at `tau`, s, where the angle has this sine and cosine.
    pub(super) fn new(tau: f64, sine: [f64; 2]) -> Self {
        Self { tau, sine }
    }
}

/// Zeros in increasing order. A constant plus a harmonic function has two in a period; by Rolle's theorem each lower
/// derivative has at most one more than the one above.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Zeros {
    list: [Zero; 4],
    len: usize,
}

impl Zeros {
    fn push(&mut self, zero: Zero) {
        if self.len < self.list.len() {
            self.list[self.len] = zero;
            self.len += 1;
        }
    }

    pub(super) fn len(&self) -> usize {
        self.len
    }

    pub(super) fn get(&self, number: usize) -> Option<Zero> {
        self.list[..self.len].get(number).copied()
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = Zero> {
        self.list[..self.len].iter().copied()
    }
}

impl Flight {
    /// The place at `tau`, s, where the angle is this one, with derivative number `order`.
    #[allow(clippy::inline_always)] // the order is known where it is called, and little is left
    #[inline(always)]
    pub(super) fn knot(&self, order: usize, tau: f64, angle: Angle) -> Knot {
        let value = match order {
            0 => self.change(tau, &angle.swept),
            1 => self.slope(tau, &angle.swept),
            _ => self.derivatives(tau, &angle)[order],
        };
        Knot { tau, value, angle }
    }

    /// The place of a `zero`, with derivative number `order`.
    #[inline]
    pub(super) fn knot_at(&self, order: usize, Zero { tau, sine }: Zero) -> Knot {
        let phi = self.omega() * tau;
        // Of a small angle, what has been passed through would lose its digits.
        let angle = if phi < Angle::SMALL { self.angle(tau) } else { Angle::known(self.sine, sine, phi) };
        self.knot(order, tau, angle)
    }

    /// Zeros of derivative number `order` strictly between `begin` and `end`.
    #[inline] // the order is known where it is called: half of what follows falls away
    pub(super) fn zeros(&self, order: usize, begin: f64, end: f64) -> Zeros {
        let [c2, c3] = self.external;
        let constant = match order {
            1 => c3 == 0.0 && c2 == 0.0,
            2 => c3 == 0.0,
            _ => true,
        };
        if constant { self.harmonic_zeros(order, begin, end) } else { self.zeros_between(order, begin, end) }
    }

    /// The zeros lie between those of the next higher derivative, where this one changes its sign.
    fn zeros_between(&self, order: usize, begin: f64, end: f64) -> Zeros {
        let mut zeros = Zeros::default();
        let mut from = self.knot(order, begin, self.angle(begin));
        let last = self.knot(order, end, self.angle(end));
        let turns = self.zeros(order + 1, begin, end);
        for to in turns.iter().map(|zero| self.knot_at(order, zero)).chain(core::iter::once(last)) {
            // A zero at the begin itself is none in between.
            let sign = if from.value == 0.0 { to.value.signum() } else { from.value.signum() };
            if sign != to.value.signum() {
                let tau = bracketed_root(from.tau, to.tau, |tau| {
                    let derivatives = self.derivatives(tau, &self.angle(tau));
                    (sign * derivatives[order], sign * derivatives[order + 1])
                });
                zeros.push(Zero { tau, sine: self.angle(tau).sine });
            }
            from = to;
        }
        zeros
    }

    /// Zeros of a derivative whose polynomial part is constant: sine or cosine have a given value twice in a period.
    #[inline]
    fn harmonic_zeros(&self, order: usize, begin: f64, end: f64) -> Zeros {
        if self.swing == 0.0 {
            return Zeros::default(); // a constant alone
        }
        let ([c2, c3], omega) = (self.external, self.omega());
        let (level, is_cosine) = match order {
            1 => (self.sine[0] - self.rate / (self.swing * omega), false),
            2 => (-2.0 * c2 / (self.swing * omega * omega), true),
            _ => (6.0 * c3 / (self.swing * omega * omega * omega), false),
        };
        let mut zeros = Zeros::default();
        if level.is_nan() || level.abs() > 1.0 {
            return zeros; // the constant outweighs the harmonic part
        }
        let first = level.asin() * (1.0 / TAU);
        // cos x is the sine of an angle that is ahead by a quarter of a turn.
        let at_begin = self.turns_at(begin) + if is_cosine { 0.25 } else { 0.0 };
        let other = ((1.0 - level) * (1.0 + level)).sqrt();
        let mut both = [(first, other), (0.5 - first, -other)].map(|(turns, other)| Zero {
            tau: begin + fraction(turns - at_begin) * self.window_length(),
            sine: if is_cosine { [-other, level] } else { [level, other] },
        });
        if both[1].tau < both[0].tau {
            both.swap(0, 1);
        }
        both.into_iter().filter(|zero| zero.tau > begin && zero.tau < end).for_each(|zero| zeros.push(zero));
        zeros
    }
}
