//! From instantiation to termination, and debug logging.

use super::{Call, Core, Instance};
use crate::call_state::CallState;
use crate::error::CallError;
use crate::logger::LogCategory;
use crate::slave::{Experiment, Slave};
use crate::standard::Standard;

/// What is wrong with an experiment: the argument, its value and the bound.
pub(super) fn fault(experiment: &Experiment) -> Option<(&'static str, f64, String)> {
    let start = experiment.start_time;
    if !start.is_finite() {
        return Some(("startTime", start, "it must be finite".into()));
    }
    // An infinite stop time is a harmless way to say that there is none.
    if let Some(stop) = experiment.stop_time.filter(|t| t.is_nan() || *t < start) {
        return Some(("stopTime", stop, format!("it must not lie before {start} s")));
    }
    let tolerance = experiment.tolerance.filter(|it| !(it.is_finite() && *it > 0.0))?;
    Some(("tolerance", tolerance, "it must be finite and positive".into()))
}

impl<S: Slave> Instance<S> {
    /// `fmi2SetDebugLogging`. Without names, all categories are meant. An unknown name is logged and no more:
    /// the computation can go on.
    pub(crate) fn set_debug_logging(&mut self, on: bool, names: &[&str]) {
        // FMI 2.0 sets what is on, FMI 3.0 switches what is named.
        let adds = self.session.standard == Standard::Fmi3;
        if !adds && !on || names.is_empty() || names.contains(&LogCategory::ALL_NAME) {
            self.logger.enable_all(on);
            return;
        }
        // While the categories so far are on: the new ones may not show the message.
        let is_unknown = |name: &&&str| LogCategory::from_name(name).is_none();
        for name in names.iter().filter(is_unknown) {
            self.logger.tolerated(format_args!("there is no log category {name:?}; tolerated"));
        }
        let known = names.iter().filter_map(|name| LogCategory::from_name(name));
        if adds { known.for_each(|category| self.logger.enable(category, on)) } else { self.logger.enable_only(known) }
    }

    /// `fmi2SetupExperiment`
    pub(crate) fn setup_experiment(&mut self, experiment: Experiment) -> Call {
        if let Some((argument, value, bound)) = fault(&experiment) {
            return Err(CallError::BadArgument { argument, value: value.to_string(), bound });
        }
        self.core.time = experiment.start_time;
        self.core.experiment = Some(experiment);
        self.core.dirty = true;
        Ok(self.core.model.setup_experiment(&experiment, &self.logger)?)
    }

    /// `fmi2EnterInitializationMode`. A missing `fmi2SetupExperiment` is tolerated: the simulation starts at 0.
    pub(crate) fn enter_initialization_mode(&mut self) -> Call {
        if self.core.experiment.is_none() {
            self.logger.tolerated("fmi2SetupExperiment was not called; tolerated, the simulation starts at 0 s");
            self.setup_experiment(Experiment { start_time: 0.0, stop_time: None, tolerance: None })?;
        }
        self.core.state = CallState::InitializationMode;
        Ok(())
    }

    /// `fmi2ExitInitializationMode`
    pub(crate) fn exit_initialization_mode(&mut self) -> Call {
        self.update()?;
        self.core.model.initialize(&self.logger)?;
        self.core.state = self.session.first_state();
        self.core.ticking = true; // what happens at the start is an event
        self.core.dirty = self.core.exchange; // to be placed at the start
        Ok(())
    }

    /// `fmi2Terminate`
    pub(crate) fn terminate(&mut self) -> Call {
        self.update()?; // of model exchange: what is read from now on is of the last time and inputs
        self.core.model.terminate(&self.logger)?;
        self.core.state = CallState::Terminated;
        Ok(())
    }

    /// `fmi2Reset`: a fresh model. Saved FMU states and log settings stay.
    pub(crate) fn reset(&mut self) {
        *self.core = Core::new(self.core.exchange, self.resources.as_deref());
        self.logger.forget_given();
        self.strings.clear();
    }
}
