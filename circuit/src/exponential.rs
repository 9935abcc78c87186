//! Integration of the circuit with exponential diodes: the length of the internal steps, and the ledger.
//!
//! A step itself, with the estimate of its error, is in [`step`]; [`closed`] takes it in closed form where it can.

mod closed;
mod step;

use core::cell::Cell;

use crate::devices::Devices;
use crate::error::{Error, Failure};
use crate::network::Network;
use crate::node_equations::Point;
use crate::parameters::Solver;
use step::Flow;

/// Accepted steps in a row that did not grow, after which a much shorter one is tried. At the edge where an element
/// begins to conduct, a step may end below the edge, where nothing restores it, and the next repeat that for ever at
/// an error just below the tolerance; a step short enough to resolve the edge gets past it.
const PLATEAU: u32 = 32;

/// First steps to begin the next call with, in calls: of most ramps one step is enough, and many shorter ones are only for
/// a transient.
const REMEMBERED: std::ops::Range<f64> = 0.1..0.8;

/// Most trial voltages in one call. Most steps need none; where Newton's method never settles, one takes thousands, and as
/// many of these as there may be steps would take minutes. A fuzzer has less time.
const TRIALS: usize = if cfg!(fuzzing) { 5_000 } else { 2_000_000 };

/// One call of [`Exponential::advance`], with films that leak or without.
pub(crate) struct Exponential<'a, const LEAKS: bool> {
    pub devices: &'a Devices,
    pub solver: &'a Solver,
    /// Number of nodes.
    pub count: usize,
    /// Node charges (C) and capacitances (F) at the start, and the rates of these (F/s).
    pub charge: [f64; 2],
    pub capacitance: [f64; 2],
    pub rate: [f64; 2],
    /// Time at the start, for messages (s).
    pub time: f64,
    /// Trial voltages so far, where Newton's method did not settle.
    pub trials: Cell<usize>,
}

impl<const LEAKS: bool> Exponential<'_, LEAKS> {
    /// Integrates over `dt` seconds; `network` gets charges and ledger, `internal_step` the step to begin the next call
    /// with where that is not the whole call.
    ///
    /// # Errors
    /// [`Error::Integration`] when steps underflow, or are too many or too hard to solve.
    pub fn advance(
        &self,
        network: &mut Network,
        dt: f64,
        internal_step: &mut f64,
        load_voltage: f64,
    ) -> Result<Point, Error> {
        let mut flow = Flow::default();
        let mut point = Point { voltage: network.nodes.map(|node| node.voltage()), load_voltage, ..Point::default() };
        let mut next = if REMEMBERED.contains(&(*internal_step / dt)) { *internal_step } else { dt };
        let (mut elapsed, mut plateau, mut rejected) = (0.0, 0, false);
        for _ in 0..self.solver.maximum_steps {
            if self.trials.get() > TRIALS {
                return Err(self.failed(elapsed, next, Failure::Trials(TRIALS)));
            }
            let last = next >= dt - elapsed;
            let h = if last { dt - elapsed } else { next };
            if h <= 1e-18 * dt || elapsed + h == elapsed {
                return Err(self.failed(elapsed, h, Failure::ErrorEstimate));
            }
            let closed = self.closed(&flow, &point, elapsed, h);
            let Some(step) = closed.or_else(|| self.step(&flow, &point, elapsed, h)) else {
                if h <= 1e-12 * dt {
                    return Err(self.failed(elapsed, h, Failure::NodeEquations));
                }
                next = 0.1 * h;
                continue;
            };
            let proposed = h * (0.9 * step.error.max(f64::MIN_POSITIVE).powf(-0.25)).clamp(0.1, 4.0);
            if step.error > 1.0 {
                next = proposed.min(if rejected { 0.2 * h } else { 0.9 * h });
                rejected = true;
                continue;
            }
            rejected = false;
            flow = step.flow;
            point = step.point;
            if elapsed == 0.0 {
                *internal_step = proposed;
            }
            if last {
                self.record(&flow, network);
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

    /// Adds what has flowed to the charges and the ledger.
    fn record(&self, flow: &Flow<LEAKS>, network: &mut Network) {
        let charges = self.charges(flow);
        for (node, charge) in network.nodes.iter_mut().zip(charges) {
            node.charge = charge;
        }
        let ledger = &mut network.ledger;
        let drawn = flow.drawn[0] + flow.drawn[1];
        ledger.supply_charge += drawn;
        ledger.supply += self.devices.supply * drawn;
        ledger.load_charge += flow.released[0] + flow.released[1];
        ledger.load += flow.load;
        ledger.zener += flow.zener;
        ledger.diode += flow.diode;
        ledger.leakage += flow.leakage;
        ledger.mechanical += flow.mechanical;
    }
}
