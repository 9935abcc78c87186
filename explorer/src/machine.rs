//! A generator with all its parameters.

use std::cell::Cell;

use videg_circuit::{Release, Settings};
use videg_coupled::{Impacts, TOLERANCE, Times};
use videg_data::{membrane, recording};
use videg_model::{ForceTable, Recording, Setup};
use wasm_bindgen::prelude::wasm_bindgen;

use crate::setter::{Setter, Values};

/// A generator: parameters of harvester and circuit, and the files that it takes.
#[wasm_bindgen]
#[derive(Debug, Clone, Default)]
pub struct Machine {
    pub(crate) values: Values,
    recording: Option<Recording>,
    table: Option<ForceTable>,
    /// The circuit beside the harvester in runs up to a time, s, once it is known.
    resolved: Cell<Option<(f64, Settings)>>,
}

#[wasm_bindgen]
impl Machine {
    /// The machine of the start values.
    #[wasm_bindgen(constructor)]
    pub fn new() -> Self {
        Self::default()
    }

    /// Sets all variables back to their start values; the files stay.
    pub fn clear(&mut self) {
        self.values = Values::default();
        self.resolved.take();
    }

    /// Sets the variable called `name`; a choice by its number, a switch as 0 or 1.
    ///
    /// # Errors
    /// If there is no such variable, or a choice is no whole number.
    pub fn set(&mut self, name: &str, value: f64) -> Result<(), String> {
        self.resolved.take();
        Setter::of(name)?.set(&mut self.values, value).map_err(|error| format!("{name}: {error}"))
    }

    /// Takes the recorded excitation of a file of this `text`; an empty text is none.
    ///
    /// # Errors
    /// The first line that is not one of a recording.
    #[wasm_bindgen(js_name = setRecording)]
    pub fn set_recording(&mut self, text: &str) -> Result<(), String> {
        self.resolved.take();
        let read = |text: &str| recording::parse(text.as_bytes()).map_err(|error| error.to_string());
        self.recording = Some(text).filter(|text| !text.is_empty()).map(read).transpose()?;
        Ok(())
    }

    /// Takes the measured membrane of a file of this `text`; an empty text is none.
    ///
    /// # Errors
    /// The first line that is not one of a membrane.
    #[wasm_bindgen(js_name = setTable)]
    pub fn set_table(&mut self, text: &str) -> Result<(), String> {
        self.resolved.take();
        let read = |text: &str| membrane::parse(text.as_bytes()).map_err(|error| error.to_string());
        self.table = Some(text).filter(|text| !text.is_empty()).map(read).transpose()?;
        Ok(())
    }

    /// What follows from the parameters, in the order of [`Machine::derived_names`].
    ///
    /// # Errors
    /// Parameters that the harvester refuses.
    pub fn derived(&self) -> Result<Vec<f64>, String> {
        let setup = self.setup();
        setup.validate().map_err(|error| error.to_string())?;
        let p = setup.parameters;
        let membrane = videg_model::Membrane::new(setup);
        Ok(vec![
            p.travel(),
            p.membrane_radius(),
            p.membrane_thickness(),
            membrane.rest_capacitance(),
            p.cylinder_amplitude(),
            p.normalized_amplitude(),
        ])
    }

    /// Names of what [`Machine::derived`] gives.
    #[wasm_bindgen(js_name = derivedNames)]
    pub fn derived_names() -> Vec<String> {
        ["travel", "membraneRadius", "membraneThickness", "restCapacitance", "cylinderAmplitude", "gamma"]
            .map(ToOwned::to_owned)
            .to_vec()
    }

    /// Voltages of supply, Zener diode or switch, and storage, V: what was asked for, or what follows from the harvester.
    ///
    /// # Errors
    /// Parameters that the harvester refuses.
    pub fn voltages(&self, until: f64) -> Result<Vec<f64>, String> {
        let circuit = self.settings(until)?.circuit;
        Ok(vec![circuit.supply_voltage, circuit.zener_voltage, circuit.storage_voltage])
    }
}

impl Machine {
    pub(crate) fn setup(&self) -> Setup<'_> {
        // A table is taken only where the law asks for it, so that one may look at both.
        let is_measured = self.values.parameters.membrane_law == videg_model::MembraneLaw::Table;
        let table = self.table.as_ref().filter(|_| is_measured);
        Setup { recording: self.recording.as_ref(), table, ..(&self.values.parameters).into() }
    }

    /// The circuit beside the harvester, whose best release voltage is that of a run up to `until`, s.
    pub(crate) fn settings(&self, until: f64) -> Result<Settings, String> {
        if let Some((_, settings)) = self.resolved.get().filter(|(known, _)| *known == until) {
            return Ok(settings);
        }
        let Values { parameters, circuit, given } = self.values;
        let chooses = circuit.circuit.release == Release::Storage && !given.storage;
        let ratio = || Impacts::of(self.setup(), [0.0, until]).map(|impacts| impacts.best_ratio());
        let ratio = if chooses { ratio().map_err(|error| error.to_string())? } else { 1.0 };
        let settings = given.complete(circuit, parameters.bias_voltage, ratio);
        self.resolved.set(Some((until, settings)));
        Ok(settings)
    }

    /// The same machine with another value of a variable.
    pub(crate) fn with(&self, setter: Setter, value: f64) -> Result<Self, String> {
        let mut other = self.clone();
        other.resolved.take();
        setter.set(&mut other.values, value)?;
        Ok(other)
    }
}

/// Times of a run that is averaged from `from` to its end `until`, s.
pub(crate) fn times(from: f64, until: f64) -> Times {
    Times { until, window: [from, until], tolerance: TOLERANCE }
}
