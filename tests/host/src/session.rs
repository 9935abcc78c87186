//! Random sequences of calls on two instances at once, and the check of each answer.

use crate::call::{Answer, Effect, call};
use crate::instance::{Blob, Instance, Known, is_refused};
use crate::{Fmu, Line, Random};
use core::ptr::null_mut;
use fmu_export::abi::{fmi2Discard, fmi2Error, fmi2FMUstate, fmi2Fatal, fmi2OK, fmi2Status, fmi2Warning};
use fmu_export::{CallState, Function, Interface, Legality};
use std::collections::BTreeSet;

/// Calls of a sequence, at most.
const LENGTH: usize = 32;

/// What a run came across.
#[derive(Debug, Default)]
pub struct Census {
    /// How often each status was returned.
    pub statuses: [u64; 5],
    /// The cells of the tables: function, interface and state, by name.
    pub cells: BTreeSet<(&'static str, String, String)>,
}

/// Runs a random sequence for each seed.
///
/// # Errors
/// The first answer that is not what the standard says.
pub fn run(fmu: &Fmu, seeds: core::ops::Range<u64>) -> Result<Census, String> {
    let mut census = Census::default();
    for seed in seeds {
        let mut random = Random::seeded(seed);
        let length = random.below(LENGTH);
        sequence(fmu, &mut random, length, &mut census).map_err(|what| format!("seed {seed}: {what}"))?;
    }
    Ok(census)
}

/// Runs the sequence that `bytes` tell, as a fuzzer chooses them.
///
/// # Errors
/// The first answer that is not what the standard says.
pub fn run_tape(fmu: &Fmu, bytes: &[u8]) -> Result<(), String> {
    sequence(fmu, &mut Random::from_tape(bytes), bytes.len(), &mut Census::default())
}

/// At most `length` calls.
fn sequence(fmu: &Fmu, random: &mut Random, length: usize, census: &mut Census) -> Result<(), String> {
    let other = if fmu.functions.exchange.is_some() { Interface::ModelExchange } else { Interface::CoSimulation };
    let mut instances = [Instance::new(fmu, Interface::CoSimulation)?, Instance::new(fmu, other)?];
    let mut blobs = Vec::new();
    for _ in 0..length {
        if !random.goes_on() {
            break;
        }
        let number = random.below(instances.len());
        match random.below(100) {
            0 => instances[number] = Instance::new(fmu, instances[number].interface)?,
            1 => {
                let number = random.below(1000);
                ensure(is_refused(fmu, number), || format!("wrong instantiation {number} is not refused"))?;
            }
            _ => turn(fmu, random, (&mut instances, number), &mut blobs, census)?,
        }
    }
    Ok(())
}

fn ensure(holds: bool, what: impl FnOnce() -> String) -> Result<(), String> {
    if holds { Ok(()) } else { Err(what()) }
}

/// One call on one of the instances.
fn turn(
    fmu: &Fmu,
    random: &mut Random,
    (instances, number): (&mut [Instance; 2], usize),
    blobs: &mut Vec<Blob>,
    census: &mut Census,
) -> Result<(), String> {
    let foreign: Vec<fmi2FMUstate> = instances[1 - number].saved.iter().map(|saved| saved.0).collect();
    let instance = &mut instances[number];
    let function = choose(random, instance);
    if function == Function::FreeInstance
        || function.interface() == Some(Interface::ModelExchange) && fmu.functions.exchange.is_none()
    {
        return Ok(());
    }
    let nobody = random.once_in(100);
    let component = if nobody { null_mut() } else { instance.component };
    let answer = call(fmu, random, instance, (function, component), &foreign, blobs);
    let lines = instance.log().take();
    let case = || format!("{function:?} ({}, {:?}): {} {lines:?}", instance.interface, instance.known, answer.status);
    if nobody {
        return ensure(answer.status == fmi2Error && lines.is_empty(), || format!("no component, {}", case()));
    }
    judge(instance, function, &answer, &lines).map_err(|what| format!("{what}: {}", case()))?;
    let state = instance.known.state.to_string();
    census.cells.insert((function.name(), instance.interface.to_string(), state));
    census.statuses[usize::try_from(answer.status).unwrap_or_default()] += 1;
    advance(instance, function, answer, blobs);
    Ok(())
}

/// A function: often the one that goes on, else a legal one or any.
fn choose(random: &mut Random, instance: &Instance) -> Function {
    use CallState as S;
    use Function as F;
    let any = random.pick(Function::ALL);
    match random.below(10) {
        0 | 1 => any,
        2..5 => {
            let legal = |f: &Function| f.legality(instance.interface, instance.known.state) == Legality::Legal;
            let mut candidates = (0..20).map(|_| random.pick(Function::ALL)).filter(legal);
            candidates.next().unwrap_or(any)
        }
        _ => match instance.known.state {
            S::Instantiated => {
                random.pick(&[F::SetupExperiment, F::EnterInitializationMode, F::EnterInitializationMode])
            }
            S::InitializationMode => {
                random.pick(&[F::SetReal, F::SetString, F::ExitInitializationMode, F::ExitInitializationMode])
            }
            S::StepComplete => random.pick(&[F::DoStep, F::DoStep, F::DoStep, F::SetString, F::GetFmuState]),
            S::EventMode => random.pick(&[F::NewDiscreteStates, F::EnterContinuousTimeMode, F::SetString]),
            S::ContinuousTimeMode => {
                random.pick(&[F::SetTime, F::SetContinuousStates, F::EnterEventMode, F::GetDerivatives])
            }
            S::StepFailed => random.pick(&[F::Reset, F::SetFmuState, any, any, any]),
            S::Error => random.pick(&[F::Reset, F::SetFmuState, any]),
            S::Terminated => random.pick(&[F::Reset, any]),
            S::StepInProgress | S::StepCanceled | S::StepMode | S::IntermediateUpdateMode | S::Fatal => any,
        },
    }
}

/// Whether an answer is what the tables, the arguments and the log demand.
fn judge(instance: &Instance, function: Function, answer: &Answer, lines: &[Line]) -> Result<(), String> {
    let (status, state) = (answer.status, instance.known.state);
    let legality = function.legality(instance.interface, state);
    let discards = matches!(function, Function::DoStep) || function.name().ends_with("Status");
    ensure((fmi2OK..=fmi2Fatal).contains(&status), || "no such status".into())?;
    ensure(status != fmi2Discard || discards, || "it cannot be discarded".into())?;
    // Nothing leads out of the fatal state.
    let error = if state == CallState::Fatal { fmi2Fatal } else { fmi2Error };
    if legality == Legality::Illegal {
        ensure(status == error, || "illegal calls are errors".into())?;
    } else {
        ensure(!answer.wrong || status == error, || "wrong arguments are errors".into())?;
    }
    let tolerated = legality == Legality::Tolerated && state != CallState::Fatal && instance.logs_all;
    let forbidden = |line: &Line| line.category == "logTolerated" && line.message.contains("FMI 2.0 forbids it");
    ensure(!tolerated || lines.iter().any(forbidden), || "tolerated without a word".into())?;
    let told = |line: &Line| line.status == status && line.category == category(status);
    let silent = status == fmi2OK || status < fmi2Error && !instance.logs_all;
    ensure(silent || lines.iter().any(told), || "no reason given".into())?;
    let illegal = lines.iter().any(|line| line.message.contains(&format!("illegal in state {state};")));
    ensure(illegal == (legality == Legality::Illegal), || "the log tells of another legality".into())?;
    ensure(lines.iter().all(|line| !line.message.contains("internal error")), || "a panic".into())
}

fn category(status: fmi2Status) -> &'static str {
    match status {
        fmi2Warning => "logStatusWarning",
        fmi2Discard => "logStatusDiscard",
        fmi2Error => "logStatusError",
        _ => "logStatusFatal",
    }
}

