//! A panic behind any function of FMI 3.0 becomes an error with a message; instances that cannot be made say why.
#![allow(clippy::expect_used, clippy::panic)] // Helpers outside of #[test] functions fail a test, too.

mod common;

use common::calls3::{call, host_in};
use common::fmi3::*;
use common::toy::{PANIC_IN_CALL, PANIC_IN_NEW};
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
