//! Energies and charges from the time points of ngspice.
//!
//! Currents are summed by the trapezoidal rule over ngspice's own points. What a node's charge C V changes by is what has
//! flowed in less what has flowed out, so the difference that the rule leaves where a current jumps is known: the flows
//! take it in proportion to what they carry. Integrators within the netlist would have tolerances of their own and would
//! weigh in the control of the step.

use videg_circuit::{Ledger, Topology};

use super::circuit::{Branch, Elements, Start};
use crate::circuit_sample::CircuitSample;

/// What holds at one time point of ngspice.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Instant {
    /// Time, s.
    pub time: f64,
    /// Capacitances of the nodes, F; on a shared node the first is the sum and the second 0.
    pub capacitance: [f64; 2],
    /// Voltages of the nodes, V.
    pub voltage: [f64; 2],
    /// Load voltage, V.
    pub load_voltage: f64,
    /// Currents of the charging diodes, A.
    pub supply: [f64; 2],
    /// Currents of the release elements, A.
    pub release: [f64; 2],
}

/// Running books over the time points of a run, taken one after the other.
#[derive(Debug, Clone)]
pub struct Books {
    elements: Elements,
    last: Instant,
    initial_energy: f64,
    sums: Ledger,
}

impl Books {
    /// Books of a run that begins with `capacitance` (left, right), F, charged to `U_in`. ngspice does not tell its
    /// first time point, 0 s.
    pub fn new(elements: &Elements, capacitance: [f64; 2]) -> Self {
        let start = Instant {
            capacitance: match elements.topology {
                Topology::SharedNode => [capacitance.iter().sum(), 0.0],
                Topology::Isolated => capacitance,
            },
            voltage: [elements.supply_voltage; 2],
            load_voltage: elements.start().load,
            ..Instant::default()
        };
        Self { elements: *elements, initial_energy: stored(&start), last: start, sums: Ledger::default() }
    }

    /// The values of [`Elements::vectors`], with the time, as an instant; capacitances in pF.
    ///
    /// `None` if there are too few of them.
    pub fn instant(elements: &Elements, time: f64, values: &[f64]) -> Option<Instant> {
        use super::capacitance::PICO;
        let load_voltage =
            |voltage: &[f64], current: f64| voltage.first().map_or(elements.resistance() * current, |v| *v);
        match (elements.topology, values) {
            (Topology::SharedNode, &[cl, cr, de, supply, release, ref out @ ..]) => Some(Instant {
                time,
                capacitance: [(cl + cr) * PICO, 0.0],
                voltage: [de; 2],
                load_voltage: load_voltage(out, release),
                supply: [supply, 0.0],
                release: [release, 0.0],
            }),
            (Topology::Isolated, &[cl, cr, left, right, sl, sr, rl, rr, ref out @ ..]) => Some(Instant {
                time,
                capacitance: [cl * PICO, cr * PICO],
                voltage: [left, right],
                load_voltage: load_voltage(out, rl + rr),
                supply: [sl, sr],
                release: [rl, rr],
            }),
            _ => None,
        }
    }

    /// Takes the next time point.
    pub fn take(&mut self, now: &Instant) {
        let last = self.last;
        self.book(&last, now);
        self.last = *now;
    }

    /// Books what flowed between two time points.
    fn book(&mut self, last: &Instant, now: &Instant) {
        (0..2).for_each(|j| self.book_node(last, now, j));
    }

    fn book_node(&mut self, last: &Instant, now: &Instant, j: usize) {
        let half = 0.5 * (now.time - last.time);
        let [entered, left] = [|at: &Instant, j: usize| at.supply[j], |at: &Instant, j: usize| at.release[j]];
        let charge = |flow: fn(&Instant, usize) -> f64| half * (flow(last, j) + flow(now, j));
        let missing = missing(last, now, j, half, [charge(entered), charge(left)]);
        // The charge of a flow, and its energy where it crosses a voltage, with what the rule has missed.
        let energy = |flow: fn(&Instant, usize) -> f64, missing: f64, drop: &dyn Fn(&Instant) -> f64| {
            let (a, b) = (drop(last), drop(now));
            half * (a * flow(last, j) + b * flow(now, j)) + 0.5 * (a + b) * missing
        };
        let supply_charge = charge(entered) + missing[0];
        let drop = energy(left, missing[1], &|at| at.voltage[j] - at.load_voltage);
        let load = match self.elements.branch {
            Branch::Switch { .. } => energy(left, missing[1], &|at| at.voltage[j]),
            Branch::Zener { .. } | Branch::Storage { .. } => energy(left, missing[1], &|at| at.load_voltage),
        };
        let (zener, release_diode) = match self.elements.branch {
            Branch::Zener { .. } => (drop, 0.0),
            Branch::Switch { .. } => (0.0, 0.0),
            Branch::Storage { .. } => (0.0, drop),
        };
        let supply_voltage = self.elements.supply_voltage;
        self.sums.supply_charge += supply_charge;
        self.sums.supply += supply_voltage * supply_charge;
        self.sums.load_charge += charge(left) + missing[1];
        self.sums.load += load;
        self.sums.zener += zener;
        self.sums.diode += energy(entered, missing[0], &|at| supply_voltage - at.voltage[j]) + release_diode;
        self.sums.mechanical += work(last, now, j);
    }

    /// The books at the last time point taken.
    pub fn ledger(&self) -> Ledger {
        Ledger { stored: stored(&self.last) - self.initial_energy, ..self.sums }
    }

    /// The circuit at the last time point taken.
    pub fn sample(&self) -> CircuitSample {
        let last = &self.last;
        CircuitSample {
            voltage: last.voltage,
            load_voltage: last.load_voltage,
            load_current: last.release.iter().sum(),
            supply_current: last.supply.iter().sum(),
            ledger: self.ledger(),
        }
    }

    /// Voltages at the last time point taken.
    pub fn end(&self) -> Start {
        Start { membranes: self.last.voltage, load: self.last.load_voltage }
    }

    /// Last time point taken, s.
    pub fn time(&self) -> f64 {
        self.last.time
    }
}

/// What the trapezoidal rule misses of the charges that have `entered` and `left` node `j`, C, so that they make up for the
/// change of its charge. In `half` a step on either side it misses at most the change of a current times that, for a
/// current that rises or falls all the way; what lies beyond is an error of ngspice, and stays.
fn missing(last: &Instant, now: &Instant, j: usize, half: f64, [entered, left]: [f64; 2]) -> [f64; 2] {
    let held = |at: &Instant| at.capacitance[j] * at.voltage[j];
    let difference = held(now) - held(last) - (entered - left);
    let most = [now.supply[j] - last.supply[j], now.release[j] - last.release[j]].map(|change| half * change.abs());
    let both = most[0] + most[1];
    let share = if both > 0.0 { (difference / both).clamp(-1.0, 1.0) } else { 0.0 };
    [share * most[0], -share * most[1]]
}

/// Energy of the field, J.
fn stored(at: &Instant) -> f64 {
    (0..2).map(|j| 0.5 * at.capacitance[j] * at.voltage[j] * at.voltage[j]).sum()
}

/// Work of the mechanics between two time points, `-integral 1/2 V^2 dC`, J: capacitance and voltage both linear.
fn work(last: &Instant, now: &Instant, j: usize) -> f64 {
    let (a, b) = (last.voltage[j], now.voltage[j]);
    -(a * a + a * b + b * b) / 6.0 * (now.capacitance[j] - last.capacitance[j])
}
