//! A node that leaks through its film while its capacitance runs linearly in time, with or without a load behind it.
//!
//! A film whose resistivity times permittivity is `T` has the conductance `C / T` beside its capacitance, and with
//! `l = 1 / T` Kirchhoff's law `d(C V)/dt = -w / R - l C V`, `w = V - U_d`, reads in the logarithmic time of
//! [`Discharge`](crate::release::Discharge)
//!
//! `dw/dtau = -(a + l C) w - (k + l C) U_d`, with `a = k + 1/R`:
//!
//! its solution is an integral of `exp(-a tau - l t)`, an incomplete gamma function in general. The integrals here are
//! Gauss-Legendre sums over pieces on which no exponent changes by more than 2: exact to rounding, as the closed forms
//! without a leak are.

use crate::quadrature::{PANEL, rule};

/// Exponents beyond this leave nothing that rounding would keep.
const FORGOTTEN: f64 = 45.0;

/// `(1 - exp(-b tau)) / b`, without cancellation where `b tau` is small or zero.
pub(crate) fn phi(b: f64, tau: f64) -> f64 {
    let x = b * tau;
    if x == 0.0 {
        tau
    } else if x.abs() < 1e300 {
        -(-x).exp_m1() / b
    } else {
        1.0 / b
    }
}

/// The elements around the node.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Leaking {
    /// Rate `k` of the capacitance (F/s).
    pub rate: f64,
    /// `1/R` of the load (S), finite; 0 without one.
    pub conductance: f64,
    /// Fixed drop `U_d` between node and load (V).
    pub drop: f64,
    /// `l` (1/s), above 0.
    pub leak: f64,
}

/// Integrals over a span.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Integrals {
    /// `integral w^2 dt` (V^2 s).
    pub excess_squared: f64,
    /// `integral V^2 dt` (V^2 s).
    pub voltage_squared: f64,
    /// `integral C V dt` (C s).
    pub charge: f64,
    /// `integral C V^2 dt` (J s).
    pub energy: f64,
}

/// Integrates over `[from, from + length]`, where exponents change by `change` at most: `f` gets places and weights.
fn quadrature(from: f64, length: f64, change: f64, mut f: impl FnMut(f64, f64)) {
    let half = 0.5 * length;
    for (x, weight) in rule(change) {
        f(from + half * (1.0 - x), weight * half);
        f(from + half * (1.0 + x), weight * half);
    }
}

/// The shorter of `rest` and the length over which an exponent that changes at most at `rate` changes by [`PANEL`].
fn panel(rest: f64, rate: f64) -> f64 {
    // Compared as a product: the quotient of a rate near 0 would overflow.
    if rate * rest <= PANEL { rest } else { PANEL / rate }
}

impl Leaking {
    /// Coefficient `a` (S).
    fn decay(&self) -> f64 {
        self.rate + self.conductance
    }

    /// `l C` after the logarithmic time `tau` (S).
    fn conductance_after(&self, capacitance: f64, tau: f64) -> f64 {
        self.leak * (capacitance * (self.rate * tau).exp())
    }

    /// The length of a panel of at most `rest`, on which exponents change at `steady` plus that of the leak. `backwards`
    /// from where the capacitance is `capacitance`, or forwards.
    fn panel(&self, rest: f64, steady: f64, capacitance: f64, backwards: bool) -> f64 {
        let near = self.leak * capacitance;
        let length = panel(rest, steady + near);
        let far = self.conductance_after(capacitance, if backwards { -length } else { length });
        if far > near { panel(length, steady + far) } else { length }
    }

    /// `w` after the logarithmic time `tau`, which begins with `excess` and ends with `capacitance`.
    pub fn excess_after(&self, excess: f64, capacitance: f64, tau: f64) -> f64 {
        let a = self.decay();
        // Seconds from `back` before the end to the end are C phi(k, back).
        let exponent = |back: f64| a * back + self.leak * (capacitance * phi(self.rate, back));
        let own = excess * (-exponent(tau)).exp();
        if self.drop == 0.0 {
            return own;
        }
        let (mut sum, mut back) = (0.0, 0.0);
        while back < tau && exponent(back) < FORGOTTEN {
            let present = capacitance * (-self.rate * back).exp();
            let length = self.panel(tau - back, a.abs() + self.rate.abs(), present, true);
            let most = present.max(present * (-self.rate * length).exp());
            let change = length * (a.abs() + 2.0 * self.rate.abs() + self.leak * most);
            quadrature(back, length, change, |x, weight| {
                let pull = self.rate + self.conductance_after(capacitance, -x);
                sum += weight * pull * (-exponent(x)).exp();
            });
            if back + length == back {
                break;
            }
            back += length;
        }
        own - self.drop * sum
    }

