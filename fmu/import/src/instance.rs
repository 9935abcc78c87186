//! An instance of an FMU: life cycle and stepping. Its variables are in `access`, its states in `state`.

use std::ffi::{CStr, CString};
use std::fmt;
use std::ptr;
use std::rc::Rc;
use std::sync::Arc;

use fmu_abi::{
    fmi2Boolean, fmi2CallbackFunctions, fmi2CoSimulation, fmi2Component, fmi2False, fmi2Fatal, fmi2LastSuccessfulTime,
    fmi2OK, fmi2Status, fmi2Terminated, fmi2True, fmi2Warning,
};

use super::description::ModelDescription;
use super::error::{FmiError, Result};
use super::fmu::{Loaded, c_string};
use super::isolated::{self, Verdict, Wanted};
use super::library::Functions;
use super::logging::{Environment, LogRecord, Logging};

/// A co-simulation slave. Freed on drop, unless the FMU has reported a fatal error.
///
/// OK and Warning count as success everywhere. The FMU itself checks which call is legal when; an illegal one is an
/// error with the FMU's message. FMI 2.0 does not let an instance move between threads, so it is not `Send`.
pub struct Instance {
    core: Rc<Core>,
}

/// The component and all that must outlive it. Saved states hold it as well.
pub(super) struct Core {
    loaded: Arc<Loaded>,
    component: fmi2Component,
    name: CString,
    text_name: String,
    environment: Arc<Environment>,
    // The FMU keeps a pointer to this.
    callbacks: Rc<fmi2CallbackFunctions>,
}

impl Core {
    pub(super) fn name(&self) -> &str {
        &self.text_name
    }

    /// Calls a function of the FMU and turns its status into a result.
    #[inline]
    pub(super) fn call(
        &self,
        function: &'static str,
        call: impl FnOnce(&Functions, fmi2Component) -> fmi2Status,
    ) -> Result<()> {
        if self.loaded.is_dead() {
            return Err(self.dead(function));
        }
        let before = self.environment.count();
        let status = call(&self.loaded.functions, self.component);
        if status == fmi2OK || status == fmi2Warning { Ok(()) } else { Err(self.failed(function, status, before)) }
    }

    /// Asks for warnings and errors alone, in the categories that FMI 2.0 reserves for them, so that errors can say
    /// why. An FMU that declares no such category or refuses stays silent.
    fn ask_for_complaints(&self) {
        const RESERVED: [&CStr; 4] = [c"logStatusWarning", c"logStatusDiscard", c"logStatusError", c"logStatusFatal"];
        let declared = &self.loaded.description.log_categories;
        let wanted = RESERVED.iter().filter(|name| declared.iter().any(|it| it.as_bytes() == name.to_bytes()));
        let wanted: Vec<_> = wanted.map(|name| name.as_ptr()).collect();
        if wanted.is_empty() {
            return;
        }
        // SAFETY: there are as many names as is said, and they live forever.
        let _ = self.call("fmi2SetDebugLogging", |functions, component| unsafe {
            (functions.set_debug_logging)(component, fmi2True, wanted.len(), wanted.as_ptr())
        });
    }

    /// The error of a call that began after the first `before` messages.
    #[cold]
    fn failed(&self, function: &'static str, status: fmi2Status, before: usize) -> FmiError {
        if self.loaded.pool().is_some() {
            // SAFETY: the component is that of a living isolated instance.
            if let Some(verdict) = unsafe { isolated::verdict(self.component) } {
                return self.convicted(function, verdict);
            }
        } else if status == fmi2Fatal {
            self.loaded.kill();
        }
        let (instance, messages) = (self.text_name.clone(), self.environment.last(before));
        FmiError::Call { function, instance, status: status.into(), messages }
    }

    /// Why a call to an isolated instance came to nothing.
    #[cold]
    fn convicted(&self, function: &'static str, verdict: Verdict) -> FmiError {
        match verdict {
            Verdict::Ended(ending) => FmiError::Isolated(ending),
            Verdict::Over => self.dead(function),
        }
    }

    #[cold]
    fn dead(&self, function: &'static str) -> FmiError {
        let model = self.loaded.description.co_simulation.model_identifier.clone();
        FmiError::Dead { function, instance: self.text_name.clone(), model }
    }

    /// Fails unless the FMU declares a capability.
    pub(super) fn require(&self, function: &'static str, supported: bool, capability: &'static str) -> Result<()> {
        if supported {
            return Ok(());
        }
        Err(FmiError::NotSupported { function, instance: self.text_name.clone(), capability })
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
        Err(FmiError::Length { function, instance: self.text_name.clone(), references, values, what })
    }
}

impl Drop for Core {
    fn drop(&mut self) {
        if self.loaded.is_dead() {
            // Not even freeing is allowed, and the FMU may still use what it was given.
            std::mem::forget((
                Rc::clone(&self.callbacks),
                Arc::clone(&self.environment),
                std::mem::take(&mut self.name),
            ));
            return;
        }
        // SAFETY: the component is live, and nothing uses it afterwards.
        unsafe { (self.loaded.functions.free_instance)(self.component) };
    }
}

