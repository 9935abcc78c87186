//! The circuit as a user sees it.

use core::cell::Cell;

use crate::devices::Devices;
use crate::error::{Error, finite, not_negative, positive};
use crate::exponential::Exponential;
use crate::ideal::EVENTS;
use crate::ledger::Ledger;
use crate::network::{Elements, Network};
use crate::parameters::{DiodeParameters, Diodes, Parameters, Release, Topology, names};
use crate::state::{Mode, Node, State};

/// The harvesting circuit of Fig. 8(a) with two time-varying membrane capacitances.
///
/// ```
/// use videg_circuit::{Circuit, Parameters, Topology};
///
/// let parameters = Parameters { topology: Topology::Isolated, ..Parameters::default() };
/// let mut circuit = Circuit::new(parameters, [15e-12, 15e-12])?;
/// circuit.advance(0.01, [20e-12, 15e-12])?; // stretched: the supply tops it up
/// circuit.advance(1.00, [15e-12, 15e-12])?; // relaxed: the charge leaves for the load
/// assert!((circuit.ledger().supply_charge - 2000.0 * 5e-12).abs() < 1e-20);
/// assert!(circuit.ledger().surplus() < 0.0); // a series Zener burns more than the mechanics gave
/// # Ok::<(), videg_circuit::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Circuit {
    parameters: Parameters,
    state: State,
}

impl Circuit {
    /// A circuit with both membranes charged to `U_in`; `capacitance` is left, right (F).
    ///
    /// # Errors
    /// A parameter or capacitance out of bounds, by name; a stored energy that is no finite number.
    pub fn new(parameters: Parameters, capacitance: [f64; 2]) -> Result<Self, Error> {
        Self::with_voltages(parameters, capacitance, [parameters.supply_voltage; 2])
    }

    /// A circuit that starts from given voltages, left and right (V), 0 or more; equal on a shared node.
    ///
    /// The ideal diode fills a membrane below `U_in` at once, and a load of 0 ohm or a storage empties one above the
    /// voltage of release at once; the ledger, zero before, holds that energy. The same rule for exponential diodes, whose inrush through no
    /// resistance at all has no other limit.
    ///
    /// # Errors
    /// A parameter, capacitance or voltage out of bounds, by name; a stored energy that is no finite number.
    pub fn with_voltages(parameters: Parameters, capacitance: [f64; 2], voltage: [f64; 2]) -> Result<Self, Error> {
        parameters.validate()?;
        check_capacitances(capacitance)?;
        not_negative(names::LEFT_VOLTAGE, voltage[0], "V")?;
        not_negative(names::RIGHT_VOLTAGE, voltage[1], "V")?;
        let [left, right] = voltage;
        let shared = parameters.topology == Topology::SharedNode;
        if shared && left != right {
            return Err(Error::VoltagesDiffer { left, right });
        }
        let charge = if shared {
            [left * (capacitance[0] + capacitance[1]), 0.0]
        } else {
            [left * capacitance[0], right * capacitance[1]]
        };
        let mut circuit = Self { parameters, state: State { charge, capacitance, ..State::default() } };
        circuit.start(voltage);
        // Bounds apart, the energy of a farad at 1e200 V is no number.
        circuit.state.validate()?;
        Ok(circuit)
    }

    /// Lets the ideal elements act on the voltages given.
    fn start(&mut self, voltage: [f64; 2]) {
        self.state.initial_energy = self.stored_energy();
        let mut network = self.network();
        for (j, v) in voltage.into_iter().enumerate().take(network.count) {
            if v == self.parameters.supply_voltage {
                network.nodes[j].mode = Mode::Charging;
            }
            network.inrush(j);
            network.outrush(j);
        }
        network.rank();
        self.accept(network);
        self.update_ideal_outputs(&network);
    }

