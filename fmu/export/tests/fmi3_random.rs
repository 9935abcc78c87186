//! Random calls of FMI 3.0 in any order, with arguments right and wrong, within steps, too: each answer is held against the table
//! and against what is known of the state of the instance.
#![allow(clippy::expect_used, clippy::panic, non_upper_case_globals)] // A helper fails a test, too; constants as in the standard.

mod common;

use common::calls3::call;
use common::fmi3::*;
use common::toy;
use core::ptr::{null, null_mut};
use fmu_export::abi::fmi3::*;
use fmu_export::fmi3::Function;
use fmu_export::{CallState, Interface, Legality};
use fmu_host::Random;
use std::cell::RefCell;
use std::collections::HashSet;
use std::rc::Rc;

/// Sequences; few for Miri, which is a thousand times slower.
const SEQUENCES: u64 = if cfg!(miri) { 40 } else { 100_000 };

/// What is known of an instance.
struct Known {
    session: Session,
    state: CallState,
    time: f64,
}

impl Known {
    fn interface(&self) -> Interface {
        if self.session.exchange { Interface::ModelExchange } else { Interface::CoSimulation }
    }

    /// The state after a call that succeeded.
    fn follow(&mut self, function: Function) {
        use CallState as S;
        use Function as F;
        self.state = match function {
            F::EnterInitializationMode => S::InitializationMode,
            F::ExitInitializationMode if self.session.exchange || self.session.event_mode => S::EventMode,
            F::ExitInitializationMode | F::EnterStepMode => S::StepMode,
            F::EnterEventMode => S::EventMode,
            F::EnterContinuousTimeMode => S::ContinuousTimeMode,
            F::Terminate => S::Terminated,
            F::Reset => {
                self.time = 0.0;
                S::Instantiated
            }
            _ => self.state,
        };
    }

    /// A function that leads on in this state, or any.
    fn choose(&self, random: &mut Random) -> Function {
        use CallState as S;
        use Function as F;
        let any = random.pick(Function::ALL);
        if random.once_in(8) {
            return any;
        }
        match self.state {
            S::Instantiated => F::EnterInitializationMode,
            S::InitializationMode => random.pick(&[F::ExitInitializationMode, F::SetFloat64, F::GetFloat64]),
            S::EventMode if self.session.exchange => {
                random.pick(&[F::UpdateDiscreteStates, F::EnterContinuousTimeMode, F::GetClock])
            }
            S::EventMode => random.pick(&[F::UpdateDiscreteStates, F::EnterStepMode, F::SetClock, F::GetClock]),
            S::ContinuousTimeMode => {
                random.pick(&[F::SetTime, F::SetContinuousStates, F::EnterEventMode, F::GetEventIndicators])
            }
            S::StepMode => random.pick(&[F::DoStep, F::DoStep, F::DoStep, F::EnterEventMode, F::SetString]),
            S::Terminated => random.pick(&[F::Reset, F::SetFmuState, any]),
            _ => any,
        }
    }
}

/// Get and Set of random variables and values, some of them with a NULL or a wrong count.
fn access(host: &Host, function: Function, random: &mut Random) -> Option<fmi3Status> {
    use Function as F;
    let i = host.instance;
    let reference = u32::try_from(random.below(40)).unwrap_or_default();
    let count = random.pick(&[1, 1, 1, 1, 0, 2]);
    let (mut float, mut int, mut flag, mut text) =
        (random.pick(&[0.5, 2.0, -1.0, f64::NAN, f64::INFINITY]), 0_i32, 0_u8, null());
    let is_null = random.once_in(20);
    let place = |pointer: *mut f64| if is_null { null_mut() } else { pointer };
    let word =
        random.pick(&[c"", c"panic getter", c"error step", c"warning step", c"discard step", c"panic step"]).as_ptr();
    let reference = &raw const reference;
    Some(unsafe {
        match function {
            F::GetFloat64 => fmi3GetFloat64(i, reference, 1, place(&raw mut float), count),
            F::SetFloat64 => fmi3SetFloat64(i, reference, 1, place(&raw mut float), count),
            F::GetInt32 => fmi3GetInt32(i, reference, 1, &raw mut int, count),
            F::SetInt32 => fmi3SetInt32(i, reference, 1, &raw const int, count),
            F::GetBoolean => fmi3GetBoolean(i, reference, 1, &raw mut flag, count),
            F::GetString => fmi3GetString(i, reference, 1, &raw mut text, count),
            F::SetString => fmi3SetString(i, &toy::TROUBLE, 1, &raw const word, count),
            F::GetClock => fmi3GetClock(i, reference, 1, &raw mut flag),
            _ => return None,
        }
    })
}

