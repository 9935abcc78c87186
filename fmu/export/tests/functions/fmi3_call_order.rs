//! Which call of FMI 3.0 is legal in which state: the table cell by cell, and the C functions driven through every cell.

use crate::common::calls3::{call, failed_host, host_in, status_of};
use crate::common::fmi3::*;
use core::cell::RefCell;
use core::ptr::null_mut;
use fmu_export::abi::fmi3::*;
use fmu_export::fmi3::Function;
use fmu_export::{CallState, Interface, Legality};
use std::rc::Rc;

/// What FMI 3.0 says of the states of model exchange (sections 2.3 and 3.2), with the functions of equal rows together. A column is
/// a state: i instantiated, g configuration mode, I initialization mode, v event mode, m continuous-time mode, u reconfiguration
/// mode, t terminated, e after an error, which is terminated, F after a fatal one. `x` legal, a digit legal under a condition.
const MODEL_EXCHANGE: &[(&str, &str)] = &[
    // igIvmuteF
    ("x.xxx.xx.", "SetDebugLogging Reset FreeInstance"),
    (
        "8.888.88.",
        "GetFMUState SetFMUState FreeFMUState SerializedFMUStateSize SerializeFMUState DeserializeFMUState \
         GetNumberOfVariableDependencies GetVariableDependencies",
    ),
    ("x........", "EnterInitializationMode"),
    ("..x......", "ExitInitializationMode"),
    ("8..8.....", "EnterConfigurationMode"),
    (".x...x...", "ExitConfigurationMode"),
    ("...xx....", "Terminate"),
    (
        "6.x66.66.",
        "GetFloat32 GetFloat64 GetInt8 GetUInt8 GetInt16 GetUInt16 GetInt32 GetUInt32 GetInt64 GetUInt64 \
         GetBoolean GetString GetBinary",
    ),
    ("9.9x9.99.", "GetClock"),
    ("132453...", "SetFloat32 SetFloat64"),
    (
        "132473...",
        "SetInt8 SetUInt8 SetInt16 SetUInt16 SetInt32 SetUInt32 SetInt64 SetUInt64 SetBoolean SetString \
         SetBinary",
    ),
    ("..888.88.", "GetDirectionalDerivative GetAdjointDerivative"),
    ("..88.....", "GetIntervalDecimal GetIntervalFraction"),
    (
        "..8......",
        "GetShiftDecimal GetShiftFraction SetIntervalDecimal SetIntervalFraction SetShiftDecimal \
         SetShiftFraction",
    ),
    ("...8.....", "SetClock EvaluateDiscreteStates EnterContinuousTimeMode"),
    ("...x.....", "UpdateDiscreteStates"),
    ("....x....", "EnterEventMode CompletedIntegratorStep SetTime SetContinuousStates"),
    ("..xxx.xx.", "GetContinuousStates GetContinuousStateDerivatives GetEventIndicators GetNominalsOfContinuousStates"),
    ("x..x.....", "GetNumberOfContinuousStates GetNumberOfEventIndicators"),
    (".........", "EnterStepMode DoStep GetOutputDerivatives ActivateModelPartition"),
];

