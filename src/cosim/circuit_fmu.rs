//! The FMU `HarvestingCircuit`, or any that speaks the same names, as a circuit that the master can step.

use super::instance::{SavedState, read, references};
use super::{CircuitSample, CircuitSlave, CosimError};
use crate::scenario::Setting;
use fmu_import::{Fmu, Instance, Logging};
use videg_circuit::Settings;

/// The FMU `HarvestingCircuit`. The capacitances go in with their first derivative, so that they run linearly over each
/// step as they do for the embedded solver.
pub struct FmuCircuit {
    label: String,
    instance: Instance,
    inputs: [u32; 2],
    outputs: [u32; CircuitSample::NAMES.len()],
    saved: SavedState,
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
        instance.begin_initialization(
            0.0,
            Some(until),
            settings,
            |it| fmu.description().is_input(&it.name),
            |instance, setting| instance.set_by_name(&setting.name, &setting.value),
        )?;
        let inputs = references(fmu, ["left.capacitance", "right.capacitance"])?;
        let outputs = references(fmu, CircuitSample::NAMES)?;
        instance.set_real(&inputs, &capacitance)?;
        instance.exit_initialization_mode()?;
        Ok(Self { label: label.to_owned(), instance, inputs, outputs, saved: SavedState::default() })
    }

    /// Every setting as text for the FMU. Numbers read back to the same bits.
    pub fn settings(settings: &Settings) -> Vec<Setting> {
        let quantities = Settings::QUANTITIES.iter().map(|q| (q.name, format!("{:?}", (q.get)(settings))));
        let choices = Settings::CHOICES.iter().map(|c| (c.name, c.chosen(settings).to_owned()));
        quantities.chain(choices).map(|(name, value)| Setting::new(name, value)).collect()
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
        read(&self.instance, &self.outputs).map(CircuitSample::from_columns)
    }

    fn save(&mut self) -> Result<(), CosimError> {
        self.saved.save(&self.instance)
    }

    fn restore(&mut self) -> Result<(), CosimError> {
        self.saved.restore(&mut self.instance)
    }
}
