//! An instance of an FMU: life cycle and stepping. Its variables are in `access`, its states in `state`.

use std::ffi::CString;
use std::fmt;
use std::mem::ManuallyDrop;
use std::rc::Rc;
use std::sync::Arc;

use fmu_abi::{fmi2False, fmi2Fatal, fmi2Status};

use super::component::{Arguments, Component, is_done};
use super::description::ModelDescription;
use super::error::{FmiError, Result};
use super::isolated::Loss;
use super::loaded::{Code, Loaded, c_string};
use super::logging::{Environment, LogRecord, Logging};
use super::request::{Request, Results};
use super::slave::Slave;

/// A co-simulation slave. Freed on drop, unless the FMU has reported a fatal error.
///
/// A method fails when its function returns neither OK nor Warning, when slices that belong together differ in length, and when
/// the FMU has reported a fatal error or its process has ended. The FMU itself checks which call is legal when; an illegal one
/// is an error with the FMU's message. FMI 2.0 does not let an instance move between threads, so it is not `Send`.
pub struct Instance {
    core: Rc<Core>,
}

/// The slave and all that must outlive it. Saved states hold it as well.
pub(super) struct Core {
    loaded: Arc<Loaded>,
    slave: ManuallyDrop<Slave>,
    name: String,
    environment: Arc<Environment>,
}

impl Core {
    pub(super) fn name(&self) -> &str {
        &self.name
    }

    /// Calls a function of the FMU and turns its status into a result.
    #[inline]
    pub(super) fn call(&self, request: &Request<'_>, results: Results<'_>) -> Result<()> {
        if self.loaded.is_dead() {
            return Err(self.dead(request.function()));
        }
        let before = self.environment.count();
        let status = self.slave.call(request, results);
        if is_done(status) { Ok(()) } else { Err(self.failed(request.function(), status, before)) }
    }

    /// Calls a function that gives nothing but its status.
    #[inline]
    pub(super) fn done(&self, request: &Request<'_>) -> Result<()> {
        self.call(request, Results::None)
    }

    /// Asks for warnings and errors alone, in the categories that FMI 2.0 reserves for them, so that errors can say
    /// why. An FMU that declares no such category or refuses stays silent.
    fn ask_for_complaints(&self) {
        const RESERVED: [&str; 4] = ["logStatusWarning", "logStatusDiscard", "logStatusError", "logStatusFatal"];
        let declared = &self.loaded.description.log_categories;
        let wanted = RESERVED.into_iter().filter(|name| declared.iter().any(|it| it == name));
        let categories: Vec<_> = wanted.filter_map(|name| CString::new(name).ok()).collect();
        if !categories.is_empty() {
            let _ = self.done(&Request::SetDebugLogging { on: true, categories: categories.into() });
        }
    }

    /// The error of a call that began after the first `before` messages.
    #[cold]
    fn failed(&self, function: &'static str, status: fmi2Status, before: usize) -> FmiError {
        match self.slave.loss() {
            Some(Loss::Ended(ending)) => return FmiError::Isolated(ending),
            Some(Loss::Over) => return self.dead(function),
            // All instances of an FMU in this process share its library.
            None if status == fmi2Fatal && matches!(self.loaded.code, Code::Here { .. }) => self.loaded.kill(),
            None => {}
        }
        let (instance, messages) = (self.name.clone(), self.environment.last(before));
        FmiError::Call { function, instance, status: status.into(), messages }
    }

    #[cold]
    fn dead(&self, function: &'static str) -> FmiError {
        let model = self.loaded.description.co_simulation.model_identifier.clone();
        FmiError::Dead { function, instance: self.name.clone(), model }
    }

    /// Fails unless the FMU declares a capability.
    pub(super) fn require(&self, function: &'static str, supported: bool, capability: &'static str) -> Result<()> {
        if supported {
            return Ok(());
        }
        Err(FmiError::NotSupported { function, instance: self.name.clone(), capability })
    }

    /// The error of a call that was not made because of its arguments.
    #[cold]
    pub(super) fn refused(&self, function: &'static str, reason: String) -> FmiError {
        FmiError::Arguments { function, instance: self.name.clone(), reason }
    }

    /// Fails unless there are as many values as value references.
    #[inline]
    pub(super) fn same_length(
        &self,
        function: &'static str,
        references: usize,
        values: usize,
        what: &'static str,
    ) -> Result<()> {
        if references == values {
            return Ok(());
        }
        Err(self.refused(function, format!("{references} value references but {values} {what}")))
    }
}

impl Drop for Core {
    fn drop(&mut self) {
        // Of a dead FMU not even an instance may be freed, and it may still use what it was given.
        if !self.loaded.is_dead() {
            // SAFETY: nothing uses it afterwards.
            unsafe { ManuallyDrop::drop(&mut self.slave) };
        }
    }
}

