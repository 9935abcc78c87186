//! An FMU as a circuit that the master can step: `HarvestingCircuit`, or a user's with a [`Mapping`].

use super::instance::{SavedState, begin};
use super::mapping::{Connection, Mapping, Wire};
use super::{CircuitSample, CircuitSlave, CosimError};
use crate::scenario::Setting;
use fmu_import::{Fmu, Instance, Kind, nearest_name};
use videg_circuit::Settings;

/// A circuit FMU of the user, and what of it counts.
#[derive(Clone, Copy)]
pub struct ForeignCircuit<'a> {
    /// The FMU.
    pub fmu: &'a Fmu,
    /// Its names for the variables of a circuit.
    pub mapping: &'a Mapping,
    /// Real variables whose waveforms are wanted.
    pub probes: &'a [String],
}

/// A circuit in an FMU. If it can interpolate inputs, the capacitances go in with their first derivative, so that they run linearly over
/// each step as they do for the embedded solver; otherwise they have the value of the step's end.
pub struct FmuCircuit {
    label: String,
    instance: Instance,
    connection: Connection,
    /// Value references of the inputs.
    inputs: Vec<u32>,
    outputs: Vec<u32>,
    /// At the communication point.
    sample: CircuitSample,
    membranes: MembraneEnergy,
    saved: (SavedState, CircuitSample, MembraneEnergy),
    probes: Vec<String>,
    probe_references: Vec<u32>,
    probed: Vec<f64>,
    notes: Vec<String>,
}

/// Energies of the membranes from C(t) and U(t), for an FMU that does not tell them.
#[derive(Debug, Clone, Copy, Default)]
struct MembraneEnergy {
    /// F
    capacitance: [f64; 2],
    /// V
    voltage: [f64; 2],
    /// Energy stored at the start, J.
    initial: f64,
    /// Work of the mechanics so far, J.
    mechanical: f64,
}

impl MembraneEnergy {
    fn new(capacitance: [f64; 2], voltage: [f64; 2]) -> Self {
        let membranes = Self { capacitance, voltage, ..Self::default() };
        Self { initial: membranes.energy(), ..membranes }
    }

    fn energy(&self) -> f64 {
        (0..2).map(|side| 0.5 * self.capacitance[side] * self.voltage[side].powi(2)).sum()
    }

    /// The integral of -1/2 U^2 dC up to the next point. The product of the voltages at both ends stands for U^2: that is exact at
    /// constant voltage and at constant charge.
    fn add(&mut self, capacitance: [f64; 2], voltage: [f64; 2]) {
        for side in 0..2 {
            let change = capacitance[side] - self.capacitance[side];
            self.mechanical -= 0.5 * self.voltage[side] * voltage[side] * change;
        }
        (self.capacitance, self.voltage) = (capacitance, voltage);
    }

    /// The `sample` with the energies that the FMU does not tell.
    fn complete(&self, mut sample: CircuitSample) -> CircuitSample {
        let ledger = &mut sample.ledger;
        if ledger.stored.is_nan() {
            ledger.stored = self.energy() - self.initial;
        }
        if ledger.mechanical.is_nan() {
            ledger.mechanical = self.mechanical;
        }
        sample
    }
}

impl FmuCircuit {
    /// Instantiates `fmu`, which has the names of `HarvestingCircuit`, and initialises it with `settings` at `capacitance` (left,
    /// right), F, from 0 to `until`, s.
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
        Self::with(label, fmu, Mapping::default().connect(fmu.description())?, &[], settings, capacitance, until)
    }

    /// The same with the variables of `connection`, and with the waveforms of `probes`.
    pub(super) fn with(
        label: &str,
        fmu: &Fmu,
        connection: Connection,
        probes: &[String],
        settings: &[Setting],
        capacitance: [f64; 2],
        until: f64,
    ) -> Result<Self, CosimError> {
        let description = fmu.description();
        let probe_references = probes.iter().map(|name| real(description, name)).collect::<Result<Vec<_>, _>>()?;
        let mut notes = Vec::new();
        if !connection.interpolates {
            notes.push(format!(
                "{}: takes no derivatives of inputs (canInterpolateInputs), so C(t) goes in as steps; the error is of first order in \
                 --step",
                description.model_name
            ));
        }
        let mut instance = begin(fmu, "circuit", Some(until), settings, |setting| setting.value.as_str().into())?;
        let references = |wires: &[Wire]| wires.iter().map(|wire| wire.reference).collect::<Vec<_>>();
        let (inputs, outputs) = (references(&connection.inputs), references(&connection.outputs));
        instance.set_real(&inputs, &connection.scaled(capacitance)[..inputs.len()])?;
        instance.exit_initialization_mode()?;
        let mut circuit = Self {
            label: label.to_owned(),
            instance,
            connection,
            inputs,
            outputs,
            sample: CircuitSample::default(),
            membranes: MembraneEnergy::default(),
            saved: (SavedState::default(), CircuitSample::default(), MembraneEnergy::default()),
            probes: probes.to_vec(),
            probed: vec![0.0; probe_references.len()],
            probe_references,
            notes,
        };
        let sample = circuit.read()?;
        circuit.instance.get_real(&circuit.probe_references, &mut circuit.probed)?;
        circuit.membranes = MembraneEnergy::new(capacitance, sample.voltage);
        circuit.sample = circuit.membranes.complete(sample);
        Ok(circuit)
    }

    /// The outputs as the FMU has them; NaN for what it does not tell.
    fn read(&self) -> Result<CircuitSample, CosimError> {
        let mut values = [0.0; CircuitSample::NAMES.len()];
        let values = &mut values[..self.outputs.len()];
        self.instance.get_real(&self.outputs, values)?;
        if let Some(index) = values.iter().position(|value| !value.is_finite()) {
            let variable = self.connection.outputs[index].variable.clone();
            return Err(CosimError::NotFinite { label: self.label.clone(), variable, value: values[index] });
        }
        Ok(CircuitSample::from_columns(self.connection.columns(values)))
    }

    /// Every setting as text for the FMU. Numbers read back to the same bits.
    pub fn settings(settings: &Settings) -> Vec<Setting> {
        let quantities = Settings::QUANTITIES.iter().map(|q| (q.name, format!("{:?}", (q.get)(settings))));
        let choices = Settings::CHOICES.iter().map(|c| (c.name, c.chosen(settings).to_owned()));
        quantities.chain(choices).map(|(name, value)| Setting::new(name, value)).collect()
    }
}

