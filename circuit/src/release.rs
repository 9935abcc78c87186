//! Closed forms of a node that discharges into the load while its capacitance runs linearly in time.
//!
//! With `C(t) = C0 + k t`, the load behind a fixed drop `U_d` (`U_z` for a Zener, 0 for a closed switch) and
//! `w = V - U_d`, Kirchhoff's law `d(C V)/dt = -w / R` reads in the logarithmic time `tau = ln(C / C0) / k`
//!
//! `dw/dtau = -a w - k U_d`, with `a = k + 1/R`:
//!
//! constant coefficients. In `t` this is the power law `(C / C0)^(-a/k)`, whose cases `k -> 0`, `R k -> 0` and
//! `R k -> -1` are ordinary points here, because only `phi(b) = (1 - exp(-b tau)) / b` appears. With a leak of the film the
//! coefficients are not constant: see [`leaking`](crate::leaking).

use crate::leaking::{Leaking, phi};
use crate::quadrature::{EIGHT, PANEL, SHORT, rule};

/// A node, or two joined ones, releasing charge over a linear ramp of its capacitance.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Discharge {
    /// Capacitance at the start (F).
    pub capacitance: f64,
    /// Its rate `k` (F/s).
    pub rate: f64,
    /// `1/R` (S), finite and above 0.
    pub conductance: f64,
    /// Fixed drop `U_d` between node and load (V).
    pub drop: f64,
    /// Load voltage `w = V - U_d` at the start (V).
    pub excess: f64,
    /// Part of the charge that leaks through the film in a second (1/s), 0 for none.
    pub leak: f64,
}

/// A stretch of time from the start of a [`Discharge`] on.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Span {
    /// Length (s).
    pub t: f64,
    /// The same as logarithmic time (s/F); not worked out with a leak.
    tau: f64,
    /// Load voltage `w` at the end (V).
    pub excess: f64,
}

/// Integrals over a span of a [`Discharge`].
#[derive(Debug, Clone, Copy)]
pub(crate) struct Work {
    /// Energy of the load, `integral w^2 / R dt` (J).
    pub load: f64,
    /// Work of the mechanics, `-integral 1/2 V^2 dC` (J).
    pub mechanical: f64,
    /// Charge that leaked (C).
    pub leaked: f64,
    /// Its energy (J).
    pub leakage: f64,
}

impl Discharge {
    /// Coefficient `a = k + 1/R` of the logarithmic time.
    fn decay(&self) -> f64 {
        self.rate + self.conductance
    }

    /// Logarithmic time `tau` after `t` seconds (s/F).
    fn tau(&self, t: f64) -> f64 {
        let x = self.rate * t / self.capacitance;
        let stretch = if x == 0.0 { 1.0 } else { x.ln_1p() / x };
        t / self.capacitance * stretch
    }

    /// Seconds after the logarithmic time `tau`, the inverse of [`Self::tau`].
    fn time(&self, tau: f64) -> f64 {
        let y = self.rate * tau;
        let stretch = if y == 0.0 { 1.0 } else { y.exp_m1() / y };
        self.capacitance * tau * stretch
    }

    fn excess_at_tau(&self, tau: f64) -> f64 {
        let a = self.decay();
        let pushed = if self.drop == 0.0 { 0.0 } else { self.rate * self.drop * phi(a, tau) };
        self.excess * (-a * tau).exp() - pushed
    }

    /// Capacitance after `t` seconds (F).
    pub fn capacitance_at(&self, t: f64) -> f64 {
        self.capacitance + self.rate * t
    }

    /// The first `t` seconds.
    #[inline]
    pub fn span(&self, t: f64) -> Span {
        if self.leak > 0.0 {
            return Span { t, tau: f64::NAN, excess: self.leaking_excess_at(t) };
        }
        let tau = self.tau(t);
        Span { t, tau, excess: self.excess_at_tau(tau) }
    }

    /// Load voltage `w` after `t` seconds (V).
    #[inline]
    pub fn excess_at(&self, t: f64) -> f64 {
        if self.leak > 0.0 { self.leaking_excess_at(t) } else { self.excess_at_tau(self.tau(t)) }
    }

    #[cold]
    fn leaking_excess_at(&self, t: f64) -> f64 {
        self.leaking().excess_after(self.excess, self.capacitance_at(t), self.bounded_tau(t))
    }

    #[cold]
    fn leaking_slope_at(&self, t: f64) -> f64 {
        let lost = self.leak * self.capacitance_at(t);
        let pull = (self.decay() + lost) * self.excess_at(t) + (self.rate + lost) * self.drop;
        -pull / self.capacitance_at(t)
    }

    /// [`Self::work`] with a leak.
    #[cold]
    pub fn leaking_work(&self, t: f64) -> Work {
        let integrals = self.leaking().integrals(self.excess, self.capacitance, self.bounded_tau(t));
        Work {
            load: self.conductance * integrals.excess_squared,
            mechanical: -0.5 * self.rate * integrals.voltage_squared,
            leaked: self.leak * integrals.charge,
            leakage: self.leak * integrals.energy,
        }
    }

