//! A panic behind any function of FMI 3.0 becomes an error with a message; instances that cannot be made say why.

use crate::common::calls3::{call, host_in};
use crate::common::fmi3::*;
use crate::common::toy::{
    COUNT_OF_VARIABLES, GAIN, INPUT, INTEGRAL, PANIC_IN_CALL, PANIC_IN_CLONE, PANIC_IN_DROP, PANIC_IN_NEW, TICK,
};
use core::ptr::null_mut;
use fmu_export::abi::fmi3::*;
use fmu_export::fmi3::Function;
use fmu_export::{CallState, Interface, Legality};

#[test]
fn a_panic_behind_every_function_becomes_an_error() {
    let mut functions = 0;
    for &function in Function::ALL.iter().filter(|function| **function != Function::FreeInstance) {
        let of = |session: Session| {
            let interface = if session.exchange { Interface::ModelExchange } else { Interface::CoSimulation };
            let legal = |state: &CallState| function.legality(interface, *state) == Legality::Legal;
            let host = CallState::ALL.into_iter().filter(legal).find_map(|state| host_in(session, state));
            host.map(|host| (session, host))
        };
        let Some((_, host)) = [Session::EVENTS, Session::EXCHANGE].into_iter().find_map(of) else { continue };
        let saved = host.save();
        PANIC_IN_CALL.set(Some(function.name()));
        let status = call(host.instance, function, saved);
        PANIC_IN_CALL.set(None);
        assert_eq!(status, fmi3Error, "{function:?}");
        let message = format!("{}: internal error, the model panicked: panic in {}", function.name(), function.name());
        assert!(host.lines().iter().any(|line| line.message == message), "{function:?}");
        assert_eq!(unsafe { fmi3Reset(host.instance) }, fmi3OK);
        functions += 1;
    }
    // Two are legal nowhere.
    assert_eq!(functions, Function::ALL.len() - 3);
}

#[test]
fn a_panic_within_a_step_ends_the_step_and_no_more() {
    for session in [Session::PLAIN, Session::EVENTS, Session::LOOKS] {
        let host = Host::started(session);
        host.trouble("panic step");
        assert_eq!(host.step(0.0, 0.5).status, fmi3Error);
        assert!(host.error().contains("the model panicked: panic in step"));
        assert_eq!(unsafe { fmi3Reset(host.instance) }, fmi3OK);
    }
}

/// A hook of the model, the session and state in which a call reaches it, and the C function.
#[test]
fn a_panic_in_every_hook_of_the_model_becomes_an_error() {
    use CallState as S;
    use Function as F;
    for (hook, session, state, function) in [
        ("setup", Session::PLAIN, S::Instantiated, F::EnterInitializationMode),
        ("update", Session::PLAIN, S::InitializationMode, F::ExitInitializationMode),
        ("initialize", Session::EVENTS, S::InitializationMode, F::ExitInitializationMode),
        ("step", Session::LOOKS, S::StepMode, F::DoStep),
        ("event handler", Session::EVENTS, S::EventMode, F::UpdateDiscreteStates),
        ("event handler", Session::EXCHANGE, S::EventMode, F::UpdateDiscreteStates),
        ("place", Session::EXCHANGE, S::EventMode, F::EnterContinuousTimeMode),
        ("terminate", Session::PLAIN, S::StepMode, F::Terminate),
        ("write", Session::PLAIN, S::StepMode, F::SerializedFmuStateSize),
    ] {
        let host = host_in(session, state).expect("a state that is reached");
        host.trouble(&format!("panic {hook}"));
        let saved = host.save();
        assert_eq!(call(host.instance, function, saved), fmi3Error, "{hook}");
        assert_eq!(
            host.error(),
            format!("{}: internal error, the model panicked: panic in {hook}", function.name()),
            "{hook}"
        );
        assert_eq!(unsafe { fmi3Reset(host.instance) }, fmi3OK);
        host.start();
    }
}

