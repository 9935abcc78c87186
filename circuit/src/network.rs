//! The nodes between ideal elements: which element conducts, and how charge and energy flow meanwhile.

use crate::ledger::Ledger;
use crate::parameters::{Parameters, Release};
use crate::release::{Discharge, Span};
use crate::state::{Mode, Node};

/// Relative size of what rounding may do to a comparison of two nodes.
pub(crate) const NOISE: f64 = 16.0 * f64::EPSILON;

/// Part of the rate of a capacitance by which that and the leak may differ where they are about to be in balance: a node
/// that leaves its voltage earlier by as much does so at an error of the square of this.
pub(crate) const SETTLED: f64 = 1e-10;

/// The elements around the nodes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Elements {
    /// `U_in` (V).
    pub supply: f64,
    /// Voltage of release (V): `U_z`, or `U_out` of a storage.
    pub threshold: f64,
    /// Drop between node and load while the load sets the current (V): `U_z` for a Zener, else 0.
    pub drop: f64,
    /// `1/R` (S), from 0 to infinity with both ends; a storage takes charge as a load of 0 ohm does.
    pub conductance: f64,
    /// Part of the charge that leaks through the film in a second (1/s), 0 for none.
    pub leak: f64,
    /// Kind of the release element.
    pub release: Release,
}

impl Elements {
    pub fn new(parameters: &Parameters) -> Self {
        Self {
            supply: parameters.supply_voltage,
            threshold: parameters.release_voltage(),
            drop: match parameters.release {
                Release::Zener => parameters.zener_voltage,
                Release::Switch | Release::Storage => 0.0,
            },
            conductance: match parameters.release {
                Release::Zener | Release::Switch => parameters.conductance(),
                Release::Storage => f64::INFINITY,
            },
            leak: parameters.leakage_rate(),
            release: parameters.release,
        }
    }

    /// A load of 0 ohm, or a storage, holds the node at the voltage of release whatever the current.
    pub fn short(&self) -> bool {
        self.conductance == f64::INFINITY
    }

    /// A load of infinite resistance takes no charge.
    pub fn open(&self) -> bool {
        self.conductance == 0.0
    }

    /// With the voltage of release at `U_in` a node is never between the two elements.
    fn meet(&self) -> bool {
        self.supply == self.threshold
    }
}

/// The nodes with ideal elements, and the ledger.
///
/// # Two nodes, one load
/// The release elements are one-way, so that the load follows the highest node above `U_z`: a lower one is
/// blocked, its charge constant, until it meets the leader. At equal voltage both conduct if both currents are
/// positive (the nodes are then joined), and else only the one that would otherwise rise above the other. The
/// sum of the currents is what the load takes, so this choice is unique. With switches at `U_z`, both
/// duty-cycled, the load sees one of them at a time: both are held while the sum of their mean currents stays
/// below `U_z / R`, and join, or one leads, beyond.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Network {
    pub elements: Elements,
    /// The nodes; only the first `count` exist.
    pub nodes: [Node; 2],
    pub count: usize,
    /// Load voltage `w = V - U_d` of the releasing nodes (V). Kept beside their charges, in which a small one
    /// would drown.
    pub excess: f64,
    pub ledger: Ledger,
    /// Changes of mode.
    pub events: u64,
}

impl Network {
    /// Indices of the nodes in a mode.
    pub fn in_mode(&self, mode: Mode) -> impl Iterator<Item = usize> {
        let modes = self.nodes.map(|node| node.mode);
        (0..self.count).filter(move |&j| modes[j] == mode)
    }

    /// The discharge of the releasing nodes, joined if there are two.
    pub fn discharge(&self) -> Option<Discharge> {
        let mut sum = Node::default();
        for j in self.in_mode(Mode::Releasing) {
            sum.capacitance += self.nodes[j].capacitance;
            sum.rate += self.nodes[j].rate;
        }
        (sum.capacitance > 0.0).then_some(Discharge {
            capacitance: sum.capacitance,
            rate: sum.rate,
            conductance: self.elements.conductance,
            drop: self.elements.drop,
            excess: self.excess,
            leak: self.elements.leak,
        })
    }

