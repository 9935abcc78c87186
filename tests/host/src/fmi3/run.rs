//! Random sequences of calls: each answer is held against the table and against what is known of the state of the instance.

use super::{Fmu, Host, Line, Session, call, wild};
use crate::Random;
use core::ptr::{null_mut, without_provenance_mut};
use fmu_export::abi::fmi3::*;
use fmu_export::fmi3::Function;
use fmu_export::{CallState, Interface, Legality};
use std::cell::RefCell;
use std::collections::HashSet;
use std::rc::Rc;

/// Calls of a sequence, at most.
const LENGTH: usize = 80;

/// What a run came across.
#[derive(Debug, Default)]
pub struct Census {
    /// How often each status was returned.
    pub statuses: [u64; 5],
    /// The cells of the table: function, whether it is model exchange, state.
    pub cells: HashSet<(usize, bool, usize)>,
    /// How often a state was restored.
    pub restored: u64,
}

/// A state that the importer holds.
struct Saved {
    token: fmi3FMUState,
    state: CallState,
    time: f64,
    /// Bits of the outputs then, if reading changes nothing.
    outputs: Option<Vec<u64>>,
}

/// What is known of an instance.
struct Known {
    session: Session,
    state: CallState,
    time: f64,
    saved: Vec<Saved>,
    /// Categories were switched; errors are told all the same.
    is_quiet: bool,
}

impl Known {
    fn new(session: Session) -> Self {
        Self { session, state: CallState::Instantiated, time: 0.0, saved: Vec::new(), is_quiet: false }
    }

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
            S::EventMode => {
                let on = if self.session.exchange { F::EnterContinuousTimeMode } else { F::EnterStepMode };
                random.pick(&[F::UpdateDiscreteStates, on, on, F::SetClock, F::GetClock, F::SetString, F::GetFmuState])
            }
            S::ContinuousTimeMode => {
                random.pick(&[F::SetTime, F::SetContinuousStates, F::EnterEventMode, F::GetEventIndicators])
            }
            S::StepMode => random.pick(&[
                F::DoStep,
                F::DoStep,
                F::DoStep,
                F::EnterEventMode,
                F::SetString,
                F::SetString,
                F::GetFmuState,
            ]),
            S::Terminated => random.pick(&[F::Reset, F::SetFmuState, any]),
            _ => any,
        }
    }

    /// One of the saved states, or what is none.
    fn token(&self, random: &mut Random) -> fmi3FMUState {
        let foreign = [null_mut(), without_provenance_mut(random.below(1000))];
        match self.saved.get(random.below(self.saved.len())) {
            Some(saved) if !random.once_in(8) => saved.token,
            _ => random.pick(&foreign),
        }
    }
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

/// The bits of all Float64 outputs that are there between events.
fn outputs(fmu: &Fmu, host: &Host) -> Vec<u64> {
    fmu.intermediate().into_iter().map(|reference| host.float(reference).to_bits()).collect()
}

/// Calls that make, take or free FMU states, and what becomes known by them.
fn states(fmu: &Fmu, host: &Host, known: &mut Known, function: Function, random: &mut Random) -> Option<fmi3Status> {
    use Function as F;
    let (i, mut token) = (host.instance, known.token(random));
    let position = known.saved.iter().position(|saved| saved.token == token);
    Some(match function {
        F::GetFmuState if known.saved.len() < 4 => {
            let mut token = null_mut();
            let status = unsafe { (fmu.functions.fmi3GetFMUState)(i, &raw mut token) };
            if status == fmi3OK {
                let outputs = (known.state == CallState::StepMode).then(|| outputs(fmu, host));
                known.saved.push(Saved { token, state: known.state, time: known.time, outputs });
            }
            status
        }
        F::SetFmuState => {
            let status = host.restore(token);
            if status == fmi3OK {
                let saved = &known.saved[position.expect("a state that was given out")];
                (known.state, known.time) = (saved.state, saved.time);
                if let Some(before) = &saved.outputs {
                    assert_eq!(&outputs(fmu, host), before, "what was saved comes back");
                }
            }
            status
        }
        F::FreeFmuState => {
            let status = unsafe { (fmu.functions.fmi3FreeFMUState)(i, &raw mut token) };
            if let Some(position) = position.filter(|_| status == fmi3OK) {
                known.saved.remove(position);
                assert!(token.is_null());
            }
            status
        }
        F::DeserializeFmuState if known.saved.len() < 4 && position.is_some() && known.state != CallState::Fatal => {
            let Saved { state, time, ref outputs, .. } = known.saved[position?];
            let outputs = outputs.clone();
            let bytes = host.serialize(token);
            let (status, token) = host.deserialize(&bytes);
            assert_eq!(status, fmi3OK, "{:?}, {:?}, {state}", host.lines(), known.session);
            known.saved.push(Saved { token, state, time, outputs });
            status
        }
        _ => return None,
    })
}