#[test]
fn a_panic_at_the_event_of_model_exchange_becomes_an_error() {
    let host = Host::new(Session::EXCHANGE);
    host.start();
    assert_eq!(host.enter_event_mode(), fmi3OK);
    host.trouble("panic event handler");
    assert_eq!(unsafe { fmi3EnterContinuousTimeMode(host.instance) }, fmi3OK);
    assert_eq!(host.enter_event_mode(), fmi3Error);
    assert!(host.error().contains("the model panicked: panic in event handler"));
}

#[test]
fn a_panic_in_a_call_within_a_step_ends_the_step() {
    let host = Host::started(Session::LOOKS);
    let instance = host.instance;
    host.on_look(move |_, _| {
        let mut value = 0.0;
        PANIC_IN_CALL.set(Some("fmi3GetFloat64"));
        let status = unsafe { fmi3GetFloat64(instance, &INTEGRAL, 1, &raw mut value, 1) };
        PANIC_IN_CALL.set(None);
        assert_eq!(status, fmi3Error);
        None
    });
    assert_eq!(host.step(0.0, 0.5).status, fmi3Error);
    let lines = host.lines();
    assert_eq!(lines.len(), 2, "{lines:?}");
    assert!(lines[0].message.contains("the model panicked: panic in fmi3GetFloat64"));
    assert!(lines[1].message.starts_with("fmi3DoStep: "));
}

#[test]
fn panics_while_a_model_is_copied_or_dropped_are_caught() {
    let host = Host::started(Session::PLAIN);
    host.save();
    PANIC_IN_CLONE.set(true);
    assert_eq!(host.step(0.0, 0.5).status, fmi3Error, "a saved state is copied when the present one changes");
    PANIC_IN_CLONE.set(false);
    assert!(host.error().contains("the model panicked: panic in clone"));
    assert_eq!(unsafe { fmi3Reset(host.instance) }, fmi3OK);
    let environment = Box::<Environment>::default();
    let instance = instantiate(Session::EVENTS, "host", &token(), &environment);
    PANIC_IN_DROP.set(true);
    unsafe { fmi3FreeInstance(instance) };
    let lines = environment.lines();
    let message = "fmi3FreeInstance: internal error, the model panicked: panic in drop";
    assert!(lines.iter().any(|line| line.message == message), "{lines:?}");
}

#[test]
fn what_an_importer_may_not_read_within_steps_is_refused_at_once() {
    for reference in [GAIN, INPUT, TICK, COUNT_OF_VARIABLES, u32::MAX] {
        let environment = Box::<Environment>::default();
        let required = [INTEGRAL, reference];
        assert!(instantiate_for(Session::LOOKS, "host", &token(), &environment, &required).is_null());
        let message = format!("requiredIntermediateVariables holds {reference}, which has no intermediateUpdate");
        assert!(environment.lines().iter().any(|line| line.status == fmi3Error && line.message.contains(&message)));
    }
}

#[test]
fn an_instance_that_cannot_be_made_is_null_and_says_why() {
    let refused = |session, name: &str, token: &str, message: &str| {
        let environment = Box::<Environment>::default();
        assert!(instantiate(session, name, token, &environment).is_null());
        let lines = environment.lines();
        assert!(lines.iter().any(|line| line.status == fmi3Error && line.message.contains(message)), "{lines:?}");
    };
    for session in [Session::EXCHANGE, Session::PLAIN] {
        refused(session, " ", &token(), "instanceName is empty, blank, NULL or not UTF-8");
        refused(session, "host", "{other}", "instantiationToken = \"{other}\"; this FMU has {");
        PANIC_IN_NEW.set(true);
        refused(session, "host", &token(), "the model panicked");
        PANIC_IN_NEW.set(false);
    }
    let instance = unsafe {
        let (name, token) = (c"host".as_ptr(), c"".as_ptr());
        fmi3InstantiateScheduledExecution(name, token, name, 0, 0, null_mut(), None, None, None, None)
    };
    assert!(instance.is_null());
    assert_eq!(unsafe { core::ffi::CStr::from_ptr(fmi3GetVersion()) }, c"3.0");
}
