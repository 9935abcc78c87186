//! What leaks through the films between ideal elements, at the rate `l`, and when these switch meanwhile: each root inside
//! the step, none missed. All of it is `cold`, so that circuits without leakage keep their speed.
//!
//! A node that nothing feeds holds `Q exp(-l t)`. All nodes leak at one rate, so that the difference of the charges of a
//! blocked node and a leader changes its sign as without a leak; what the supply and a Zener diode hold does not.

use crate::network::{NOISE, Network, SETTLED};
use crate::release::Discharge;
use crate::roots::{Curve, bracketed, first_descent};
use crate::state::{Mode, Node};

impl Network {
    /// [`Network::drift`] with a leak.
    #[cold]
    pub fn leaking_drift(&self, j: usize) -> f64 {
        let node = &self.nodes[j];
        let drift = node.rate + self.elements.leak * node.capacitance;
        // In balance the capacitance falls, and the leak is about to lose.
        if drift.abs() <= SETTLED * node.rate.abs() { SETTLED * node.rate } else { drift }
    }

    /// Books what leaks in `t` seconds from a node at a constant voltage, which its element replaces.
    #[cold]
    pub fn leak_held(&mut self, j: usize, t: f64, end: f64) {
        let node = &self.nodes[j];
        let leaked = |voltage: f64| self.elements.leak * t * voltage * (0.5 * (node.capacitance + end));
        match node.mode {
            Mode::Charging => {
                let (supply, charge) = (self.elements.supply, leaked(self.elements.supply));
                self.ledger.supply_charge += charge;
                self.ledger.supply += supply * charge;
                self.ledger.leakage += supply * charge;
            }
            Mode::Holding => {
                let charge = leaked(self.elements.threshold);
                self.ledger.leakage += self.elements.threshold * charge;
                self.release_at_threshold(-charge);
            }
            Mode::Off | Mode::Releasing => {}
        }
    }

    /// A node that nothing feeds loses charge by leakage alone.
    #[cold]
    pub fn decay(&mut self, j: usize, t: f64, end: f64) {
        let leak = self.elements.leak;
        let node = &mut self.nodes[j];
        let alone = Discharge {
            capacitance: node.capacitance,
            rate: node.rate,
            conductance: 0.0,
            drop: 0.0,
            excess: node.voltage(),
            leak,
        };
        let work = alone.leaking_work(t);
        node.charge *= (-leak * t).exp();
        node.capacitance = end;
        self.ledger.mechanical += work.mechanical;
        self.ledger.leakage += work.leakage;
    }

    /// By how much less than a load takes leaking nodes have to press on its switches for these to hold them (S).
    #[cold]
    pub fn margin(&self) -> f64 {
        let rates: f64 = self.in_mode(Mode::Holding).map(|j| self.nodes[j].rate.abs()).sum();
        SETTLED * (self.elements.conductance + rates)
    }

    /// When a node that nothing feeds falls to `voltage`, within `span` seconds.
    #[cold]
    pub fn time_to_leak_to(&self, node: &Node, voltage: f64, span: f64) -> Option<f64> {
        self.time_to_cross(node, voltage, 1.0, span)
    }

    /// When a node that nothing feeds rises to `voltage`, within `span` seconds.
    #[cold]
    pub fn time_to_rise_to(&self, node: &Node, voltage: f64, span: f64) -> Option<f64> {
        if node.rate < 0.0 { self.time_to_cross(node, voltage, -1.0, span) } else { None }
    }

    /// When `sign (Q exp(-l t) - U C)` falls through zero; its slope is monotone.
    fn time_to_cross(&self, node: &Node, voltage: f64, sign: f64, span: f64) -> Option<f64> {
        let leak = self.elements.leak;
        let charge = |t: f64| node.charge * (-leak * t).exp();
        Curve {
            value: |t: f64| {
                let level = voltage * (node.capacitance + node.rate * t);
                (sign * (charge(t) - level), level)
            },
            slopes: |t: f64| {
                let lost = leak * charge(t);
                (-sign * (lost + voltage * node.rate), sign * leak * lost)
            },
            inflection: f64::INFINITY,
        }
        .first_descent(span, NOISE)
    }