/// A step from where the instance is, or from somewhere else.
fn step(host: &Host, known: &mut Known, random: &mut Random) -> fmi3Status {
    let t = known.time + random.pick(&[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, f64::NAN]);
    let h = random.pick(&[0.25, 0.5, 1.0, 2.5, 0.0, -1.0]);
    let stepped = host.step(t, h);
    if matches!(stepped.status, fmi3OK | fmi3Warning) {
        assert!(!stepped.event || known.session.event_mode);
        assert!(!stepped.early || known.session.early_return);
        assert!(stepped.early == (stepped.time < t + h) || stepped.terminate, "{stepped:?}");
        assert!(stepped.time >= t && stepped.time <= t + h);
        known.time = stepped.time;
    }
    stepped.status
}

#[test]
fn a_hundred_thousand_random_call_sequences_go_as_the_table_says() {
    let mut cells = HashSet::new();
    let mut statuses = [0_u64; 5];
    std::panic::set_hook(Box::new(|_| ())); // the toy panics often
    for seed in 0..SEQUENCES {
        let mut random = Random::seeded(seed);
        let mut is = || random.once_in(2);
        let session = Session { exchange: is(), event_mode: is(), early_return: is(), looks: is() };
        let session = if session.exchange { Session::EXCHANGE } else { session };
        let host = Host::new(session);
        let mut known = Known { session, state: CallState::Instantiated, time: 0.0 };
        let mut saved = null_mut();
        for _ in 0..random.below(80) {
            let function = known.choose(&mut random);
            if function == Function::FreeInstance {
                continue;
            }
            let before = known.state;
            let legality = function.legality(known.interface(), before);
            cells.insert((function.name(), session.exchange, before.to_string()));
            // Within a step the importer calls what comes to its mind.
            let inside = Rc::new(RefCell::new(None));
            if session.looks && random.once_in(3) {
                let (instance, called) = (host.instance, random.pick(Function::ALL));
                let answer = inside.clone();
                host.on_look(move |time, _| {
                    if called != Function::FreeInstance {
                        *answer.borrow_mut() = Some((called, call(instance, called, null_mut())));
                    }
                    Some(time)
                });
            }
            let status = match function {
                Function::DoStep => step(&host, &mut known, &mut random),
                Function::GetFmuState if legality == Legality::Legal => {
                    saved = host.save();
                    known.session = session;
                    fmi3OK
                }
                Function::SetFmuState | Function::FreeFmuState | Function::SerializedFmuStateSize => {
                    call(host.instance, function, null_mut())
                }
                Function::SerializeFmuState | Function::DeserializeFmuState => {
                    call(host.instance, function, if legality == Legality::Legal { saved } else { null_mut() })
                }
                _ => access(&host, function, &mut random).unwrap_or_else(|| call(host.instance, function, null_mut())),
            };
            let lines = host.lines();
            statuses[usize::try_from(status).expect("a status")] += 1;
            if let Some((called, answer)) = inside.take() {
                let legal = called.legality(Interface::CoSimulation, CallState::IntermediateUpdateMode);
                assert!(legal == Legality::Legal || answer == fmi3Error, "{called:?} within a step");
                cells.insert((called.name(), false, CallState::IntermediateUpdateMode.to_string()));
            }
            if legality == Legality::Illegal {
                assert_eq!(
                    status,
                    if before == CallState::Fatal { fmi3Fatal } else { fmi3Error },
                    "{function:?} in {before}"
                );
            }
            assert!(status == fmi3OK || lines.iter().any(|line| line.status == status), "{function:?}: {lines:?}");
            match status {
                fmi3OK | fmi3Warning => known.follow(function),
                fmi3Error => known.state = CallState::Terminated,
                fmi3Fatal => known.state = CallState::Fatal,
                _ => {}
            }
        }
    }
    drop(std::panic::take_hook());
    if !cfg!(miri) {
        let enough = |(status, count): (usize, &u64)| *count > [1000, 100, 100, 1000, 0][status] || status == 4;
        assert!(statuses.iter().enumerate().all(enough), "all sorts of status: {statuses:?}");
        // Six states of model exchange, six of co-simulation, and what is called within a step; no call is fatal here.
        assert_eq!(cells.len(), 70 * (5 + 5 + 1), "every function in every state");
    }
}
