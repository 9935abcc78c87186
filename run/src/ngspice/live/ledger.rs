//! The energy that each element of a circuit takes, summed up over the time points of ngspice.
//!
//! ngspice solves Kirchhoff's law for currents that it gets from charges by a difference formula: that of order 1, of order 2
//! (Gear) or the trapezoidal rule. The same formula gives the charge of a step from a current. So the charges meet Kirchhoff's
//! law as the currents do. The energy of an element is the mean of its voltages at both ends of a step times that charge. By Tellegen's theorem these energies
//! sum to zero, and those of capacitors and membranes are exact.

use serde::{Deserialize, Serialize};

use super::network::{Flow, Network};

/// Sums over some elements.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Group {
    /// Energy that they took so far, J.
    pub energy: f64,
    /// Charge that flowed through them so far, C.
    pub charge: f64,
    /// Their current, A.
    pub current: f64,
    /// Voltage across the first of them, V.
    pub voltage: f64,
}

/// The membranes.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Membranes {
    /// Their voltages, left and right, V; 0 for one that is not there.
    pub voltage: [f64; 2],
    /// Change of the energy of their field so far, J.
    pub stored: f64,
    /// Work of the mechanics on them so far, J.
    pub mechanical: f64,
}

/// How ngspice differentiates charges.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Formula {
    Euler,
    Gear,
    Trapezoidal,
}

/// A time step: its length and that of the one before, s.
#[derive(Debug, Clone, Copy)]
struct Step {
    now: f64,
    before: f64,
}

/// A branch at the last time point.
#[derive(Debug, Clone, Copy, Default)]
struct Last {
    /// V
    voltage: f64,
    /// A
    current: f64,
    /// Charge of the step that led there, C.
    charge: f64,
}

/// A membrane at a time point.
#[derive(Debug, Clone, Copy, Default)]
struct Membrane {
    /// V
    voltage: f64,
    /// Charge that the change of its capacitance holds, C.
    change: f64,
    /// Current of that charge, A.
    rate: f64,
    /// Its whole charge, C.
    charge: f64,
}

/// The ledger of a run.
pub struct ElementLedger {
    network: Network,
    second_order: Formula,
    time: f64,
    step: f64,
    last: Vec<Last>,
    membranes: [Membrane; 2],
    /// Charge of the change of each membrane in the last step, C.
    moved: [f64; 2],
    /// Energy of the field at the start, J.
    field: f64,
    mechanical: f64,
    /// The first branch of each element, if it has one.
    first: Vec<Option<usize>>,
    /// Energies, J, and charges, C, of the elements so far.
    energies: Vec<f64>,
    charges: Vec<f64>,
}

impl ElementLedger {
    /// A ledger that begins at 0 s with the given `voltage` of each node, V, and no currents; `is_trapezoidal` is the
    /// method of ngspice.
    pub fn new(network: Network, is_trapezoidal: bool, voltage: impl Fn(&str) -> f64) -> Self {
        let mut values = vec![0.0; network.vectors.len()];
        for &vector in &network.nodes {
            values[vector] = voltage(&network.vectors[vector]);
        }
        let elements = network.accounts.len();
        let mut first = vec![None; elements];
        for (k, branch) in network.branches.iter().enumerate().rev() {
            first[branch.element] = Some(k);
        }
        let mut ledger = Self {
            first,
            second_order: if is_trapezoidal { Formula::Trapezoidal } else { Formula::Gear },
            time: 0.0,
            step: 0.0,
            last: vec![Last::default(); network.branches.len()],
            membranes: [Membrane::default(); 2],
            moved: [0.0; 2],
            field: 0.0,
            mechanical: 0.0,
            energies: vec![0.0; elements],
            charges: vec![0.0; elements],
            network,
        };
        ledger.begin(&values);
        for (last, branch) in ledger.last.iter_mut().zip(&ledger.network.branches) {
            last.voltage = branch.start.unwrap_or(last.voltage);
        }
        ledger
    }