    /// When the charging diode of node `j` ceases to conduct, within `span` seconds: the capacitance falls too quickly for
    /// the leak, `k + l C = 0`.
    #[cold]
    pub fn time_to_leave(&self, j: usize, span: f64) -> Option<f64> {
        let (rate, drift) = (self.nodes[j].rate, self.drift(j));
        if rate < 0.0 && drift > 0.0 { time_to_lose(drift, self.elements.leak * -rate, span) } else { None }
    }

    /// When duty-cycled switches cannot hold their nodes any longer, within `span` seconds: the less capacitance is left,
    /// the less leaks.
    #[cold]
    pub fn time_to_overrun(&self, span: f64) -> Option<f64> {
        let falling: f64 = self.in_mode(Mode::Holding).map(|j| -self.nodes[j].rate).sum();
        if self.elements.short() || falling <= 0.0 {
            return None;
        }
        time_to_lose(self.elements.conductance - self.pressure(), self.elements.leak * falling, span)
    }

    /// [`Self::time_to_meet`](Network) with a leak: `h = C_j V_leader - Q_j`, where `h exp(l t)` has the slope of
    /// [`Self::crossings`].
    #[cold]
    pub fn time_to_meet_leaking(&self, j: usize, leader: &Discharge, span: f64) -> Option<f64> {
        let (node, leak) = (self.nodes[j], self.elements.leak);
        let capacitance = |t: f64| node.capacitance + node.rate * t;
        let value = |t: f64| {
            let level = capacitance(t) * (leader.drop + leader.excess_at(t));
            (level - node.charge * (-leak * t).exp(), level)
        };
        let slope = |t: f64| {
            let voltage = leader.drop + leader.excess_at(t);
            let charge = node.charge * (-leak * t).exp();
            node.rate * voltage + capacitance(t) * leader.slope_at(t) + leak * charge
        };
        let turns = self.crossings(j, leader, span);
        first_descent(value, slope, turns.into_iter().flatten().chain([span]), NOISE)
    }

    /// [`Self::time_to_block`](Network) with a leak.
    #[cold]
    pub fn time_to_block_leaking(&self, j: usize, pair: &Discharge, span: f64) -> Option<f64> {
        let value = |t: f64| self.share(j, pair, t);
        let slope = |t: f64| self.share_slope(j, pair, t);
        first_descent(value, slope, self.parts(j, pair, span), NOISE)
    }

    /// Slope of [`Network::share`] (A F/s).
    fn share_slope(&self, j: usize, discharge: &Discharge, t: f64) -> f64 {
        let (node, g) = (&self.nodes[j], discharge.conductance);
        let capacitance = node.capacitance + node.rate * t;
        let slope = discharge.slope_at(t);
        g * (node.rate * discharge.excess_at(t) + capacitance * slope) + self.relative_lead(j, discharge) * slope
    }

    /// `C k_j - C_j k` with negative sign, of node `j` and the whole discharge (F^2/s): [`Network::lead`] where the two
    /// nodes are joined.
    fn relative_lead(&self, j: usize, discharge: &Discharge) -> f64 {
        let node = &self.nodes[j];
        node.capacitance * discharge.rate - discharge.capacitance * node.rate
    }

    /// Zeros of `f = C_j w / R + V lead`, in order, at most one in each of the [`Self::parts`].
    fn crossings(&self, j: usize, discharge: &Discharge, span: f64) -> [Option<f64>; 3] {
        let (node, lead) = (self.nodes[j], self.relative_lead(j, discharge));
        let value = |t: f64| {
            let w = discharge.excess_at(t);
            (node.capacitance + node.rate * t) * w * discharge.conductance + (w + discharge.drop) * lead
        };
        let slope = |t: f64| {
            let w_slope = discharge.slope_at(t);
            let own = node.rate * discharge.excess_at(t) + (node.capacitance + node.rate * t) * w_slope;
            own * discharge.conductance + w_slope * lead
        };
        let mut zeros = [None; 3];
        let mut from = 0.0;
        for (zero, to) in zeros.iter_mut().zip(self.parts(j, discharge, span)) {
            if value(from) * value(to) < 0.0 {
                *zero = Some(bracketed(|t| (value(t), slope(t)), from, to, 0.5 * (from + to)));
            }
            from = to;
        }
        zeros
    }

