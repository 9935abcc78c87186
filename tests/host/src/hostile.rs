//! Values and arguments that no FMU can use, one by one: each must be refused with a status and a line in the log.

use crate::{Fmu, Instance, Log};
use core::ffi::CStr;
use core::ptr::null;
use fmu_export::Interface;
use fmu_export::abi::{
    fmi2CallbackFunctions, fmi2CoSimulation, fmi2Component, fmi2Error, fmi2OK, fmi2Status, fmi2String, fmi2True,
    fmi2Warning,
};

/// Reals that are no numbers.
pub const NO_NUMBERS: [f64; 3] = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY];

/// An instance in a state that takes Reals.
type Start = fn(&Fmu) -> Result<Instance<'_>, String>;

/// A call on an instance, by name.
type Call<'a> = (&'a str, &'a dyn Fn(fmi2Component) -> fmi2Status);

fn demand(holds: bool, what: impl FnOnce() -> String) -> Result<(), String> {
    if holds { Ok(()) } else { Err(what()) }
}

/// Whether a call was refused, with a reason.
fn refused(instance: &mut Instance, status: fmi2Status, what: &str) -> Result<(), String> {
    let lines = instance.log().take();
    let told = lines.iter().any(|line| line.status == fmi2Error && line.category == "logStatusError");
    let panicked = lines.iter().any(|line| line.message.contains("internal error"));
    demand(status == fmi2Error && told && !panicked, || format!("{what}: status {status}, {lines:?}"))
}

fn fresh(fmu: &Fmu) -> Result<Instance<'_>, String> {
    Instance::new(fmu, Interface::CoSimulation)
}

fn initializing_for(fmu: &Fmu, interface: Interface) -> Result<Instance<'_>, String> {
    let (instance, f) = (Instance::new(fmu, interface)?, &fmu.functions);
    // SAFETY: the component is live.
    let status = unsafe {
        (f.fmi2SetupExperiment)(instance.component, 0, 0.0, 0.0, 0, 0.0)
            .max((f.fmi2EnterInitializationMode)(instance.component))
    };
    demand(status == fmi2OK, || format!("initialisation: status {status}"))?;
    Ok(instance)
}

fn initializing(fmu: &Fmu) -> Result<Instance<'_>, String> {
    initializing_for(fmu, Interface::CoSimulation)
}

fn initialized_for(fmu: &Fmu, interface: Interface) -> Result<Instance<'_>, String> {
    let instance = initializing_for(fmu, interface)?;
    // SAFETY: the component is live.
    let status = unsafe { (fmu.functions.fmi2ExitInitializationMode)(instance.component) };
    demand(status == fmi2OK, || format!("initialisation: status {status}"))?;
    Ok(instance)
}

fn initialized(fmu: &Fmu) -> Result<Instance<'_>, String> {
    initialized_for(fmu, Interface::CoSimulation)
}

fn at_event(fmu: &Fmu) -> Result<Instance<'_>, String> {
    initialized_for(fmu, Interface::ModelExchange)
}

fn exchanging(fmu: &Fmu) -> Result<Instance<'_>, String> {
    let instance = at_event(fmu)?;
    let exchange = fmu.functions.exchange.as_ref().ok_or("no model exchange")?;
    // SAFETY: the component is live.
    let status = unsafe { (exchange.fmi2EnterContinuousTimeMode)(instance.component) };
    demand(status == fmi2OK, || format!("continuous-time mode: status {status}"))?;
    Ok(instance)
}

