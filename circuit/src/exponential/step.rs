//! One internal step with exponential diodes, and its error.
//!
//! SDIRK4 of Hairer and Wanner (Solving Ordinary Differential Equations II, Table 6.5): five stages, order 4, embedded
//! order 3, L-stable and stiffly accurate. It has no explicit stage, so that a kink of the capacitance between two
//! steps, after which the diode currents jump, costs nothing: every stage is on the new branch.
//!
//! # What the embedded method does not see
//! - An element that begins to conduct before the first stage, in the first quarter of the step: all stages are on one
//!   smooth branch then, the wrong one for that quarter. A probe right after the start takes part in a second estimate.
//! - A steep element that ceases to conduct at the start: it passes some `C N Vt` within nanoseconds that no stage sees.
//!   The step has to resolve them, see [`Exponential::left`].
//!
//! # What it sees and is none
//! Where a steep element conducts, the node is on its branch at the end of any step, and the charge follows from that:
//! transients of nanoseconds need not be resolved. As Hairer and Wanner do (IV.8), the estimate is multiplied by
//! `(1 - gamma h J)^-1`, here of the elements between node and a constant voltage. A load of its own has to be resolved,
//! for its energy does not follow from the charge.

use crate::devices::Devices;
use crate::node_equations::{NodeEquations, Point};
use crate::parameters::Release;

use super::Exponential;

const STAGES: usize = 5;
/// Diagonal coefficient.
const GAMMA: f64 = 0.25;
const NODES: [f64; STAGES] = [0.25, 0.75, 0.55, 0.5, 1.0];
const BELOW: [[f64; STAGES - 1]; STAGES] = [
    [0.0, 0.0, 0.0, 0.0],
    [0.5, 0.0, 0.0, 0.0],
    [17.0 / 50.0, -1.0 / 25.0, 0.0, 0.0],
    [371.0 / 1360.0, -137.0 / 2720.0, 15.0 / 544.0, 0.0],
    [25.0 / 24.0, -49.0 / 48.0, 125.0 / 16.0, -85.0 / 12.0],
];
/// Weights of the method, which are its last row, minus those of the embedded one.
const ERROR: [f64; STAGES] = [-3.0 / 16.0, -27.0 / 32.0, 25.0 / 32.0, 0.0, 0.25];
/// Where the probe is, in steps.
const PROBE: f64 = 1e-3;
/// Weight of the start, extrapolated from probe and first stage, in the second estimate.
const START: f64 = 0.25;
/// Weights of the stages in the second estimate: with [`START`] the other combination that vanishes for solutions of
/// order 3.
const SECOND: [f64; STAGES] = [-0.5, 0.5, 0.0, 0.0, -0.25];
/// How much an estimate may be too small where an element begins to conduct inside the step.
const KINK: f64 = 4.0;
/// Load voltage, in supply voltages, below which the energy of the load is not asked to be accurate by itself.
const SMALL_LOAD: f64 = 1e-2;

/// What flows, or has flowed since the start of the call; also its rate or its error. What leaks is 0, and costs nothing,
/// unless it is of films that do.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Flow<const LEAKS: bool> {
    /// Charges through the charging diodes (C).
    pub drawn: [f64; 2],
    /// Charges through the release elements (C).
    pub released: [f64; 2],
    /// Charges through the films (C).
    pub leaked: [f64; 2],
    /// Energies of the load, the Zener diodes, the other diodes and the films, and work of the mechanics (J).
    pub load: f64,
    pub zener: f64,
    pub diode: f64,
    pub leakage: f64,
    pub mechanical: f64,
}

impl<const LEAKS: bool> Flow<LEAKS> {
    fn add(&mut self, other: &Self, factor: f64) {
        for j in 0..2 {
            self.drawn[j] += factor * other.drawn[j];
            self.released[j] += factor * other.released[j];
        }
        self.load += factor * other.load;
        self.zener += factor * other.zener;
        self.diode += factor * other.diode;
        self.mechanical += factor * other.mechanical;
        if LEAKS {
            self.leaked[0] += factor * other.leaked[0];
            self.leaked[1] += factor * other.leaked[1];
            self.leakage += factor * other.leakage;
        }
    }

    #[inline]
    fn sum(flows: &[Self], weights: [f64; STAGES], h: f64) -> Self {
        let mut sum = Self::default();
        for (flow, weight) in flows.iter().zip(weights) {
            sum.add(flow, h * weight);
        }
        sum
    }
}

/// Result of one internal step.
pub(crate) struct Step<const LEAKS: bool> {
    pub flow: Flow<LEAKS>,
    pub point: Point,
    /// Error estimate over tolerance.
    pub error: f64,
}

/// What errors are relative to.
pub(super) struct Scale {
    /// (C)
    pub charge: f64,
    /// (J)
    pub energy: f64,
    /// Of the load's energy (J).
    pub load: f64,
}

