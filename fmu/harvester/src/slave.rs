//! The model behind the functions of FMI.

use std::cell::Cell;
use std::path::Path;
use std::sync::Arc;

use fmu_export::{
    EventOutcome, Experiment, LogCategory, Logger, ModelInfo, Slave, SlaveError, StateError, StateReader, StateWriter,
    Stop, Terminal, Variable,
};
use videg_model::{ContactLaw, Event, Harvester as Model, Impact, ModelError, Parameters, Peak, PulseShape, Side};

use crate::file::Files;
use crate::harvester::Harvester;
use crate::limits;
use crate::variables::VARIABLES;

/// Relative tolerance at which the integrators of common importers keep a free cylinder in its place in model exchange; with
/// 1e-4, which many take if none is given, it drifts by centimetres in 100 s. Co-simulation needs none: it is exact.
const EXCHANGE_TOLERANCE: f64 = 1e-8;

impl Harvester {
    /// The inputs are where their rates have taken them in a step of `h`, s, and stay there.
    fn follow_rates(&mut self, h: f64) {
        self.external_force += core::mem::take(&mut self.external_force_rate) * h;
        let rates = core::mem::take(&mut self.voltage_rates);
        self.voltages = [0, 1].map(|k| self.voltages[k] + rates[k] * h);
    }

    /// A step of `h`, s, from `t` to `end`, s, as `advance` takes it, which says whether it stopped before. Force and voltages run on at
    /// their rates over the step and stay where those took them, unless they are set again.
    #[inline(always)]
    #[allow(clippy::inline_always)] // a step in which nothing happens takes some ten nanoseconds
    fn step(
        &mut self,
        t: f64,
        h: f64,
        end: f64,
        log: &Logger,
        advance: impl FnOnce(&mut Model, f64, &mut dyn FnMut(&Event)) -> Result<bool, ModelError>,
    ) -> Result<bool, SlaveError> {
        if self.is_too_long(h) {
            return Err(self.too_long(t, h));
        }
        self.check_limits(log);
        let time = self.model().map_or(t, Model::time);
        let behind = t - time;
        if behind > h && (behind * self.parameters.frequency > 1.0 || self.is_too_long(behind)) {
            return Err(elsewhere(t, time));
        }
        self.predicted.take();
        let Self { parameters, files, model, .. } = self;
        let model = running(model)?;
        let mut number = model.totals().impacts;
        let mut last_impact = None;
        let mut show = |event: &Event| match event {
            Event::Impact(impact) => {
                (number, last_impact) = (number + 1, Some((impact.side, impact.speed)));
                if log.is_enabled(LogCategory::Events) {
                    log.event(describe(number, impact));
                }
            }
            Event::Peak(peak) => limits::check(parameters.with_table(files.table()), peak, log),
        };
        let advanced = model
            .set_external_force(self.external_force, self.external_force_rate)
            .and_then(|()| model.set_voltages(self.voltages, self.voltage_rates))
            .and_then(|()| advance(model, end, &mut show));
        let stopped = advanced.map_err(|error| SlaveError::error(error.to_string()))?;
        if last_impact.is_some() {
            self.last_impact = last_impact;
        }
        if self.has_hit != last_impact.is_some() {
            self.has_hit = last_impact.is_some();
        }
        if self.external_force_rate != 0.0 || self.voltage_rates[0] != 0.0 || self.voltage_rates[1] != 0.0 {
            self.follow_rates(h);
        }
        Ok(stopped)
    }

    /// Warns of limits exceeded at present. Nothing needs looking at while the voltages have not changed since both membranes
    /// were flat: a membrane is worst off when flat or at a peak, and peaks are checked as they come.
    #[inline]
    fn check_limits(&mut self, log: &Logger) {
        let [left, right] = self.checked;
        if self.voltages[0] != left || self.voltages[1] != right {
            self.check_limits_closely(log);
        }
    }

    fn check_limits_closely(&mut self, log: &Logger) {
        let Ok(model) = &self.model else { return };
        limits::check_present(model, self.voltages, log);
        let flat = Side::BOTH.into_iter().all(|side| model.deflection(side).value == 0.0);
        self.checked = if flat { self.voltages } else { [f64::NAN; 2] };
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
        .default_tolerance(EXCHANGE_TOLERANCE)
        .can_serialize()
        .directional_derivatives()
        .model_exchange(3)
        .stops_at_events()
        .terminals(&[
            Terminal {
                name: "left",
                description: "Left membrane, as a circuit sees it",
                members: &[("capacitance", "left.capacitance"), ("voltage", "left.voltage")],
            },
            Terminal {
                name: "right",
                description: "Right membrane, as a circuit sees it",
                members: &[("capacitance", "right.capacitance"), ("voltage", "right.voltage")],
            },
        ]);

    fn variables() -> &'static [Variable<Self>] {
        &VARIABLES
    }

    fn new() -> Self {
        let parameters = Parameters::default();
        Self {
            parameters,
            files: Arc::new(Files::nothing()),
            external_force: 0.0,
            external_force_rate: 0.0,
            voltages: [parameters.bias_voltage; 2],
            voltage_rates: [0.0; 2],
            start_time: 0.0,
            placed: false,
            checked: [f64::NAN; 2],
            predicted: Cell::new(None),
            last_impact: None,
            has_hit: false,
            model: Model::new(&parameters, 0.0).map_err(|error| error.to_string()),
        }
    }