fn starts(fmu: &Fmu) -> Vec<(&'static str, Start)> {
    let mut starts: Vec<(&'static str, Start)> =
        vec![("instantiated", fresh), ("initializationMode", initializing), ("stepComplete", initialized)];
    if fmu.functions.exchange.is_some() {
        starts.extend([("eventMode", at_event as Start), ("continuousTimeMode", exchanging)]);
    }
    starts
}

/// Each variable set to each of [`NO_NUMBERS`] in each state: refused, or taken where infinity has a meaning; then the FMU
/// runs on. Gives the number of values taken.
///
/// # Errors
/// What was not refused.
pub fn variables(fmu: &Fmu) -> Result<usize, String> {
    let mut taken = 0;
    for (state, start) in starts(fmu) {
        for reference in 0..fmu.variables {
            for value in NO_NUMBERS {
                let mut instance = start(fmu)?;
                // SAFETY: one reference, one value; the component is live.
                let status = unsafe {
                    (fmu.functions.fmi2SetReal)(instance.component, &raw const reference, 1, &raw const value)
                };
                let what = format!("variable {reference} = {value} in {state}");
                if status <= fmi2Warning && value == f64::INFINITY {
                    taken += 1;
                    runs_on(fmu, &mut instance, state).map_err(|e| format!("{what}: {e}"))?;
                } else {
                    refused(&mut instance, status, &what)?;
                }
            }
        }
    }
    Ok(taken)
}

/// Whether a run with an infinite parameter gets through initialisation and a step, or ends in an error with a reason.
fn runs_on(fmu: &Fmu, instance: &mut Instance, state: &str) -> Result<(), String> {
    let (c, f) = (instance.component, &fmu.functions);
    // SAFETY: the component is live.
    let status = unsafe {
        let mut status = fmi2OK;
        if state == "instantiated" {
            status =
                status.max((f.fmi2SetupExperiment)(c, 0, 0.0, 0.0, 0, 0.0)).max((f.fmi2EnterInitializationMode)(c));
        }
        if state != "stepComplete" {
            status = status.max((f.fmi2ExitInitializationMode)(c));
        }
        status.max((f.fmi2DoStep)(c, 0.0, 0.01, fmi2True))
    };
    if status < fmi2Error { Ok(()) } else { refused(instance, status, "run") }
}

/// Each Real argument of each function set to each of [`NO_NUMBERS`], and to other values that make no sense.
///
/// # Errors
/// What was not refused.
pub fn arguments(fmu: &Fmu) -> Result<(), String> {
    let f = fmu.functions;
    for bad in NO_NUMBERS {
        // SAFETY: the components are live.
        unsafe {
            let check = |start: Start, what: &str, call: &dyn Fn(fmi2Component) -> fmi2Status| {
                let mut instance = start(fmu)?;
                let status = call(instance.component);
                refused(&mut instance, status, &format!("{what} = {bad}"))
            };
            check(fresh, "startTime", &|c| (f.fmi2SetupExperiment)(c, 0, 0.0, bad, 0, 0.0))?;
            check(fresh, "tolerance", &|c| (f.fmi2SetupExperiment)(c, 1, bad, 0.0, 0, 0.0))?;
            if bad != f64::INFINITY {
                check(fresh, "stopTime", &|c| (f.fmi2SetupExperiment)(c, 0, 0.0, 0.0, 1, bad))?;
            }
            check(initialized, "communicationStepSize", &|c| (f.fmi2DoStep)(c, 0.0, bad, 1))?;
            check(initialized, "currentCommunicationPoint", &|c| (f.fmi2DoStep)(c, bad, 0.01, 1))?;
            for reference in 0..fmu.variables {
                check(initialized, "input derivative", &|c| {
                    (f.fmi2SetRealInputDerivatives)(c, &raw const reference, 1, &1, &raw const bad)
                })?;
            }
            let Some(exchange) = f.exchange else { continue };
            check(exchanging, "time", &|c| (exchange.fmi2SetTime)(c, bad))?;
            for state in 0..fmu.states {
                let states: Vec<_> = (0..fmu.states).map(|k| if k == state { bad } else { 0.0 }).collect();
                check(exchanging, "state", &|c| (exchange.fmi2SetContinuousStates)(c, states.as_ptr(), fmu.states))?;
            }
        }
    }
    for (t, h) in [(0.0, 0.0), (0.0, -0.01), (0.0, 5e-324), (7.0, 0.01), (-1.0, 0.01), (1e300, 0.01)] {
        let mut instance = initialized(fmu)?;
        // SAFETY: the component is live.
        let status = unsafe { (f.fmi2DoStep)(instance.component, t, h, fmi2True) };
        // The smallest number does advance time from 0 s; whether the FMU takes it is up to the model.
        let possible = h == 5e-324 && status < fmi2Error;
        if !possible {
            refused(&mut instance, status, &format!("step from {t} by {h}"))?;
        }
    }
    Ok(())
}

/// Value references that are none, in each function that takes one.
///
/// # Errors
/// What was not refused.
pub fn references(fmu: &Fmu) -> Result<(), String> {
    let f = fmu.functions;
    for bad in [fmu.variables, u32::MAX] {
        let vr = &raw const bad;
        let text = c"".as_ptr();
        // SAFETY: one reference, one value each.
        let calls: [Call; 10] = unsafe {
            [
                ("fmi2GetReal", &|c| (f.fmi2GetReal)(c, vr, 1, &mut 0.0)),
                ("fmi2GetInteger", &|c| (f.fmi2GetInteger)(c, vr, 1, &mut 0)),
                ("fmi2GetBoolean", &|c| (f.fmi2GetBoolean)(c, vr, 1, &mut 0)),
                ("fmi2GetString", &|c| (f.fmi2GetString)(c, vr, 1, &mut null())),
                ("fmi2SetReal", &|c| (f.fmi2SetReal)(c, vr, 1, &0.0)),
                ("fmi2SetInteger", &|c| (f.fmi2SetInteger)(c, vr, 1, &0)),
                ("fmi2SetBoolean", &|c| (f.fmi2SetBoolean)(c, vr, 1, &0)),
                ("fmi2SetString", &|c| (f.fmi2SetString)(c, vr, 1, &raw const text)),
                ("fmi2SetRealInputDerivatives", &|c| (f.fmi2SetRealInputDerivatives)(c, vr, 1, &1, &0.0)),
                ("fmi2GetRealOutputDerivatives", &|c| (f.fmi2GetRealOutputDerivatives)(c, vr, 1, &1, &mut 0.0)),
            ]
        };
        for (what, call) in calls {
            let mut instance = initialized(fmu)?;
            let status = call(instance.component);
            refused(&mut instance, status, &format!("{what} of {bad}"))?;
        }
    }
    Ok(())
}

/// Odd resource locations and missing callbacks: an instance is made all the same, and works.
///
/// # Errors
/// What was refused, or did not work.
pub fn instantiation(fmu: &Fmu) -> Result<(), String> {
    let long = [b"file:///".as_slice(), &vec![b'a'; 1 << 20], b"\0"].concat();
    let long = CStr::from_bytes_with_nul(&long).map_err(|e| e.to_string())?;
    let odd = [
        c"",
        c"file:",
        c"file:/x",
        c"file:///a%20b/%C3%A9",
        c"file:///%zz",
        c"file:///%FF",
        c"file:///%00",
        c"file://host/x",
        c"http://example.org/x",
        c"fmi2://x",
        c"C:\\x",
        c"\xff\xfe",
        long,
    ];
    let none = fmi2CallbackFunctions {
        logger: None,
        allocateMemory: None,
        freeMemory: None,
        stepFinished: None,
        componentEnvironment: core::ptr::null_mut(),
    };
    for location in odd.into_iter().map(CStr::as_ptr).chain([null()]) {
        let mut log = Log::default();
        let logging = Log::callbacks(&raw mut log);
        for callbacks in [null(), &raw const none, &raw const logging] {
            works(fmu, location, callbacks)?;
        }
        let panicked = log.take().iter().any(|line| line.status > fmi2Error || line.message.contains("panicked"));
        demand(!panicked, || "a panic".into())?;
    }
    Ok(())
}

/// Whether an instance made with these arguments takes a step, refuses another, and can be freed.
fn works(fmu: &Fmu, location: fmi2String, callbacks: *const fmi2CallbackFunctions) -> Result<(), String> {
    let f = &fmu.functions;
    // SAFETY: strings are zero-terminated or NULL, the component is live.
    let statuses = unsafe {
        let c = (f.fmi2Instantiate)(c"odd".as_ptr(), fmi2CoSimulation, fmu.guid.as_ptr(), location, callbacks, 0, 1);
        demand(!c.is_null(), || "no instance".into())?;
        let statuses = [
            (f.fmi2SetupExperiment)(c, 0, 0.0, 0.0, 0, 0.0),
            (f.fmi2EnterInitializationMode)(c),
            (f.fmi2ExitInitializationMode)(c),
            (f.fmi2DoStep)(c, 0.0, 0.01, 1),
            (f.fmi2DoStep)(c, 0.0, f64::NAN, 1),
        ];
        (f.fmi2FreeInstance)(c);
        statuses
    };
    demand(statuses == [fmi2OK, fmi2OK, fmi2OK, fmi2OK, fmi2Error], || format!("statuses {statuses:?}"))
}