impl<const LEAKS: bool> Exponential<'_, LEAKS> {
    /// One step of `h` seconds from `start`, `elapsed` seconds after the start of the call; `None` where the node
    /// equations are not solved.
    pub fn step(&self, start: &Flow<LEAKS>, guess: &Point, elapsed: f64, h: f64) -> Option<Step<LEAKS>> {
        let probe = self.equations(start, elapsed + PROBE * h, PROBE * h).solve(guess)?;
        let mut rates = [Flow::default(); STAGES];
        let (mut flow, mut point) = (*start, probe);
        let mut top: f64 = 0.0;
        for i in 0..STAGES {
            flow = *start;
            for (rate, weight) in rates[..i].iter().zip(BELOW[i]) {
                flow.add(rate, h * weight);
            }
            point = self.equations(&flow, elapsed + NODES[i] * h, GAMMA * h).solve(&point)?;
            rates[i] = self.rates(&point, elapsed + NODES[i] * h);
            flow.add(&rates[i], h * GAMMA);
            top = top.max(point.load_voltage);
        }
        let mut second = Flow::sum(&rates, SECOND, h);
        second.add(&self.rates(&probe, elapsed + PROBE * h), START * h * GAMMA / (GAMMA - PROBE));
        second.add(&rates[0], -START * h * PROBE / (GAMMA - PROBE));
        let scale = self.scale(start, elapsed, top);
        let damped = |difference: &Flow<LEAKS>| self.damped(difference, &point, elapsed + h, h);
        // The probe may be within the transients: twice for it.
        let error = [damped(&Flow::sum(&rates, ERROR, h)), damped(&damped(&second))]
            .into_iter()
            .map(|error| KINK * self.norm(&error, &scale))
            .fold(self.left(start, &probe, elapsed, h) / scale.charge, larger);
        let error = error / self.solver.relative_tolerance;
        error.is_finite().then_some(Step { flow, point, error })
    }

    /// Node charges when `flow` has flowed (C).
    pub fn charges(&self, flow: &Flow<LEAKS>) -> [f64; 2] {
        [0, 1].map(|j| self.charge[j] + net(flow, j))
    }

    /// Node capacitances `t` seconds after the start of the call (F).
    pub(super) fn capacitances(&self, t: f64) -> [f64; 2] {
        [0, 1].map(|j| self.capacitance[j] + self.rate[j] * t)
    }

    fn equations(&self, flow: &Flow<LEAKS>, t: f64, span: f64) -> NodeEquations<'_> {
        NodeEquations {
            devices: self.devices,
            count: self.count,
            capacitance: self.capacitances(t).map(|c| if LEAKS { c * (1.0 + span * self.devices.leak) } else { c }),
            charge: self.charges(flow),
            span,
            trials: &self.trials,
        }
    }

    /// Currents and powers at a solution of the node equations (A, W), `t` seconds after the start of the call.
    fn rates(&self, point: &Point, t: f64) -> Flow<LEAKS> {
        let (supply, out) = (self.devices.supply, point.load_voltage);
        let mut rates = Flow { drawn: point.supply, released: point.release, ..Flow::default() };
        for j in 0..self.count {
            let (v, drawn, released) = (point.voltage[j], point.supply[j], point.release[j]);
            match self.devices.release {
                Release::Zener => {
                    rates.load += out * released;
                    rates.zener += (v - out) * released;
                }
                Release::Switch => rates.load += v * released,
                Release::Storage => {
                    rates.load += out * released;
                    rates.diode += (v - out) * released;
                }
            }
            rates.diode += (supply - v) * drawn;
            rates.mechanical -= 0.5 * v * v * self.rate[j];
            if LEAKS {
                rates.leaked[j] = self.devices.leak * ((self.capacitance[j] + self.rate[j] * t) * v);
                rates.leakage += v * rates.leaked[j];
            }
        }
        rates
    }

    /// An estimate, without what steep elements take back by the end of the step.
    fn damped(&self, difference: &Flow<LEAKS>, end: &Point, t: f64, h: f64) -> Flow<LEAKS> {
        let mut damped = *difference;
        let capacitances = self.capacitances(t);
        for (j, capacitance) in capacitances.into_iter().enumerate().take(self.count) {
            let (v, span) = (end.voltage[j], GAMMA * h / capacitance);
            let supply = span * self.devices.charging(v).1;
            let release = span * self.devices.holding(v).1;
            let leak = if LEAKS { GAMMA * h * self.devices.leak } else { 0.0 };
            let charge = net(difference, j) / (1.0 + supply + release + leak);
            let (less, more) = (supply * charge, release * charge);
            damped.drawn[j] -= less;
            damped.released[j] += more;
            if LEAKS {
                damped.leaked[j] += leak * charge;
                damped.leakage += v * (leak * charge);
            }
            damped.diode -= (self.devices.supply - v) * less;
            match self.devices.release {
                Release::Zener => {}
                Release::Switch => damped.load += v * more,
                Release::Storage => {
                    damped.load += end.load_voltage * more;
                    damped.diode += (v - end.load_voltage) * more;
                }
            }
        }
        damped
    }

    /// Charge that steep elements which conduct at the start, but no longer at the probe, pass before the first stage
    /// (C), unless the step is short enough to resolve it.
    fn left(&self, start: &Flow<LEAKS>, probe: &Point, elapsed: f64, h: f64) -> f64 {
        let (charge, capacitance) = (self.charges(start), self.capacitances(elapsed));
        let mut left = 0.0;
        for j in 0..self.count {
            for element in [Devices::charging, Devices::holding] {
                let (current, slope) = element(self.devices, charge[j] / capacitance[j]);
                let later = element(self.devices, probe.voltage[j]).1;
                if GAMMA * h * slope > capacitance[j] && GAMMA * h * later < capacitance[j] {
                    left += capacitance[j] * (current / slope).abs();
                }
            }
        }
        left
    }

    /// Charges are relative to `C U_in` or to what is there, if more; energies to that at its voltage; that of the load
    /// to the same charge at the voltage of the load, which may be small.
    pub(super) fn scale(&self, start: &Flow<LEAKS>, elapsed: f64, top: f64) -> Scale {
        let supply = self.devices.supply;
        let (charges, capacitances) = (self.charges(start), self.capacitances(elapsed));
        let mut scale = Scale { charge: 0.0, energy: 0.0, load: 0.0 };
        for j in 0..self.count {
            let charge = charges[j].max(capacitances[j] * supply);
            scale.charge += charge;
            scale.energy += charge * (charge / capacitances[j]);
        }
        scale.load = match self.devices.release {
            Release::Zener => (scale.charge * top.max(SMALL_LOAD * supply)).min(scale.energy),
            Release::Switch | Release::Storage => scale.energy,
        };
        scale
    }

    /// Largest relative component.
    fn norm(&self, error: &Flow<LEAKS>, scale: &Scale) -> f64 {
        let mut largest: f64 = 0.0;
        for j in 0..self.count {
            for charge in [error.drawn[j], error.released[j], net(error, j)] {
                largest = larger(largest, charge / scale.charge);
            }
            if LEAKS {
                largest = larger(largest, error.leaked[j] / scale.charge);
            }
        }
        for energy in [error.zener, error.diode, error.mechanical] {
            largest = larger(largest, energy / scale.energy);
        }
        if LEAKS {
            largest = larger(largest, error.leakage / scale.energy);
        }
        larger(largest, error.load / scale.load)
    }
}