    /// Ends of the parts of the span, in order, on each of which `f` has one zero at most.
    ///
    /// `f` is zero where `z = C_j w / V` has the value `z* = -lead R`. There `C_j dz/dt = k_j (2 z* - C_j) - l C_j (C_j - z*)`:
    /// between two roots of this, `z` passes `z*` in one direction only.
    fn parts(&self, j: usize, discharge: &Discharge, span: f64) -> impl Iterator<Item = f64> {
        let (node, leak, g) = (&self.nodes[j], self.elements.leak, discharge.conductance);
        let (lead, c) = (self.relative_lead(j, discharge), node.capacitance);
        // In terms of C_j over that at the start.
        let mut inside = quadratic([2.0 * lead * node.rate, (node.rate * g + leak * lead) * c, leak * g * c * c])
            .map(|relative| quotient((relative - 1.0) * c, node.rate))
            .map(|t| Some(t).filter(|t| *t > 0.0 && *t < span));
        inside.sort_by(|a, b| a.unwrap_or(span).total_cmp(&b.unwrap_or(span)));
        inside.into_iter().flatten().chain([span])
    }
}

/// Seconds within `span` after which nothing is left of `size`, which shrinks at `rate`.
fn time_to_lose(size: f64, rate: f64, span: f64) -> Option<f64> {
    // Compared as a product: a quotient by nothing is no number.
    (size < rate * span).then(|| size / rate)
}

/// Roots of `a x^2 + b x + c`, from `[c, b, a]`; NaN for those that are not real.
fn quadratic(coefficients: [f64; 3]) -> [f64; 2] {
    let size = coefficients.into_iter().fold(0.0, |size: f64, it| size.max(it.abs()));
    let [c, b, a] = coefficients.map(|it| quotient(it, size));
    let discriminant = b * b - 4.0 * a * c;
    if discriminant.is_nan() || discriminant < 0.0 {
        return [f64::NAN; 2];
    }
    let larger = -0.5 * (b + discriminant.sqrt().copysign(b));
    [quotient(larger, a), quotient(c, larger)]
}

/// A quotient that is a number, or NaN without a division.
fn quotient(a: f64, b: f64) -> f64 {
    if a.abs() < 1e300 * b.abs() { a / b } else { f64::NAN }
}

impl Discharge {
    /// [`Discharge::time_to_fall_to`] with a leak, within `span` seconds. The voltage falls through `threshold` only while
    /// `pull` is above 0, which ends at most once, and falls all that time.
    #[cold]
    pub fn time_to_leak_to(&self, threshold: f64, span: f64) -> Option<f64> {
        let floor = threshold - self.drop;
        let pull =
            (self.rate + self.conductance) * floor + self.rate * self.drop + self.leak * self.capacitance * threshold;
        let size = self.conductance * floor + self.rate.abs() * threshold;
        let falls = self.rate < 0.0;
        if falls && pull <= SETTLED * size {
            return None;
        }
        let held = if falls { time_to_lose(pull, self.leak * threshold * -self.rate, span) } else { None };
        let end = held.unwrap_or(span);
        if self.excess_at(end) >= floor {
            return None;
        }
        Some(bracketed(|t| (self.excess_at(t) - floor, self.slope_at(t)), 0.0, end, 0.5 * end))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn a_quadratic_has_its_roots_to_the_last_bits_whatever_their_sizes() {
        let [a, b] = quadratic([1.0, -1e8, 1.0]);
        assert_relative_eq!(a, 1e8, max_relative = 1e-15);
        assert_relative_eq!(b, 1e-8, max_relative = 1e-15);
        assert_eq!(quadratic([-12e-200, 2e-200, 2e-200]), [-3.0, 2.0]);
        assert!(quadratic([1.0, 0.0, 1.0])[0].is_nan());
        let [a, b] = quadratic([-3.0, 2.0, 0.0]);
        assert!(a.is_nan() && b == 1.5);
        assert!(quadratic([0.0; 3])[1].is_nan());
    }
}
