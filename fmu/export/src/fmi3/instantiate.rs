//! The functions without an instance that is live, or without a status.

use crate::added::has_events;
use crate::ffi::{Fmu, array, check_name, fmi2FreeInstance, made, text};
use crate::instance::{Instance, Session};
use crate::logger::{Callback, Logger};
use crate::panics::guard;
use crate::slave::Slave;
use crate::standard::Standard;
use crate::variable::{Causality, Kind, Variability, Variable};
use core::ptr::null_mut;
use fmu_abi::fmi3::{
    fmi3Boolean, fmi3ClockUpdateCallback, fmi3False, fmi3Instance, fmi3InstanceEnvironment,
    fmi3IntermediateUpdateCallback, fmi3LockPreemptionCallback, fmi3LogMessageCallback, fmi3String,
    fmi3UnlockPreemptionCallback, fmi3ValueReference,
};
use std::path::PathBuf;

/// What all three functions are given.
struct Request {
    function: &'static str,
    name: fmi3String,
    token: fmi3String,
    resources: fmi3String,
    logging_on: bool,
    environment: fmi3InstanceEnvironment,
    log: fmi3LogMessageCallback,
}

/// Makes an instance of the session that `session` gives, if it is what the FMU offers.
unsafe fn instantiate<S: Slave>(
    fmu: &Fmu,
    request: &Request,
    session: impl FnOnce(&Logger) -> Result<Session, String>,
) -> fmi3Instance {
    guard(null_mut(), || {
        // SAFETY: contract of this module.
        let [name, token, resources] = unsafe { [request.name, request.token, request.resources].map(|it| text(it)) };
        let name = name.unwrap_or_default();
        let callback = request.log.map_or(Callback::None, Callback::Fmi3);
        let logger = |logging_on| Logger::new(callback, request.environment, name, logging_on);
        made(request.function, &logger(true), || {
            let folder = resources.ok().map(PathBuf::from);
            let own = fmu.guid::<S>(Standard::Fmi3, folder.as_deref())?;
            check_name(name)?;
            let given = token.map_err(|reason| format!("instantiationToken: {reason}"))?;
            if given != own.to_string() {
                return Err(format!("instantiationToken = {given:?}; this FMU has {own}"));
            }
            let logger = logger(request.logging_on);
            let session = session(&logger)?;
            if let Err(reason) = resources
                && !request.resources.is_null()
            {
                logger.warning(format_args!("{}: resourcePath: {reason}", request.function));
            }
            logger.take_warned(); // there is no status to carry it
            Ok(Instance::<S>::new(session, folder, logger, own))
        })
    })
}

/// `fmi3InstantiateModelExchange`
#[allow(clippy::too_many_arguments)] // The arguments of the C function, and the FMU; so below.
pub unsafe fn fmi3InstantiateModelExchange<S: Slave>(
    fmu: &Fmu,
    name: fmi3String,
    token: fmi3String,
    resources: fmi3String,
    _visible: fmi3Boolean,
    logging_on: fmi3Boolean,
    environment: fmi3InstanceEnvironment,
    log: fmi3LogMessageCallback,
) -> fmi3Instance {
    let (function, logging_on) = ("fmi3InstantiateModelExchange", logging_on != fmi3False);
    let request = Request { function, name, token, resources, logging_on, environment, log };
    // SAFETY: contract of this module; so below.
    unsafe {
        instantiate::<S>(fmu, &request, |_| match S::INFO.model_exchange {
            Some(_) => Ok(Session::new(Standard::Fmi3, true)),
            None => Err("this FMU offers co-simulation only".to_owned()),
        })
    }
}

/// `fmi3InstantiateCoSimulation`
#[allow(clippy::too_many_arguments)]
pub unsafe fn fmi3InstantiateCoSimulation<S: Slave>(
    fmu: &Fmu,
    name: fmi3String,
    token: fmi3String,
    resources: fmi3String,
    _visible: fmi3Boolean,
    logging_on: fmi3Boolean,
    event_mode_used: fmi3Boolean,
    early_return_allowed: fmi3Boolean,
    required: *const fmi3ValueReference,
    required_count: usize,
    environment: fmi3InstanceEnvironment,
    log: fmi3LogMessageCallback,
    intermediate_update: fmi3IntermediateUpdateCallback,
) -> fmi3Instance {
    let (function, logging_on) = ("fmi3InstantiateCoSimulation", logging_on != fmi3False);
    let request = Request { function, name, token, resources, logging_on, environment, log };
    unsafe {
        instantiate::<S>(fmu, &request, |logger| {
            let event_mode = event_mode_used != fmi3False;
            if event_mode && !has_events::<S>() {
                return Err("eventModeUsed is true, but this FMU has no event mode".to_owned());
            }
            if !event_mode && S::variables().iter().any(Variable::is_clock) {
                logger.tolerated("this FMU has clocks, for which FMI 3.0 wants eventModeUsed; tolerated, none ticks");
            }
            let required = array(required, required_count, "requiredIntermediateVariables");
            let intermediate = required.map_err(|error| error.to_string())?.to_vec();
            if let Some(bad) = intermediate.iter().find(|reference| !is_intermediate::<S>(**reference)) {
                return Err(format!("requiredIntermediateVariables holds {bad}, which has no intermediateUpdate"));
            }
            Ok(Session {
                event_mode,
                early_return: early_return_allowed != fmi3False,
                intermediate,
                intermediate_update,
                environment,
                ..Session::new(Standard::Fmi3, false)
            })
        })
    }
}

/// `fmi3InstantiateScheduledExecution`, which no FMU of this exporter offers.
#[allow(clippy::too_many_arguments)]
pub unsafe fn fmi3InstantiateScheduledExecution<S: Slave>(
    fmu: &Fmu,
    name: fmi3String,
    token: fmi3String,
    resources: fmi3String,
    _visible: fmi3Boolean,
    _logging_on: fmi3Boolean,
    environment: fmi3InstanceEnvironment,
    log: fmi3LogMessageCallback,
    _clock_update: fmi3ClockUpdateCallback,
    _lock_preemption: fmi3LockPreemptionCallback,
    _unlock_preemption: fmi3UnlockPreemptionCallback,
) -> fmi3Instance {
    let function = "fmi3InstantiateScheduledExecution";
    let request = Request { function, name, token, resources, logging_on: true, environment, log };
    unsafe { instantiate::<S>(fmu, &request, |_| Err("this FMU offers no scheduled execution".to_owned())) }
}

/// Whether an importer may read a variable within a step: continuous outputs.
pub(crate) fn is_intermediate<S: Slave>(reference: u32) -> bool {
    let row = usize::try_from(reference).ok().and_then(|index| S::variables().get(index));
    row.is_some_and(|row| {
        let continuous = matches!(row.kind(), Kind::Real(_)) && row.variability() == Variability::Continuous;
        continuous && row.causality() == Causality::Output
    })
}

/// `fmi3FreeInstance`, as that of FMI 2.0.
pub unsafe fn fmi3FreeInstance<S: Slave>(instance: fmi3Instance) {
    // SAFETY: contract of this module.
    unsafe { fmi2FreeInstance::<S>(instance) }
}

/// `fmi3GetVersion`
pub const unsafe fn fmi3GetVersion<S: Slave>() -> fmi3String {
    c"3.0".as_ptr()
}
