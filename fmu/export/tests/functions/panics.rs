//! A panic behind any hook is an error of that call and nothing more: the host lives on.

use crate::common::calls::{call, host_in};
use crate::common::toy::*;
use crate::common::*;
use core::ptr::null_mut;
use fmu_export::abi::*;
use fmu_export::{CallState, Function, Interface, Legality};

/// The call failed, the reason is logged, and a reset makes the instance usable again.
fn assert_survives(host: &Host, status: fmi2Status, function: &str, hook: &str) {
    assert_eq!(status, fmi2Error, "{hook}");
    let expected = format!("{function}: internal error, the model panicked: panic in {hook}");
    assert_eq!(host.error(), expected);
    assert_eq!(host.step(0.0, 1.0), fmi2Error, "the error state");
    assert_eq!(host.reset(), fmi2OK);
    host.start(0.0, None);
    assert_eq!(host.step(0.0, 1.0), fmi2OK);
}

/// Every function that acts on an instance, in a state in which it is legal; those without an instance to act on
/// cannot fail but `fmi2Instantiate` (below). `tests/fmus` of the root package sees that the libraries export
/// no other functions.
#[test]
fn a_panic_behind_any_function_is_an_error_of_that_call_and_the_host_lives_on() {
    let mut cases = 0;
    for &function in Function::ALL.iter().filter(|f| **f != Function::FreeInstance) {
        for interface in [Interface::ModelExchange, Interface::CoSimulation] {
            let legal = |state: &CallState| function.legality(interface, *state) == Legality::Legal;
            let Some(host) = CallState::ALL.into_iter().filter(legal).find_map(|state| host_in(interface, state))
            else {
                assert!(function.interface().is_some_and(|own| own != interface) || function == Function::CancelStep);
                continue;
            };
            let saved = host.save();
            PANIC_IN_CALL.set(Some(function.name()));
            let status = call(&host, function, saved);
            PANIC_IN_CALL.set(None);
            assert_eq!(status, fmi2Error, "{function:?}");
            let expected = format!("{0}: internal error, the model panicked: panic in {0}", function.name());
            assert!(
                host.lines().iter().any(|line| line.status == fmi2Error && line.message == expected),
                "{function:?}"
            );
            assert_eq!(host.reset(), fmi2OK);
            host.start(0.0, None);
            cases += 1;
        }
    }
    assert_eq!(cases, 2 * 22 - 2 + 8 + 10, "common functions for both interfaces, the others for their own");
}

#[test]
fn a_panic_in_any_hook_is_an_error() {
    type Row = (&'static str, &'static str, fn() -> Host, fn(&Host) -> fmi2Status);
    let rows: [Row; 10] = [
        ("setup", "fmi2SetupExperiment", Host::new, |host| host.setup(0.0, None)),
        ("update", "fmi2GetReal", Host::initializing, |host| host.try_real(DOUBLED).0),
        ("initialize", "fmi2ExitInitializationMode", Host::initializing, |host| host.exit_initialization()),
        ("step", "fmi2DoStep", Host::initialized, |host| host.step(0.0, 1.0)),
        ("terminate", "fmi2Terminate", Host::initialized, |host| host.terminate()),
        ("getter", "fmi2GetReal", Host::initializing, |host| host.try_real(GAIN).0),
        ("setter", "fmi2SetReal", Host::initializing, |host| host.set_real(GAIN, 3.0)),
        ("derivative", "fmi2GetDirectionalDerivative", Host::initializing, |host| {
            host.directional_derivative(&[DOUBLED], &[GAIN], &[1.0]).expect_err("a panic")
        }),
        ("write", "fmi2SerializedFMUstateSize", Host::initialized, |host| {
            host.try_serialize(host.save()).expect_err("a panic")
        }),
        ("read", "fmi2DeSerializeFMUstate", Host::initialized, |host| {
            host.deserialize(&host.serialize(host.save()), &mut null_mut())
        }),
    ];
    for (hook, function, start, act) in rows {
        let host = start();
        host.trouble(&format!("panic {hook}"));
        let status = act(&host);
        assert_survives(&host, status, function, hook);
    }
}