/// The same of co-simulation (section 4.2): s step mode, n intermediate update mode.
const CO_SIMULATION: &[(&str, &str)] = &[
    // igIvsnuteF
    ("x.xxx..xx.", "SetDebugLogging Reset FreeInstance"),
    ("8.888..88.", "GetFMUState SetFMUState FreeFMUState SerializedFMUStateSize SerializeFMUState DeserializeFMUState"),
    ("8.8888.88.", "GetNumberOfVariableDependencies GetVariableDependencies"),
    ("x.........", "EnterInitializationMode"),
    ("..x.......", "ExitInitializationMode"),
    ("8...8.....", "EnterConfigurationMode"),
    (".x....x...", "ExitConfigurationMode"),
    ("...xx.....", "Terminate"),
    ("6.x660.66.", "GetFloat32 GetFloat64"),
    (
        "6.x667.66.",
        "GetInt8 GetUInt8 GetInt16 GetUInt16 GetInt32 GetUInt32 GetInt64 GetUInt64 GetBoolean GetString \
         GetBinary",
    ),
    ("9.9x9..99.", "GetClock"),
    ("1324503...", "SetFloat32 SetFloat64"),
    (
        "1324573...",
        "SetInt8 SetUInt8 SetInt16 SetUInt16 SetInt32 SetUInt32 SetInt64 SetUInt64 SetBoolean SetString \
         SetBinary",
    ),
    ("..888..88.", "GetDirectionalDerivative GetAdjointDerivative"),
    ("..88......", "GetIntervalDecimal GetIntervalFraction"),
    (
        "..8.......",
        "GetShiftDecimal GetShiftFraction SetIntervalDecimal SetIntervalFraction SetShiftDecimal \
         SetShiftFraction",
    ),
    ("...8......", "SetClock EvaluateDiscreteStates EnterStepMode"),
    ("...x......", "UpdateDiscreteStates"),
    ("....8.....", "EnterEventMode"),
    ("....x.....", "DoStep"),
    ("....80.88.", "GetOutputDerivatives"),
    (
        "..........",
        "EnterContinuousTimeMode CompletedIntegratorStep SetTime SetContinuousStates GetContinuousStates \
         GetContinuousStateDerivatives GetEventIndicators GetNominalsOfContinuousStates \
         GetNumberOfContinuousStates GetNumberOfEventIndicators ActivateModelPartition",
    ),
];

/// Cells in which the standard lets an FMU choose, or contradicts itself, and what is chosen here.
const CHOSEN: &[(&str, &str, Legality, &str)] = &[
    ("EnterConfigurationMode", "vs", Legality::Illegal, "there are no tunable structural parameters"),
    ("GetClock", "iImste", Legality::Illegal, "clocks tick in event mode only"),
    (
        "SetFloat32 SetFloat64 SetInt8 SetUInt8 SetInt16 SetUInt16 SetInt32 SetUInt32 SetInt64 SetUInt64 SetBoolean \
         SetString SetBinary",
        "n",
        Legality::Illegal,
        "intermediate values are only read",
    ),
    ("FreeInstance FreeFMUState", "F", Legality::Tolerated, "memory would be lost"),
];

/// States that no instance is in: there are no structural parameters.
const NEVER: &str = "gu";

fn letters(interface: Interface) -> &'static str {
    match interface {
        Interface::ModelExchange => "igIvmuteF",
        Interface::CoSimulation => "igIvsnuteF",
    }
}

fn state(letter: char) -> Option<CallState> {
    Some(match letter {
        'i' => CallState::Instantiated,
        'I' => CallState::InitializationMode,
        'v' => CallState::EventMode,
        'm' => CallState::ContinuousTimeMode,
        's' => CallState::StepMode,
        'n' => CallState::IntermediateUpdateMode,
        't' | 'e' => CallState::Terminated,
        'F' => CallState::Fatal,
        _ => return None,
    })
}

/// Whether a function is among these, which lack their "fmi3".
fn names(list: &str, function: Function) -> bool {
    list.split(' ').any(|name| function.name().strip_prefix("fmi3") == Some(name))
}

fn expected(function: Function, interface: Interface, letter: char) -> Legality {
    let chosen = CHOSEN.iter().find(|row| names(row.0, function) && row.1.contains(letter));
    if let Some((.., legality, _)) = chosen {
        return *legality;
    }
    let table = if interface == Interface::ModelExchange { MODEL_EXCHANGE } else { CO_SIMULATION };
    let cells = table.iter().find(|row| names(row.1, function)).expect("a row").0;
    let column = letters(interface).find(letter).expect("a column");
    if cells.as_bytes()[column] == b'.' { Legality::Illegal } else { Legality::Legal }
}

#[test]
#[cfg_attr(miri, ignore = "safe code that compares words, ten minutes long")]
fn every_cell_of_the_table_is_as_in_the_standard() {
    assert_eq!(Function::ALL.len(), 71);
    let mut cells = 0;
    for &function in Function::ALL {
        for interface in [Interface::ModelExchange, Interface::CoSimulation] {
            for letter in letters(interface).chars() {
                let Some(state) = state(letter) else {
                    assert!(NEVER.contains(letter));
                    continue;
                };
                let found = function.legality(interface, state);
                assert_eq!(found, expected(function, interface, letter), "{function:?}, {interface} in {state}");
                cells += 1;
            }
        }
    }
    assert_eq!(cells, 71 * (7 + 8));
}

