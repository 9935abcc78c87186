//! The first event of a flight over a suspended cylinder, on one piece of its power series.
//!
//! A gap, a rate or an acceleration is a polynomial there. It goes into the search for the first fall below zero of a contact,
//! which misses none; the place is then refined with all digits.

use super::{Crossing, End, OUTSIDE};
use crate::motion::mount::Mount;
use crate::motion::side::Side;
use crate::motion::suspended::{Series, derivative, value_and_slope};
use crate::numerics::chebyshev;
use crate::numerics::roots::{bracketed_root, short_root_near};
use crate::paper::gap::gap;

/// A flight on one piece: what it is besides the motion of the cylinder.
#[derive(Debug, Clone, Copy)]
pub struct Leg {
    pub half_travel: f64,
    /// dz at the begin, m, and its rate, m/s.
    pub dz: f64,
    pub rate: f64,
    /// What gravity and friction add to dz'', m/s^2, by the ball's own motion.
    pub relative: f64,
}

/// What bounds say of a piece; most are decided by them.
enum Decision {
    /// dz stays between the membranes.
    Quiet,
    /// It goes straight to one of them, which it meets at this place in [0, 1].
    Contact(Side, f64),
    Doubtful,
}

fn contact_at(side: Side, gap: &Series, place: f64, length: f64) -> End {
    let [_, slope] = value_and_slope(gap, place);
    End::Contact(Crossing { elapsed: place * length, side, speed: (-slope / length).max(0.0) })
}

/// Terms up to this order have control points; those above are a bound.
const LOW: usize = 6;

/// Sums over the terms of a series.
struct Bounds {
    /// The polynomial of the terms up to order [`LOW`] lies between these points, those of Bernstein and Bezier.
    points: [f64; LOW + 1],
    /// What the others add at the end.
    rest: f64,
    /// What they add to the value anywhere, and to the points' steps, at most.
    tail: f64,
    slope_tail: f64,
    /// Sum of the absolute terms.
    size: f64,
}

impl Bounds {
    fn new(terms: &Series) -> Self {
        /// What a term adds to each point, one point more for whole vectors: C(k, n) / C([`LOW`], n).
        const SHARES: [[f64; LOW + 2]; LOW + 1] = shares();
        let mut points = [0.0; LOW + 2];
        for (term, shares) in terms.iter().zip(&SHARES) {
            for (point, share) in points.iter_mut().zip(shares) {
                *point += share * term;
            }
        }
        let low = terms[..=LOW].iter().map(|term| term.abs()).sum::<f64>();
        let (mut rest, mut tail, mut slope_tail) = (0.0, 0.0, 0.0);
        for (n, term) in terms.iter().enumerate().skip(LOW + 1) {
            rest += term;
            tail += term.abs();
            slope_tail += n as f64 / LOW as f64 * term.abs();
        }
        Self { points: core::array::from_fn(|k| points[k]), rest, tail, slope_tail, size: low + tail }
    }
}

const fn shares() -> [[f64; LOW + 2]; LOW + 1] {
    let mut shares = [[0.0; LOW + 2]; LOW + 1];
    let mut k = 0;
    while k <= LOW {
        // C(k, n) / C(LOW, n), one after the other.
        let (mut share, mut n) = (1.0, 0);
        while n <= k {
            shares[n][k] = share;
            share *= (k - n) as f64 / (if n < LOW { LOW - n } else { 1 }) as f64;
            n += 1;
        }
        k += 1;
    }
    shares
}

impl Leg {
    /// How far dz may move towards `side`, m, until the ball meets the membrane.
    #[inline]
    fn room(&self, side: Side) -> f64 {
        gap(self.half_travel, side.sign(), self.dz)
    }

    /// The terms of dz after `tau`, s, but for dz at the start, from those of the cylinder.
    fn terms_of(&self, cylinder: &Series, tau: f64) -> Series {
        let mut terms = *cylinder;
        (terms[0], terms[1]) = (0.0, self.rate * tau);
        terms[2] += 0.5 * self.relative * tau * tau;
        terms
    }

    /// The end of the flight within `length`, s, its first piece, for which these are the terms of the `cylinder`.
    pub fn end(&self, cylinder: &Series, length: f64, slip: f64) -> Option<End> {
        let terms = self.terms_of(cylinder, length);
        match self.decision(&terms, slip) {
            Decision::Quiet => None,
            Decision::Contact(side, place) => Some(contact_at(side, &self.gap(side, &terms), place, length)),
            Decision::Doubtful => self.doubtful_end(&terms, length, slip),
        }
    }

    /// What bounds say of a piece.
    fn decision(&self, terms: &Series, slip: f64) -> Decision {
        let Bounds { points, rest, tail, slope_tail, size } = Bounds::new(terms);
        let steps = core::array::from_fn::<f64, LOW, _>(|k| points[k + 1] - points[k]);
        let rises = steps.iter().all(|step| *step > slope_tail);
        let falls = steps.iter().all(|step| *step < -slope_tail);
        if slip != 0.0 && !(rises && slip > 0.0 || falls && slip < 0.0) {
            return Decision::Doubtful;
        }
        let [left, right] = [Side::Left, Side::Right].map(|side| self.room(side));
        if !rises && !falls {
            let stays = points.iter().all(|point| left - point > tail && right + point > tail);
            return if stays { Decision::Quiet } else { Decision::Doubtful };
        }
        let (side, room) = if rises { (Side::Left, left) } else { (Side::Right, right) };
        if room <= self.rounding_of(size) {
            return Decision::Doubtful;
        }
        let end = room - side.sign() * (points[LOW] + rest);
        if end > 0.0 {
            return Decision::Quiet;
        }
        let gap = self.gap(side, terms);
        let guess = room / (room - end);
        Decision::Contact(side, short_root_near(guess, 0.0, 1.0, |x| value_and_slope(&gap, x).into()))
    }

