//! The one instance of a worker, and the calls on it.

use std::collections::HashMap;
use std::ffi::CString;
use std::sync::Arc;

use fmu_abi::{fmi2Error, fmi2OK, fmi2Status};

use super::protocol::{Given, LONGEST_STATE};
use crate::component::{Arguments, Component, is_done};
use crate::library::Functions;
use crate::logging::Environment;
use crate::request::{Request, Results};

/// The result of a call: its status, and what else it gave.
type Answer = (fmi2Status, Given);

const ERROR: Answer = (fmi2Error, Given::Nothing);

/// The functions of the library, and the instance once it is made.
pub(super) struct Session {
    functions: Functions,
    environment: Arc<Environment>,
    component: Option<Component>,
    /// Addresses of states by their numbers.
    states: HashMap<u64, u64>,
    last_state: u64,
}

impl Session {
    pub fn new(functions: &Functions, environment: Arc<Environment>) -> Self {
        Self { functions: *functions, environment, component: None, states: HashMap::new(), last_state: 0 }
    }

    /// Carries out a call. Without an instance, and with a state that there is not, it is an error.
    pub fn answer(&mut self, mut request: Request<'_>) -> Answer {
        match &request {
            Request::Instantiate { name, guid, resources, debug } => {
                let arguments = Arguments { name, guid, resources, debug: *debug };
                self.component = Component::new(&self.functions, &arguments, &self.environment);
                return (fmi2OK, Given::Number(self.component.is_some().into()));
            }
            Request::Free => {
                self.component = None;
                return (fmi2OK, Given::Nothing);
            }
            _ => {}
        }
        let Some(component) = &self.component else { return ERROR };
        let mut number = 0;
        if let Some(state) = request.state().filter(|state| **state != 0) {
            number = *state;
            let Some(address) = self.states.get(&number) else { return ERROR };
            *state = *address;
        }
        let request = &request;
        let call = |results: Results<'_>| component.call(request, results);
        match request {
            Request::GetReal { references: of } | Request::GetOutputDerivatives { references: of, .. } => {
                given(vec![0.0; of.len()], Given::Reals, |to| call(Results::Reals(to)))
            }
            Request::DirectionalDerivative { unknowns: of, .. } => {
                given(vec![0.0; of.len()], Given::Reals, |to| call(Results::Reals(to)))
            }
            Request::LastSuccessfulTime => given(vec![0.0], Given::Reals, |to| call(Results::Reals(to))),
            Request::GetInteger { references: of } | Request::GetBoolean { references: of } => {
                given(vec![0; of.len()], Given::integers, |to| call(Results::Integers(to)))
            }
            Request::Terminated => given(vec![0], Given::integers, |to| call(Results::Integers(to))),
            Request::GetString { references: of } => {
                given(vec![CString::default(); of.len()], Given::texts, |to| call(Results::Texts(to)))
            }
            Request::SerializeState { size, .. } => match usize::try_from(*size) {
                Ok(size @ ..=LONGEST_STATE) => given(vec![0; size], Given::Bytes, |to| call(Results::Bytes(to))),
                _ => ERROR,
            },
            Request::StateSize { .. } => given(0, Given::Number, |to| call(Results::Number(to))),
            Request::GetState { .. } | Request::DeserializeState { .. } => {
                let mut address = 0;
                let status = call(Results::Number(&mut address));
                (status, self.keep(number, address))
            }
            Request::FreeState { .. } => {
                self.states.remove(&number);
                if number == 0 { ERROR } else { (call(Results::None), Given::Nothing) }
            }
            _ => (call(Results::None), Given::Nothing),
        }
    }

    /// Keeps a state under its number, or under a new one.
    fn keep(&mut self, state: u64, address: u64) -> Given {
        if address == 0 {
            return Given::Number(0);
        }
        let number = if state == 0 { self.last_state + 1 } else { state };
        self.last_state = self.last_state.max(number);
        self.states.insert(number, address);
        Given::Number(number)
    }
}

/// Has `call` fill in values; what it gives, if it is done.
fn given<T>(mut values: T, of: impl FnOnce(T) -> Given, call: impl FnOnce(&mut T) -> fmi2Status) -> Answer {
    let status = call(&mut values);
    (status, if is_done(status) { of(values) } else { Given::Nothing })
}
