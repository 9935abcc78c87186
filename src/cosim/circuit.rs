//! Circuits as the master sees them: the embedded solver, and the FMU around it or any that speaks the same names.

use videg_circuit::{Circuit, Ledger, Settings};

use super::CosimError;
use crate::fmi::{Fmu, Instance, Logging};
use crate::scenario::Setting;

/// Outputs of a circuit at one communication point.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct CircuitSample {
    /// Voltages of the membranes, left and right, V.
    pub voltage: [f64; 2],
    /// Voltage across the load, V.
    pub load_voltage: f64,
    /// Current through the load, A.
    pub load_current: f64,
    /// Current from the supply, A.
    pub supply_current: f64,
    /// Energies and charges so far.
    pub ledger: Ledger,
}

impl CircuitSample {
    /// Names of [`CircuitSample::columns`], as the FMU `HarvestingCircuit` has them.
    pub const NAMES: [&'static str; 13] = [
        "left.voltage",
        "right.voltage",
        "load.voltage",
        "load.current",
        "supply.current",
        "supply.energy",
        "load.energy",
        "zener.energy",
        "diode.energy",
        "stored.energy",
        "mechanical.energy",
        "supply.charge",
        "load.charge",
    ];

    /// The values as a row of a time series.
    pub fn columns(&self) -> [f64; Self::NAMES.len()] {
        let Ledger { supply, load, zener, diode, stored, mechanical, supply_charge, load_charge } = self.ledger;
        let [left, right] = self.voltage;
        let energies = [supply, load, zener, diode, stored, mechanical];
        let mut row = [0.0; Self::NAMES.len()];
        row[..5].copy_from_slice(&[left, right, self.load_voltage, self.load_current, self.supply_current]);
        row[5..11].copy_from_slice(&energies);
        row[11..].copy_from_slice(&[supply_charge, load_charge]);
        row
    }

    /// The sample of which these are the [`columns`](Self::columns).
    pub fn from_columns(row: [f64; Self::NAMES.len()]) -> Self {
        let [
            left,
            right,
            load_voltage,
            load_current,
            supply_current,
            supply,
            load,
            zener,
            diode,
            stored,
            mechanical,
            q_in,
            q_out,
        ] = row;
        let ledger = Ledger { supply, load, zener, diode, stored, mechanical, supply_charge: q_in, load_charge: q_out };
        Self { voltage: [left, right], load_voltage, load_current, supply_current, ledger }
    }
}

/// A circuit that the master can step.
pub trait CircuitSlave {
    /// What the circuit is called in tables.
    fn label(&self) -> &str;

    /// Steps from `time` by `step`, s, while the capacitances (left, right), F, run linearly from `start` to `end`.
    ///
    /// # Errors
    /// What the circuit says.
    fn step(&mut self, time: f64, step: f64, start: [f64; 2], end: [f64; 2]) -> Result<(), CosimError>;

    /// Outputs at the communication point.
    ///
    /// # Errors
    /// What the circuit says.
    fn sample(&self) -> Result<CircuitSample, CosimError>;
}

/// The solver of `videg-circuit`, called directly.
pub struct EmbeddedCircuit {
    label: String,
    circuit: Circuit,
}

impl EmbeddedCircuit {
    /// A circuit with `settings`, both membranes charged, at `capacitance` (left, right), F.
    ///
    /// # Errors
    /// Settings out of bounds.
    pub fn new(label: &str, settings: &Settings, capacitance: [f64; 2]) -> Result<Self, CosimError> {
        let circuit = Circuit::new(settings.parameters(), capacitance)
            .map_err(|cause| CosimError::Circuit { label: label.to_owned(), cause })?;
        Ok(Self { label: label.to_owned(), circuit })
    }