    /// Advances by `dt` seconds, the capacitances (left, right) (F) running linearly in time to the values given.
    ///
    /// With ideal diodes the result is exact, whatever `dt`. With `dt` = 0 the capacitances jump: charge is
    /// conserved, the supply tops up at once what falls below `U_in`, and no charge reaches a load above 0 ohm; a
    /// storage takes what rises to `U_out`.
    ///
    /// # Errors
    /// `dt` or a capacitance out of bounds, by name; a voltage, current or energy that is no finite number;
    /// [`Error::Integration`] with exponential diodes. The circuit is unchanged then.
    pub fn advance(&mut self, dt: f64, capacitance: [f64; 2]) -> Result<(), Error> {
        not_negative(names::STEP, dt, "s")?;
        check_capacitances(capacitance)?;
        if dt == 0.0 && capacitance == self.state.capacitance {
            return Ok(());
        }
        finite("time", self.state.time + dt, "s")?;
        let before = self.state;
        match self.parameters.diodes {
            Diodes::Ideal => self.advance_ideal(dt, capacitance)?,
            Diodes::Exponential(diode) if self.parameters.leaks() => {
                self.advance_exponential::<true>(&diode, dt, capacitance)?;
            }
            Diodes::Exponential(diode) => self.advance_exponential::<false>(&diode, dt, capacitance)?,
        }
        self.state.capacitance = capacitance;
        self.state.time += dt;
        self.check_numbers().inspect_err(|_| self.state = before)
    }

    /// Advances by `length` seconds, the capacitances (left, right) (F) running along straight lines through `knots`, which are evenly spaced in
    /// time; the first knot is where they are now, and fewer than two are no line. The same as a call of [`Circuit::advance`] for each line, but lines that can be taken as one
    /// ([`Circuit::is_path_independent`]) are. `seen` gets the number of each knot that ends a line, and the voltages there.
    ///
    /// # Errors
    /// As [`Circuit::advance`]. The circuit is unchanged then.
    pub fn advance_along(
        &mut self,
        length: f64,
        knots: &[[f64; 2]],
        mut seen: impl FnMut(usize, [f64; 2]),
    ) -> Result<(), Error> {
        if knots.len() < 2 {
            return Ok(());
        }
        not_negative(names::STEP, length, "s")?;
        knots.iter().try_for_each(|knot| check_capacitances(*knot))?;
        finite("time", self.state.time + length, "s")?;
        let last = knots.len() - 1;
        let before = self.state;
        if self.parameters.diodes != Diodes::Ideal {
            for (k, knot) in knots.iter().enumerate().skip(1) {
                self.advance(length / last as f64, *knot).inspect_err(|_| self.state = before)?;
                seen(k, self.voltage());
            }
            return Ok(());
        }
        let mut network = self.network();
        let mut start = 0;
        while start < last {
            let goes_on = |k: &usize| {
                network.is_path_independent(self.node_capacitances(knots[k + 1])) && !turns(&knots[start..=k + 1])
            };
            let end = start + 1 + (start + 1..last).take_while(goes_on).count();
            // A line that is the whole way takes the time to the last bit.
            let part = (end - start) as f64 / last as f64;
            let begin = self.state.time + length * (start as f64 / last as f64);
            self.advance_network(&mut network, begin, length * part, knots[end])?;
            seen(end, self.voltages(&network.nodes));
            start = end;
        }
        self.accept(network);
        self.update_ideal_outputs(&network);
        self.state.capacitance = knots[last];
        self.state.time += length;
        self.check_numbers().inspect_err(|_| self.state = before)
    }

    /// Whether all that happens while both capacitances (F), and their sum, go to `capacitance` without turning round
    /// follows from where they end: with ideal diodes, no leak, and no charge that the load would get. One call of
    /// [`Circuit::advance`] is then as good as many.
    pub fn is_path_independent(&self, capacitance: [f64; 2]) -> bool {
        self.parameters.diodes == Diodes::Ideal
            && self.network().is_path_independent(self.node_capacitances(capacitance))
    }

    /// That no voltage, current or energy has left the range of numbers, as it does beside a capacitance of 1e308 F.
    fn check_numbers(&self) -> Result<(), Error> {
        let ([left, right], ledger) = (self.voltage(), self.ledger());
        let State { load_voltage, load_current, supply_current, .. } = self.state;
        let sum = left + right + load_voltage + load_current + supply_current + ledger.converted() + ledger.mechanical;
        if (sum + ledger.supply_charge + ledger.load_charge).is_finite() {
            return Ok(());
        }
        finite(names::LEFT_VOLTAGE, left, "V")?;
        finite(names::RIGHT_VOLTAGE, right, "V")?;
        finite("load.voltage", load_voltage, "V")?;
        finite("load.current", load_current, "A")?;
        finite("supply.current", supply_current, "A")?;
        ledger.validate()?;
        finite("energy converted", ledger.converted(), "J")
    }

