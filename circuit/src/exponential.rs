//! Integration of the circuit with exponential diodes.
//!
//! The states are the node charges, the ledger is integrated beside them. SDIRK4 of Hairer and Wanner (Solving
//! Ordinary Differential Equations II, Table 6.5): five stages, order 4, embedded order 3, L-stable and stiffly
//! accurate. It has no explicit stage, so that a kink of the capacitance between two steps, after which the diode
//! currents jump, costs nothing: every stage is on the new branch.

use crate::devices::Devices;
use crate::error::{Error, Failure};
use crate::ledger::Ledger;
use crate::network::Network;
use crate::parameters::{Release, Solver};
use crate::stage::{Point, Stage};

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

/// Accepted steps in a row that did not grow, after which a much shorter one is tried. At the edge where an element
/// begins to conduct, a step may end below the edge, where nothing restores it, and the next repeat that for ever at
/// an error just below the tolerance; a step short enough to resolve the edge gets past it.
const PLATEAU: u32 = 32;

/// Charges of the nodes, then the integrals of the ledger.
type Vector = [f64; 9];

/// One call of [`Exponential::advance`].
pub(crate) struct Exponential<'a> {
    pub devices: &'a Devices,
    pub solver: &'a Solver,
    /// Number of nodes.
    pub count: usize,
    /// Node capacitances at the start (F) and their rates (F/s).
    pub capacitance: [f64; 2],
    pub rate: [f64; 2],
    /// Time at the start, for messages (s).
    pub time: f64,
}

/// Result of one internal step.
struct Step {
    values: Vector,
    point: Point,
    /// Error estimate over tolerance.
    error: f64,
}

