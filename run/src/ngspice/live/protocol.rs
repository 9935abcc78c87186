//! What the master's process and the worker say to each other.

use serde::{Deserialize, Serialize};

use super::ledger::{Group, Membranes};
use super::network::Account;
use videg_system::messages;

/// First message to the worker: which build asks.
pub fn build() -> String {
    messages::build(&[include_bytes!("protocol.rs"), include_bytes!("ledger.rs"), include_bytes!("network.rs")])
}

/// Second message to the worker: the circuit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Job {
    /// Lines of the netlist, the title first, `.end` last.
    pub netlist: Vec<String>,
    /// Names of the external sources, in the order of [`Ramp::start`].
    pub sources: Vec<String>,
    /// Commands before the analysis.
    pub commands: Vec<String>,
    /// Longest time step that ngspice may take, s.
    pub longest_step: f64,
    /// End of the transient analysis, s: beyond the last communication point.
    pub stop: f64,
    /// Begins with the voltages of `.ic`, 0 for other nodes; otherwise with the operating point.
    pub from_initial_conditions: bool,
    /// ngspice integrates by the trapezoidal rule, otherwise by Gear's method of order 2.
    pub is_trapezoidal: bool,
    /// Memory that the worker may take, bytes.
    pub memory: Option<u64>,
}

/// What the worker tells of the circuit.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Circuit {
    /// The elements.
    pub elements: Vec<Account>,
    /// Names of the nodes.
    pub nodes: Vec<String>,
    /// Elements of which ngspice does not tell all currents.
    pub unread: Vec<usize>,
}

/// What the master wants to know at each communication point.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Wanted {
    /// Groups of elements, by their place in [`Circuit::elements`].
    pub groups: Vec<Vec<usize>>,
    /// Vectors: nodes and `source#branch`.
    pub probes: Vec<String>,
    /// Values of the external sources at 0 s, V.
    pub start: Vec<f64>,
}

/// Each further message to the worker.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Request {
    /// What is wanted: begin. The third message.
    Wanted(Wanted),
    /// Go on until a communication point.
    Ramp(Ramp),
    /// The energies of all elements so far.
    Energies,
}

/// A step to a communication point.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Ramp {
    /// Where it begins: the communication point reached last, s.
    pub from: f64,
    /// The next communication point, s.
    pub to: f64,
    /// Values of the external sources where it begins, V.
    pub start: Vec<f64>,
    /// Values at its end; linear in between, V.
    pub end: Vec<f64>,
}

impl Ramp {
    /// Value of source `index` at `time`, s; beyond the ends that of the end.
    pub fn value(&self, index: usize, time: f64) -> Option<f64> {
        let (start, end) = (*self.start.get(index)?, *self.end.get(index)?);
        let part = if self.to > self.from { (time - self.from) / (self.to - self.from) } else { 1.0 };
        Some(start + (end - start) * part.clamp(0.0, 1.0))
    }
}

/// The circuit at a communication point.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct State {
    /// The membranes.
    pub membranes: Membranes,
    /// The groups.
    pub groups: Vec<Group>,
    /// The probes, V or A.
    pub probes: Vec<f64>,
}

impl State {
    /// Whether all its numbers are finite: sums and quotients of finite voltages and currents need not be.
    pub fn is_finite(&self) -> bool {
        let Membranes { voltage, stored, mechanical } = self.membranes;
        let groups = self.groups.iter().flat_map(|group| [group.energy, group.charge, group.current, group.voltage]);
        voltage
            .into_iter()
            .chain([stored, mechanical])
            .chain(groups)
            .chain(self.probes.iter().copied())
            .all(f64::is_finite)
    }
}

/// Each message from the worker.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Reply {
    /// It cannot go on, and why. The first, so that every build reads it as this.
    Failure(String),
    /// The circuit is loaded.
    Circuit(Circuit),
    /// The communication point asked for is reached.
    Reached(State),
    /// Energies that the elements took so far, J.
    Energies(Vec<f64>),
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ramp_is_linear_and_ends_at_its_ends() {
        let ramp = Ramp { from: 1.0, to: 3.0, start: vec![10.0], end: vec![20.0] };
        for (time, expected) in [(0.5, 10.0), (1.0, 10.0), (1.5, 12.5), (3.0, 20.0), (4.0, 20.0)] {
            assert_eq!(ramp.value(0, time), Some(expected));
        }
        assert_eq!(ramp.value(1, 2.0), None);
    }
}