    fn set_resources(&mut self, folder: &Path) {
        Arc::make_mut(&mut self.files).resources = Some(folder.into());
    }

    fn setup_experiment(&mut self, experiment: &Experiment, _log: &Logger) -> Result<(), SlaveError> {
        self.start_time = experiment.start_time;
        Ok(())
    }

    fn update(&mut self) {
        self.read_files();
        self.model = self.at_start();
        self.predicted.take();
    }

    fn initialize(&mut self, log: &Logger) -> Result<(), SlaveError> {
        let impulsive = self.parameters.contact_law == ContactLaw::Impulsive;
        if impulsive && self.parameters.restitution < PulseShape::MIN_RESTITUTION {
            log.warning(format_args!(
                "membrane.restitution = {}: pulses of C(t) fall as for {}, 100 times slower than they rise; without a \
                 rebound they would never end",
                self.parameters.restitution,
                PulseShape::MIN_RESTITUTION
            ));
        }
        if let Some(neglected) = self.parameters.neglected_mass() {
            log.warning(neglected);
        }
        let model = running(&mut self.model)?;
        let impact = model.present_impact();
        if let Some(impact) = impact {
            show_impact(model, &impact, self.voltages, log);
        }
        self.has_hit = impact.is_some();
        self.last_impact = impact.map(|impact| (impact.side, impact.speed));
        Ok(())
    }

    fn do_step(&mut self, t: f64, h: f64, log: &Logger) -> Result<(), SlaveError> {
        self.step(t, h, t + h, log, |model, end, show| model.advance_with(end, show).map(|()| false))?;
        Ok(())
    }

    /// Events are the impacts; other knots of C(t) are points that are worth looking at.
    fn do_step_to_event(&mut self, t: f64, end: f64, log: &Logger) -> Result<Option<Stop>, SlaveError> {
        let stopped = self.step(t, end - t, end, log, |model, end, show| model.advance_to_knot(end, show))?;
        let time = self.model().map_or(end, Model::time);
        Ok(stopped.then_some(Stop { time, is_event: self.has_hit }))
    }

    fn place(&mut self, time: f64, states: Option<&[f64]>) -> Result<(), SlaveError> {
        let force = self.external_force;
        (self.placed, self.has_hit) = (true, false);
        self.predicted.take();
        let model = running(&mut self.model)?;
        let present = model.states();
        let states = states.map_or(Ok(present), <[f64; 5]>::try_from);
        let states = states.map_err(|error| SlaveError::error(error.to_string()))?;
        model.place(time, states, force).map_err(|error| SlaveError::error(error.to_string()))
    }

    fn event_indicators(&self) -> Vec<f64> {
        self.model().map_or([f64::NAN; 3], Model::event_indicators).to_vec()
    }

    fn handle_events(&mut self, log: &Logger) -> Result<EventOutcome, SlaveError> {
        if !self.placed {
            return Ok(EventOutcome::default()); // co-simulation does what is due within its steps
        }
        let voltages = self.voltages;
        let model = running(&mut self.model)?;
        let impacts = model.totals().impacts;
        let states_changed = model.handle_events().map_err(|error| SlaveError::error(error.to_string()))?;
        if let Some(impact) = model.present_impact().filter(|_| model.totals().impacts > impacts) {
            show_impact(model, &impact, voltages, log);
            (self.has_hit, self.last_impact) = (true, Some((impact.side, impact.speed)));
        }
        Ok(EventOutcome { states_changed, next_event_time: model.next_time_event() })
    }

    /// Each step checks the point that it starts from; the last point starts none.
    fn terminate(&mut self, log: &Logger) -> Result<(), SlaveError> {
        if !self.placed {
            self.check_limits(log);
        }
        Ok(())
    }

    fn write_state(&self, out: &mut StateWriter) -> Result<(), StateError> {
        self.write(out)
    }

    fn read_state(from: &mut StateReader<'_>, present: &Self) -> Result<Self, StateError> {
        Self::read_from(from, present)
    }
}

/// The model, or why there is none.
fn running(model: &mut Result<Model, String>) -> Result<&mut Model, SlaveError> {
    model.as_mut().map_err(|reason| SlaveError::error(reason.clone()))
}

/// Why no step begins at `t`, s: the model is far behind, as only a forged state has it, and could take for ever to get there.
#[cold]
fn elsewhere(t: f64, there: f64) -> SlaveError {
    SlaveError::error(format!("the step begins at t = {t} s, but the state is of t = {there} s"))
}

/// Logs the last impact of the model, at the present time, and warns of limits that it exceeds under these voltages, V.
fn show_impact(model: &Model, impact: &Impact, voltages: [f64; 2], log: &Logger) {
    let Impact { time, side, speed, .. } = *impact;
    log.event(describe(model.totals().impacts, impact));
    if model.parameters().contact_law == ContactLaw::Impulsive {
        let (deflection, voltage) = (model.membrane().deflection(speed), voltages[side.index()]);
        limits::warn(model.membrane(), &Peak { time, side, deflection, voltage }, log);
    }
}

/// An impact as the log shows it.
fn describe(number: u64, impact: &Impact) -> String {
    let Impact { time, side, speed, rests } = impact;
    let side = if *side == Side::Left { "left" } else { "right" };
    let rest = if *rests { "; the ball rests on it" } else { "" };
    format!("impact {number} at t = {time} s on the {side} membrane, relative speed {speed} m/s{rest}")
}
