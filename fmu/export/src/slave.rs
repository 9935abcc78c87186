//! The trait that a model implements to become an FMU.

use crate::error::SlaveError;
use crate::info::ModelInfo;
use crate::logger::Logger;
use crate::serialize::{StateError, StateReader, StateWriter};
use crate::variable::Variable;
use std::path::Path;

/// What the importer says about the experiment before initialisation.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Experiment {
    /// Time at which the simulation starts, s.
    pub start_time: f64,
    /// Time behind which the importer will not go, s.
    pub stop_time: Option<f64>,
    /// Relative tolerance that the importer asks for.
    pub tolerance: Option<f64>,
}

/// Where a step stopped.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stop {
    /// Time that was reached, s: behind the begin of the step and not behind its end.
    pub time: f64,
    /// An event has happened there: the environment is told, and output clocks may tick. Otherwise it is a point that is worth
    /// looking at, such as a kink of an output.
    pub is_event: bool,
}

/// What an event did.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct EventOutcome {
    /// Continuous states have changed.
    pub states_changed: bool,
    /// Time of the next event that is due whatever the states do, s.
    pub next_event_time: Option<f64>,
}

/// A model that can be exported as an FMU for co-simulation.
///
/// Life of a slave: [`new`](Self::new) and [`set_resources`](Self::set_resources); the start values of the table are written; Sets, with
/// [`update`](Self::update) before each Get that follows; [`setup_experiment`](Self::setup_experiment);
/// more Sets; [`initialize`](Self::initialize); then [`do_step`](Self::do_step), Sets of inputs and Gets;
/// [`terminate`](Self::terminate).
///
/// `Clone` is the FMU state: a clone must hold *everything*, random generators, event history and input
/// derivatives included. Functions that take `&self`, getters included, change nothing that a clone holds. A panic in any of
/// these functions is caught and becomes `fmi2Error`. Where `clone_from` takes no new memory, trying steps takes none.
pub trait Slave: Clone + Send + 'static {
    /// Facts about the FMU as a whole.
    const INFO: ModelInfo;

    /// For a table that is known at run time only: reads it from the folder `resources` of the unpacked FMU, if the importer names
    /// one, for [`variables`](Self::variables) to give. Called before anything else at each instantiation, and when the FMU is packaged.
    /// A library belongs to one FMU, so that what the first call has read counts.
    ///
    /// # Errors
    /// If there is no table; the instantiation fails.
    fn load_variables(resources: Option<&Path>) -> Result<(), SlaveError> {
        let _ = resources;
        Ok(())
    }

    /// The variable table. The value reference of a variable is its index here.
    fn variables() -> &'static [Variable<Self>];

    /// A fresh model. The start values of the table are written into it afterwards, through the setters and in
    /// the order of the table, so it need not repeat them.
    fn new() -> Self;

    /// Takes note of the folder `resources` of the unpacked FMU. Called right after [`new`](Self::new), if the importer names a
    /// folder.
    fn set_resources(&mut self, folder: &Path) {
        let _ = folder;
    }

    /// Takes note of start time, stop time and tolerance.
    ///
    /// # Errors
    /// If the model cannot run this experiment.
    fn setup_experiment(&mut self, experiment: &Experiment, log: &Logger) -> Result<(), SlaveError> {
        let _ = (experiment, log);
        Ok(())
    }

    /// Makes calculated parameters and initial outputs consistent with what was set. Called lazily, before
    /// initialisation is complete only: ahead of a Get that follows a Set, and ahead of
    /// [`initialize`](Self::initialize). The values may still be contradictory; this function has no say in that.
    fn update(&mut self) {}

    /// Ends initialisation: validates the parameters together and sets up the state. From here on, the outputs
    /// are the model's to keep consistent.
    ///
    /// # Errors
    /// If the parameters make no sense; the message names them, their values and the bound.
    fn initialize(&mut self, log: &Logger) -> Result<(), SlaveError> {
        let _ = log;
        Ok(())
    }

    /// Advances from time `t` to `t + h`, s. `h` is finite and positive; `t` agrees with the end of the step
    /// before to within the rounding of the master, which may count in single precision: 2.4e-7 of the time, or of 1 s, and at
    /// most a tenth of `h`.
    ///
    /// # Errors
    /// [`SlaveError::discard`] if the step was done in part or not at all and a smaller one may work,
    /// [`SlaveError::terminate`] to end the simulation, [`SlaveError::error`] if the instance cannot go on.
    fn do_step(&mut self, t: f64, h: f64, log: &Logger) -> Result<(), SlaveError>;

    /// FMI 3.0: advances as [`do_step`](Self::do_step) does, from `t` to `end`, s, but stops at the first point behind `t` that an
    /// environment wants to see. Called in its place, with what is left of the step, where the environment can handle events, or
    /// wants to return early or see intermediate values. None where the step went to its end without such a point.
    ///
    /// # Errors
    /// As [`do_step`](Self::do_step); a discarded step must leave the model as it was.
    fn do_step_to_event(&mut self, t: f64, end: f64, log: &Logger) -> Result<Option<Stop>, SlaveError> {
        self.do_step(t, end - t, log).map(|()| None)
    }

    /// Model exchange: takes over `time`, s, the inputs as they are set and, if given, the continuous states. Getters, event
    /// indicators and events that follow are those of this point. The first call, right after
    /// [`initialize`](Self::initialize), gives no states: the model keeps its initial ones.
    ///
    /// # Errors
    /// If the model cannot be there.
    fn place(&mut self, time: f64, states: Option<&[f64]>) -> Result<(), SlaveError> {
        let _ = (time, states);
        Err(SlaveError::error("this FMU does not offer model exchange"))
    }

    /// Model exchange: as many event indicators as [`ModelInfo::model_exchange`] says. A change of sign is an event.
    fn event_indicators(&self) -> Vec<f64> {
        Vec::new()
    }

    /// Does what is due at the present point: in model exchange, and in event mode of co-simulation (FMI 3.0), where what the model
    /// does within its steps is done already. A second call at the same point changes nothing more.
    ///
    /// # Errors
    /// If the model cannot go on.
    fn handle_events(&mut self, log: &Logger) -> Result<EventOutcome, SlaveError> {
        let _ = log;
        Ok(EventOutcome::default())
    }

    /// Ends the simulation; final values can still be read.
    ///
    /// # Errors
    /// If something could not be wound up.
    fn terminate(&mut self, log: &Logger) -> Result<(), SlaveError> {
        let _ = log;
        Ok(())
    }

    /// Called at the head of each C function that acts on the instance and is legal, but `fmi2FreeInstance`. For tests
    /// that look at the exporter, or make it fail anywhere.
    #[doc(hidden)]
    fn on_call(&self, function: &'static str) {
        let _ = function;
    }

    /// Writes everything that [`read_state`](Self::read_state) needs. Called only if
    /// [`ModelInfo::can_serialize`] is set.
    ///
    /// # Errors
    /// What [`StateWriter::write`] says.
    fn write_state(&self, out: &mut StateWriter) -> Result<(), StateError> {
        let _ = out;
        Err(StateError::Unsupported)
    }

    /// Rebuilds a model from what [`write_state`](Self::write_state) wrote, in the same order. The bytes have
    /// the right checksum and come from an FMU with the same GUID; anything left over is refused. `present` is the model of the
    /// instance that reads it: it has what no bytes hold, such as the folder of its resources.
    ///
    /// # Errors
    /// If the bytes describe no valid model.
    fn read_state(from: &mut StateReader<'_>, present: &Self) -> Result<Self, StateError> {
        let _ = (from, present);
        Err(StateError::Unsupported)
    }
}