    fn advance_ideal(&mut self, dt: f64, capacitance: [f64; 2]) -> Result<(), Error> {
        let mut network = self.network();
        self.advance_network(&mut network, self.state.time, dt, capacitance)?;
        self.accept(network);
        self.update_ideal_outputs(&network);
        Ok(())
    }

    /// Lets `dt` seconds pass in the `network` of this circuit, from `time`, s, on.
    fn advance_network(&self, network: &mut Network, time: f64, dt: f64, capacitance: [f64; 2]) -> Result<(), Error> {
        let ends = self.node_capacitances(capacitance);
        if dt == 0.0 {
            network.jump(ends);
            return Ok(());
        }
        network.advance(dt, ends).ok_or(Error::TooManyEvents { time, step: dt, bound: EVENTS })
    }

    fn advance_exponential<const LEAKS: bool>(
        &mut self,
        diode: &DiodeParameters,
        dt: f64,
        capacitance: [f64; 2],
    ) -> Result<(), Error> {
        let mut network = self.network();
        let ends = self.node_capacitances(capacitance);
        let start = network.nodes.map(|node| node.capacitance);
        let rate = [0, 1].map(|j| (ends[j] - start[j]) / dt);
        if rate.iter().any(|rate| !rate.is_finite()) {
            network.jump(ends);
            self.accept(network);
            return Ok(());
        }
        let devices = Devices::new(&self.parameters, diode);
        let solver = Exponential::<'_, LEAKS> {
            devices: &devices,
            solver: &diode.solver,
            count: network.count,
            charge: network.nodes.map(|node| node.charge),
            capacitance: start,
            rate,
            time: self.state.time,
            trials: Cell::default(),
        };
        let mut internal_step = self.state.internal_step;
        let point = solver.advance(&mut network, dt, &mut internal_step, self.state.load_voltage)?;
        self.accept(network);
        self.state.internal_step = internal_step;
        self.state.load_voltage = point.load_voltage;
        self.state.load_current = point.release.iter().sum();
        self.state.supply_current = point.supply.iter().sum();
        Ok(())
    }

    /// Parameters of this circuit.
    pub fn parameters(&self) -> &Parameters {
        &self.parameters
    }

    /// Time since the start (s).
    pub fn time(&self) -> f64 {
        self.state.time
    }

    /// Capacitances, left and right (F).
    pub fn capacitance(&self) -> [f64; 2] {
        self.state.capacitance
    }

    /// Voltages `U_DE` of the membranes, left and right (V).
    pub fn voltage(&self) -> [f64; 2] {
        self.voltages(&self.state.nodes(self.parameters.nodes()))
    }

    fn voltages(&self, nodes: &[Node; 2]) -> [f64; 2] {
        match self.parameters.topology {
            Topology::SharedNode => [nodes[0].voltage(); 2],
            Topology::Isolated => nodes.map(|node| node.voltage()),
        }
    }

    /// Load voltage `U_out` (V): that of the storage, or else `I R`, a mean value where a switch is duty-cycled. At a
    /// load of infinite resistance it is the open-circuit voltage behind the release element.
    pub fn load_voltage(&self) -> f64 {
        self.state.load_voltage
    }

    /// Current into the load or the storage (A).
    pub fn load_current(&self) -> f64 {
        self.state.load_current
    }

    /// Current drawn from the supply (A).
    pub fn supply_current(&self) -> f64 {
        self.state.supply_current
    }

    /// Energies and charges since the start.
    pub fn ledger(&self) -> Ledger {
        Ledger { stored: self.stored_energy() - self.state.initial_energy, ..self.state.ledger }
    }

    /// Changes of mode since the start: how often an ideal element began or ceased to conduct. Exponential diodes
    /// have no modes and leave it at 0.
    pub fn events(&self) -> u64 {
        self.state.events
    }

    /// The dynamic state, as plain numbers.
    pub fn state(&self) -> State {
        self.state
    }

    /// Goes back (or on) to a state exported from a circuit with the same parameters.
    ///
    /// # Errors
    /// A state that no circuit can be in; the circuit is unchanged then.
    pub fn restore(&mut self, state: &State) -> Result<(), Error> {
        state.validate()?;
        self.state = *state;
        Ok(())
    }

    fn node_capacitances(&self, [left, right]: [f64; 2]) -> [f64; 2] {
        match self.parameters.topology {
            Topology::SharedNode => [left + right, 0.0],
            Topology::Isolated => [left, right],
        }
    }

    fn network(&self) -> Network {
        let count = self.parameters.nodes();
        Network {
            elements: Elements::new(&self.parameters),
            nodes: self.state.nodes(count),
            count,
            excess: self.state.load_voltage,
            ledger: self.state.ledger,
            events: self.state.events,
        }
    }

    fn stored_energy(&self) -> f64 {
        let count = self.parameters.nodes();
        self.state.nodes(count)[..count].iter().map(Node::energy).sum()
    }

    fn accept(&mut self, mut network: Network) {
        if self.parameters.diodes == Diodes::Ideal {
            self.state.events = network.events;
        } else {
            for node in &mut network.nodes {
                node.mode = Mode::Off;
            }
        }
        self.state.set_nodes(&network.nodes);
        self.state.ledger = network.ledger;
    }

    fn update_ideal_outputs(&mut self, network: &Network) {
        let elements = &network.elements;
        let given = |j: usize| -network.drift(j);
        // At rest a leaking node is about to leave the voltage of release.
        let held = network.pressure().max(0.0);
        let filled: f64 = network.in_mode(Mode::Charging).map(given).sum();
        let top = network.nodes[..network.count].iter().map(Node::voltage).fold(0.0, f64::max);
        self.state.supply_current = 0.0 - elements.supply * filled;
        (self.state.load_voltage, self.state.load_current) = if elements.open() {
            let above = top > elements.threshold;
            (if above { top - elements.drop } else { 0.0 }, 0.0)
        } else if let Some(discharge) = network.discharge() {
            (discharge.excess, discharge.excess * elements.conductance)
        } else {
            // Adding zero turns the -0 of an empty sum into 0.
            let current = elements.threshold * held + 0.0;
            let storage = elements.release == Release::Storage;
            (if storage { elements.threshold } else { current / elements.conductance }, current)
        };
    }
}

