//! The embedded solver as a circuit that the master can step.

use videg_circuit::{Circuit, Settings, State};

use super::{CircuitSample, CircuitSlave, CosimError};
use crate::scenario::Setting;
use fmu_import::unit_hint;

/// The solver of `videg-circuit`, called directly.
pub struct EmbeddedCircuit {
    label: String,
    circuit: Circuit,
    kept: State,
}

impl EmbeddedCircuit {
    /// A circuit with `settings`, both membranes charged, at `capacitance` (left, right), F.
    pub fn new(label: &str, settings: &Settings, capacitance: [f64; 2]) -> Result<Self, CosimError> {
        let circuit = Circuit::new(settings.parameters(), capacitance)
            .map_err(|cause| CosimError::Circuit { label: label.to_owned(), cause })?;
        let kept = circuit.state();
        Ok(Self { label: label.to_owned(), circuit, kept })
    }

    fn failed(&self, cause: videg_circuit::Error) -> CosimError {
        CosimError::Circuit { label: self.label.clone(), cause }
    }

    /// Takes a setting by its name, if the circuit has such a variable; says whether it had.
    ///
    /// # Errors
    /// A value that is no number, out of bounds, or no item of the choice.
    pub fn apply(settings: &mut Settings, setting: &Setting) -> Result<bool, CosimError> {
        let fail = |bound: String| {
            let (name, value) = (setting.name.clone(), setting.value.clone());
            Err(CosimError::Setting { place: setting.place(), name, value, bound })
        };
        if let Some(quantity) = Settings::QUANTITIES.iter().find(|quantity| quantity.name == setting.name) {
            return match setting.value.parse::<f64>() {
                Ok(value) if value >= quantity.min && value <= quantity.max => {
                    (quantity.set)(settings, value);
                    Ok(true)
                }
                Ok(_) => fail(format!("allowed: {} to {} {}", quantity.min, quantity.max, quantity.unit)),
                Err(_) => {
                    let hint = unit_hint(&setting.value, Some(quantity.unit)).map(|hint| format!(" {hint}"));
                    fail(format!("not a number{}", hint.unwrap_or_else(|| format!(" [{}]", quantity.unit))))
                }
            };
        }
        let Some(choice) = Settings::CHOICES.iter().find(|choice| choice.name == setting.name) else {
            return Ok(false);
        };
        if choice.choose(settings, &setting.value) {
            return Ok(true);
        }
        let items: Vec<_> = choice.items.iter().map(|(name, _)| *name).collect();
        fail(format!("allowed: {}", items.join(", ")))
    }
}

impl CircuitSlave for EmbeddedCircuit {
    fn label(&self) -> &str {
        &self.label
    }

    fn step(&mut self, _time: f64, step: f64, start: [f64; 2], end: [f64; 2]) -> Result<(), CosimError> {
        let stepped = self.circuit.advance(0.0, start).and_then(|()| self.circuit.advance(step, end));
        stepped.map_err(|cause| self.failed(cause))
    }

    fn sample(&self) -> Result<CircuitSample, CosimError> {
        Ok(CircuitSample::from(&self.circuit))
    }

    fn save(&mut self) -> Result<(), CosimError> {
        self.kept = self.circuit.state();
        Ok(())
    }

    fn restore(&mut self) -> Result<(), CosimError> {
        self.circuit.restore(&self.kept).map_err(|cause| self.failed(cause))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_of_the_circuit_are_taken_by_name_and_others_left_alone() {
        let mut settings = Settings::default();
        let mut apply = |text| EmbeddedCircuit::apply(&mut settings, &Setting::parse(text).unwrap());
        assert!(!apply("ball.mass=1").unwrap());
        assert!(apply("load.resistance=inf").unwrap() && apply("topology=isolated").unwrap());
        for (text, expected) in [
            ("topology=star", "--set topology: topology = star: allowed: sharedNode, isolated"),
            ("load.resistance=-1", "--set load.resistance: load.resistance = -1: allowed: 0 to inf Ohm"),
            ("load.resistance=NaN", "--set load.resistance: load.resistance = NaN: allowed: 0 to inf Ohm"),
            ("supply.voltage=2kV", "--set supply.voltage: supply.voltage = 2kV: not a number in V; did you mean 2000?"),
            ("supply.voltage=much", "--set supply.voltage: supply.voltage = much: not a number [V]"),
        ] {
            assert_eq!(apply(text).unwrap_err().to_string(), expected);
        }
        assert_eq!(settings.circuit.load_resistance, f64::INFINITY);
        assert_eq!(settings.circuit.topology, videg_circuit::Topology::Isolated);
    }
}