impl Instance {
    pub(super) fn new(loaded: Arc<Loaded>, name: &str, logging: Logging) -> Result<Self> {
        let text_name = name.to_owned();
        let name = c_string("instance name", name)?;
        if loaded.is_dead() {
            let model = loaded.description.co_simulation.model_identifier.clone();
            return Err(FmiError::Dead { function: "fmi2Instantiate", instance: text_name, model });
        }
        let environment = Environment::new(logging.sink);
        let callbacks = Rc::new(environment.callbacks());
        let component = instantiate(&loaded, &name, &environment, &callbacks, logging.enabled)?;
        if component.is_null() {
            let model = loaded.description.co_simulation.model_identifier.clone();
            let (guid, messages) = (loaded.description.guid.clone(), environment.last(0));
            return Err(FmiError::Instantiate { instance: text_name, model, guid, messages });
        }
        let core = Core { loaded, component, name, text_name, environment, callbacks };
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
        if self.core.loaded.pool().is_none() {
            return Ok(());
        }
        // SAFETY: the component is that of a living isolated instance.
        let verdict = unsafe { isolated::free(self.core.component) };
        verdict.map_or(Ok(()), |verdict| Err(self.core.convicted("fmi2FreeInstance", verdict)))
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
    ///
    /// # Errors
    /// When the call fails.
    pub fn set_debug_logging(&mut self, on: bool) -> Result<()> {
        // SAFETY: no categories are passed.
        self.core.call("fmi2SetDebugLogging", |functions, component| unsafe {
            (functions.set_debug_logging)(component, fmi2Boolean::from(on), 0, ptr::null())
        })
    }

    /// Announces the times of the experiment, in seconds, and the relative tolerance.
    ///
    /// # Errors
    /// When the call fails.
    pub fn setup_experiment(&mut self, start: f64, stop: Option<f64>, tolerance: Option<f64>) -> Result<()> {
        let (has_tolerance, has_stop) = (fmi2Boolean::from(tolerance.is_some()), fmi2Boolean::from(stop.is_some()));
        let (tolerance, stop) = (tolerance.unwrap_or(0.0), stop.unwrap_or(0.0));
        // SAFETY: only numbers are passed.
        self.core.call("fmi2SetupExperiment", |functions, component| unsafe {
            (functions.setup_experiment)(component, has_tolerance, tolerance, start, has_stop, stop)
        })
    }

    /// Begins the initialization.
    ///
    /// # Errors
    /// When the call fails.
    pub fn enter_initialization_mode(&mut self) -> Result<()> {
        // SAFETY: nothing but the component is passed.
        self.core.call("fmi2EnterInitializationMode", |functions, component| unsafe {
            (functions.enter_initialization_mode)(component)
        })
    }

    /// Ends the initialization; stepping may begin.
    ///
    /// # Errors
    /// When the call fails.
    pub fn exit_initialization_mode(&mut self) -> Result<()> {
        // SAFETY: nothing but the component is passed.
        self.core.call("fmi2ExitInitializationMode", |functions, component| unsafe {
            (functions.exit_initialization_mode)(component)
        })
    }

    /// Goes from `time` to `time + step`, in seconds.
    ///
    /// # Errors
    /// When the step is discarded or fails. After a discarded one, see [`Instance::last_successful_time`].
    #[inline]
    pub fn do_step(&mut self, time: f64, step: f64) -> Result<()> {
        // The last argument promises nothing: a master may go back to earlier states.
        // SAFETY: only numbers are passed.
        self.core
            .call("fmi2DoStep", |functions, component| unsafe { (functions.do_step)(component, time, step, fmi2False) })
    }

    /// Time up to which a discarded step was carried out, s.
    ///
    /// # Errors
    /// When the FMU does not know.
    pub fn last_successful_time(&self) -> Result<f64> {
        let mut time = 0.0;
        // SAFETY: the pointer is to a live number.
        self.core.call("fmi2GetRealStatus", |functions, component| unsafe {
            (functions.get_real_status)(component, fmi2LastSuccessfulTime, &raw mut time)
        })?;
        Ok(time)
    }

    /// Whether a discarded step means that the slave wants the simulation to end.
    ///
    /// # Errors
    /// When the FMU does not know.
    pub fn wants_to_terminate(&self) -> Result<bool> {
        let mut terminated = fmi2False;
        // SAFETY: the pointer is to a live number.
        self.core.call("fmi2GetBooleanStatus", |functions, component| unsafe {
            (functions.get_boolean_status)(component, fmi2Terminated, &raw mut terminated)
        })?;
        Ok(terminated != fmi2False)
    }

    /// Ends the simulation. Values can still be read.
    ///
    /// # Errors
    /// When the call fails.
    pub fn terminate(&mut self) -> Result<()> {
        // SAFETY: nothing but the component is passed.
        self.core.call("fmi2Terminate", |functions, component| unsafe { (functions.terminate)(component) })
    }

    /// Goes back to where [`super::Fmu::instantiate`] left it.
    ///
    /// # Errors
    /// When the call fails.
    pub fn reset(&mut self) -> Result<()> {
        // SAFETY: nothing but the component is passed.
        self.core.call("fmi2Reset", |functions, component| unsafe { (functions.reset)(component) })
    }
}

/// Has the FMU make a component; NULL if it refuses.
fn instantiate(
    loaded: &Loaded,
    name: &CStr,
    environment: &Arc<Environment>,
    callbacks: &Rc<fmi2CallbackFunctions>,
    debug: bool,
) -> Result<fmi2Component> {
    let (guid, resources) = (loaded.guid(), loaded.resources());
    if let Some(pool) = loaded.pool() {
        return pool.instantiate(&Wanted { name, guid, resources, debug }, environment);
    }
    let (name, guid, resources) = (name.as_ptr(), guid.as_ptr(), resources.as_ptr());
    let debug = fmi2Boolean::from(debug);
    let function = loaded.functions.instantiate;
    // SAFETY: the strings and the callbacks live as long as the component, in `Core`.
    Ok(unsafe { function(name, fmi2CoSimulation, guid, resources, Rc::as_ptr(callbacks), fmi2False, debug) })
}

impl fmt::Debug for Instance {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let model = &self.description().model_name;
        out.debug_struct("Instance").field("name", &self.name()).field("model", model).finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests;