/// The state that was saved last is copied when the present one is about to change.
#[test]
fn a_panic_in_clone_is_an_error() {
    let host = Host::initialized();
    let (saved, mut state) = (host.save(), null_mut());
    PANIC_IN_CLONE.set(true);
    let status = host.step(0.0, 1.0);
    PANIC_IN_CLONE.set(false);
    assert_survives(&host, status, "fmi2DoStep", "clone");
    host.refused(host.restore(saved), "is no FMU state of this instance");

    let host = Host::initialized();
    host.save();
    PANIC_IN_CLONE.set(true);
    let status = host.save_in(&mut state);
    PANIC_IN_CLONE.set(false);
    assert!(state.is_null());
    assert_survives(&host, status, "fmi2GetFMUstate", "clone");
}

#[test]
fn a_panic_in_new_fails_instantiate_and_reset() {
    let host = Host::initialized();
    PANIC_IN_NEW.set(true);
    let mut log = Log::default();
    let functions = Log::callbacks(&raw mut log);
    let c = instantiate(Some("toy"), fmi2CoSimulation, Some(&guid()), None, &raw const functions, false);
    let status = host.reset();
    PANIC_IN_NEW.set(false);
    assert!(c.is_null());
    assert_eq!(log.lines[0].message, "fmi2Instantiate: the model panicked: panic in new");
    assert_survives(&host, status, "fmi2Reset", "new");
}

#[test]
fn a_panic_in_drop_ends_with_the_call() {
    let host = Host::initialized();
    PANIC_IN_DROP.set(true);
    assert_survives(&host, host.reset(), "fmi2Reset", "drop");
    host.save();
    let mut host = host;
    PANIC_IN_DROP.set(true);
    unsafe { fmi2FreeInstance(core::mem::replace(&mut host.component, null_mut())) };
    assert_eq!(host.error(), "fmi2FreeInstance: internal error, the model panicked: panic in drop");
    assert!(!PANIC_IN_DROP.get());
}

/// A call that fails without touching the model leaves the error state behind, too, where a saved state is to be copied
/// first.
#[test]
fn a_panic_in_clone_while_a_call_fails_leaves_the_error_state() {
    let host = Host::initialized();
    host.save();
    PANIC_IN_CLONE.set(true);
    let status = host.try_real(COUNT_OF_VARIABLES).0;
    PANIC_IN_CLONE.set(false);
    assert_eq!(status, fmi2Error);
    host.refused(host.step(0.0, 1.0), "in state error");
}

/// A host at 3 s with a state at 1 s that has its own memory, and memory for a copy that is dropped when more comes.
fn host_with_a_spare() -> (Host, fmi2FMUstate) {
    let host = Host::initialized();
    let mut first = host.save();
    assert_eq!(host.step(0.0, 1.0), fmi2OK);
    let second = host.save();
    assert_eq!(host.step(1.0, 1.0), fmi2OK);
    assert_eq!(host.restore(first), fmi2OK);
    assert_eq!(host.free_state(&mut first), fmi2OK);
    assert_eq!(host.step(0.0, 3.0), fmi2OK);
    (host, second)
}

#[test]
fn a_panic_in_drop_does_not_lose_the_state_that_was_just_restored_or_saved() {
    let restore = |host: &Host, saved: &mut fmi2FMUstate| host.restore(*saved);
    let save = |host: &Host, saved: &mut fmi2FMUstate| host.save_in(saved);
    for (act, time) in [(&restore as &dyn Fn(&Host, &mut fmi2FMUstate) -> fmi2Status, 1.0), (&save, 3.0)] {
        let (host, mut saved) = host_with_a_spare();
        PANIC_IN_DROP.set(true);
        assert_eq!(act(&host, &mut saved), fmi2Error);
        assert!(!PANIC_IN_DROP.get(), "nothing was dropped");
        assert_eq!(host.step(1.0, 1.0), fmi2Error, "the error state");
        assert_eq!(host.restore(saved), fmi2OK);
        assert_eq!(host.real(TIME), time);
        assert_eq!(host.step(time, 1.0), fmi2OK);
    }
}