/// Whether the log says that a call of this function is illegal, or forbidden and tolerated.
fn judged(function: Function, lines: &[Line], state: CallState) -> Legality {
    let says = |words: &str| {
        let beginning = format!("{}: {words} in state {state}", function.name());
        lines.iter().any(|line| line.message.starts_with(&beginning))
    };
    match (says("illegal"), says("FMI 3.0 forbids it")) {
        (true, _) => Legality::Illegal,
        (_, true) => Legality::Tolerated,
        _ => Legality::Legal,
    }
}

fn check(function: Function, status: fmi3Status, lines: &[Line], legality: Legality, state: CallState) {
    assert_eq!(judged(function, lines, state), legality, "{function:?} in {state}: {lines:?}");
    let wanted = match legality {
        Legality::Illegal if state == CallState::Fatal => fmi3Fatal,
        Legality::Illegal => fmi3Error,
        _ => status_of(function),
    };
    assert_eq!(status, wanted, "{function:?} in {state}: {lines:?}");
    assert!(status == fmi3OK || lines.iter().any(|line| line.status == status), "each failure has its reason");
}

fn functions() -> impl Iterator<Item = Function> {
    Function::ALL.iter().copied().filter(|function| *function != Function::FreeInstance)
}

/// Under Miri one, and of its cells each function in every third state, since each cell is an instance of its own; random calls reach
/// the others there.
const SESSIONS: &[Session] =
    if cfg!(miri) { &[Session::EVENTS] } else { &[Session::EVENTS, Session::EXCHANGE, Session::PLAIN] };

#[test]
fn the_c_functions_follow_the_table_in_every_state() {
    let mut cells = 0;
    for &session in SESSIONS {
        let interface = if session.exchange { Interface::ModelExchange } else { Interface::CoSimulation };
        for (row, function) in functions().enumerate() {
            let columns = letters(interface).chars().filter(|letter| !"gun".contains(*letter)).enumerate();
            for (_, letter) in columns.filter(|(column, _)| !cfg!(miri) || (row + column).is_multiple_of(3)) {
                let state = state(letter).expect("a state");
                let host = if letter == 'e' { Some(failed_host(session)) } else { host_in(session, state) };
                let Some(host) = host else { continue };
                let saved = if state == CallState::Fatal { null_mut() } else { host.save() };
                let status = call(host.instance, function, saved);
                let legality = expected(function, interface, letter);
                if function == Function::EnterEventMode && session == Session::PLAIN && legality == Legality::Legal {
                    assert!(host.error().contains("eventModeUsed = fmi3False"));
                    continue;
                }
                check(function, status, &host.lines(), legality, state);
                cells += 1;
            }
        }
    }
    // Without event mode there is one state less, and one call that is refused.
    assert_eq!(cells, if cfg!(miri) { 164 } else { 70 * (7 + 7 + 6) - 1 });
}

#[test]
fn within_a_step_the_c_functions_follow_the_table() {
    for function in functions() {
        let host = Host::started(Session::LOOKS);
        let (instance, saved) = (host.instance, host.save());
        // Its bytes cannot be made there.
        let saved = if function == Function::DeserializeFmuState { null_mut() } else { saved };
        host.lines();
        let seen = Rc::new(RefCell::new(None));
        let status = seen.clone();
        host.on_look(move |_, _| {
            *status.borrow_mut() = Some(call(instance, function, saved));
            None
        });
        let stepped = host.step(0.0, 0.5);
        let (status, mut lines) = (seen.borrow().expect("a look"), host.lines());
        let legality = expected(function, Interface::CoSimulation, 'n');
        if status == fmi3Error {
            assert_eq!(stepped.status, fmi3Error, "an instance that fails within a step does not end it");
            assert!(lines.pop().expect("a line").message.contains("fmi3DoStep: "), "{function:?}");
        } else {
            assert_eq!(stepped.status, fmi3OK);
        }
        check(function, status, &lines, legality, CallState::IntermediateUpdateMode);
    }
}