    /// [`Self::tau`] where it is a number. Otherwise from the capacitances at both ends: beside 1e98 F, one of some pF rounds to nothing, and
    /// a time over 1e-314 F overflows.
    fn bounded_tau(&self, t: f64) -> f64 {
        /// The smallest number above 0.
        const LEAST: f64 = f64::from_bits(1);
        let tau = self.tau(t);
        if tau.is_finite() {
            return tau;
        }
        let end = self.capacitance_at(t).max(LEAST);
        ((end.ln() - self.capacitance.ln()) / self.rate).abs().min(f64::MAX)
    }

    fn leaking(&self) -> Leaking {
        Leaking { rate: self.rate, conductance: self.conductance, drop: self.drop, leak: self.leak }
    }

    /// `dw/dt` after `t` seconds (V/s).
    pub fn slope_at(&self, t: f64) -> f64 {
        if self.leak > 0.0 {
            return self.leaking_slope_at(t);
        }
        let a = self.decay();
        // a w + k U_d decays as a whole: forming it from w would cancel near the steady state.
        let initial = a * self.excess + self.rate * self.drop;
        -initial * (-a * self.tau(t)).exp() / self.capacitance_at(t)
    }

    /// `d2w/dt2` after `t` seconds (V/s^2).
    pub fn curvature_at(&self, t: f64) -> f64 {
        -self.slope_at(t) * (self.decay() + self.rate) / self.capacitance_at(t)
    }

    /// When the node voltage falls to `threshold` (at least `U_d`), in seconds from the start, if it does.
    pub fn time_to_fall_to(&self, threshold: f64) -> Option<f64> {
        let a = self.decay();
        let floor = threshold - self.drop;
        // w tends to -k U_d / a when a > 0 and moves away from it otherwise.
        let above = self.excess - floor;
        let pull = a * floor + self.rate * self.drop;
        if pull <= 0.0 {
            return None;
        }
        let x = a * above / pull;
        let stretch = if x == 0.0 { 1.0 } else { x.ln_1p() / x };
        Some(self.time((above / pull * stretch).max(0.0)))
    }

    /// Energies over a span.
    #[inline]
    pub fn work(&self, span: &Span) -> Work {
        if self.leak > 0.0 {
            return self.leaking_work(span.t);
        }
        let tau = span.tau;
        let a_tau = (self.decay() * tau).abs();
        let (load, field) = if self.drop == 0.0 {
            // One exponential: there is nothing to multiply out.
            let square = self.excess * self.excess * phi(self.decay() + self.conductance, tau);
            (square, square)
        } else if a_tau > 4.0 {
            self.squares_split(tau)
        } else {
            self.squares_by_quadrature(tau, 2.0 * a_tau + (self.rate * tau).abs())
        };
        Work {
            load: self.conductance * self.capacitance * load,
            mechanical: -0.5 * self.rate * self.capacitance * field,
            leaked: 0.0,
            leakage: 0.0,
        }
    }

    /// `integral w^2 exp(k tau) dtau` and the same of `V^2`, with `w = A exp(-a tau) + B` multiplied out; `A`
    /// and `B` are harmless where `a tau` is not small.
    fn squares_split(&self, tau: f64) -> (f64, f64) {
        let a = self.decay();
        let steady = -self.rate * self.drop / a;
        let transient = self.excess - steady;
        let fast = phi(a + self.conductance, tau) * transient * transient;
        let mixed = 2.0 * transient * phi(self.conductance, tau);
        let slow = phi(-self.rate, tau);
        // steady + U_d, written without cancellation for a small R.
        let steady_voltage = self.conductance * self.drop / a;
        (fast + steady * (mixed + steady * slow), fast + steady_voltage * (mixed + steady_voltage * slow))
    }

    /// The same integrals by Gauss-Legendre quadrature. `span` is the largest exponent in the integrands; the
    /// rule is exact to rounding for spans of 2, which sets the number of panels.
    fn squares_by_quadrature(&self, tau: f64, span: f64) -> (f64, f64) {
        if span < SHORT {
            return self.squares_on_panel(tau, 0.5 * tau, rule(span));
        }
        let mut panels = 1.0;
        while span > PANEL * panels {
            panels += 1.0;
        }
        let half = 0.5 * tau / panels;
        let mut sums = (0.0, 0.0);
        let mut panel = 0.0;
        while panel < panels {
            let centre = (2.0 * panel + 1.0) * half;
            let squares = self.squares_on_panel(2.0 * half, centre, &EIGHT);
            sums.0 += squares.0;
            sums.1 += squares.1;
            panel += 1.0;
        }
        sums
    }

