//! Which call is legal in which state: the table cell by cell, and the C functions driven through every cell.

use crate::common::calls::{call, host_in};
use crate::common::toy::Toy;
use crate::common::*;
use core::ptr::{null, null_mut};
use fmu_export::abi::*;
use fmu_export::{CallState, Causality, Function, Initial, Interface, Legality, Slave, Standard, Variability};

/// The table of FMI 2.0, section 3.2.3 (model exchange), with the functions of equal rows together. A column is a state:
/// i instantiated, I initializationMode, v eventMode, m continuousTimeMode, t terminated, e error, F fatal. `x` legal, a digit
/// legal under the condition of that footnote.
const MODEL_EXCHANGE: &[(&str, &str)] = &[
    // iIvmteF
    (
        "xxxxxx.",
        "SetDebugLogging FreeInstance Reset SetFMUstate FreeFMUstate SerializedFMUstateSize SerializeFMUstate DeSerializeFMUstate",
    ),
    ("x......", "SetupExperiment EnterInitializationMode"),
    (".x.....", "ExitInitializationMode"),
    ("..xx...", "Terminate EnterEventMode"),
    (".2xxx7.", "GetReal GetInteger GetBoolean GetString"),
    ("1345...", "SetReal"),
    ("134....", "SetInteger SetBoolean SetString"),
    ("xxxxx7.", "GetFMUstate GetNominalsOfContinuousStates"),
    (".xxxx7.", "GetDirectionalDerivative GetEventIndicators GetContinuousStates GetDerivatives"),
    ("..x....", "NewDiscreteStates EnterContinuousTimeMode"),
    ("...x...", "CompletedIntegratorStep SetContinuousStates"),
    ("..8x...", "SetTime"),
];

/// The table of section 4.2.4 (co-simulation): c stepComplete, p stepInProgress, f stepFailed, x stepCanceled; else as above.
const CO_SIMULATION: &[(&str, &str)] = &[
    // iIcpfxteF
    ("xxxxxxxx.", "SetDebugLogging"),
    (
        "xxx.xxxx.",
        "FreeInstance Reset SetFMUstate FreeFMUstate SerializedFMUstateSize SerializeFMUstate DeSerializeFMUstate",
    ),
    ("x........", "SetupExperiment EnterInitializationMode"),
    (".x.......", "ExitInitializationMode"),
    ("..x.x....", "Terminate"),
    (".2x.87x7.", "GetReal GetInteger GetBoolean GetString"),
    ("136......", "SetReal SetInteger SetBoolean SetString"),
    ("xxx.87x7.", "GetFMUstate"),
    (".xx.87x7.", "GetDirectionalDerivative"),
    ("xxx......", "SetRealInputDerivatives"),
    ("..x.8xx7.", "GetRealOutputDerivatives"),
    ("..x......", "DoStep"),
    ("...x.....", "CancelStep"),
    ("..xxx.x..", "GetStatus GetRealStatus GetIntegerStatus GetBooleanStatus GetStringStatus"),
];

/// What is tolerated beyond the standard, and why.
const TOLERATED: &[(&str, CallState, &str)] = &[
    ("GetReal GetInteger GetBoolean GetString", CallState::Instantiated, "importers show start values"),
    (
        "SetTime",
        CallState::EventMode,
        "footnote 8 is for purely discrete FMUs; importers go to an event in either mode",
    ),
    ("FreeInstance FreeFMUstate", CallState::Fatal, "memory would be lost"),
];

const BOTH: [Interface; 2] = [Interface::ModelExchange, Interface::CoSimulation];

/// The states of an interface, as columns of its table.
fn columns(interface: Interface) -> &'static [CallState] {
    use CallState::*;
    match interface {
        Interface::ModelExchange => {
            &[Instantiated, InitializationMode, EventMode, ContinuousTimeMode, Terminated, Error, Fatal]
        }
        Interface::CoSimulation => &[
            Instantiated,
            InitializationMode,
            StepComplete,
            StepInProgress,
            StepFailed,
            StepCanceled,
            Terminated,
            Error,
            Fatal,
        ],
    }
}

/// Whether a function is among these, which lack their "fmi2".
fn names(list: &str, function: Function) -> bool {
    list.split(' ').any(|name| function.name().strip_prefix("fmi2") == Some(name))
}