/// Whether one of the capacitances, or their sum, which had not turned round before, does so at the last knot but one of
/// `knots`. From the first on: between a rise and a fall, two knots may be equal.
fn turns(knots: &[[f64; 2]]) -> bool {
    let [first, .., here, after] = knots else { return false };
    let steps = |a: &[f64; 2], b: &[f64; 2]| [b[0] - a[0], b[1] - a[1], b[0] + b[1] - a[0] - a[1]];
    steps(first, here).iter().zip(steps(here, after)).any(|(so_far, next)| so_far * next < 0.0)
}

fn check_capacitances([left, right]: [f64; 2]) -> Result<(), Error> {
    positive(names::LEFT_CAPACITANCE, left, "F")?;
    positive(names::RIGHT_CAPACITANCE, right, "F")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turn_is_seen_in_each_capacitance_and_in_the_sum_and_behind_a_plateau() {
        let turn = |knots: &[[f64; 2]]| turns(&knots.iter().map(|c| c.map(|c| c * 1e-12)).collect::<Vec<_>>());
        assert!(turn(&[[1.0, 1.0], [2.0, 1.0], [1.0, 1.0]]));
        assert!(turn(&[[1.0, 1.0], [1.0, 2.0], [1.0, 2.0], [1.0, 1.0]]));
        assert!(turn(&[[1.0, 5.0], [4.0, 4.0], [5.0, 1.0]]));
        assert!(!turn(&[[1.0, 1.0], [1.0, 1.0], [2.0, 1.0]]));
        assert!(!turn(&[[1.0, 1.0], [2.0, 3.0], [2.0, 3.0], [3.0, 4.0]]));
        assert!(!turn(&[[1.0, 1.0], [2.0, 2.0]]));
    }
}