#[test]
fn within_a_step_no_instance_is_freed() {
    let host = Host::started(Session::LOOKS);
    let instance = host.instance;
    host.on_look(move |_, _| {
        unsafe { fmi3FreeInstance(instance) };
        None
    });
    assert_eq!(host.stepped(0.0, 0.5), (false, false, 0.5));
    assert_eq!(host.float(crate::common::toy::INTEGRAL), 1.0);
}

#[test]
fn after_an_error_the_instance_is_terminated_and_a_reset_or_a_saved_state_leads_back() {
    let host = Host::started(Session::EVENTS);
    let saved = host.save();
    assert_eq!(host.step(7.0, 1.0).status, fmi3Error);
    assert!(host.error().starts_with("fmi3DoStep: currentCommunicationPoint = 7 s"));
    assert_eq!(host.step(0.0, 1.0).status, fmi3Error);
    assert_eq!(host.error(), "fmi3DoStep: illegal in state terminated; legal in: stepMode");
    assert_eq!(host.float(crate::common::toy::GAIN), 2.0, "values may still be read, for debugging");
    assert_eq!(host.restore(saved), fmi3OK);
    assert_eq!(host.stepped(0.0, 0.5), (false, false, 0.5));
    assert_eq!(unsafe { fmi3Reset(host.instance) }, fmi3OK);
    assert_eq!(host.enter_initialization(None), fmi3OK);
}

#[test]
fn in_every_session_reset_and_a_saved_state_lead_out_of_an_error() {
    for session in [Session::EXCHANGE, Session::PLAIN, Session::EVENTS, Session::LOOKS] {
        let host = Host::started(session);
        let saved = host.save();
        assert_eq!(host.try_float(u32::MAX).0, fmi3Error);
        assert_eq!(unsafe { fmi3Terminate(host.instance) }, fmi3Error, "{session:?}");
        assert_eq!(host.restore(saved), fmi3OK, "{session:?}");
        assert_eq!(unsafe { fmi3Terminate(host.instance) }, fmi3OK, "{session:?}");
        assert_eq!(host.try_float(u32::MAX).0, fmi3Error);
        assert_eq!(unsafe { fmi3Reset(host.instance) }, fmi3OK, "{session:?}");
        host.start();
    }
}

#[test]
fn a_reset_within_a_step_that_has_failed_does_not_bring_the_step_back() {
    let host = Host::started(Session::LOOKS);
    let instance = host.instance;
    let seen = Rc::new(RefCell::new(None));
    let statuses = seen.clone();
    host.on_look(move |_, _| {
        let first = unsafe { fmi3Reset(instance) }; // illegal there, so that the instance is terminated
        *statuses.borrow_mut() = Some((first, unsafe { fmi3Reset(instance) }));
        None
    });
    assert_eq!(host.step(0.0, 0.5).status, fmi3Error);
    assert_eq!(*seen.borrow(), Some((fmi3Error, fmi3OK)));
    assert!(host.lines().pop().expect("a line").message.starts_with("fmi3DoStep: "));
    assert_eq!(unsafe { fmi3Reset(host.instance) }, fmi3OK);
    host.on_look(|_, _| None);
    host.start();
    assert_eq!(host.stepped(0.0, 0.5), (false, false, 0.5));
}

/// Free the instance under the feet of the step: what follows in `fmi3DoStep` would read freed memory.
#[test]
fn within_a_step_that_has_failed_no_instance_is_freed() {
    let host = Host::started(Session::LOOKS);
    let instance = host.instance;
    host.on_look(move |_, _| {
        assert_eq!(unsafe { fmi3Reset(instance) }, fmi3Error);
        unsafe { fmi3FreeInstance(instance) };
        None
    });
    assert_eq!(host.step(0.0, 0.5).status, fmi3Error);
    assert_eq!(unsafe { fmi3Reset(host.instance) }, fmi3OK);
}

#[test]
fn every_function_takes_a_null_instance_for_an_error() {
    for function in functions() {
        assert_eq!(call(null_mut(), function, null_mut()), fmi3Error, "{function:?}");
    }
    unsafe { fmi3FreeInstance(null_mut()) };
}
