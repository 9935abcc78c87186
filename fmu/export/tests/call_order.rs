//! Which call is legal in which state: the table cell by cell, and the C functions driven through every cell.
#![allow(clippy::expect_used, clippy::panic)] // Helpers outside of #[test] functions fail a test, too.

mod common;

use common::*;
use core::ptr::{null, null_mut};
use fmi2_export::abi::*;
use fmi2_export::{CallState, Causality, Function, Legality, Variability, is_settable};

/// The table of FMI 2.0.4, section 4.2.4, written down independently of the one under test. A column is a state:
/// i instantiated, I initializationMode, c stepComplete, p stepInProgress, f stepFailed, x stepCanceled,
/// t terminated, e error, F fatal. `+` legal, `~` tolerated, `.` illegal.
const EXPECTED: &[(&str, &str)] = &[
    //                               iIcpfxteF
    ("fmi2SetDebugLogging", "++++++++."),
    ("fmi2FreeInstance", "+++.++++~"),
    ("fmi2SetupExperiment", "+........"),
    ("fmi2EnterInitializationMode", "+........"),
    ("fmi2ExitInitializationMode", ".+......."),
    ("fmi2Terminate", "..+.+...."),
    ("fmi2Reset", "+++.++++."),
    ("fmi2GetReal", "~++.++++."),
    ("fmi2GetInteger", "~++.++++."),
    ("fmi2GetBoolean", "~++.++++."),
    ("fmi2GetString", "~++.++++."),
    ("fmi2SetReal", "+++......"),
    ("fmi2SetInteger", "+++......"),
    ("fmi2SetBoolean", "+++......"),
    ("fmi2SetString", "+++......"),
    ("fmi2GetFMUstate", "+++.++++."),
    ("fmi2SetFMUstate", "+++.++++."),
    ("fmi2FreeFMUstate", "+++.++++~"),
    ("fmi2SerializedFMUstateSize", "+++.++++."),
    ("fmi2SerializeFMUstate", "+++.++++."),
    ("fmi2DeSerializeFMUstate", "+++.++++."),
    ("fmi2GetDirectionalDerivative", ".++.++++."),
    ("fmi2SetRealInputDerivatives", "+++......"),
    ("fmi2GetRealOutputDerivatives", "..+.++++."),
    ("fmi2DoStep", "..+......"),
    ("fmi2CancelStep", "...+....."),
    ("fmi2GetStatus", "..+++.+.."),
    ("fmi2GetRealStatus", "..+++.+.."),
    ("fmi2GetIntegerStatus", "..+++.+.."),
    ("fmi2GetBooleanStatus", "..+++.+.."),
    ("fmi2GetStringStatus", "..+++.+.."),
];

fn legality(cell: char) -> Legality {
    match cell {
        '+' => Legality::Legal,
        '~' => Legality::Tolerated,
        '.' => Legality::Illegal,
        other => panic!("{other}"),
    }
}

#[test]
fn every_cell_of_the_table_is_as_in_the_standard() {
    assert_eq!(Function::ALL.len(), EXPECTED.len());
    for (function, (name, cells)) in Function::ALL.iter().zip(EXPECTED) {
        assert_eq!(function.name(), *name);
        for (state, cell) in CallState::ALL.into_iter().zip(cells.chars()) {
            assert_eq!(function.legality(state), legality(cell), "{name} in {state}");
        }
    }
}

#[test]
fn what_may_be_set_is_as_in_the_footnotes_of_the_table() {
    use CallState::{InitializationMode, Instantiated, StepComplete};
    let variabilities = [Variability::Fixed, Variability::Tunable, Variability::Discrete, Variability::Continuous];
    for state in CallState::ALL {
        let initial = matches!(state, Instantiated | InitializationMode);
        for variability in variabilities {
            let tunable = variability == Variability::Tunable && state == StepComplete;
            let cell = |causality| is_settable(causality, variability, state);
            assert_eq!(cell(Causality::Parameter), initial || tunable, "{state}");
            assert_eq!(cell(Causality::Input), initial || state == StepComplete, "{state}");
            for never in [Causality::CalculatedParameter, Causality::Output, Causality::Local, Causality::Independent] {
                assert!(!cell(never), "{state}");
            }
        }
    }
}