    /// The same where no bound decides.
    fn doubtful_end(&self, terms: &Series, length: f64, slip: f64) -> Option<End> {
        let turn = if slip == 0.0 { None } else { first_negative(&derivative(terms).map(|term| slip * term)) };
        let rounding = self.rounding_of(terms.iter().map(|term| term.abs()).sum());
        let contact = |side: Side| {
            let gap = self.gap(side, terms);
            let place = first_contact(&gap, rounding, OUTSIDE * self.half_travel)?;
            let [_, slope] = value_and_slope(&gap, place);
            Some(Crossing { elapsed: place * length, side, speed: (-slope / length).max(0.0) })
        };
        let contacts = Side::BOTH.into_iter().filter_map(contact);
        let contact = contacts.min_by(|a, b| a.elapsed.total_cmp(&b.elapsed));
        match (contact, turn.map(|place| place * length)) {
            (Some(crossing), turn) if turn.is_none_or(|turn| crossing.elapsed <= turn) => Some(End::Contact(crossing)),
            (_, Some(elapsed)) => Some(End::Turn { elapsed }),
            _ => None,
        }
    }

    /// When, within `length`, s, the first piece, for which these are the terms of the `cylinder`, the acceleration takes a ball
    /// that the cylinder carries away from `support`, or to any side, against friction.
    pub fn departure(&self, cylinder: &Series, length: f64, (support, mount): (Option<Side>, &Mount)) -> Option<f64> {
        let acceleration = derivative(&derivative(&self.terms_of(cylinder, length)));
        let square = length * length;
        let departure = |side: Side| {
            let mut push = acceleration.map(|term| side.sign() * term);
            let size = push.iter().map(|term| term.abs()).sum::<f64>() / square;
            push[0] += (mount.friction + mount.tolerance(size)) * square;
            first_negative(&push).map(|place| place * length)
        };
        match support {
            Some(side) => departure(side),
            None => Side::BOTH.into_iter().filter_map(departure).min_by(f64::total_cmp),
        }
    }

    /// The gap to the membrane at `side`, m, as a series.
    fn gap(&self, side: Side, terms: &Series) -> Series {
        let mut gap = terms.map(|term| -side.sign() * term);
        gap[0] = self.room(side);
        gap
    }

    /// Rounding error, m, of a gap whose terms have absolute values of this sum.
    fn rounding_of(&self, size: f64) -> f64 {
        8.0 * f64::EPSILON * (self.half_travel + self.dz.abs() + size)
    }
}

/// Where a gap first closes, in [0, 1]. One that is open by less than `outside` below zero at the start counts as closed, or as about
/// to open; what starts farther beyond the membrane must come inside first.
fn first_contact(gap: &Series, rounding: f64, outside: f64) -> Option<f64> {
    if gap[0] >= -outside.max(1e3 * rounding) {
        return first_fall(gap);
    }
    let inside = first_fall(&gap.map(|term| -term))?;
    let from = |place: f64| inside + (1.0 - inside) * place;
    let rest = chebyshev::GRID.fit(&chebyshev::GRID.nodes.map(|x| value_and_slope(gap, from(0.5 * (x + 1.0)))[0]));
    // Where it comes inside it is rounding.
    rest.first_fall(rest.bound().max(rounding / f64::EPSILON)).map(|x| from(0.5 * (x + 1.0)))
}

/// Where a polynomial on [0, 1] is first below zero by more than rounding, as it may be from the begin.
fn first_negative(polynomial: &Series) -> Option<f64> {
    let size: f64 = polynomial.iter().map(|term| term.abs()).sum();
    if polynomial[0] < -16.0 * f64::EPSILON * size { Some(0.0) } else { first_fall(polynomial) }
}

/// Where a polynomial on [0, 1] first falls below zero by more than rounding.
fn first_fall(polynomial: &Series) -> Option<f64> {
    let [start, rest @ ..] = polynomial;
    let change: f64 = rest.iter().map(|term| term.abs()).sum();
    if *start > change {
        return None;
    }
    let values = chebyshev::GRID.nodes.map(|x| value_and_slope(polynomial, 0.5 * (x + 1.0))[0]);
    let place = 0.5 * (1.0 + chebyshev::GRID.fit(&values).first_fall(start.abs() + change)?);
    Some(refined(polynomial, place))
}

/// The root near `place`, to all digits, if the polynomial passes zero there on its way down, else `place` itself.
fn refined(polynomial: &Series, place: f64) -> f64 {
    const WIDTH: f64 = 1e-6;
    let [low, high] = [(place * (1.0 - WIDTH)).max(0.0), (place * (1.0 + WIDTH)).min(1.0)];
    let value = |x: f64| value_and_slope(polynomial, x)[0];
    if low > 0.0 && value(low) > 0.0 && value(high) <= 0.0 {
        return bracketed_root(low, high, |x| value_and_slope(polynomial, x).into());
    }
    place
}