    /// Integrals over the logarithmic time `tau`, which begins with `excess` and `capacitance`.
    pub fn integrals(&self, excess: f64, capacitance: f64, tau: f64) -> Integrals {
        let mut sums = Integrals::default();
        let (a, k) = (self.decay(), self.rate.abs());
        let (mut at, mut excess, mut capacitance, mut exponent) = (0.0, excess, capacitance, 0.0);
        while at < tau {
            // What is left of the start may change quickly; the rest follows the capacitance.
            let length = if exponent < FORGOTTEN {
                self.panel(tau - at, a.abs() + k, capacitance, false)
            } else {
                panel(tau - at, PANEL * k)
            };
            let end = capacitance * (self.rate * length).exp();
            // The square of an excess, with up to three factors of the capacitance.
            let change = length * (2.0 * (a.abs() + self.leak * capacitance.max(end)) + 3.0 * k);
            quadrature(0.0, length, change, |x, weight| {
                let present = capacitance * (self.rate * x).exp();
                let w = self.excess_after(excess, present, x);
                let v = w + self.drop;
                // dt = C dtau
                let weight = weight * present;
                sums.excess_squared += weight * w * w;
                sums.voltage_squared += weight * v * v;
                sums.charge += weight * present * v;
                sums.energy += weight * present * v * v;
            });
            if at + length == at {
                break;
            }
            at += length;
            exponent += a * length + self.leak * (end * phi(self.rate, length));
            excess = self.excess_after(excess, end, length);
            capacitance = end;
        }
        sums
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    const C: f64 = 30e-12;

    /// Logarithmic time of `t` seconds.
    fn tau(rate: f64, t: f64) -> f64 {
        if rate == 0.0 { t / C } else { (rate * t / C).ln_1p() / rate }
    }

    #[test]
    fn a_node_without_a_load_loses_its_charge_with_the_time_constant() {
        for rate in [-1e-10, 0.0, 3e-10] {
            let leaking = Leaking { rate, conductance: 0.0, drop: 0.0, leak: 20.0 };
            let (t, end) = (0.1, C + rate * 0.1);
            let voltage = leaking.excess_after(2000.0, end, tau(rate, t));
            assert_relative_eq!(voltage, 2000.0 * C / end * (-2.0_f64).exp(), max_relative = 1e-14);
            let integrals = leaking.integrals(2000.0, C, tau(rate, t));
            assert_relative_eq!(integrals.charge, 2000.0 * C / 20.0 * (1.0 - (-2.0_f64).exp()), max_relative = 1e-13);
        }
    }

    #[test]
    fn a_constant_capacitance_gives_exponentials_however_long_the_span() {
        // V tends to g U_d / (g + l C).
        let (g, leak, drop, v0) = (1e-9, 10.0, 2000.0, 2500.0);
        let leaking = Leaking { rate: 0.0, conductance: g, drop, leak };
        let whole = g + leak * C;
        let steady = g * drop / whole;
        for t in [1e-6, 1e-3, 0.03, 0.3, 3.0, 300.0] {
            let decayed = (-whole / C * t).exp();
            let v = steady + (v0 - steady) * decayed;
            let found = leaking.excess_after(v0 - drop, C, t / C);
            assert_relative_eq!(found, v - drop, max_relative = 1e-12, epsilon = 1e-10);
            let charge = C * (steady * t + (v0 - steady) * C / whole * -(-whole / C * t).exp_m1());
            assert_relative_eq!(leaking.integrals(v0 - drop, C, t / C).charge, charge, max_relative = 1e-12);
        }
    }

    #[test]
    fn the_charge_that_enters_the_node_is_what_the_integrals_say() {
        // d(CV) = -g w dt - l C V dt, and d(C V^2 / 2) = -g w V dt - l C V^2 dt - k V^2 / 2 dt.
        for (rate, conductance, leak, drop) in [
            (-1e-10, 1e-9, 3.0, 2000.0),
            (-2.9e-9, 1e-9, 3.0, 2000.0),
            (-1e-10, 1e-4, 300.0, 2000.0),
            (-1e-10, 1e-9, 1e5, 0.0),
            (4e-9, 1e-12, 1e3, 2000.0),
            (-2.5e-9, 2.4e-9, 80.0, 2000.0),
        ] {
            let leaking = Leaking { rate, conductance, drop, leak };
            let excess = 300.0;
            for t in [0.01, 1e-3, 1e-4, 1e-5] {
                let (end, span) = (C + rate * t, tau(rate, t));
                let v = [excess, leaking.excess_after(excess, end, span)].map(|w| w + drop);
                let found = leaking.integrals(excess, C, span);
                let passed = C * v[0] - end * v[1] - leak * found.charge;
                // g w V = g w^2 + U_d g w
                let spent = conductance * found.excess_squared + drop * passed + leak * found.energy;
                let work = -0.5 * rate * found.voltage_squared;
                let stored = 0.5 * (end * v[1] * v[1] - C * v[0] * v[0]);
                assert_relative_eq!(work, stored + spent, max_relative = 1e-11, epsilon = 1e-12 * C * v[0] * v[0]);
            }
        }
    }
}