/// What the standard and the list of what is tolerated say; a function of the other interface is illegal.
fn expected(function: Function, interface: Interface, column: usize) -> Legality {
    let table = if interface == Interface::ModelExchange { MODEL_EXCHANGE } else { CO_SIMULATION };
    let state = columns(interface)[column];
    let cells = table.iter().find(|row| names(row.1, function)).map_or(".........", |row| row.0);
    let legal = match cells.as_bytes()[column] {
        b'.' => false,
        b'8' => function != Function::SetTime,
        _ => true,
    };
    match TOLERATED.iter().any(|row| names(row.0, function) && row.1 == state) {
        true => Legality::Tolerated,
        false if legal => Legality::Legal,
        false => Legality::Illegal,
    }
}

#[test]
fn every_cell_of_the_table_is_as_in_the_standard() {
    let named = |name: &str| Function::ALL.iter().any(|function| names(name, *function));
    assert!(MODEL_EXCHANGE.iter().chain(CO_SIMULATION).flat_map(|row| row.1.split(' ')).all(named));
    for &function in Function::ALL {
        for interface in BOTH {
            for (column, &state) in columns(interface).iter().enumerate() {
                let found = function.legality(interface, state);
                assert_eq!(found, expected(function, interface, column), "{function:?}, {interface} in {state}");
            }
        }
    }
}

fn is_of_fmi_3(state: CallState) -> bool {
    matches!(state, CallState::StepMode | CallState::IntermediateUpdateMode)
}

#[test]
fn what_may_be_set_is_as_in_the_footnotes_of_the_table() {
    use CallState::{ContinuousTimeMode, EventMode, InitializationMode, Instantiated, StepComplete};
    for variable in Toy::variables() {
        let input = variable.causality() == Causality::Input;
        let parameter = variable.causality() == Causality::Parameter;
        let tunable = parameter && variable.variability() == Variability::Tunable;
        for state in CallState::ALL.into_iter().filter(|state| !is_of_fmi_3(*state)) {
            let legal = match state {
                Instantiated => variable.initial() == Some(Initial::Exact), // footnote 1; nothing here is "approx"
                InitializationMode => variable.initial() == Some(Initial::Exact) || input, // footnote 3
                StepComplete | EventMode => input || tunable,               // footnotes 6 and 4
                ContinuousTimeMode => {
                    // footnote 5
                    input && variable.variability() == Variability::Continuous || variable.name() == "integral"
                }
                _ => false,
            };
            let expected = match state {
                Instantiated if input => Legality::Tolerated, // importers set all start values
                _ if legal => Legality::Legal,
                _ => Legality::Illegal,
            };
            let found = variable.may_be_set(Toy::variables(), state, Standard::Fmi2);
            assert_eq!(found, expected, "{} in {state}", variable.name());
        }
    }
}

#[test]
fn initialization_mode_gives_outputs_and_initial_unknowns_and_the_rest_is_tolerated() {
    let unknown = ["doubled", "integral", "count", "isOn", "echo", "der(integral)", "held", "samples"]; // footnote 2
    for variable in Toy::variables().iter().filter(|variable| variable.is_of(Standard::Fmi2)) {
        for state in CallState::ALL {
            let restricted = state == CallState::InitializationMode && !unknown.contains(&variable.name());
            let expected = if restricted { Legality::Tolerated } else { Legality::Legal };
            assert_eq!(
                variable.may_be_read(Toy::variables(), state, Standard::Fmi2),
                expected,
                "{} in {state}",
                variable.name()
            );
        }
    }
    let host = Host::initializing();
    assert_eq!(host.try_real(toy::INTEGRAL), (fmi2OK, 0.0));
    assert_eq!(host.lines(), []);
    assert_eq!(host.try_real(toy::GAIN), (fmi2OK, 2.0));
    assert_eq!(told(&host), ["FMI 2.0 forbids that parameter toy.gain be read in state initializationMode; tolerated"]);
}

#[test]
fn an_input_set_before_initialization_mode_is_tolerated_its_derivative_is_legal() {
    let host = Host::new();
    assert_eq!(host.set_real(toy::INPUT, 3.0), fmi2OK);
    assert_eq!(told(&host), ["FMI 2.0 forbids that input u be set in state instantiated; tolerated"]);
    assert_eq!(host.set_derivative(toy::INPUT, 1, 2.0), fmi2OK);
    host.start(0.0, None);
    assert_eq!(host.step(0.0, 1.0), fmi2OK);
    assert_eq!(host.real(toy::INTEGRAL), 2.0 * (3.0 + 0.5 * 2.0));
}

/// The messages, all of them of tolerated calls.
fn told(host: &Host) -> Vec<String> {
    let lines = host.lines();
    assert!(lines.iter().all(|line| (line.status, line.category.as_str()) == (fmi2OK, "logTolerated")), "{lines:?}");
    lines.into_iter().map(|line| line.message).collect()
}

