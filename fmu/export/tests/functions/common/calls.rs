//! Any function in any state, with arguments that are right.

use super::*;
use core::ptr::{null, null_mut};
use fmu_export::abi::*;
use fmu_export::{CallState, Function, Interface};

/// An instance in this state; none for the two that no instance of this exporter reaches.
pub fn host_in(interface: Interface, state: CallState) -> Option<Host> {
    let exchange = interface == Interface::ModelExchange;
    let kind = if exchange { fmi2ModelExchange } else { fmi2CoSimulation };
    let host = match state {
        CallState::Instantiated => Host::of_kind(kind),
        CallState::InitializationMode => Host::initializing_of(kind),
        CallState::StepInProgress | CallState::StepCanceled => return None,
        CallState::ContinuousTimeMode => Host::exchanging(),
        _ if exchange => Host::at_event(),
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
            host.trouble("fatal terminate");
            assert_eq!(host.terminate(), fmi2Fatal);
        }
        _ => {}
    }
    host.lines();
    Some(host)
}

/// Calls a function with arguments that are right as such. `state` is an FMU state of the instance or NULL.
pub fn call(host: &Host, function: Function, mut state: fmi2FMUstate) -> fmi2Status {
    use Function as F;
    let c = host.component;
    let (mut real, mut integer, mut text, mut size) = (0.0, 0, null(), 0);
    let mut fresh = null_mut();
    let (mut vr, mut order, value) = (toy::INPUT, 1, 1.0);
    let mut bytes = [0; 1024];
    unsafe {
        match function {
            F::SetDebugLogging => fmi2SetDebugLogging(c, fmi2True, 0, null()),
            F::FreeInstance => unreachable!("it has no status"),
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
                fmi2SerializedFMUstateSize(c, state, &raw mut size);
                fmi2SerializeFMUstate(c, state, bytes.as_mut_ptr(), size);
                fmi2DeSerializeFMUstate(c, bytes.as_ptr(), size, &raw mut fresh)
            }
            F::GetDirectionalDerivative => fmi2GetDirectionalDerivative(c, null(), 0, null(), 0, null(), null_mut()),
            F::SetRealInputDerivatives => {
                fmi2SetRealInputDerivatives(c, &raw const vr, 1, &raw const order, &raw const value)
            }
            F::GetRealOutputDerivatives => {
                vr = toy::INTEGRAL;
                fmi2GetRealOutputDerivatives(c, &raw const vr, 1, &raw const order, &raw mut real)
            }
            F::DoStep => host.step(0.0, 1.0),
            F::CancelStep => fmi2CancelStep(c),
            F::GetStatus => fmi2GetStatus(c, fmi2DoStepStatus, &raw mut integer),
            F::GetRealStatus => fmi2GetRealStatus(c, fmi2LastSuccessfulTime, &raw mut real),
            F::GetIntegerStatus => fmi2GetIntegerStatus(c, fmi2DoStepStatus, &raw mut integer),
            F::GetBooleanStatus => fmi2GetBooleanStatus(c, fmi2Terminated, &raw mut integer),
            F::GetStringStatus => fmi2GetStringStatus(c, fmi2PendingStatus, &raw mut text),
            F::EnterEventMode => fmi2EnterEventMode(c),
            F::NewDiscreteStates => fmi2NewDiscreteStates(c, core::mem::MaybeUninit::uninit().as_mut_ptr()),
            F::EnterContinuousTimeMode => fmi2EnterContinuousTimeMode(c),
            F::CompletedIntegratorStep => {
                fmi2CompletedIntegratorStep(c, fmi2True, &raw mut integer, (&raw mut order).cast())
            }
            F::SetTime => fmi2SetTime(c, 0.5),
            F::SetContinuousStates => fmi2SetContinuousStates(c, &raw const value, 1),
            F::GetDerivatives => fmi2GetDerivatives(c, &raw mut real, 1),
            F::GetEventIndicators => fmi2GetEventIndicators(c, &raw mut real, 1),
            F::GetContinuousStates => fmi2GetContinuousStates(c, &raw mut real, 1),
            F::GetNominals => fmi2GetNominalsOfContinuousStates(c, &raw mut real, 1),
        }
    }
}
