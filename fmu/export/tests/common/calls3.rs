//! Any function of FMI 3.0 in any state, with arguments that are right.

use super::fmi3::*;
use super::toy;
use core::ptr::{null, null_mut};
use fmu_export::CallState;
use fmu_export::abi::fmi3::*;
use fmu_export::fmi3::Function;

/// An instance in this state; none for those that no instance of the session reaches. Intermediate update mode is reached within a
/// step only.
pub fn host_in(session: Session, state: CallState) -> Option<Host> {
    let host = match state {
        CallState::Instantiated => Host::new(session),
        CallState::InitializationMode | CallState::EventMode => {
            let host = Host::new(session);
            assert_eq!(host.enter_initialization(None), fmi3OK);
            if state == CallState::EventMode {
                if !session.exchange && !session.event_mode {
                    return None;
                }
                assert_eq!(host.exit_initialization(), fmi3OK);
            }
            host
        }
        CallState::ContinuousTimeMode if session.exchange => Host::started(session),
        CallState::StepMode if !session.exchange => Host::started(session),
        CallState::Terminated | CallState::Fatal => {
            let host = Host::started(session);
            if state == CallState::Fatal {
                host.fail_fatally();
            } else {
                assert_eq!(unsafe { fmi3Terminate(host.instance) }, fmi3OK);
            }
            host
        }
        _ => return None,
    };
    host.lines();
    Some(host)
}

/// An initialised instance after a call that returned `fmi3Error`.
pub fn failed_host(session: Session) -> Host {
    let host = Host::started(session);
    assert_eq!(host.try_float(u32::MAX).0, fmi3Error);
    host.lines();
    host
}

impl Host {
    fn fail_fatally(&self) {
        if self.session.exchange {
            assert_eq!(self.enter_event_mode(), fmi3OK); // where strings can be set
        }
        self.trouble("fatal terminate");
        assert_eq!(unsafe { fmi3Terminate(self.instance) }, fmi3Fatal);
    }
}