    /// `C1 k2 - C2 k1`, seen from node `j` (F^2/s): the same all along a pair of linear ramps. Positive if the
    /// node would rise above the other one at constant charge.
    pub fn lead(&self, j: usize) -> f64 {
        let (own, other) = (&self.nodes[j], &self.nodes[1 - j]);
        own.capacitance * other.rate - other.capacitance * own.rate
    }

    /// Whether what happens while the capacitances go to `ends` without turning round follows from where they end, see
    /// [`Circuit::is_path_independent`](crate::Circuit::is_path_independent).
    pub fn is_path_independent(&self, ends: [f64; 2]) -> bool {
        let Elements { threshold, leak, .. } = self.elements;
        let is_calm = |(node, end): (&Node, f64)| {
            node.mode != Mode::Releasing && (self.elements.open() || node.charge <= threshold * end)
        };
        leak == 0.0 && self.nodes[..self.count].iter().zip(ends).all(is_calm)
    }

    /// Current into node `j` that holds its voltage, over this voltage (S): `k + l C` with the rate `l` of the leak.
    #[inline]
    pub fn drift(&self, j: usize) -> f64 {
        if self.elements.leak > 0.0 { self.leaking_drift(j) } else { self.nodes[j].rate }
    }

    /// Current that holds all nodes at the voltage of release, over this voltage (S).
    #[inline]
    pub fn pressure(&self) -> f64 {
        self.in_mode(Mode::Holding).map(|j| -self.drift(j)).sum()
    }

    /// Brings the modes in line with the present rates; a node in [`Mode::Holding`] means here that it is at
    /// `U_z`, whatever follows from it.
    pub fn settle(&mut self) {
        for j in 0..self.count {
            self.leave_held_voltage(j);
        }
        if self.in_mode(Mode::Releasing).next().is_some() {
            for j in 0..self.count {
                if self.nodes[j].mode == Mode::Holding {
                    self.nodes[j].mode = Mode::Off;
                }
            }
        } else if !self.elements.short() {
            self.leave_threshold();
        }
        self.block_reverse_current();
    }

    /// A held node leaves its voltage when its current runs the other way.
    fn leave_held_voltage(&mut self, j: usize) {
        let (open, meet) = (self.elements.open(), self.elements.meet());
        let drift = self.drift(j);
        let node = &mut self.nodes[j];
        match node.mode {
            Mode::Charging if drift < 0.0 => {
                node.mode = if meet && !open { Mode::Holding } else { Mode::Off };
            }
            Mode::Holding if drift > 0.0 => {
                node.mode = if meet { Mode::Charging } else { Mode::Off };
            }
            _ => {}
        }
    }

    /// Nodes at `U_z` whose capacitance falls go into the load, unless duty-cycled switches can hold them.
    fn leave_threshold(&mut self) {
        let pressure = self.pressure();
        let held = match self.elements.release {
            Release::Zener | Release::Storage => pressure <= 0.0,
            Release::Switch if self.elements.leak > 0.0 => pressure <= self.elements.conductance - self.margin(),
            Release::Switch => pressure <= self.elements.conductance,
        };
        if held {
            return;
        }
        self.excess = self.elements.threshold - self.elements.drop;
        for j in 0..self.count {
            if self.nodes[j].mode == Mode::Holding {
                self.nodes[j].mode = if self.drift(j) < 0.0 { Mode::Releasing } else { Mode::Off };
            }
        }
    }

    /// Of two releasing nodes, blocks the one whose own current would be negative.
    fn block_reverse_current(&mut self) {
        if self.in_mode(Mode::Releasing).count() < 2 {
            return;
        }
        let Some(discharge) = self.discharge() else { return };
        for j in 0..2 {
            let (current, scale) = self.share(j, &discharge, 0.0);
            if current < -NOISE * scale {
                self.nodes[j].mode = Mode::Off;
                return;
            }
        }
    }

