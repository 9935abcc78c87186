//! Values and arguments that no FMU can use, one by one: each must be refused with a status and a line in the log.

use crate::{Fmu, Host, Instance};
use fmu_export::abi::{fmi2Error, fmi2OK, fmi2Status, fmi2True, fmi2Warning};
use fmu_export::{CallState, Interface};

/// Reals that are no numbers.
const NO_NUMBERS: [f64; 3] = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY];

/// The states that take Reals; the last two are of model exchange.
const STATES: [CallState; 5] = [
    CallState::Instantiated,
    CallState::InitializationMode,
    CallState::StepComplete,
    CallState::EventMode,
    CallState::ContinuousTimeMode,
];

fn demand(holds: bool, what: impl FnOnce() -> String) -> Result<(), String> {
    if holds { Ok(()) } else { Err(what()) }
}

/// Whether a call was refused, with a reason.
fn refused(host: &Host, status: fmi2Status, what: &str) -> Result<(), String> {
    let lines = host.lines();
    let told = lines.iter().any(|line| line.status == fmi2Error && line.category == "logStatusError");
    let panicked = lines.iter().any(|line| line.message.contains("internal error"));
    demand(status == fmi2Error && told && !panicked, || format!("{what}: status {status}, {lines:?}"))
}

/// An instance in one of [`STATES`], at 0 s.
fn at(fmu: &Fmu, state: CallState) -> Result<Instance<'_>, String> {
    let exchange = STATES[3..].contains(&state);
    let instance = Instance::new(fmu, if exchange { Interface::ModelExchange } else { Interface::CoSimulation })?;
    let mut status = fmi2OK;
    if state != CallState::Instantiated {
        status = status.max(instance.setup(0.0, None)).max(instance.enter_initialization());
    }
    if STATES[2..].contains(&state) {
        status = status.max(instance.exit_initialization());
    }
    if state == CallState::ContinuousTimeMode {
        status = status.max(instance.enter_continuous_time_mode());
    }
    demand(status == fmi2OK, || format!("status {status} on the way to {state}"))?;
    Ok(instance)
}

/// Each variable set to what is no number in each state: refused, or taken where infinity has a meaning; then the FMU runs
/// on. Gives the number of values taken.
///
/// # Errors
/// What was not refused.
pub fn variables(fmu: &Fmu) -> Result<usize, String> {
    let mut taken = 0;
    for &state in &STATES[..if fmu.functions.exchange.is_some() { 5 } else { 3 }] {
        for reference in 0..fmu.variables {
            for value in NO_NUMBERS {
                let instance = at(fmu, state)?;
                let status = instance.set_real(reference, value);
                let what = format!("variable {reference} = {value} in {state}");
                if status <= fmi2Warning && value == f64::INFINITY {
                    taken += 1;
                    runs_on(&instance, state).map_err(|e| format!("{what}: {e}"))?;
                } else {
                    refused(&instance, status, &what)?;
                }
            }
        }
    }
    Ok(taken)
}

/// Whether a run with an infinite parameter gets through initialisation and a step, or ends in an error with a reason.
fn runs_on(host: &Host, state: CallState) -> Result<(), String> {
    let mut status = fmi2OK;
    if state == CallState::Instantiated {
        status = status.max(host.setup(0.0, None)).max(host.enter_initialization());
    }
    if state != CallState::StepComplete {
        status = status.max(host.exit_initialization());
    }
    status = status.max(host.step(0.0, 0.01));
    if status < fmi2Error { Ok(()) } else { refused(host, status, "run") }
}

/// Each Real argument of each function set to what is no number, and to other values that make no sense.
///
/// # Errors
/// What was not refused.
pub fn arguments(fmu: &Fmu) -> Result<(), String> {
    let check = |state, what: &str, call: &dyn Fn(&Host) -> fmi2Status| {
        let instance = at(fmu, state)?;
        refused(&instance, call(&instance), what)
    };
    for bad in NO_NUMBERS {
        check(CallState::Instantiated, "startTime", &|host| host.setup(bad, None))?;
        check(CallState::Instantiated, "tolerance", &|host| {
            // SAFETY: the component is live.
            unsafe { (host.functions.fmi2SetupExperiment)(host.component, fmi2True, bad, 0.0, 0, 0.0) }
        })?;
        if bad != f64::INFINITY {
            check(CallState::Instantiated, "stopTime", &|host| host.setup(0.0, Some(bad)))?;
        }
        check(CallState::StepComplete, "communicationStepSize", &|host| host.step(0.0, bad))?;
        check(CallState::StepComplete, "currentCommunicationPoint", &|host| host.step(bad, 0.01))?;
        for reference in 0..fmu.variables {
            check(CallState::StepComplete, "input derivative", &|host| host.set_derivative(reference, 1, bad))?;
        }
        let Some(exchange) = fmu.functions.exchange else { continue };
        // SAFETY: the component is live.
        check(CallState::ContinuousTimeMode, "time", &|host| unsafe { (exchange.fmi2SetTime)(host.component, bad) })?;
        for state in 0..fmu.states {
            let states: Vec<_> = (0..fmu.states).map(|k| if k == state { bad } else { 0.0 }).collect();
            check(CallState::ContinuousTimeMode, "state", &|host| host.place(0.0, &states))?;
        }
    }
    for (t, h) in [(0.0, 0.0), (0.0, -0.01), (7.0, 0.01), (-1.0, 0.01), (1e300, 0.01)] {
        check(CallState::StepComplete, &format!("step from {t} by {h}"), &|host| host.step(t, h))?;
    }
    // The smallest number does advance time from 0 s; whether the FMU takes it is up to the model.
    let instance = at(fmu, CallState::StepComplete)?;
    let status = instance.step(0.0, 5e-324);
    if status < fmi2Error { Ok(()) } else { refused(&instance, status, "the smallest step") }
}
