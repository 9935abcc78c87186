//! What the importer sets, and the model that is driven by it.

use std::cell::Cell;
use std::sync::Arc;

use videg_model::{ForceTable, Harvester as Model, ModelError, Parameters, Recording, Setup, Side};

use crate::file::{Files, Loaded};

/// External force, N, and its rate, N/s, voltages, V, and their rates, V/s.
type Inputs = [[f64; 2]; 3];

/// Times that a model predicts, s: the largest double where there is none.
#[derive(Clone, Copy)]
pub(crate) enum Predicted {
    NextImpact,
    NextKnot,
    KnownUntil,
}

impl Predicted {
    const ALL: [Self; 3] = [Self::NextImpact, Self::NextKnot, Self::KnownUntil];

    fn by(self, model: &Model) -> f64 {
        let time = match self {
            Self::NextImpact => model.next_impact(),
            Self::NextKnot => model.next_knot(),
            Self::KnownUntil => Some(model.known_until()),
        };
        time.unwrap_or(f64::MAX)
    }
}

/// The harvester as a slave.
pub struct Harvester {
    pub(crate) parameters: Parameters,
    /// Shared by all saved states.
    pub(crate) files: Arc<Files>,
    pub(crate) external_force: f64,
    pub(crate) external_force_rate: f64,
    pub(crate) voltages: [f64; 2],
    pub(crate) voltage_rates: [f64; 2],
    pub(crate) start_time: f64,
    /// The model runs under an integrator of the importer's: model exchange.
    pub(crate) placed: bool,
    /// Voltages that have not changed since the limits were checked with both membranes flat, V; NaN if they have.
    pub(crate) checked: [f64; 2],
    /// What the model predicts under these inputs, if they are not those it runs under and somebody has asked.
    pub(crate) predicted: Cell<Option<(Inputs, [f64; 3])>>,
    /// The last impact that was seen: side, and relative speed, m/s.
    pub(crate) last_impact: Option<(Side, f64)>,
    /// It is of the present time.
    pub(crate) has_hit: bool,
    /// The model, or why there is none; before initialisation it is made anew from the parameters whenever they are read.
    pub(crate) model: Result<Model, String>,
}

impl Clone for Harvester {
    fn clone(&self) -> Self {
        let predicted = Cell::new(self.predicted.get());
        Self { files: self.files.clone(), model: self.model.clone(), predicted, ..*self }
    }

    /// Takes no memory that is there already, and counts nothing that is shared already.
    fn clone_from(&mut self, source: &Self) {
        let Self {
            parameters,
            ref files,
            external_force,
            external_force_rate,
            voltages,
            voltage_rates,
            start_time,
            placed,
            checked,
            ref predicted,
            last_impact,
            has_hit,
            ref model,
        } = *source;
        self.model.clone_from(model);
        if !Arc::ptr_eq(&self.files, files) {
            self.files.clone_from(files);
        }
        (self.parameters, self.start_time, self.placed, self.checked) = (parameters, start_time, placed, checked);
        (self.external_force, self.external_force_rate) = (external_force, external_force_rate);
        (self.voltages, self.voltage_rates) = (voltages, voltage_rates);
        (self.last_impact, self.has_hit) = (last_impact, has_hit);
        self.predicted.set(predicted.get());
    }
}

impl Harvester {
    /// Reads a value from the model; NaN while the parameters contradict each other (before initialisation only).
    pub(crate) fn read(&self, value: impl FnOnce(&Model) -> f64) -> f64 {
        self.model.as_ref().map_or(f64::NAN, value)
    }

    fn inputs(&self) -> Inputs {
        [[self.external_force, self.external_force_rate], self.voltages, self.voltage_rates]
    }

    /// A time, s, that the model predicts under the inputs as they are set.
    pub(crate) fn predicted(&self, time: Predicted) -> f64 {
        let inputs = self.inputs();
        if let Some((under, times)) = self.predicted.get()
            && under == inputs
        {
            return times[time as usize];
        }
        self.read(|model| {
            let Some(model) = self.pending(model) else { return time.by(model) };
            let times = Predicted::ALL.map(|time| time.by(&model));
            self.predicted.set(Some((inputs, times)));
            times[time as usize]
        })
    }

    /// The model under the inputs as they are set, if it does not run under these: it takes them over with the next step.
    /// None, too, if it refuses them, which that step says.
    pub(crate) fn pending(&self, model: &Model) -> Option<Model> {
        let [force, voltages, rates] = self.inputs();
        if self.placed || model.has_inputs(force, voltages, rates) {
            return None;
        }
        model.under_inputs(force, voltages, rates).ok()
    }

    /// W of an impact at this relative speed, m/s, J: Eq. (13).
    pub(crate) fn impact_energy(&self, speed: f64) -> f64 {
        let bias = self.parameters.bias_voltage;
        self.read(|model| model.membrane().impact_energy(bias, speed))
    }

    /// How that of the last impact changes with its speed, J s/m, by central differences of the fourth order.
    pub(crate) fn energy_slope(&self) -> f64 {
        let Some((_, speed)) = self.last_impact.filter(|(_, speed)| *speed > 0.0) else { return 0.0 };
        let h = 1e-3 * speed;
        let [far, near, back, far_back] = [2.0, 1.0, -1.0, -2.0].map(|k| self.impact_energy(speed + k * h));
        (8.0 * (near - back) - (far - far_back)) / (12.0 * h)
    }

    /// The model, once initialised.
    pub(crate) fn model(&self) -> Option<&Model> {
        self.model.as_ref().ok()
    }

    /// The parameters with the recording and the measured membrane.
    pub(crate) fn setup(&self) -> Result<Setup<'_>, String> {
        let Files { recorded, measured, .. } = &*self.files;
        Ok(self.parameters.with_recording(recorded.content()?).with_table(measured.content()?))
    }

    /// The model at the start, as parameters, files and inputs have it.
    pub(crate) fn at_start(&self) -> Result<Model, String> {
        let setup = self.setup()?;
        let start = || {
            let mut model = Model::new(setup, self.start_time)?;
            model.set_external_force(self.external_force, 0.0)?;
            model.set_voltages(self.voltages, [0.0; 2])?;
            Ok(model)
        };
        start().map_err(|error| match error {
            ModelError::RecordingKind { .. } | ModelError::RepeatedTooFast { .. } => {
                Loaded::<Recording>::named(&self.files.excitation, error)
            }
            ModelError::UnusedTable => Loaded::<ForceTable>::named(&self.files.membrane, error),
            _ => error.to_string(),
        })
    }

    /// Reads the files, unless they were the last ones to be read.
    pub(crate) fn read_files(&mut self) {
        if !self.files.are_read() {
            Arc::make_mut(&mut self.files).read();
        }
    }
}
