//! One call of a function with random arguments.

use crate::arguments::Arguments;
use crate::instance::{Blob, Instance, Known};
use crate::{Fmu, Random};
use core::mem::MaybeUninit;
use core::ptr::{null, null_mut, without_provenance_mut};
use fmu_export::Function;
use fmu_export::abi::{fmi2Component, fmi2EventInfo, fmi2FMUstate, fmi2False, fmi2Status, fmi2String, fmi2True};

/// What a call changes if it succeeds, beyond what the call state says.
pub(crate) enum Effect {
    Nothing,
    Time(f64),
    LogsAll(bool),
    /// This state holds what is known now, or what was known when it was serialised.
    Saved(fmi2FMUstate, Option<Known>),
    Restored(Option<Known>),
    Freed(fmi2FMUstate),
    Serialised(Vec<i8>, Option<Known>),
}

/// The outcome of a call.
pub(crate) struct Answer {
    pub(crate) status: fmi2Status,
    /// An argument was surely wrong.
    pub(crate) wrong: bool,
    pub(crate) effect: Effect,
}

/// A state to be handed over: one of the instance, seldom NULL, one that was freed, of another instance, or an invention.
fn state(a: &mut Arguments, instance: &Instance, foreign: &[fmi2FMUstate]) -> (fmi2FMUstate, Option<Known>) {
    let other = match a.random.below(16) {
        0 => null_mut(),
        1 => without_provenance_mut(a.random.below(1 << 40) | 1),
        2 if !instance.freed.is_empty() => a.random.pick(&instance.freed),
        3 if !foreign.is_empty() => a.random.pick(foreign),
        _ if instance.saved.is_empty() => null_mut(),
        _ => {
            let (state, known) = a.random.pick(&instance.saved);
            return (state, Some(known));
        }
    };
    a.wrong = true;
    (other, None)
}

/// A place for a state: holding NULL or one of the instance; seldom one that it does not have.
fn state_or_null(a: &mut Arguments, instance: &Instance, foreign: &[fmi2FMUstate]) -> fmi2FMUstate {
    if a.random.below(3) > 0 {
        return null_mut();
    }
    let (state, _) = state(a, instance, foreign);
    if state.is_null() {
        a.wrong = false;
    }
    state
}

/// Strings, some of which the toy of the exporter takes for an order to fail; NULL and what is no UTF-8 is wrong.
fn texts(a: &mut Arguments, size: usize) -> Vec<fmi2String> {
    const TEXTS: [fmi2String; 12] = [
        c"".as_ptr(),
        c"text".as_ptr(),
        c"discard step".as_ptr(),
        c"discard step".as_ptr(),
        c"error step".as_ptr(),
        c"fatal step".as_ptr(),
        c"warning step".as_ptr(),
        c"fatal terminate".as_ptr(),
        c"error event handler".as_ptr(),
        c"fatal event handler".as_ptr(),
        c"\xff".as_ptr(),
        null(),
    ];
    let numbers: Vec<_> = (0..size).map(|_| a.random.below(TEXTS.len())).collect();
    a.wrong_if(numbers.iter().any(|&number| number >= 10));
    numbers.into_iter().map(|number| TEXTS[number]).collect()
}

/// `fmi2DeSerializeFMUstate` of a state that was serialised, or of one that is damaged now.
unsafe fn deserialise(
    a: &mut Arguments,
    (instance, component): (&Instance, fmi2Component),
    foreign: &[fmi2FMUstate],
    blobs: &mut [Blob],
    effect: &mut Effect,
) -> fmi2Status {
    let f = a.fmu.functions.fmi2DeSerializeFMUstate;
    let mut state = state_or_null(a, instance, foreign);
    if blobs.is_empty() {
        a.wrong = true;
        let bytes = [7; 40];
        // SAFETY: the array holds so many bytes.
        return unsafe { f(component, a.array(&bytes), bytes.len(), a.place(&mut state)) };
    }
    let blob = &mut blobs[a.random.below(blobs.len())];
    if a.random.once_in(4) {
        let position = a.random.below(blob.bytes.len());
        blob.bytes[position] ^= a.random.pick(&[1, 2, 64, -128]);
    }
    let size = if a.random.once_in(12) { a.random.below(blob.bytes.len()) } else { blob.bytes.len() };
    a.wrong_if(blob.is_damaged() || blob.interface != instance.interface || size < blob.bytes.len());
    // SAFETY: the array holds at least so many bytes.
    let status = unsafe { f(component, a.array(&blob.bytes), size, a.place(&mut state)) };
    *effect = Effect::Saved(state, Some(blob.known));
    status
}