impl Exponential<'_> {
    /// Integrates over `dt` seconds; `network` gets charges and ledger, `internal_step` the step to begin the next call
    /// with: that begins with a kink of the capacitance, too, and after a kink the first step is the shortest.
    ///
    /// # Errors
    /// [`Error::Integration`] when steps underflow or are too many.
    pub fn advance(
        &self,
        network: &mut Network,
        dt: f64,
        internal_step: &mut f64,
        load_voltage: f64,
    ) -> Result<Point, Error> {
        let mut values = pack(network);
        let mut point = Point { voltage: network.nodes.map(|node| node.voltage()), load_voltage, ..Point::default() };
        let mut next = if *internal_step > 0.0 { *internal_step } else { dt };
        let (mut elapsed, mut plateau, mut first) = (0.0, 0, true);
        for _ in 0..self.solver.maximum_steps {
            let last = next >= dt - elapsed;
            let h = if last { dt - elapsed } else { next };
            if h <= 1e-18 * dt || elapsed + h == elapsed {
                return Err(self.failed(elapsed, h, Failure::ErrorEstimate));
            }
            let Some(step) = self.step(&values, &point, elapsed, h) else {
                if h <= 1e-12 * dt {
                    return Err(self.failed(elapsed, h, Failure::NodeEquations));
                }
                next = 0.1 * h;
                continue;
            };
            let proposed = h * (0.9 * step.error.powf(-0.25)).clamp(0.1, 4.0);
            if step.error > 1.0 {
                next = proposed.min(0.9 * h);
                continue;
            }
            values = step.values;
            point = step.point;
            if first {
                // A step cut short by the end of the call says nothing against a longer one.
                *internal_step = if last { proposed.max(next) } else { proposed };
                first = false;
            }
            if last {
                unpack(&values, network);
                return Ok(point);
            }
            next = proposed;
            elapsed += h;
            plateau = if proposed < 1.5 * h { plateau + 1 } else { 0 };
            if plateau == PLATEAU {
                (plateau, next) = (0, 0.01 * next);
            }
        }
        Err(self.failed(elapsed, next, Failure::Steps(self.solver.maximum_steps)))
    }

    fn failed(&self, elapsed: f64, step: f64, failure: Failure) -> Error {
        Error::Integration { time: self.time + elapsed, step, failure }
    }

    fn step(&self, start: &Vector, guess: &Point, elapsed: f64, h: f64) -> Option<Step> {
        let mut slopes = [[0.0; 9]; STAGES];
        let mut values = *start;
        let mut point = *guess;
        for i in 0..STAGES {
            values = *start;
            for (slope, weight) in slopes[..i].iter().zip(BELOW[i]) {
                add(&mut values, slope, h * weight);
            }
            let t = elapsed + NODES[i] * h;
            let stage = Stage {
                devices: self.devices,
                count: self.count,
                capacitance: [0, 1].map(|j| self.capacitance[j] + self.rate[j] * t),
                charge: [values[0], values[1]],
                span: GAMMA * h,
            };
            point = stage.solve(&point)?;
            slopes[i] = self.slope(&point);
            add(&mut values, &slopes[i], h * GAMMA);
        }
        let mut difference = [0.0; 9];
        for (slope, weight) in slopes.iter().zip(ERROR) {
            add(&mut difference, slope, h * weight);
        }
        let error = self.norm(&difference);
        error.is_finite().then_some(Step { values, point, error })
    }

    /// Rates of charges and ledger at a solution of the node equations.
    fn slope(&self, point: &Point) -> Vector {
        let (supply, out) = (self.devices.supply, point.load_voltage);
        let mut slope = [0.0; 9];
        for j in 0..self.count {
            let (v, drawn, released) = (point.voltage[j], point.supply[j], point.release[j]);
            slope[j] = drawn - released;
            slope[2] += supply * drawn;
            match self.devices.release {
                Release::Zener => {
                    slope[3] += out * released;
                    slope[4] += (v - out) * released;
                }
                Release::Switch => slope[3] += v * released,
                Release::Storage => {
                    slope[3] += out * released;
                    slope[5] += (v - out) * released;
                }
            }
            slope[5] += (supply - v) * drawn;
            slope[6] -= 0.5 * v * v * self.rate[j];
            slope[7] += drawn;
            slope[8] += released;
        }
        slope
    }

    /// Largest component, charges relative to `C U_in` and energies to `C U_in^2`, over the tolerance.
    fn norm(&self, difference: &Vector) -> f64 {
        let charge = self.capacitance.iter().sum::<f64>() * self.devices.supply;
        let energy = charge * self.devices.supply;
        let relative = |i: usize| {
            let scale = if (2..7).contains(&i) { energy } else { charge };
            difference[i].abs() / scale
        };
        // NaN must not be lost, as it would be in f64::max.
        let largest = (0..9).map(relative).fold(0.0, |a: f64, b| if b <= a { a } else { b });
        largest / self.solver.relative_tolerance
    }
}

fn add(sum: &mut Vector, term: &Vector, factor: f64) {
    for (s, t) in sum.iter_mut().zip(term) {
        *s += factor * t;
    }
}

fn pack(network: &Network) -> Vector {
    let [first, second] = network.nodes.map(|node| node.charge);
    let l = &network.ledger;
    [first, second, l.supply, l.load, l.zener, l.diode, l.mechanical, l.supply_charge, l.load_charge]
}

fn unpack(values: &Vector, network: &mut Network) {
    network.nodes[0].charge = values[0];
    network.nodes[1].charge = values[1];
    network.ledger = Ledger {
        supply: values[2],
        load: values[3],
        zener: values[4],
        diode: values[5],
        mechanical: values[6],
        supply_charge: values[7],
        load_charge: values[8],
        stored: network.ledger.stored,
    };
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
        for power in 0..3 {
            let sum: f64 = (0..STAGES).map(|i| ERROR[i] * NODES[i].powi(power)).sum();
            assert!(sum.abs() < 1e-13);
        }
        for (row, node) in BELOW.iter().zip(NODES) {
            assert_relative_eq!(row.iter().sum::<f64>() + GAMMA, node, max_relative = 1e-13);
        }
    }
}