    /// Takes a setting by its name, if the circuit has such a variable; says whether it had.
    ///
    /// # Errors
    /// A value that is no number, out of bounds, or no item of the choice.
    pub fn apply(settings: &mut Settings, setting: &Setting) -> Result<bool, CosimError> {
        let fail = |bound: String| {
            Err(CosimError::Setting { name: setting.name.clone(), value: setting.value.clone(), bound })
        };
        if let Some(quantity) = Settings::QUANTITIES.iter().find(|quantity| quantity.name == setting.name) {
            return match setting.value.parse::<f64>() {
                Ok(value) if value >= quantity.min && value <= quantity.max => {
                    (quantity.set)(settings, value);
                    Ok(true)
                }
                Ok(_) => fail(format!("allowed: {} to {} {}", quantity.min, quantity.max, quantity.unit)),
                Err(_) => fail(format!("not a number [{}]", quantity.unit)),
            };
        }
        let Some(choice) = Settings::CHOICES.iter().find(|choice| choice.name == setting.name) else {
            return Ok(false);
        };
        if let Some(item) = choice.items.iter().position(|(name, _)| *name == setting.value) {
            (choice.set)(settings, item);
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
        stepped.map_err(|cause| CosimError::Circuit { label: self.label.clone(), cause })
    }

    fn sample(&self) -> Result<CircuitSample, CosimError> {
        let c = &self.circuit;
        Ok(CircuitSample {
            voltage: c.voltage(),
            load_voltage: c.load_voltage(),
            load_current: c.load_current(),
            supply_current: c.supply_current(),
            ledger: c.ledger(),
        })
    }
}

/// The FMU `HarvestingCircuit`. The capacitances go in with their first derivative, so that they run linearly over each
/// step as they do for the embedded solver.
pub struct FmuCircuit {
    label: String,
    instance: Instance,
    inputs: [u32; 2],
    outputs: [u32; CircuitSample::NAMES.len()],
}

impl FmuCircuit {
    /// Instantiates `fmu` and initialises it with `settings` at `capacitance` (left, right), F, from 0 to `until`, s.
    ///
    /// # Errors
    /// A setting that the FMU refuses, or an FMU that lacks a variable.
    pub fn new(
        label: &str,
        fmu: &Fmu,
        settings: &[Setting],
        capacitance: [f64; 2],
        until: f64,
    ) -> Result<Self, CosimError> {
        let mut instance = fmu.instantiate("circuit", Logging::default())?;
        for setting in settings {
            instance.set_by_name(&setting.name, &setting.value)?;
        }
        let reference = |name: &str| Ok::<_, CosimError>(fmu.description().variable(name)?.value_reference);
        let inputs = [reference("left.capacitance")?, reference("right.capacitance")?];
        let mut outputs = [0; CircuitSample::NAMES.len()];
        for (slot, name) in outputs.iter_mut().zip(CircuitSample::NAMES) {
            *slot = reference(name)?;
        }
        instance.setup_experiment(0.0, Some(until), None)?;
        instance.enter_initialization_mode()?;
        instance.set_real(&inputs, &capacitance)?;
        instance.exit_initialization_mode()?;
        Ok(Self { label: label.to_owned(), instance, inputs, outputs })
    }
}

impl CircuitSlave for FmuCircuit {
    fn label(&self) -> &str {
        &self.label
    }

    fn step(&mut self, time: f64, step: f64, start: [f64; 2], end: [f64; 2]) -> Result<(), CosimError> {
        let rate = [0, 1].map(|j| (end[j] - start[j]) / step);
        self.instance.set_real(&self.inputs, &start)?;
        self.instance.set_real_input_derivatives(&self.inputs, &[1, 1], &rate)?;
        Ok(self.instance.do_step(time, step)?)
    }

    fn sample(&self) -> Result<CircuitSample, CosimError> {
        let mut row = [0.0; CircuitSample::NAMES.len()];
        self.instance.get_real(&self.outputs, &mut row)?;
        Ok(CircuitSample::from_columns(row))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn apply(text: &str) -> Result<(bool, Settings), CosimError> {
        let mut settings = Settings::default();
        let found = EmbeddedCircuit::apply(&mut settings, &Setting::parse(text).unwrap())?;
        Ok((found, settings))
    }

    #[test]
    fn settings_of_the_circuit_are_taken_by_name_and_others_left_alone() {
        assert_eq!(apply("load.resistance=inf").unwrap().1.circuit.load_resistance, f64::INFINITY);
        assert_eq!(apply("topology=isolated").unwrap().1.circuit.topology, videg_circuit::Topology::Isolated);
        assert!(!apply("ball.mass=1").unwrap().0);
    }

    #[test]
    fn a_value_that_the_circuit_cannot_take_is_named_with_its_bound() {
        for (text, expected) in [
            ("topology=star", "topology = star: allowed: sharedNode, isolated"),
            ("load.resistance=-1", "load.resistance = -1: allowed: 0 to inf Ohm"),
            ("load.resistance=NaN", "load.resistance = NaN: allowed: 0 to inf Ohm"),
            ("supply.voltage=much", "supply.voltage = much: not a number [V]"),
        ] {
            assert_eq!(apply(text).unwrap_err().to_string(), expected);
        }
    }

    #[test]
    fn a_row_of_numbers_makes_the_sample_that_made_it() {
        let mut row = [0.0; CircuitSample::NAMES.len()];
        row.iter_mut().enumerate().for_each(|(k, value)| *value = k as f64);
        assert_eq!(CircuitSample::from_columns(row).columns(), row);
    }
}