    /// The same over one panel, from its length, its centre, and nodes and weights of a rule.
    fn squares_on_panel(&self, length: f64, centre: f64, rule: &[(f64, f64)]) -> (f64, f64) {
        let half = 0.5 * length;
        let mut sums = (0.0, 0.0);
        for (x, weight) in rule {
            for s in [centre - x * half, centre + x * half] {
                let w = self.excess_at_tau(s);
                let v = w + self.drop;
                let scale = weight * half * (self.rate * s).exp();
                sums.0 += scale * w * w;
                sums.1 += scale * v * v;
            }
        }
        sums
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    fn discharge(rate: f64, resistance: f64, drop: f64, voltage: f64) -> Discharge {
        Discharge { capacitance: 30e-12, rate, conductance: 1.0 / resistance, drop, excess: voltage - drop, leak: 0.0 }
    }

    #[test]
    fn a_constant_capacitance_gives_the_exponential_of_rc() {
        let d = discharge(0.0, 1e9, 2000.0, 2100.0);
        assert_relative_eq!(d.excess_at(0.03), 100.0 * (-1.0_f64).exp(), max_relative = 1e-14);
        let energy = 0.5 * 30e-12 * 1e4 * (1.0 - (-2.0_f64).exp());
        assert_relative_eq!(d.work(&d.span(0.03)).load, energy, max_relative = 1e-13);
    }

    #[test]
    fn both_ways_to_integrate_agree_where_they_meet() {
        for (rate, resistance, drop) in
            [(-1e-10, 1e9, 2000.0), (-1e-10, 1e9, 0.0), (2e-10, 2e8, 2000.0), (-1e-9, 3e8, 2000.0)]
        {
            let d = discharge(rate, resistance, drop, 2300.0);
            let tau = 4.0 / d.decay().abs();
            let split = d.squares_split(tau);
            let quadrature = d.squares_by_quadrature(tau, 8.0 + (rate * tau).abs());
            assert_relative_eq!(split.0, quadrature.0, max_relative = 1e-12);
            assert_relative_eq!(split.1, quadrature.1, max_relative = 1e-12);
        }
    }

    #[test]
    fn a_short_span_and_a_node_without_a_drop_take_less_work_for_the_same_integrals() {
        for (rate, drop) in [(-1e-10, 2000.0), (2e-9, 2000.0), (-4e-9, 1500.0), (-1e-10, 0.0), (3e-9, 0.0)] {
            let d = discharge(rate, 1e9, drop, 2300.0);
            for part in [1e-3, 0.3, 0.999] {
                let tau = part * SHORT / (2.0 * d.decay().abs() + rate.abs());
                let (load, field) = d.squares_on_panel(tau, 0.5 * tau, &EIGHT);
                let t = d.time(tau);
                let work = d.work(&d.span(t));
                let scale = d.conductance * d.capacitance;
                assert_relative_eq!(work.load, scale * load, max_relative = 2e-14);
                assert_relative_eq!(work.mechanical, -0.5 * rate * d.capacitance * field, max_relative = 2e-14);
            }
        }
    }

    #[test]
    fn the_power_law_is_smooth_through_its_removable_singularities() {
        let (t, resistance) = (0.01, 1e9);
        for singular in [0.0, -1.0 / resistance] {
            let at = discharge(singular, resistance, 2000.0, 2100.0);
            for offset in [1e-9, -1e-9] {
                let near = discharge(singular + offset / resistance, resistance, 2000.0, 2100.0);
                assert_relative_eq!(at.excess_at(t), near.excess_at(t), max_relative = 1e-7);
                assert_relative_eq!(at.work(&at.span(t)).load, near.work(&near.span(t)).load, max_relative = 1e-7);
            }
        }
    }

    #[test]
    fn slope_and_curvature_are_the_derivatives() {
        let d = discharge(-3e-10, 4e8, 2000.0, 2050.0);
        let (t, h) = (0.01, 1e-5);
        let slope = (d.excess_at(t + h) - d.excess_at(t - h)) / (2.0 * h);
        let curvature = (d.slope_at(t + h) - d.slope_at(t - h)) / (2.0 * h);
        assert_relative_eq!(d.slope_at(t), slope, max_relative = 1e-6);
        assert_relative_eq!(d.curvature_at(t), curvature, max_relative = 1e-6);
    }

    #[test]
    fn the_fall_to_the_threshold_is_met_on_time_or_never() {
        let zener = discharge(1e-10, 1e9, 2000.0, 2010.0);
        let t = zener.time_to_fall_to(2000.0).unwrap();
        assert!(zener.excess_at(t).abs() < 1e-9);
        let switch = discharge(-1e-10, 1e9, 0.0, 2100.0);
        let t = switch.time_to_fall_to(2000.0).unwrap();
        assert_relative_eq!(switch.excess_at(t), 2000.0, max_relative = 1e-13);
        assert_eq!(discharge(-1e-10, 1e9, 2000.0, 2010.0).time_to_fall_to(2000.0), None);
        assert_eq!(discharge(-2e-9, 1e9, 0.0, 2010.0).time_to_fall_to(2000.0), None);
    }

    #[test]
    fn extreme_loads_stay_finite() {
        for resistance in [1e-250, 1e-3, 1e250] {
            for rate in [-1e-10, 0.0, 1e-10] {
                let d = discharge(rate, resistance, 2000.0, 2000.5);
                let work = d.work(&d.span(0.1));
                assert!(d.excess_at(0.1).is_finite() && work.load.is_finite());
                assert!(work.mechanical.is_finite());
            }
        }
    }
}