    /// The elements.
    pub fn network(&self) -> &Network {
        &self.network
    }

    /// Begins with `values` of the vectors.
    fn begin(&mut self, values: &[f64]) {
        for k in 0..self.last.len() {
            let voltage = self.voltage(k, values);
            self.last[k] = Last { voltage, current: self.current(k, values, voltage), charge: 0.0 };
        }
        self.membranes = self.membranes_at(values);
        self.field = field(&self.membranes);
    }

    /// Takes a time point: the time, s, and the values of [`Network::vectors`].
    pub fn add(&mut self, time: f64, values: &[f64]) {
        let step = Step { now: time - self.time, before: self.step };
        if step.now <= 0.0 {
            // The operating point, with which a run without initial conditions begins.
            return self.begin(values);
        }
        let membranes = self.membranes_at(values);
        let moved = [0, 1].map(|side| membranes[side].change - self.membranes[side].change);
        let voltages: Vec<_> = (0..self.last.len()).map(|k| self.voltage(k, values)).collect();
        let currents: Vec<_> =
            voltages.iter().enumerate().map(|(k, &voltage)| self.current(k, values, voltage)).collect();
        let charges = self.flows(step, &voltages, &currents, &membranes, moved);
        for (k, branch) in self.network.branches.iter().enumerate() {
            let last = &mut self.last[k];
            self.energies[branch.element] += 0.5 * (last.voltage + voltages[k]) * charges[k];
            // Of a transistor, what flows into its first terminal.
            if self.first[branch.element] == Some(k) {
                self.charges[branch.element] += charges[k];
            }
            let is_known = matches!(branch.flow, Flow::Conductance(_) | Flow::Current(_) | Flow::Diode { .. });
            let current = if is_known { currents[k] } else { charges[k] / step.now };
            *last = Last { voltage: voltages[k], current, charge: charges[k] };
        }
        for (before, now) in self.membranes.iter().zip(&membranes) {
            // -1/2 V dC V: what the change of the field's energy exceeds that of the charge by.
            self.mechanical += 0.5 * (now.voltage * before.charge - before.voltage * now.charge);
        }
        (self.membranes, self.moved, self.time, self.step) = (membranes, moved, time, step.now);
    }

    /// The charge that flows through each branch in a step, C.
    fn flows(
        &self,
        step: Step,
        voltages: &[f64],
        currents: &[f64],
        membranes: &[Membrane; 2],
        moved: [f64; 2],
    ) -> Vec<f64> {
        let by = |formula| self.flows_by(formula, step, voltages, currents, membranes);
        if step.before == 0.0 {
            return by(Formula::Euler);
        }
        // ngspice does not tell which order a step had. The charges of C(t) are known, and so are their currents.
        let deviation = |formula: Formula| -> f64 {
            let side = |side: usize| {
                let last = Last { current: self.membranes[side].rate, charge: self.moved[side], ..Last::default() };
                (formula.charge(step, membranes[side].rate, &last) - moved[side]).abs()
            };
            side(0) + side(1)
        };
        let (first, second) = (deviation(Formula::Euler), deviation(self.second_order));
        if first != second {
            return by(if first < second { Formula::Euler } else { self.second_order });
        }
        // Between the pulses no such charge moves: the formula by which Kirchhoff's law holds.
        let residual = |charges: &[f64]| -> f64 {
            let energy = |(k, charge): (usize, f64)| 0.5 * (self.last[k].voltage + voltages[k]) * charge;
            charges.iter().copied().enumerate().map(energy).sum::<f64>().abs()
        };
        let (first, second) = (by(Formula::Euler), by(self.second_order));
        if residual(&first) < residual(&second) { first } else { second }
    }