/// What was called within steps, and what came of it.
type Inside = Rc<RefCell<Vec<(Function, fmi3Status)>>>;

/// Within a step the importer calls what comes to its mind.
fn look(fmu: &Rc<Fmu>, host: &Host, token: fmi3FMUState, random: &mut Random) -> Inside {
    let (instance, inside, fmu) = (host.instance, Inside::default(), fmu.clone());
    let (list, mut random) = (inside.clone(), Random::seeded(random.bits()));
    host.on_look(move |time, _| {
        let function = random.pick(Function::ALL);
        if function == Function::FreeInstance {
            unsafe { (fmu.functions.fmi3FreeInstance)(instance) }; // no instance is freed there
        } else if random.once_in(2) {
            list.borrow_mut().push((function, wild(&fmu, instance, function, &mut random, token)));
        } else {
            list.borrow_mut().push((function, call(&fmu, instance, function, null_mut())));
        }
        random.pick(&[None, None, Some(time), Some(time + 0.5), Some(f64::NAN)])
    });
    inside
}

/// Whether the log says so of a call.
fn says(lines: &[Line], function: Function, words: &str, state: CallState) -> bool {
    let beginning = format!("{}: {words} in state {state}", function.name());
    lines.iter().any(|line| line.message.starts_with(&beginning))
}

/// Runs a random sequence for each seed.
///
/// # Panics
/// At the first answer that is not what the standard says.
pub fn run(fmu: &Fmu, seeds: core::ops::Range<u64>) -> Census {
    let fmu = Rc::new(fmu.clone());
    let mut census = Census::default();
    for seed in seeds {
        let mut random = Random::seeded(seed);
        let mut is = || random.once_in(2);
        let session = Session { exchange: is(), event_mode: is(), early_return: is(), looks: is() };
        let session = match session {
            Session { exchange: true, .. } if fmu.exchange => Session::EXCHANGE,
            other => Session { exchange: false, event_mode: other.event_mode && fmu.events, ..other },
        };
        sequence(&fmu, session, &mut random, &mut census);
    }
    census
}

/// Random calls of one instance.
fn sequence(fmu: &Rc<Fmu>, session: Session, random: &mut Random, census: &mut Census) {
    let required = if session.looks { fmu.intermediate() } else { Vec::new() };
    let (host, mut known) = (Host::requiring(fmu, session, &required), Known::new(session));
    for _ in 0..random.below(LENGTH) {
        let function = known.choose(random);
        if function == Function::FreeInstance {
            continue;
        }
        let (before, token) = (known.state, known.token(random));
        let legality = function.legality(known.interface(), before);
        census.cells.insert((function as usize, session.exchange, before as usize));
        host.on_look(|_, _| None);
        let looks = session.looks && random.once_in(3);
        let inside = if looks { look(fmu, &host, token, random) } else { Inside::default() };
        let managed = if random.once_in(8) { None } else { states(fmu, &host, &mut known, function, random) };
        let status = match (managed, function) {
            (Some(status), _) => status,
            (None, Function::DoStep) if !random.once_in(16) => step(&host, &mut known, random),
            // What these change would not be known.
            (None, Function::SetFmuState | Function::FreeFmuState | Function::GetFmuState) => {
                wild(fmu, host.instance, function, random, null_mut())
            }
            (None, _) if random.once_in(3) => call(fmu, host.instance, function, null_mut()),
            (None, _) => wild(fmu, host.instance, function, random, token),
        };
        let lines = host.lines();
        census.statuses[usize::try_from(status).expect("a status")] += 1;
        for (called, answer) in inside.take() {
            let state = CallState::IntermediateUpdateMode;
            let illegal = called.legality(Interface::CoSimulation, state) == Legality::Illegal;
            assert!(!illegal || answer == fmi3Error && status == fmi3Error, "{called:?} within a step");
            assert_eq!(says(&lines, called, "illegal", state), illegal, "{called:?} within a step: {lines:?}");
            census.cells.insert((called as usize, false, state as usize));
        }
        let illegal = legality == Legality::Illegal;
        let refused = if before == CallState::Fatal { fmi3Fatal } else { fmi3Error };
        assert!(!illegal || status == refused, "{function:?} in {before}: {status}");
        assert_eq!(says(&lines, function, "illegal", before), illegal, "{function:?} in {before}: {lines:?}");
        let may_be_silent = status == fmi3OK || known.is_quiet && matches!(status, fmi3Warning | fmi3Discard);
        let told = lines.iter().any(|line| line.status == status);
        assert!(may_be_silent || told, "{function:?}: {status}, {lines:?}");
        known.is_quiet |= function == Function::SetDebugLogging && status == fmi3OK;
        match status {
            fmi3OK | fmi3Warning if function == Function::SetFmuState => census.restored += 1,
            fmi3OK | fmi3Warning => known.follow(function),
            fmi3Error => known.state = CallState::Terminated,
            fmi3Fatal => known.state = CallState::Fatal,
            _ => {}
        }
    }
}
