//! The functions without a component that is live, or without a status.

use super::{Fmu, Handle, text};
use crate::instance::{Instance, Session};
use crate::logger::{Callback, Logger};
use crate::panics::{guard, panic_message};
use crate::resource::resource_folder;
use crate::slave::Slave;
use crate::standard::Standard;
use core::ptr::null_mut;
use core::sync::atomic::Ordering;
use fmu_abi::{
    fmi2Boolean, fmi2CallbackFunctions, fmi2CoSimulation, fmi2Component, fmi2Error, fmi2False, fmi2ModelExchange,
    fmi2String, fmi2Type,
};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// The arguments of `fmi2Instantiate` that are checked.
struct Request<'a> {
    name: &'a str,
    kind: fmi2Type,
    guid: Result<&'a str, &'static str>,
    resources: Option<Result<&'a str, &'static str>>,
}

/// `fmi2Instantiate`. A failure is logged even with `logging_on` false, since the standard promises the reason.
#[allow(clippy::too_many_arguments)] // The arguments of the C function, and the FMU.
pub unsafe fn fmi2Instantiate<S: Slave>(
    fmu: &Fmu,
    instance_name: fmi2String,
    kind: fmi2Type,
    guid: fmi2String,
    resource_location: fmi2String,
    functions: *const fmi2CallbackFunctions,
    _visible: fmi2Boolean,
    logging_on: fmi2Boolean,
) -> fmi2Component {
    guard(null_mut(), || {
        // SAFETY: contract of this module, for all three.
        let functions = unsafe { functions.as_ref() };
        let name = unsafe { text(instance_name) };
        let (guid, resources) = unsafe { (text(guid), text(resource_location)) };
        let request = Request {
            name: name.unwrap_or_default(),
            kind,
            guid,
            resources: (!resource_location.is_null()).then_some(resources),
        };
        let callback = functions.and_then(|f| f.logger).map_or(Callback::None, Callback::Fmi2);
        let environment = functions.map_or(null_mut(), |f| f.componentEnvironment);
        let logger = |logging_on| Logger::new(callback, environment, request.name, logging_on);
        made("fmi2Instantiate", &logger(true), || create::<S>(fmu, &request, logger(logging_on != fmi2False)))
    })
}

/// The component of an instance that `create` makes; NULL if it fails, whose reason goes to the logger.
pub(crate) fn made<S: Slave>(
    name: &str,
    logger: &Logger,
    create: impl FnOnce() -> Result<Instance<S>, String>,
) -> fmi2Component {
    let created = catch_unwind(AssertUnwindSafe(create));
    match created.unwrap_or_else(|payload| Err(format!("the model panicked: {}", panic_message(payload)))) {
        Ok(instance) => Box::into_raw(Box::new(Handle::new(instance))).cast(),
        Err(reason) => {
            logger.status(fmi2Error, format_args!("{name}: {reason}"));
            null_mut()
        }
    }
}

fn create<S: Slave>(fmu: &Fmu, request: &Request<'_>, logger: Logger) -> Result<Instance<S>, String> {
    // Few models read anything from there, so an odd location is worth a warning at most.
    let resources = match request.resources.map(|uri| uri.map(resource_folder)) {
        Some(Ok(Ok(folder))) => Some(folder),
        Some(Ok(Err(e))) => {
            logger.warning(format_args!("fmi2Instantiate: {e}"));
            None
        }
        Some(Err(reason)) => {
            logger.warning(format_args!("fmi2Instantiate: fmuResourceLocation: {reason}"));
            None
        }
        None => None,
    };
    let own_guid = fmu.guid::<S>(Standard::Fmi2, resources.as_deref())?;
    check_name(request.name)?;
    let exchange = request.kind == fmi2ModelExchange;
    if !(exchange && S::INFO.model_exchange.is_some() || request.kind == fmi2CoSimulation) {
        let kind = request.kind;
        let offer = if S::INFO.model_exchange.is_some() {
            "model exchange (0) and co-simulation (1)"
        } else {
            "co-simulation (1)"
        };
        return Err(format!("fmuType = {kind}; this FMU offers {offer} only"));
    }
    let given = request.guid.map_err(|reason| format!("fmuGUID: {reason}"))?;
    if given != own_guid.to_string() {
        return Err(format!("fmuGUID = {given:?}; this FMU has {own_guid}"));
    }
    // There is no status to carry it, so the warning must not colour the next call.
    logger.take_warned();
    Ok(Instance::new(Session::new(Standard::Fmi2, exchange), resources, logger, own_guid))
}

pub(crate) fn check_name(name: &str) -> Result<(), String> {
    if name.trim().is_empty() { Err("instanceName is empty, blank, NULL or not UTF-8".to_owned()) } else { Ok(()) }
}

/// `fmi2FreeInstance`. NULL is ignored; so is an instance that is in a call, which leaks rather than vanish under
/// the feet of that call.
pub unsafe fn fmi2FreeInstance<S: Slave>(component: fmi2Component) {
    let handle = component.cast::<Handle<S>>();
    if handle.is_null() || !handle.is_aligned() {
        return;
    }
    // SAFETY: by contract the component points to a live handle.
    let live = unsafe { &*handle };
    // Within a step of FMI 3.0 the importer is called while nothing else is under way.
    if live.shown.load(Ordering::Acquire) || live.busy.swap(true, Ordering::Acquire) {
        return;
    }
    // SAFETY: by contract it came from `Box::into_raw` in `instantiate` and was not freed; `busy` keeps others out.
    let handle = unsafe { Box::from_raw(handle) };
    guard((), || handle.instance.into_inner().free());
}

/// `fmi2GetTypesPlatform`
pub const unsafe fn fmi2GetTypesPlatform<S: Slave>() -> fmi2String {
    c"default".as_ptr()
}

/// `fmi2GetVersion`
pub const unsafe fn fmi2GetVersion<S: Slave>() -> fmi2String {
    c"2.0".as_ptr()
}