    /// Own current of node `j` if joined, times `C_1 + C_2`, at `t` seconds into `discharge`:
    /// `C_j w / R + V lead_j`; and the size of its terms.
    pub fn share(&self, j: usize, discharge: &Discharge, t: f64) -> (f64, f64) {
        let w = discharge.excess_at(t);
        let drawn = (self.nodes[j].capacitance + self.nodes[j].rate * t) * w * self.elements.conductance;
        let pushed = (w + self.elements.drop) * self.lead(j);
        (drawn + pushed, drawn.abs() + pushed.abs())
    }

    /// Lets `t` seconds pass in the present modes, the capacitances running to `ends`; `discharge` is that of these seconds.
    pub fn flow(&mut self, t: f64, ends: [f64; 2], discharge: Option<(Discharge, Span)>) {
        let work = discharge.map(|(discharge, span)| {
            self.excess = span.excess.max(0.0);
            discharge.work(&span)
        });
        for (j, end) in ends.into_iter().enumerate().take(self.count) {
            if self.elements.leak > 0.0 {
                self.leak_held(j, t, end);
            }
            match self.nodes[j].mode {
                Mode::Off if self.elements.leak > 0.0 => self.decay(j, t, end),
                Mode::Off => self.coast(j, end),
                Mode::Charging => self.charge(j, end),
                Mode::Holding => self.hold(j, end),
                Mode::Releasing => self.discharge_node(j, end),
            }
        }
        if let Some(work) = work {
            self.ledger.load += work.load;
            self.ledger.mechanical += work.mechanical;
            // What has leaked has left the nodes, but not for the load.
            self.ledger.leakage += work.leakage;
            self.ledger.load_charge -= work.leaked;
            self.ledger.zener -= self.elements.drop * work.leaked;
        }
    }

    /// The charge that a releasing node passes on its way to the present load voltage.
    fn discharge_node(&mut self, j: usize, end: f64) {
        let node = &mut self.nodes[j];
        node.capacitance = end;
        let passed = node.charge - end * (self.elements.drop + self.excess);
        node.charge -= passed;
        self.ledger.load_charge += passed;
        self.ledger.zener += self.elements.drop * passed;
    }

    /// Constant charge.
    pub fn coast(&mut self, j: usize, end: f64) {
        let node = &mut self.nodes[j];
        self.ledger.mechanical +=
            0.5 * node.charge * (node.charge / end) * ((node.capacitance - end) / node.capacitance);
        node.capacitance = end;
    }

    /// `V = U_in` along a rising capacitance.
    pub fn charge(&mut self, j: usize, end: f64) {
        let supply = self.elements.supply;
        let node = &mut self.nodes[j];
        let drawn = supply * (end - node.capacitance);
        self.ledger.supply_charge += drawn;
        self.ledger.supply += supply * drawn;
        self.ledger.mechanical -= 0.5 * supply * drawn;
        node.capacitance = end;
        node.charge = supply * end;
    }

    /// The voltage of release along a falling capacitance.
    pub fn hold(&mut self, j: usize, end: f64) {
        let threshold = self.elements.threshold;
        let node = &mut self.nodes[j];
        let passed = threshold * (node.capacitance - end);
        node.capacitance = end;
        node.charge = threshold * end;
        self.ledger.mechanical += 0.5 * threshold * passed;
        self.release_at_threshold(passed);
    }

    /// Books a charge that leaves a node at the voltage of release.
    pub fn release_at_threshold(&mut self, charge: f64) {
        let energy = self.elements.threshold * charge;
        self.ledger.load_charge += charge;
        match self.elements.release {
            Release::Zener => self.ledger.zener += energy,
            Release::Switch | Release::Storage => self.ledger.load += energy,
        }
    }
}