/// Takes note of what a call changed, after the state machines of the standard.
fn advance(instance: &mut Instance, function: Function, answer: Answer, blobs: &mut Vec<Blob>) {
    use CallState as S;
    use Function as F;
    match answer.status {
        fmi2OK | fmi2Warning => {}
        fmi2Discard if function == F::DoStep => return instance.known.state = S::StepFailed,
        fmi2Discard => return,
        fmi2Error => return instance.known.state = S::Error,
        _ => return instance.known.state = S::Fatal,
    }
    let exchange = instance.interface == Interface::ModelExchange;
    match function {
        F::EnterInitializationMode => instance.known.state = S::InitializationMode,
        F::ExitInitializationMode => instance.known.state = if exchange { S::EventMode } else { S::StepComplete },
        F::EnterEventMode => instance.known.state = S::EventMode,
        F::EnterContinuousTimeMode => instance.known.state = S::ContinuousTimeMode,
        F::Terminate => instance.known.state = S::Terminated,
        F::Reset => instance.known = Known { state: S::Instantiated, time: 0.0 },
        _ => {}
    }
    match answer.effect {
        Effect::Nothing | Effect::Restored(None) | Effect::Serialised(_, None) => {}
        Effect::Time(time) => instance.known.time = time,
        Effect::LogsAll(on) => instance.logs_all = on,
        Effect::Restored(Some(known)) => instance.known = known,
        Effect::Saved(state, known) => {
            instance.saved.retain(|saved| saved.0 != state);
            instance.saved.push((state, known.unwrap_or(instance.known)));
        }
        Effect::Freed(state) => {
            instance.saved.retain(|saved| saved.0 != state);
            instance.freed.extend((!state.is_null()).then_some(state));
        }
        Effect::Serialised(bytes, Some(known)) => {
            blobs.push(Blob::new(bytes, known, instance.interface));
        }
    }
}
