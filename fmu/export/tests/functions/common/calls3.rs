//! Any function of FMI 3.0 in any state, with arguments that are right.

use super::fmi3::*;
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

/// Calls a function of the toy with arguments that are right as such.
pub fn call(instance: fmi3Instance, function: Function, state: fmi3FMUState) -> fmi3Status {
    fmu_host::fmi3::call(&fmu(), instance, function, state)
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
