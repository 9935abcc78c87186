//! The dynamic state: nodes inside, a plain struct outside.

use crate::error::{Error, finite, not_negative, positive};
use crate::ledger::Ledger;
use crate::parameters::names;

/// No run has had as many changes of mode, and none will count beyond all numbers from there.
const MAX_EVENTS: u64 = 1 << 53;

/// What holds a node at the moment.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) enum Mode {
    /// Neither element conducts: constant charge.
    #[default]
    Off,
    /// The charging diode conducts: `V = U_in`.
    Charging,
    /// At the voltage of release: a switch is duty-cycled, a Zener works into a load of 0 ohm, or a diode into a storage.
    Holding,
    /// The release element conducts and the load sets the current. Two nodes in this mode are joined.
    Releasing,
}

/// A capacitance with what holds it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Node {
    /// Charge (C).
    pub charge: f64,
    /// Capacitance (F).
    pub capacitance: f64,
    /// Rate of the capacitance over the present ramp (F/s).
    pub rate: f64,
    /// What holds it.
    pub mode: Mode,
}

impl Node {
    /// Voltage (V).
    pub fn voltage(&self) -> f64 {
        self.charge / self.capacitance
    }

    /// Stored energy (J).
    pub fn energy(&self) -> f64 {
        0.5 * self.charge * self.voltage()
    }
}

/// Everything that a [`Circuit`](crate::Circuit) carries from one step to the next, as plain numbers.
///
/// Exported by [`Circuit::state`](crate::Circuit::state), imported by
/// [`Circuit::restore`](crate::Circuit::restore); a restored circuit goes on to the last bit as the original.
/// Index 0 is the left membrane, or the shared node; index 1 is the right membrane.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize, serde::Deserialize)]
pub struct State {
    /// Time since the start (s).
    pub time: f64,
    /// Charge of each node (C); the shared node holds that of both membranes at index 0.
    pub charge: [f64; 2],
    /// Capacitance of each membrane (F).
    pub capacitance: [f64; 2],
    /// The charging diode holds the node at `U_in` (ideal diodes).
    pub charging: [bool; 2],
    /// The release element holds the node at `U_z`, or at `U_out` of a storage (ideal diodes).
    pub holding: [bool; 2],
    /// The node discharges into the load (ideal diodes).
    pub releasing: [bool; 2],
    /// Load voltage at the end of the last step (V); what a releasing node is above its release element.
    pub load_voltage: f64,
    /// Load current at the end of the last step (A).
    pub load_current: f64,
    /// Supply current at the end of the last step (A).
    pub supply_current: f64,
    /// Internal step that the integrator begins the next call with (s); 0 before the first (exponential diodes).
    pub internal_step: f64,
    /// Stored energy at the start (J).
    pub initial_energy: f64,
    /// The ledger.
    pub ledger: Ledger,
    /// Changes of mode so far (ideal diodes).
    pub events: u64,
}

impl State {
    /// The nodes, two in any case; on the shared node the second is empty, with a capacitance that can be divided by.
    pub(crate) fn nodes(&self, count: usize) -> [Node; 2] {
        let [left, right] = self.capacitance;
        let capacitance = if count == 1 { [left + right, right] } else { [left, right] };
        [0, 1].map(|j| Node { charge: self.charge[j], capacitance: capacitance[j], rate: 0.0, mode: self.mode(j) })
    }

    fn mode(&self, node: usize) -> Mode {
        if self.charging[node] {
            Mode::Charging
        } else if self.holding[node] {
            Mode::Holding
        } else if self.releasing[node] {
            Mode::Releasing
        } else {
            Mode::Off
        }
    }

    /// Takes charges and modes over from the nodes.
    pub(crate) fn set_nodes(&mut self, nodes: &[Node; 2]) {
        self.charge = nodes.map(|node| node.charge);
        self.charging = nodes.map(|node| node.mode == Mode::Charging);
        self.holding = nodes.map(|node| node.mode == Mode::Holding);
        self.releasing = nodes.map(|node| node.mode == Mode::Releasing);
    }

    /// Rejects what no circuit can be in.
    pub(crate) fn validate(&self) -> Result<(), Error> {
        positive(names::LEFT_CAPACITANCE, self.capacitance[0], "F")?;
        positive(names::RIGHT_CAPACITANCE, self.capacitance[1], "F")?;
        finite("left.charge", self.charge[0], "C")?;
        finite("right.charge", self.charge[1], "C")?;
        finite("time", self.time, "s")?;
        finite("load.voltage", self.load_voltage, "V")?;
        finite("load.current", self.load_current, "A")?;
        finite("supply.current", self.supply_current, "A")?;
        not_negative("internal step", self.internal_step, "s")?;
        finite("stored energy at the start", self.initial_energy, "J")?;
        self.ledger.validate()?;
        if self.events > MAX_EVENTS {
            return Err(Error::Count { name: "changes of mode", value: self.events, bound: MAX_EVENTS });
        }
        for node in 0..2 {
            let flags = [self.charging[node], self.holding[node], self.releasing[node]];
            if flags.iter().filter(|flag| **flag).count() > 1 {
                return Err(Error::ContradictoryMode { node });
            }
        }
        Ok(())
    }
}