/// The status of a call in a state in which it is legal or tolerated.
fn status_of(function: Function) -> fmi2Status {
    match function {
        Function::GetIntegerStatus | Function::GetStringStatus => fmi2Discard,
        _ => fmi2OK,
    }
}

#[test]
fn the_c_functions_follow_the_table_in_every_state() {
    let mut cells = 0;
    for interface in BOTH {
        for &function in Function::ALL.iter().filter(|f| **f != Function::FreeInstance) {
            for (column, &state) in columns(interface).iter().enumerate() {
                let Some(host) = host_in(interface, state) else { continue };
                let saved = if state == CallState::Fatal { null_mut() } else { host.save() };
                let status = call(&host, function, saved);
                let lines = host.lines();
                let says = |words: &str| lines.iter().any(|line| line.message.contains(words));
                let legality = expected(function, interface, column);
                let (illegal, forbidden) =
                    (format!("illegal in state {state}"), format!("forbids it in state {state}"));
                assert_eq!(says(&illegal), legality == Legality::Illegal, "{function:?}, {interface} in {state}");
                assert_eq!(says(&forbidden), legality == Legality::Tolerated, "{function:?}, {interface} in {state}");
                let expected = match (legality, state) {
                    (Legality::Illegal, CallState::Fatal) => fmi2Fatal,
                    (Legality::Illegal, _) => fmi2Error,
                    _ => status_of(function),
                };
                assert_eq!(status, expected, "{function:?}, {interface} in {state}");
                cells += 1;
            }
        }
    }
    assert_eq!(cells, (Function::ALL.len() - 1) * (7 + 9 - 2), "every cell of states that are reached");
}

/// Memory is given back in every state, and the state of an instance is freed with it.
#[test]
fn an_instance_is_freed_in_every_state_without_a_word() {
    for interface in BOTH {
        for &state in columns(interface) {
            let Some(mut host) = host_in(interface, state) else { continue };
            unsafe { fmi2FreeInstance(core::mem::replace(&mut host.component, null_mut())) };
            assert_eq!(host.lines(), [], "{interface} in {state}");
        }
    }
}

#[test]
fn a_function_of_the_other_interface_is_legal_nowhere() {
    let host = Host::at_event();
    assert_eq!(host.step(0.0, 1.0), fmi2Error);
    let place = "legal in: no state of a model-exchange instance";
    assert_eq!(host.error(), format!("fmi2DoStep: illegal in state eventMode; {place}"));
    let host = Host::initializing();
    let mut value = 0.0;
    host.refused(
        unsafe { fmi2GetDerivatives(host.component, &raw mut value, 1) },
        "legal in: no state of a co-simulation instance",
    );
}

#[test]
fn an_illegal_call_says_where_it_is_legal_and_leads_to_the_error_state() {
    let host = Host::new();
    host.refused(host.step(0.0, 1.0), "fmi2DoStep: illegal in state instantiated; legal in: stepComplete");
    host.refused(host.setup(0.0, None), "fmi2SetupExperiment: illegal in state error; legal in: instantiated");
    assert_eq!(host.reset(), fmi2OK);
    assert_eq!(host.setup(0.0, None), fmi2OK);
}

#[test]
fn from_the_error_state_a_restored_state_leads_back() {
    let host = Host::initialized();
    let saved = host.save();
    assert_eq!(host.step(7.0, 1.0), fmi2Error);
    assert_eq!(host.step(0.0, 1.0), fmi2Error);
    assert_eq!(host.real(crate::common::toy::GAIN), 2.0, "values may still be read, for debugging");
    assert_eq!(host.restore(saved), fmi2OK);
    assert_eq!(host.step(0.0, 1.0), fmi2OK);
}

#[test]
fn after_a_fatal_error_nothing_but_free_is_left() {
    let host = host_in(Interface::CoSimulation, CallState::Fatal).expect("a host");
    assert_eq!(host.reset(), fmi2Fatal);
    assert_eq!(host.try_real(crate::common::toy::GAIN).0, fmi2Fatal);
    assert_eq!(host.lines()[0].category, "logStatusFatal");
    let mut stale = core::ptr::dangling_mut();
    assert_eq!(unsafe { fmi2FreeFMUstate(host.component, &raw mut stale) }, fmi2Fatal, "refused");
    assert_eq!(host.reset(), fmi2Fatal, "a refusal does not lead out");
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
