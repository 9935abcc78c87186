//! Energies and charges from the time points of ngspice.
//!
//! Currents are summed by the trapezoidal rule over ngspice's own points. The change of a node's charge C V equals the
//! charge that has flowed in less the charge that has flowed out. What leaks through a film follows from C and V. So the error of the rule where a current jumps is known,
//! and the flows take it in proportion to the change of their currents. Integrators within the netlist would have tolerances
//! of their own and would weigh in the control of the step.

use videg_circuit::{CircuitSample, Ledger, Release, Topology};

use super::capacitance::PICO;
use super::elements::{Elements, Start};

/// The circuit at one time point of ngspice.
#[derive(Debug, Clone, Copy, Default)]
struct TimePoint {
    /// s
    time: f64,
    /// Capacitances of the nodes, F; on a shared node the first is the sum and the second 0.
    capacitance: [f64; 2],
    /// Voltages of the nodes, V.
    voltage: [f64; 2],
    load_voltage: f64,
    /// Currents of the charging diodes, A.
    supply: [f64; 2],
    /// Currents of the release elements, A.
    release: [f64; 2],
}

/// The ledger of a run over the time points of ngspice, taken one after the other.
#[derive(Debug, Clone, Copy)]
pub struct TrapezoidalLedger {
    elements: Elements,
    last: TimePoint,
    initial_energy: f64,
    sums: Ledger,
}

impl TrapezoidalLedger {
    /// The ledger of a run that begins with `capacitance` (left, right), F, charged to `U_in`. ngspice does not tell its
    /// first time point, 0 s.
    pub fn new(elements: &Elements, [left, right]: [f64; 2]) -> Self {
        let Start { membranes, load } = elements.start();
        let start = TimePoint {
            capacitance: match elements.circuit.topology {
                Topology::SharedNode => [left + right, 0.0],
                Topology::Isolated => [left, right],
            },
            voltage: membranes,
            load_voltage: load,
            ..TimePoint::default()
        };
        Self { elements: *elements, initial_energy: stored(&start), last: start, sums: Ledger::default() }
    }

    /// Takes the next time point, s, with the values of [`Elements::vectors`]; capacitances in pF.
    ///
    /// # Panics
    /// With fewer values than these.
    pub fn add(&mut self, time: f64, values: &[f64]) {
        let [left, right] = [values[0], values[1]];
        let (mut now, out) = match self.elements.circuit.topology {
            Topology::SharedNode => {
                let [voltage, supply, release] = [values[2], values[3], values[4]];
                let capacitance = [(left + right) * PICO, 0.0];
                let (supply, release) = ([supply, 0.0], [release, 0.0]);
                (
                    TimePoint { time, capacitance, voltage: [voltage; 2], load_voltage: 0.0, supply, release },
                    values.get(5),
                )
            }
            Topology::Isolated => {
                let pair = |index: usize| [values[index], values[index + 1]];
                let capacitance = [left * PICO, right * PICO];
                let (voltage, supply, release) = (pair(2), pair(4), pair(6));
                (TimePoint { time, capacitance, voltage, load_voltage: 0.0, supply, release }, values.get(8))
            }
        };
        now.load_voltage = out.copied().unwrap_or(self.elements.resistance() * (now.release[0] + now.release[1]));
        (0..2).for_each(|node| self.add_node(&now, node));
        self.last = now;
    }

    /// Adds what has flowed through a node since the last time point.
    fn add_node(&mut self, now: &TimePoint, j: usize) {
        let last = self.last;
        let half = 0.5 * (now.time - last.time);
        let ends = |value: &dyn Fn(&TimePoint) -> f64| [value(&last), value(now)];
        let entered = ends(&|at| at.supply[j]);
        let left = ends(&|at| at.release[j]);
        let charge = |[a, b]: [f64; 2]| half * (a + b);
        let leak = self.elements.circuit.leakage_rate();
        let leaked = ends(&|at| leak * at.capacitance[j] * at.voltage[j]);
        let missing = missing(&last, now, j, half, [charge(entered), charge(left) + charge(leaked)]);
        // Energy of a current that crosses a voltage, with what the rule has missed of its charge.
        let energy = |[i, k]: [f64; 2], missing: f64, voltage: &dyn Fn(&TimePoint) -> f64| {
            let [a, b] = ends(voltage);
            half * (a * i + b * k) + 0.5 * (a + b) * missing
        };
        let supply_voltage = self.elements.circuit.supply_voltage;
        let supply_charge = charge(entered) + missing[0];
        let drop = energy(left, missing[1], &|at| at.voltage[j] - at.load_voltage);
        let (zener, release_diode, is_switch) = match self.elements.circuit.release {
            Release::Zener => (drop, 0.0, false),
            Release::Switch => (0.0, 0.0, true),
            Release::Storage => (0.0, drop, false),
        };
        let load = energy(left, missing[1], &|at| if is_switch { at.voltage[j] } else { at.load_voltage });
        self.sums.supply_charge += supply_charge;
        self.sums.supply += supply_voltage * supply_charge;
        self.sums.load_charge += charge(left) + missing[1];
        self.sums.load += load;
        self.sums.zener += zener;
        self.sums.diode += energy(entered, missing[0], &|at| supply_voltage - at.voltage[j]) + release_diode;
        self.sums.leakage += energy(leaked, 0.0, &|at| at.voltage[j]);
        self.sums.mechanical += work(&last, now, j);
    }

    /// The circuit at the last time point taken.
    pub fn sample(&self) -> CircuitSample {
        let last = &self.last;
        CircuitSample {
            voltage: last.voltage,
            load_voltage: last.load_voltage,
            load_current: last.release.iter().sum(),
            supply_current: last.supply.iter().sum(),
            ledger: Ledger { stored: stored(last) - self.initial_energy, ..self.sums },
        }
    }

    /// Voltages at the last time point taken.
    pub(super) fn end(&self) -> Start {
        Start { membranes: self.last.voltage, load: self.last.load_voltage }
    }

    /// Last time point taken, s.
    pub(super) fn time(&self) -> f64 {
        self.last.time
    }
}

/// Charges, C, that the trapezoidal rule misses of those that have `entered` and `left` node `j`, so that they make up for
/// the change of its charge. In `half` a step on either side it misses at most the change of a current times that, for a
/// current that rises or falls all the way; the rest is an error of ngspice, and stays.
fn missing(last: &TimePoint, now: &TimePoint, j: usize, half: f64, [entered, left]: [f64; 2]) -> [f64; 2] {
    let charge = |at: &TimePoint| at.capacitance[j] * at.voltage[j];
    let difference = charge(now) - charge(last) - (entered - left);
    let most = [now.supply[j] - last.supply[j], now.release[j] - last.release[j]].map(|change| half * change.abs());
    let both = most[0] + most[1];
    let share = if both > 0.0 { (difference / both).clamp(-1.0, 1.0) } else { 0.0 };
    [share * most[0], -share * most[1]]
}

/// Energy of the field, J.
fn stored(at: &TimePoint) -> f64 {
    (0..2).map(|j| 0.5 * at.capacitance[j] * at.voltage[j] * at.voltage[j]).sum()
}

/// Work of the mechanics between two time points, `-integral 1/2 V^2 dC`, J: capacitance and voltage both linear.
fn work(last: &TimePoint, now: &TimePoint, j: usize) -> f64 {
    let (a, b) = (last.voltage[j], now.voltage[j]);
    -(a * a + a * b + b * b) / 6.0 * (now.capacitance[j] - last.capacitance[j])
}