    fn flows_by(
        &self,
        formula: Formula,
        step: Step,
        voltages: &[f64],
        currents: &[f64],
        membranes: &[Membrane; 2],
    ) -> Vec<f64> {
        let mut charges: Vec<f64> = Vec::with_capacity(voltages.len());
        for (k, branch) in self.network.branches.iter().enumerate() {
            let last = &self.last[k];
            charges.push(match branch.flow {
                Flow::Capacitor(capacitance) => capacitance * (voltages[k] - last.voltage),
                Flow::Membrane { .. } => {
                    let side = usize::from(self.network.membranes[1] == Some(k));
                    membranes[side].charge - self.membranes[side].charge
                }
                Flow::Conductance(_) | Flow::Current(_) | Flow::Diode { .. } => formula.charge(step, currents[k], last),
                Flow::Rest(_) | Flow::Unknown => 0.0,
            });
        }
        for &k in &self.network.rests {
            let Flow::Rest(node) = self.network.branches[k].flow else { continue };
            let mut own = 1.0;
            let mut others = 0.0;
            for &(branch, sign) in &self.network.at[node] {
                if branch == k { own = sign } else { others += sign * charges[branch] }
            }
            charges[k] = -own * others;
        }
        charges
    }

    /// Voltage across a branch, V.
    fn voltage(&self, branch: usize, values: &[f64]) -> f64 {
        let at = |node: Option<usize>| node.map_or(0.0, |node| values[self.network.nodes[node]]);
        let [first, second] = self.network.branches[branch].nodes;
        at(first) - at(second)
    }

    /// Current through a branch, A, as far as it is known at the time point itself.
    fn current(&self, branch: usize, values: &[f64], across: f64) -> f64 {
        match self.network.branches[branch].flow {
            Flow::Conductance(conductance) => conductance * across,
            Flow::Current(vector) => values[vector],
            Flow::Diode { current, voltage, conductance } => {
                // To the voltage that Kirchhoff's law was solved with.
                values[current] + values[conductance] * (across - values[voltage])
            }
            _ => 0.0,
        }
    }

    fn membranes_at(&self, values: &[f64]) -> [Membrane; 2] {
        self.network.membranes.map(|branch| {
            let Some(k) = branch else { return Membrane::default() };
            let Flow::Membrane { capacitance, change, rate } = self.network.branches[k].flow else {
                return Membrane::default();
            };
            let voltage = self.voltage(k, values);
            let (change, rate) = (values[change], values[rate]);
            Membrane { voltage, change, rate, charge: capacitance * voltage + change }
        })
    }

    /// The membranes at the last time point.
    pub fn membranes(&self) -> Membranes {
        let voltage = self.membranes.map(|membrane| membrane.voltage);
        Membranes { voltage, stored: field(&self.membranes) - self.field, mechanical: self.mechanical }
    }

    /// The sums over the elements of a group at the last time point.
    pub fn group(&self, elements: &[usize]) -> Group {
        let mut group = Group::default();
        for (k, &element) in elements.iter().enumerate() {
            let last = self.first[element].map(|branch| self.last[branch]).unwrap_or_default();
            group.energy += self.energies[element];
            group.charge += self.charges[element];
            group.current += last.current;
            if k == 0 {
                group.voltage = last.voltage;
            }
        }
        group
    }

    /// Energy that each element took so far, J.
    pub fn energies(&self) -> &[f64] {
        &self.energies
    }
}

impl Formula {
    /// The charge of a `step` that ends with `current`, A, after the step `last`.
    fn charge(self, step: Step, current: f64, last: &Last) -> f64 {
        let Step { now, before } = step;
        match self {
            Self::Euler => current * now,
            Self::Trapezoidal => 0.5 * (last.current + current) * now,
            Self::Gear => {
                let old = now / (before * (now + before));
                let new = (now + before) / (now * before) - old;
                (current + old * last.charge) / new
            }
        }
    }
}

/// Energy of the field, J.
fn field(membranes: &[Membrane; 2]) -> f64 {
    membranes.iter().map(|membrane| 0.5 * membrane.charge * membrane.voltage).sum()
}