/// An instance in this state; none for the two that no instance of this exporter reaches.
fn host_in(state: CallState) -> Option<Host> {
    let host = match state {
        CallState::Instantiated => Host::new(),
        CallState::InitializationMode => Host::initializing(),
        CallState::StepInProgress | CallState::StepCanceled => return None,
        _ => Host::initialized(),
    };
    match state {
        CallState::StepFailed => {
            host.trouble("discard step");
            assert_eq!(host.step(0.0, 1.0), fmi2Discard);
        }
        CallState::Terminated => assert_eq!(host.terminate(), fmi2OK),
        CallState::Error => assert_eq!(host.step(5.0, 1.0), fmi2Error),
        CallState::Fatal => {
            host.trouble("fatal step");
            assert_eq!(host.step(0.0, 1.0), fmi2Fatal);
        }
        _ => {}
    }
    host.lines();
    Some(host)
}

/// Calls a function with arguments that are right as such. `state` is an FMU state of the instance or NULL.
fn call(host: &Host, function: Function, mut state: fmi2FMUstate) -> fmi2Status {
    use Function as F;
    let c = host.component;
    let (mut real, mut integer, mut text, mut size) = (0.0, 0, null(), 0);
    let mut fresh = null_mut();
    let (mut vr, order, value) = (common::toy::INPUT, 1, 1.0);
    let mut bytes = [0; 1024];
    unsafe {
        match function {
            F::SetDebugLogging => fmi2SetDebugLogging(c, fmi2True, 0, null()),
            F::FreeInstance => panic!("not here"),
            F::SetupExperiment => host.setup(0.0, None),
            F::EnterInitializationMode => fmi2EnterInitializationMode(c),
            F::ExitInitializationMode => fmi2ExitInitializationMode(c),
            F::Terminate => fmi2Terminate(c),
            F::Reset => fmi2Reset(c),
            F::GetReal => fmi2GetReal(c, null(), 0, null_mut()),
            F::GetInteger => fmi2GetInteger(c, null(), 0, null_mut()),
            F::GetBoolean => fmi2GetBoolean(c, null(), 0, null_mut()),
            F::GetString => fmi2GetString(c, null(), 0, null_mut()),
            F::SetReal => fmi2SetReal(c, null(), 0, null()),
            F::SetInteger => fmi2SetInteger(c, null(), 0, null()),
            F::SetBoolean => fmi2SetBoolean(c, null(), 0, null()),
            F::SetString => fmi2SetString(c, null(), 0, null()),
            F::GetFmuState => fmi2GetFMUstate(c, &raw mut fresh),
            F::SetFmuState => fmi2SetFMUstate(c, state),
            F::FreeFmuState => fmi2FreeFMUstate(c, &raw mut state),
            F::SerializedFmuStateSize => fmi2SerializedFMUstateSize(c, state, &raw mut size),
            F::SerializeFmuState => fmi2SerializeFMUstate(c, state, bytes.as_mut_ptr(), bytes.len()),
            F::DeSerializeFmuState => {
                let source = Host::new();
                let saved = source.save();
                fmi2SerializedFMUstateSize(source.component, saved, &raw mut size);
                fmi2SerializeFMUstate(source.component, saved, bytes.as_mut_ptr(), size);
                fmi2DeSerializeFMUstate(c, bytes.as_ptr(), size, &raw mut fresh)
            }
            F::GetDirectionalDerivative => fmi2GetDirectionalDerivative(c, null(), 0, null(), 0, null(), null_mut()),
            F::SetRealInputDerivatives => {
                fmi2SetRealInputDerivatives(c, &raw const vr, 1, &raw const order, &raw const value)
            }
            F::GetRealOutputDerivatives => {
                vr = common::toy::INTEGRAL;
                fmi2GetRealOutputDerivatives(c, &raw const vr, 1, &raw const order, &raw mut real)
            }
            F::DoStep => host.step(0.0, 1.0),
            F::CancelStep => fmi2CancelStep(c),
            F::GetStatus => fmi2GetStatus(c, fmi2DoStepStatus, &raw mut integer),
            F::GetRealStatus => fmi2GetRealStatus(c, fmi2LastSuccessfulTime, &raw mut real),
            F::GetIntegerStatus => fmi2GetIntegerStatus(c, fmi2DoStepStatus, &raw mut integer),
            F::GetBooleanStatus => fmi2GetBooleanStatus(c, fmi2Terminated, &raw mut integer),
            F::GetStringStatus => fmi2GetStringStatus(c, fmi2PendingStatus, &raw mut text),
        }
    }
}

