//! The circuit behind the functions of FMI.

use fmu_export::{Logger, ModelInfo, Slave, SlaveError, StateError, StateReader, StateWriter, Terminal, Variable};
use videg_circuit::{Circuit, Error, Settings, State, names};

use crate::harvesting::{Harvesting, REST_CAPACITANCE, handed_over};
use crate::variables::VARIABLES;

/// There are no directional derivatives: those that FMI 2.0 means in co-simulation, of the voltages and energies at the end
/// of a step with respect to the capacitances given for it, would have to be carried through each switching of the diodes.
impl Slave for Harvesting {
    const INFO: ModelInfo = ModelInfo::new("HarvestingCircuit")
        .description(
            "Energy-harvesting circuit with two time-varying capacitors: diode, Zener or switch, load or storage",
        )
        .author("The videg developers")
        .version(env!("CARGO_PKG_VERSION"))
        .copyright("Copyright (c) The videg developers")
        .license("MIT OR Apache-2.0")
        .generation_tool(concat!("videg ", env!("CARGO_PKG_VERSION")))
        .default_experiment(0.0, 100.0, 1e-3)
        .can_serialize()
        .terminals(&[
            Terminal {
                name: "left",
                description: "Left membrane, as a harvester sees it",
                members: &[("capacitance", names::LEFT_CAPACITANCE), ("voltage", names::LEFT_VOLTAGE)],
            },
            Terminal {
                name: "right",
                description: "Right membrane, as a harvester sees it",
                members: &[("capacitance", names::RIGHT_CAPACITANCE), ("voltage", names::RIGHT_VOLTAGE)],
            },
        ]);

    fn variables() -> &'static [Variable<Self>] {
        &VARIABLES
    }

    fn new() -> Self {
        let (settings, capacitance) = (Settings::default(), [REST_CAPACITANCE; 2]);
        Self { settings, capacitance, rate: [None; 2], circuit: Circuit::new(settings.parameters(), capacitance) }
    }

    fn update(&mut self) {
        self.circuit = Circuit::new(self.settings.parameters(), handed_over(self.capacitance, [REST_CAPACITANCE; 2]));
    }

    fn initialize(&mut self, _log: &Logger) -> Result<(), SlaveError> {
        self.running().map(|_| ())
    }

    /// The capacitances run linearly over the step: from the values set, at the rates set, or else from where they were
    /// to the values set. No membrane has a capacitance of 0: masters that start all signals at 0 mean that they have none
    /// yet, and it stays what it was.
    fn do_step(&mut self, _t: f64, h: f64, _log: &Logger) -> Result<(), SlaveError> {
        let rate = core::mem::take(&mut self.rate);
        let present = self.running()?.capacitance();
        let capacitance = handed_over(self.capacitance, present);
        let start = [0, 1].map(|j| if rate[j].is_some() { capacitance[j] } else { present[j] });
        let end = [0, 1].map(|j| rate[j].map_or(capacitance[j], |rate| capacitance[j] + rate * h));
        let circuit = self.running()?;
        let stepped = circuit.advance(0.0, start).and_then(|()| circuit.advance(h, end));
        stepped.map_err(|error| SlaveError::error(error.to_string()))?;
        self.capacitance = end;
        Ok(())
    }

    /// Parameters, inputs and, once it has a state of its own, the circuit.
    fn write_state(&self, out: &mut StateWriter) -> Result<(), StateError> {
        // Otherwise it follows from the parameters; if they have changed since it was made, it is made anew anyway.
        let circuit = self.circuit().filter(|circuit| *circuit.parameters() == self.settings.parameters());
        out.write_parameters(self)?;
        out.write(&(self.capacitance, self.rate, circuit.map(Circuit::state)))
    }

    fn read_state(from: &mut StateReader<'_>, _: &Self) -> Result<Self, StateError> {
        let mut slave = Self::new();
        from.read_parameters(&mut slave)?;
        let state: Option<State>;
        (slave.capacitance, slave.rate, state) = from.take()?;
        let mut values = slave.capacitance.into_iter().chain(slave.rate.into_iter().flatten());
        if let Some(bad) = values.find(|value| !value.is_finite()) {
            return Err(StateError::Invalid(format!("a capacitance or its rate is {bad}")));
        }
        if let Some(state) = state {
            let invalid = |error: Error| StateError::Invalid(error.to_string());
            let mut circuit = Circuit::new(slave.settings.parameters(), state.capacitance).map_err(invalid)?;
            circuit.restore(&state).map_err(invalid)?;
            slave.circuit = Ok(circuit);
        } else {
            slave.update();
        }
        Ok(slave)
    }
}