/// Calls a function with arguments that are right as such. `state` is an FMU state of the instance or NULL. Only
/// `fmi3DeserializeFMUState` calls others before, which make its bytes, unless `state` is NULL.
#[allow(clippy::too_many_lines)] // all functions
pub fn call(instance: fmi3Instance, function: Function, mut state: fmi3FMUState) -> fmi3Status {
    use Function as F;
    let i = instance;
    let (mut float, number, mut size, mut flags, mut long) = (0.0, 1, 0, [0_u8; 5], 0);
    let (mut qualifier, mut fresh, mut bytes) = (0, null_mut(), [0_u8; 4096]);
    let (clock, tick) = (toy::SAMPLE, fmi3ClockInactive);
    let [a, b, c, d, e] = &mut flags;
    macro_rules! none {
        ($function:ident) => {
            $function(i, null(), 0, null_mut(), 0)
        };
        (set $function:ident) => {
            $function(i, null(), 0, null(), 0)
        };
    }
    unsafe {
        match function {
            F::SetDebugLogging => fmi3SetDebugLogging(i, 1, 0, null()),
            F::FreeInstance => unreachable!("it has no status"),
            F::EnterInitializationMode => fmi3EnterInitializationMode(i, 0, 0.0, 0.0, 0, 0.0),
            F::ExitInitializationMode => fmi3ExitInitializationMode(i),
            F::EnterEventMode => fmi3EnterEventMode(i),
            F::Terminate => fmi3Terminate(i),
            F::Reset => fmi3Reset(i),
            F::GetFloat32 => none!(fmi3GetFloat32),
            F::GetFloat64 => none!(fmi3GetFloat64),
            F::GetInt8 => none!(fmi3GetInt8),
            F::GetUInt8 => none!(fmi3GetUInt8),
            F::GetInt16 => none!(fmi3GetInt16),
            F::GetUInt16 => none!(fmi3GetUInt16),
            F::GetInt32 => none!(fmi3GetInt32),
            F::GetUInt32 => none!(fmi3GetUInt32),
            F::GetInt64 => none!(fmi3GetInt64),
            F::GetUInt64 => none!(fmi3GetUInt64),
            F::GetBoolean => none!(fmi3GetBoolean),
            F::GetString => none!(fmi3GetString),
            F::GetBinary => fmi3GetBinary(i, null(), 0, null_mut(), null_mut(), 0),
            F::GetClock => fmi3GetClock(i, null(), 0, null_mut()),
            F::SetFloat32 => none!(set fmi3SetFloat32),
            F::SetFloat64 => none!(set fmi3SetFloat64),
            F::SetInt8 => none!(set fmi3SetInt8),
            F::SetUInt8 => none!(set fmi3SetUInt8),
            F::SetInt16 => none!(set fmi3SetInt16),
            F::SetUInt16 => none!(set fmi3SetUInt16),
            F::SetInt32 => none!(set fmi3SetInt32),
            F::SetUInt32 => none!(set fmi3SetUInt32),
            F::SetInt64 => none!(set fmi3SetInt64),
            F::SetUInt64 => none!(set fmi3SetUInt64),
            F::SetBoolean => none!(set fmi3SetBoolean),
            F::SetString => none!(set fmi3SetString),
            F::SetBinary => fmi3SetBinary(i, null(), 0, null(), null(), 0),
            F::SetClock => fmi3SetClock(i, &raw const clock, 1, &raw const tick),
            F::GetNumberOfVariableDependencies => fmi3GetNumberOfVariableDependencies(i, 0, &raw mut size),
            F::GetVariableDependencies => {
                fmi3GetVariableDependencies(i, 0, null_mut(), null_mut(), null_mut(), null_mut(), 0)
            }
            F::GetFmuState => fmi3GetFMUState(i, &raw mut fresh),
            F::SetFmuState => fmi3SetFMUState(i, state),
            F::FreeFmuState => fmi3FreeFMUState(i, &raw mut state),
            F::SerializedFmuStateSize => fmi3SerializedFMUStateSize(i, state, &raw mut size),
            F::SerializeFmuState => fmi3SerializeFMUState(i, state, bytes.as_mut_ptr(), bytes.len()),
            F::DeserializeFmuState => {
                if !state.is_null() {
                    fmi3SerializedFMUStateSize(i, state, &raw mut size);
                    fmi3SerializeFMUState(i, state, bytes.as_mut_ptr(), bytes.len());
                }
                fmi3DeserializeFMUState(i, bytes.as_ptr(), size, &raw mut fresh)
            }
            F::GetDirectionalDerivative => {
                fmi3GetDirectionalDerivative(i, null(), 0, null(), 0, null(), 0, null_mut(), 0)
            }
            F::GetAdjointDerivative => fmi3GetAdjointDerivative(i, null(), 0, null(), 0, null(), 0, null_mut(), 0),
            F::EnterConfigurationMode => fmi3EnterConfigurationMode(i),
            F::ExitConfigurationMode => fmi3ExitConfigurationMode(i),
            F::GetIntervalDecimal => fmi3GetIntervalDecimal(i, &raw const clock, 1, &raw mut float, &raw mut qualifier),
            F::GetIntervalFraction => {
                fmi3GetIntervalFraction(i, &raw const clock, 1, &raw mut long, &raw mut long, &raw mut qualifier)
            }
            F::GetShiftDecimal => fmi3GetShiftDecimal(i, &raw const clock, 1, &raw mut float),
            F::GetShiftFraction => fmi3GetShiftFraction(i, &raw const clock, 1, &raw mut long, &raw mut long),
            F::SetIntervalDecimal => fmi3SetIntervalDecimal(i, &raw const clock, 1, &raw const float),
            F::SetIntervalFraction => fmi3SetIntervalFraction(i, &raw const clock, 1, &raw const long, &raw const long),
            F::SetShiftDecimal => fmi3SetShiftDecimal(i, &raw const clock, 1, &raw const float),
            F::SetShiftFraction => fmi3SetShiftFraction(i, &raw const clock, 1, &raw const long, &raw const long),
            F::EvaluateDiscreteStates => fmi3EvaluateDiscreteStates(i),
            F::UpdateDiscreteStates => fmi3UpdateDiscreteStates(i, a, b, c, d, e, &raw mut float),
            F::EnterContinuousTimeMode => fmi3EnterContinuousTimeMode(i),
            F::CompletedIntegratorStep => fmi3CompletedIntegratorStep(i, 1, a, b),
            F::SetTime => fmi3SetTime(i, 0.25),
            F::SetContinuousStates => fmi3SetContinuousStates(i, &raw const float, 1),
            F::GetContinuousStateDerivatives => fmi3GetContinuousStateDerivatives(i, &raw mut float, 1),
            F::GetEventIndicators => fmi3GetEventIndicators(i, &raw mut float, 1),
            F::GetContinuousStates => fmi3GetContinuousStates(i, &raw mut float, 1),
            F::GetNominals => fmi3GetNominalsOfContinuousStates(i, &raw mut float, 1),
            F::GetNumberOfEventIndicators => fmi3GetNumberOfEventIndicators(i, &raw mut size),
            F::GetNumberOfContinuousStates => fmi3GetNumberOfContinuousStates(i, &raw mut size),
            F::EnterStepMode => fmi3EnterStepMode(i),
            F::GetOutputDerivatives => {
                fmi3GetOutputDerivatives(i, &toy::INTEGRAL, 1, &raw const number, &raw mut float, 1)
            }
            F::DoStep => fmi3DoStep(i, 0.0, 0.5, 1, a, b, c, &raw mut float),
            F::ActivateModelPartition => fmi3ActivateModelPartition(i, toy::SAMPLE, 0.0),
        }
    }
}

/// What a function whose call is legal answers: all that the toy's description does not offer is an error.
pub fn status_of(function: Function) -> fmi3Status {
    use Function as F;
    match function {
        F::EnterConfigurationMode
        | F::GetNumberOfVariableDependencies
        | F::GetVariableDependencies
        | F::GetIntervalFraction
        | F::GetShiftFraction
        | F::SetIntervalDecimal
        | F::SetIntervalFraction
        | F::SetShiftDecimal
        | F::SetShiftFraction
        | F::EvaluateDiscreteStates => fmi3Error,
        _ => fmi3OK,
    }
}