#[test]
fn the_c_functions_follow_the_table_in_every_state() {
    for &function in Function::ALL.iter().filter(|f| **f != Function::FreeInstance) {
        for state in CallState::ALL {
            let Some(host) = host_in(state) else { continue };
            let saved = if state == CallState::Fatal { null_mut() } else { host.save() };
            let status = call(&host, function, saved);
            let said_illegal =
                host.lines().iter().any(|line| line.message.contains(&format!("illegal in state {state}")));
            let illegal = function.legality(state) == Legality::Illegal;
            assert_eq!(said_illegal, illegal, "{function:?} in {state}");
            let expected = match (illegal, state, function) {
                (true, CallState::Fatal, _) => fmi2Fatal,
                (true, ..) => fmi2Error,
                (_, _, Function::GetIntegerStatus | Function::GetStringStatus) => fmi2Discard,
                (_, CallState::Instantiated, Function::EnterInitializationMode) => fmi2Warning,
                _ if function.legality(state) == Legality::Tolerated => fmi2Warning,
                _ => fmi2OK,
            };
            assert_eq!(status, expected, "{function:?} in {state}");
        }
    }
}

#[test]
fn an_illegal_call_says_where_it_is_legal_and_leads_to_the_error_state() {
    let host = Host::new();
    assert_eq!(host.step(0.0, 1.0), fmi2Error);
    assert_eq!(host.error(), "fmi2DoStep: illegal in state instantiated; legal in: stepComplete");
    assert_eq!(host.setup(0.0, None), fmi2Error);
    assert_eq!(host.error(), "fmi2SetupExperiment: illegal in state error; legal in: instantiated");
    assert_eq!(host.reset(), fmi2OK);
    assert_eq!(host.setup(0.0, None), fmi2OK);
}

#[test]
fn from_the_error_state_a_restored_state_leads_back() {
    let host = Host::initialized();
    let saved = host.save();
    assert_eq!(host.step(7.0, 1.0), fmi2Error);
    assert_eq!(host.step(0.0, 1.0), fmi2Error);
    assert_eq!(host.real(common::toy::GAIN), 2.0, "values may still be read, for debugging");
    assert_eq!(host.restore(saved), fmi2OK);
    assert_eq!(host.step(0.0, 1.0), fmi2OK);
}

#[test]
fn after_a_fatal_error_nothing_but_free_is_left() {
    let host = host_in(CallState::Fatal).expect("a host");
    assert_eq!(host.reset(), fmi2Fatal);
    assert_eq!(host.try_real(common::toy::GAIN).0, fmi2Fatal);
    assert_eq!(host.lines()[0].category, "logStatusFatal");
}

#[test]
fn every_function_takes_a_null_component_for_an_error() {
    let mut host = Host::new();
    let component = core::mem::replace(&mut host.component, null_mut());
    for &function in Function::ALL.iter().filter(|f| **f != Function::FreeInstance) {
        if function != Function::DeSerializeFmuState {
            assert_eq!(call(&host, function, null_mut()), fmi2Error, "{function:?}");
        }
    }
    let mut state = null_mut();
    assert_eq!(unsafe { fmi2DeSerializeFMUstate(null_mut(), null(), 0, &raw mut state) }, fmi2Error);
    unsafe { fmi2FreeInstance(null_mut()) };
    host.component = component;
}
