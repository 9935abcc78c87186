//! The slave: what the importer sets, and the model that it drives.

use fmi2_export::{
    EventOutcome, Experiment, LogCategory, Logger, ModelInfo, Slave, SlaveError, StateError, StateReader, StateWriter,
    Variable,
};
use videg_model::{Harvester as Model, ModelError, Parameters};

use crate::variables::VARIABLES;

/// The law of the contact between ball and membrane.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum ContactLaw {
    Impulsive,
    Compliant,
}

/// The harvester as a slave.
#[derive(Clone)]
pub struct Harvester {
    pub(crate) parameters: Parameters,
    pub(crate) law: ContactLaw,
    pub(crate) electrostatic_feedback: bool,
    pub(crate) external_force: f64,
    pub(crate) external_force_rate: f64,
    pub(crate) voltages: [f64; 2],
    pub(crate) start_time: f64,
    /// The model runs under an integrator of the importer's: model exchange.
    pub(crate) placed: bool,
    /// The model; before initialisation it is made anew from the parameters whenever they are read.
    pub(crate) model: Result<Model, ModelError>,
}

impl Harvester {
    /// Reads a value from the model; NaN while the parameters contradict each other (before initialisation only).
    pub(crate) fn read(&self, value: impl FnOnce(&Model) -> f64) -> f64 {
        self.model.as_ref().map_or(f64::NAN, value)
    }

    /// The model, once initialised.
    pub(crate) fn model(&self) -> Option<&Model> {
        self.model.as_ref().ok()
    }

    fn running(&mut self) -> Result<&mut Model, SlaveError> {
        self.model.as_mut().map_err(|error| SlaveError::error(error.to_string()))
    }

    fn check_law(&self) -> Result<(), SlaveError> {
        if self.law == ContactLaw::Compliant {
            return Err(SlaveError::error("contact.law = compliant is not part of this version; allowed: impulsive"));
        }
        if self.electrostatic_feedback {
            return Err(SlaveError::error(
                "contact.electrostaticFeedback = true needs contact.law = compliant: an impact that takes no time does \
                 no electrical work; allowed: false",
            ));
        }
        Ok(())
    }
}

impl Slave for Harvester {
    const INFO: ModelInfo = ModelInfo::new("VibroImpactHarvester")
        .description("Vibro-impact dielectric elastomer generator: mechanics and membrane capacitances C(t)")
        .author("The videg developers")
        .version(env!("CARGO_PKG_VERSION"))
        .copyright("Copyright (c) The videg developers")
        .license("MIT OR Apache-2.0")
        .generation_tool(concat!("videg ", env!("CARGO_PKG_VERSION")))
        .default_experiment(0.0, 100.0, 1e-3)
        .can_serialize()
        .directional_derivatives()
        .model_exchange(2);

    fn variables() -> &'static [Variable<Self>] {
        &VARIABLES
    }

    fn new() -> Self {
        let parameters = Parameters::default();
        Self {
            parameters,
            law: ContactLaw::Impulsive,
            electrostatic_feedback: false,
            external_force: 0.0,
            external_force_rate: 0.0,
            voltages: [parameters.bias_voltage; 2],
            start_time: 0.0,
            placed: false,
            model: Model::new(&parameters, 0.0),
        }
    }

    fn setup_experiment(&mut self, experiment: &Experiment, _log: &Logger) -> Result<(), SlaveError> {
        self.start_time = experiment.start_time;
        Ok(())
    }

    fn update(&mut self) {
        self.model = Model::new(&self.parameters, self.start_time);
    }

    fn initialize(&mut self, _log: &Logger) -> Result<(), SlaveError> {
        self.check_law()?;
        self.running().map(|_| ())
    }

    fn do_step(&mut self, t: f64, h: f64, log: &Logger) -> Result<(), SlaveError> {
        let (force, rate) = (self.external_force, core::mem::take(&mut self.external_force_rate));
        let model = self.running()?;
        let advanced = model.set_external_force(force, rate).and_then(|()| {
            if log.is_enabled(LogCategory::Events) {
                log_impacts(model, t + h, log)?;
            }
            model.advance(t + h)
        });
        advanced.map_err(|error| SlaveError::error(error.to_string()))
    }

    fn place(&mut self, time: f64, states: Option<&[f64]>) -> Result<(), SlaveError> {
        let force = self.external_force;
        self.placed = true;
        let model = self.running()?;
        let present = model.states();
        let states = states.map_or(Ok(present), <[f64; 4]>::try_from);
        let states = states.map_err(|error| SlaveError::error(error.to_string()))?;
        model.place(time, states, force).map_err(|error| SlaveError::error(error.to_string()))
    }

    fn event_indicators(&self) -> Vec<f64> {
        self.model().map_or([f64::NAN; 2], Model::event_indicators).to_vec()
    }

    fn handle_events(&mut self, log: &Logger) -> Result<EventOutcome, SlaveError> {
        let model = self.running()?;
        let impacts = model.totals().impacts;
        let states_changed = model.handle_events().map_err(|error| SlaveError::error(error.to_string()))?;
        if model.totals().impacts > impacts {
            log_impact(model, log);
        }
        Ok(EventOutcome { states_changed, next_event_time: model.next_time_event() })
    }

    fn partial_derivative(&self, unknown: &Variable<Self>, known: &Variable<Self>) -> f64 {
        if self.placed { self.placed_partial(unknown, known) } else { self.partial(unknown, known) }
    }

    fn write_state(&self, out: &mut StateWriter) {
        self.write(out);
    }

    fn read_state(from: &mut StateReader<'_>) -> Result<Self, StateError> {
        Self::read_from(from)
    }
}

/// Goes from impact to impact up to `end`, s, and reports each. How a step is split does not change the motion.
fn log_impacts(model: &mut Model, end: f64, log: &Logger) -> Result<(), ModelError> {
    while let Some(time) = model.next_impact().filter(|&time| time <= end) {
        model.advance(time)?;
        log_impact(model, log);
    }
    Ok(())
}

/// Reports the impact that has just happened.
fn log_impact(model: &Model, log: &Logger) {
    let (time, totals) = (model.time(), model.totals());
    let side = if model.relative_displacement() > 0.0 { "left" } else { "right" };
    let rest = if model.resting().is_some() { "; the ball rests on it" } else { "" };
    log.event(format_args!(
        "impact {} at t = {time} s on the {side} membrane, relative speed {} m/s{rest}",
        totals.impacts, totals.last_speed
    ));
}