/// The value reference of the Real variable called `name`.
fn real(description: &fmu_import::ModelDescription, name: &str) -> Result<u32, CosimError> {
    let reals = || description.variables.iter().filter(|it| matches!(it.kind, Kind::Real { .. }));
    let found = reals().find(|it| it.name == name).map(|it| it.value_reference);
    found.ok_or_else(|| {
        let nearest = nearest_name(name, reals().map(|it| it.name.as_str()));
        let hint = nearest.map_or_else(String::new, |nearest| format!("; did you mean {nearest}?"));
        let reason = format!("{} has no such Real variable{hint}", description.model_name);
        CosimError::Element { option: "--probe".to_owned(), name: name.to_owned(), reason }
    })
}

impl Connection {
    /// The inputs of the FMU, as many as it has, for `values` in SI units (left, right).
    fn scaled(&self, values: [f64; 2]) -> [f64; 2] {
        let mut scaled = [0.0; 2];
        for (wire, scaled) in self.inputs.iter().zip(&mut scaled) {
            *scaled = wire.factor * values[wire.ours];
        }
        scaled
    }

    /// The outputs by index from the `values` of the FMU; NaN for those that are not known.
    fn columns(&self, values: &[f64]) -> [f64; CircuitSample::NAMES.len()] {
        let mut columns = [f64::NAN; CircuitSample::NAMES.len()];
        self.zero.iter().for_each(|&column| columns[column] = 0.0);
        for (wire, value) in self.outputs.iter().zip(values) {
            columns[wire.ours] = value / wire.factor;
        }
        columns
    }
}

impl CircuitSlave for FmuCircuit {
    fn label(&self) -> &str {
        &self.label
    }

    fn step(&mut self, time: f64, step: f64, start: [f64; 2], end: [f64; 2]) -> Result<(), CosimError> {
        let count = self.inputs.len();
        if self.connection.interpolates {
            let rate = self.connection.scaled([0, 1].map(|j| (end[j] - start[j]) / step));
            self.instance.set_real(&self.inputs, &self.connection.scaled(start)[..count])?;
            self.instance.set_real_input_derivatives(&self.inputs, &[1, 1][..count], &rate[..count])?;
        } else {
            self.instance.set_real(&self.inputs, &self.connection.scaled(end)[..count])?;
        }
        self.instance.do_step(time, step)?;
        self.instance.get_real(&self.probe_references, &mut self.probed)?;
        let sample = self.read()?;
        self.membranes.add(end, sample.voltage);
        self.sample = self.membranes.complete(sample);
        Ok(())
    }

    fn sample(&self) -> Result<CircuitSample, CosimError> {
        Ok(self.sample)
    }

    fn probes(&self) -> (&[String], &[f64]) {
        (&self.probes, &self.probed)
    }

    fn notes(&self) -> &[String] {
        &self.notes
    }

    fn save(&mut self) -> Result<(), CosimError> {
        (self.saved.1, self.saved.2) = (self.sample, self.membranes);
        self.saved.0.save(&self.instance)
    }

    fn restore(&mut self) -> Result<(), CosimError> {
        (self.sample, self.membranes) = (self.saved.1, self.saved.2);
        self.saved.0.restore(&mut self.instance)
    }
}