/// Charge that node `j` gains (C).
fn net<const LEAKS: bool>(flow: &Flow<LEAKS>, j: usize) -> f64 {
    let through = flow.drawn[j] - flow.released[j];
    if LEAKS { through - flow.leaked[j] } else { through }
}

/// The larger one in size; NaN must not be lost, as it would be in `f64::max`.
pub(super) fn larger(a: f64, b: f64) -> f64 {
    if b.abs() <= a { a } else { b.abs() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn the_method_is_consistent_and_of_order_four_for_quadratures() {
        let weights: Vec<f64> =
            (0..STAGES).map(|i| if i + 1 == STAGES { GAMMA } else { BELOW[STAGES - 1][i] }).collect();
        for power in 0..4 {
            let sum: f64 = (0..STAGES).map(|i| weights[i] * NODES[i].powi(power)).sum();
            assert_relative_eq!(sum, 1.0 / f64::from(power + 1), max_relative = 1e-13);
        }
        for (row, node) in BELOW.iter().zip(NODES) {
            assert_relative_eq!(row.iter().sum::<f64>() + GAMMA, node, max_relative = 1e-13);
        }
    }

    #[test]
    fn both_estimates_vanish_up_to_order_three() {
        // Sum of weights times nodes^power, and of weights times the stages' own integrals of the nodes.
        for (start, weights) in [(0.0, ERROR), (START, SECOND)] {
            for power in 0..3 {
                let sum: f64 = (0..STAGES).map(|i| weights[i] * NODES[i].powi(power)).sum();
                let at_start = if power == 0 { start } else { 0.0 };
                assert!((sum + at_start).abs() < 1e-13);
            }
            let nested = |i: usize| GAMMA * NODES[i] + (0..i).map(|k| BELOW[i][k] * NODES[k]).sum::<f64>();
            let sum: f64 = (0..STAGES).map(|i| weights[i] * nested(i)).sum();
            assert!(sum.abs() < 1e-13);
        }
    }
}