#[allow(clippy::missing_errors_doc, reason = "the documentation of the type says when a call fails")]
impl Instance {
    pub(super) fn new(loaded: Arc<Loaded>, name: &str, logging: Logging) -> Result<Self> {
        let (c_name, instance) = (c_string("instance name", name)?, name.to_owned());
        let model = loaded.description.co_simulation.model_identifier.clone();
        if loaded.is_dead() {
            return Err(FmiError::Dead { function: "fmi2Instantiate", instance, model });
        }
        let environment = Environment::new(logging.sink);
        let (guid, resources) = (&loaded.guid, &loaded.resources);
        let arguments = Arguments { name: &c_name, guid, resources, debug: logging.enabled };
        let slave = match &loaded.code {
            Code::Here { functions, .. } => {
                Component::new(functions, &arguments, &environment).map(|component| Slave::Here(Box::new(component)))
            }
            Code::Isolated(pool) => {
                pool.instantiate(&arguments, &environment)?.map(|remote| Slave::Isolated(Box::new(remote)))
            }
        };
        let Some(slave) = slave else {
            let (guid, messages) = (loaded.description.guid.clone(), environment.last(0));
            return Err(FmiError::Instantiate { instance, model, guid, messages });
        };
        let core = Core { loaded, slave: ManuallyDrop::new(slave), name: instance, environment };
        if !logging.enabled {
            core.ask_for_complaints();
        }
        Ok(Self { core: Rc::new(core) })
    }

    pub(super) fn core(&self) -> &Rc<Core> {
        &self.core
    }

    /// Frees the instance, as dropping it does, and says whether that took its process down. States that are not dropped
    /// by then are lost. An instance in this process is freed with the last of its states.
    ///
    /// # Errors
    /// When the process of an isolated instance ended meanwhile.
    pub fn free(self) -> Result<()> {
        self.core.slave.free().map_err(FmiError::Isolated)
    }

    /// Name of the instance.
    pub fn name(&self) -> &str {
        self.core.name()
    }

    /// The model description of its FMU.
    pub fn description(&self) -> &ModelDescription {
        &self.core.loaded.description
    }

    /// The last messages of the FMU about this instance (at most 100), oldest first.
    pub fn messages(&self) -> Vec<LogRecord> {
        self.core.environment.all()
    }

    /// Switches debug messages on or off, for all log categories.
    pub fn set_debug_logging(&mut self, on: bool) -> Result<()> {
        self.core.done(&Request::SetDebugLogging { on, categories: [].as_slice().into() })
    }

    /// Announces the times of the experiment, in seconds, and the relative tolerance.
    pub fn setup_experiment(&mut self, start: f64, stop: Option<f64>, tolerance: Option<f64>) -> Result<()> {
        self.core.done(&Request::SetupExperiment { tolerance, start, stop })
    }

    /// Begins the initialization.
    pub fn enter_initialization_mode(&mut self) -> Result<()> {
        self.core.done(&Request::EnterInitializationMode)
    }

    /// Ends the initialization; stepping may begin.
    pub fn exit_initialization_mode(&mut self) -> Result<()> {
        self.core.done(&Request::ExitInitializationMode)
    }

    /// Goes from `time` to `time + step`, in seconds.
    ///
    /// # Errors
    /// When the step is discarded or fails. After a discarded one, see [`Instance::last_successful_time`].
    #[inline]
    pub fn do_step(&mut self, time: f64, step: f64) -> Result<()> {
        self.core.done(&Request::DoStep { time, step })
    }

    /// Time up to which a discarded step was carried out, s.
    ///
    /// # Errors
    /// When the FMU does not know.
    pub fn last_successful_time(&self) -> Result<f64> {
        let mut time = [0.0];
        self.core.call(&Request::LastSuccessfulTime, Results::Reals(&mut time))?;
        Ok(time[0])
    }

    /// Whether a discarded step means that the slave wants the simulation to end.
    ///
    /// # Errors
    /// When the FMU does not know.
    pub fn wants_to_terminate(&self) -> Result<bool> {
        let mut terminated = [fmi2False];
        self.core.call(&Request::Terminated, Results::Integers(&mut terminated))?;
        Ok(terminated[0] != fmi2False)
    }

    /// Ends the simulation. Values can still be read.
    pub fn terminate(&mut self) -> Result<()> {
        self.core.done(&Request::Terminate)
    }

    /// Goes back to where [`super::Fmu::instantiate`] left it.
    pub fn reset(&mut self) -> Result<()> {
        self.core.done(&Request::Reset)
    }
}

impl fmt::Debug for Instance {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let model = &self.description().model_name;
        out.debug_struct("Instance").field("name", &self.name()).field("model", model).finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests;