/// Calls `function` of the instance, or of no instance if `null` says so. `foreign` are states of other instances.
#[allow(clippy::too_many_lines)] // one arm a function
pub(crate) fn call(
    fmu: &Fmu,
    random: &mut Random,
    instance: &Instance,
    (function, component): (Function, fmi2Component),
    foreign: &[fmi2FMUstate],
    blobs: &mut [Blob],
) -> Answer {
    use Function as F;
    let (c, f) = (component, &fmu.functions);
    let size = random.size();
    let mut a = Arguments { random, fmu, wrong: false };
    let a = &mut a;
    let mut effect = Effect::Nothing;
    // SAFETY: arrays hold as many values as the call says or are NULL, strings are zero-terminated or NULL, the component
    // is live or NULL.
    let status = unsafe {
        macro_rules! exchange {
            ($function:ident) => {
                match &f.exchange {
                    Some(exchange) => exchange.$function,
                    None => return Answer { status: -1, wrong: true, effect },
                }
            };
        }
        macro_rules! get {
            ($function:ident, $start:expr) => {{
                let (vr, mut values) = (a.references(size), vec![$start; size]);
                (f.$function)(c, a.array(&vr), size, a.room(&mut values))
            }};
        }
        macro_rules! set {
            ($function:ident, $values:expr) => {{
                let (vr, values) = (a.references(size), $values);
                (f.$function)(c, a.array(&vr), size, a.array(&values))
            }};
        }
        macro_rules! status {
            ($function:ident, $value:expr) => {{
                let (kind, mut value) = (a.random.pick(&[0, 1, 2, 3, 4, -1]), $value);
                (f.$function)(c, kind, a.place(&mut value))
            }};
        }
        macro_rules! fill {
            ($function:ident, $count:expr) => {{
                let count = if a.random.once_in(20) { size } else { $count };
                a.wrong_if(count != $count);
                let mut values = vec![0.0; count];
                exchange!($function)(c, a.room(&mut values), count)
            }};
        }
        match function {
            F::SetDebugLogging => {
                const NAMES: [*const core::ffi::c_char; 6] = [
                    c"logAll".as_ptr(),
                    c"logEvents".as_ptr(),
                    c"logStatusWarning".as_ptr(),
                    c"nonsense".as_ptr(),
                    c"\xff".as_ptr(),
                    null(),
                ];
                let on = a.random.pick(&[fmi2False, fmi2True, fmi2True, 7]);
                let numbers: Vec<_> = (0..size.min(3)).map(|_| a.random.below(NAMES.len())).collect();
                a.wrong_if(numbers.iter().any(|&number| number >= 4));
                let all = numbers.is_empty() || numbers.contains(&0);
                effect = Effect::LogsAll(on != fmi2False && all);
                let names: Vec<fmi2String> = numbers.iter().map(|&number| NAMES[number]).collect();
                (f.fmi2SetDebugLogging)(c, on, names.len(), a.array(&names))
            }
            F::FreeInstance => return Answer { status: -1, wrong: true, effect },
            F::SetupExperiment => {
                let (tolerance, start) = (a.random.pick(&[1e-6, 1e-3, 0.0, f64::NAN]), a.finite());
                let (with_tolerance, with_stop) = (a.random.below(2), a.random.once_in(4));
                a.wrong_if(with_tolerance == 1 && (tolerance.is_nan() || tolerance <= 0.0));
                let stop = a.random.real();
                a.wrong_if(with_stop && (stop.is_nan() || stop < start));
                effect = Effect::Time(start);
                let with_tolerance = if with_tolerance == 1 { fmi2True } else { fmi2False };
                (f.fmi2SetupExperiment)(c, with_tolerance, tolerance, start, with_stop.into(), stop)
            }
            F::EnterInitializationMode => (f.fmi2EnterInitializationMode)(c),
            F::ExitInitializationMode => (f.fmi2ExitInitializationMode)(c),
            F::Terminate => (f.fmi2Terminate)(c),
            F::Reset => (f.fmi2Reset)(c),
            F::GetReal => get!(fmi2GetReal, 0.0),
            F::GetInteger => get!(fmi2GetInteger, 0),
            F::GetBoolean => get!(fmi2GetBoolean, 0),
            F::GetString => get!(fmi2GetString, null()),
            F::SetReal => set!(fmi2SetReal, a.reals(size)),
            F::SetInteger => set!(fmi2SetInteger, a.integers(size)),
            F::SetBoolean => set!(fmi2SetBoolean, a.integers(size)),
            F::SetString if a.random.once_in(2) => {
                let (vr, values) = (fmu.favourite.unwrap_or_default(), texts(a, 1));
                (f.fmi2SetString)(c, &raw const vr, 1, a.array(&values))
            }
            F::SetString => set!(fmi2SetString, texts(a, size)),
            F::GetFmuState => {
                let mut state = state_or_null(a, instance, foreign);
                let status = (f.fmi2GetFMUstate)(c, a.place(&mut state));
                effect = Effect::Saved(state, None);
                status
            }
            F::SetFmuState => {
                let (state, known) = state(a, instance, foreign);
                effect = Effect::Restored(known);
                (f.fmi2SetFMUstate)(c, state)
            }
            F::FreeFmuState => {
                let mut state = state_or_null(a, instance, foreign);
                effect = Effect::Freed(state);
                (f.fmi2FreeFMUstate)(
                    c,
                    if a.random.once_in(20) {
                        (effect, a.wrong) = (Effect::Nothing, false);
                        null_mut()
                    } else {
                        &raw mut state
                    },
                )
            }
            F::SerializedFmuStateSize => {
                let ((state, _), mut size) = (state(a, instance, foreign), 0);
                (f.fmi2SerializedFMUstateSize)(c, state, a.place(&mut size))
            }
            F::SerializeFmuState => {
                let (state, known) = state(a, instance, foreign);
                let mut bytes = vec![0; if a.random.once_in(10) { size } else { 1 << 16 }];
                a.wrong_if(bytes.len() < 1 << 16);
                let status = (f.fmi2SerializeFMUstate)(c, state, a.room(&mut bytes), bytes.len());
                // Header and length as the envelope has them; the host could ask for the size, too.
                let mut length = 0;
                if status < 2 && (f.fmi2SerializedFMUstateSize)(c, state, &raw mut length) < 2 {
                    bytes.truncate(length);
                    effect = Effect::Serialised(bytes, known);
                }
                status
            }
            F::DeSerializeFmuState => deserialise(a, (instance, component), foreign, blobs, &mut effect),
            F::GetDirectionalDerivative => {
                let (unknown, known) = (a.references(size.min(2)), a.references(2));
                let (seeds, mut result) = ([a.random.real(), 1.0], vec![0.0; unknown.len()]);
                let (unknowns, knowns) = (unknown.len(), a.random.below(3));
                a.wrong = false; // references that are not looked at may be anything
                let (unknown, known) = (unknown.as_ptr(), known.as_ptr());
                let derivative = f.fmi2GetDirectionalDerivative;
                derivative(c, unknown, unknowns, known, knowns, seeds.as_ptr(), a.room(&mut result))
            }
            F::SetRealInputDerivatives => {
                let (vr, orders, values) = (a.references(size), a.integers(size), a.reals(size));
                a.wrong_if(values.iter().any(|value| !value.is_finite()));
                (f.fmi2SetRealInputDerivatives)(c, a.array(&vr), size, a.array(&orders), a.array(&values))
            }
            F::GetRealOutputDerivatives => {
                let (vr, orders, mut values) = (a.references(size), a.integers(size), vec![0.0; size]);
                (f.fmi2GetRealOutputDerivatives)(c, a.array(&vr), size, a.array(&orders), a.room(&mut values))
            }
            F::DoStep => {
                let t = if a.random.once_in(12) { a.finite() } else { instance.known.time };
                let h = if a.random.once_in(12) { a.finite() } else { a.random.pick(&[1e-6, 1e-3, 0.02, 0.1, 0.3]) };
                a.wrong_if(h.is_nan() || h <= 0.0);
                effect = Effect::Time(t + h);
                (f.fmi2DoStep)(c, t, h, fmi2True)
            }
            F::CancelStep => (f.fmi2CancelStep)(c),
            F::GetStatus => status!(fmi2GetStatus, 0),
            F::GetRealStatus => status!(fmi2GetRealStatus, 0.0),
            F::GetIntegerStatus => status!(fmi2GetIntegerStatus, 0),
            F::GetBooleanStatus => status!(fmi2GetBooleanStatus, 0),
            F::GetStringStatus => status!(fmi2GetStringStatus, null()),
            F::EnterEventMode => exchange!(fmi2EnterEventMode)(c),
            F::NewDiscreteStates => {
                let mut info = MaybeUninit::<fmi2EventInfo>::uninit();
                exchange!(fmi2NewDiscreteStates)(c, a.place(&mut info).cast())
            }
            F::EnterContinuousTimeMode => exchange!(fmi2EnterContinuousTimeMode)(c),
            F::CompletedIntegratorStep => {
                let (mut event, mut end) = (0, 0);
                let (event, end) = (a.place(&mut event), a.place(&mut end));
                exchange!(fmi2CompletedIntegratorStep)(c, fmi2True, event, end)
            }
            F::SetTime => {
                let time =
                    if a.random.once_in(8) { a.finite() } else { instance.known.time + a.random.pick(&[1e-6, 0.01]) };
                effect = Effect::Time(time);
                exchange!(fmi2SetTime)(c, time)
            }
            F::SetContinuousStates => {
                let count = if a.random.once_in(20) { size } else { fmu.states };
                a.wrong_if(count != fmu.states);
                let values: Vec<_> = (0..count).map(|_| 1e-3 * a.random.real()).collect();
                a.wrong_if(values.iter().any(|value| !value.is_finite()));
                exchange!(fmi2SetContinuousStates)(c, a.array(&values), count)
            }
            F::GetDerivatives => fill!(fmi2GetDerivatives, fmu.states),
            F::GetEventIndicators => fill!(fmi2GetEventIndicators, fmu.indicators),
            F::GetContinuousStates => fill!(fmi2GetContinuousStates, fmu.states),
            F::GetNominals => fill!(fmi2GetNominalsOfContinuousStates, fmu.states),
        }
    };
    Answer { status, wrong: a.wrong, effect }
}
