//! Random calls of FMI 3.0 in any order, with arguments right and wrong, within steps, too: each answer is held against the table
//! and against what is known of the state of the instance.
#![allow(clippy::expect_used, clippy::panic, non_upper_case_globals)] // A helper fails a test, too; constants as in the standard.

mod common;

use common::calls3::call;
use common::fmi3::*;
use common::toy;
use core::ffi::CStr;
use core::ptr::{null, null_mut, without_provenance_mut};
use fmu_export::abi::fmi3::*;
use fmu_export::fmi3::Function;
use fmu_export::{CallState, Interface, Legality};
use fmu_host::Random;
use std::cell::RefCell;
use std::collections::HashSet;
use std::rc::Rc;

/// Sequences; few for Miri, which is a thousand times slower.
const SEQUENCES: u64 = if cfg!(miri) { 40 } else { 100_000 };

/// A state that the importer holds.
struct Saved {
    token: fmi3FMUState,
    state: CallState,
    time: f64,
    /// What was read then, if reading changes nothing.
    integral: Option<f64>,
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

/// Texts, most of which make a hook of the toy fail.
const WORDS: [&CStr; 17] = [
    c"",
    c"",
    c"",
    c"other",
    c"\xff",
    c"panic getter",
    c"error step",
    c"warning step",
    c"discard step",
    c"refuse step",
    c"terminate step",
    c"panic step",
    c"fatal step",
    c"error terminate",
    c"fatal terminate",
    c"panic event handler",
    c"fatal event handler",
];

/// A call with random arguments. `token` is an FMU state of the instance or anything else.
#[allow(clippy::too_many_lines)] // all functions that have arguments
fn wild(i: fmi3Instance, function: Function, random: &mut Random, token: fmi3FMUState) -> fmi3Status {
    use Function as F;
    let mut vr = [(); 4].map(|()| u32::try_from(random.below(40)).unwrap_or_default());
    let count = random.pick(&[1, 1, 1, 1, 0, 2, 4]);
    let values = if random.once_in(30) { random.pick(&[0, 3, usize::MAX]) } else { count };
    let nulls: Vec<_> = (0..6).map(|_| random.once_in(60)).collect();
    // Most calls name a variable of the type.
    macro_rules! own {
        ($($reference:expr),*) => {
            if !random.once_in(8) {
                vr = [(); 4].map(|()| random.pick(&[$($reference),*]));
            }
        };
    }
    macro_rules! place {
        ($k:literal, $pointer:expr) => {
            if nulls[$k] { null_mut() } else { $pointer }
        };
    }
    macro_rules! get {
        ($function:ident, $start:expr, $($reference:expr),*) => {{
            own!($($reference),*);
            let mut found = [$start; 4];
            $function(i, place!(0, vr.as_mut_ptr()), count, place!(1, found.as_mut_ptr()), values)
        }};
    }
    macro_rules! set {
        ($function:ident, [$($value:expr),*], $($reference:expr),*) => {{
            own!($($reference),*);
            let mut given = [(); 4].map(|()| random.pick(&[$($value),*]));
            $function(i, place!(0, vr.as_mut_ptr()), count, place!(1, given.as_mut_ptr()), values)
        }};
    }
    macro_rules! whole {
        ($get:ident $set:ident $integer:ident $index:literal) => {
            if function.name().starts_with("fmi3Get") {
                get!($get, 0, toy::WIDE + $index)
            } else {
                set!($set, [$integer::MIN, 0, 1, $integer::MAX], toy::WIDE + $index)
            }
        };
    }
    let (mut floats, mut sizes, mut flags, mut longs) = ([0.5; 4], [1; 4], [0_u8; 6], [1_u64; 4]);
    let (mut orders, mut qualifiers) = ([1, random.pick(&[1, 0, 2, -1]), 1, 1], [0; 4]);
    let (mut binaries, mut bytes, mut state) = ([null(); 4], [0_u8; 64], token);
    floats[0] = random.pick(&[0.0, 0.25, 2.0, -1.0, f64::NAN, f64::INFINITY]);
    let mut references = || place!(0, vr.as_mut_ptr());
    unsafe {
        match function {
            F::SetDebugLogging => {
                let mut names = [random.pick(&WORDS).as_ptr(), c"logEvents".as_ptr()];
                fmi3SetDebugLogging(i, flags[0], count.min(2), place!(1, names.as_mut_ptr()))
            }
            F::EnterInitializationMode => {
                let (defined, stop) = (random.once_in(4).into(), random.pick(&[2.0, 5.0, -1.0]));
                fmi3EnterInitializationMode(i, 0, 0.0, if nulls[0] { f64::NAN } else { 0.0 }, defined, stop)
            }
            F::GetFloat32 => get!(fmi3GetFloat32, 0.0, toy::SINGLE),
            F::SetFloat32 => set!(fmi3SetFloat32, [0.0, 1.5, f32::NAN], toy::SINGLE),
            F::GetFloat64 => get!(fmi3GetFloat64, 0.0, toy::GAIN, toy::INTEGRAL, toy::COUNT_OF_VARIABLES),
            F::SetFloat64 => {
                set!(fmi3SetFloat64, [0.5, 2.0, -1.0, f64::NAN, f64::INFINITY], toy::GAIN, toy::LIMIT, toy::INPUT)
            }
            F::GetInt8 | F::SetInt8 => whole!(fmi3GetInt8 fmi3SetInt8 i8 0),
            F::GetUInt8 | F::SetUInt8 => whole!(fmi3GetUInt8 fmi3SetUInt8 u8 1),
            F::GetInt16 | F::SetInt16 => whole!(fmi3GetInt16 fmi3SetInt16 i16 2),
            F::GetUInt16 | F::SetUInt16 => whole!(fmi3GetUInt16 fmi3SetUInt16 u16 3),
            F::GetInt32 | F::SetInt32 => whole!(fmi3GetInt32 fmi3SetInt32 i32 4),
            F::GetUInt32 | F::SetUInt32 => whole!(fmi3GetUInt32 fmi3SetUInt32 u32 5),
            F::GetInt64 | F::SetInt64 => whole!(fmi3GetInt64 fmi3SetInt64 i64 6),
            F::GetUInt64 | F::SetUInt64 => whole!(fmi3GetUInt64 fmi3SetUInt64 u64 7),
            F::GetBoolean => get!(fmi3GetBoolean, 0, toy::ON, toy::IS_ON),
            F::SetBoolean => set!(fmi3SetBoolean, [0, 1, 2], toy::ON),
            F::GetString => get!(fmi3GetString, null(), toy::LABEL, toy::ECHO),
            F::SetString => {
                own!(toy::TROUBLE, toy::TROUBLE, toy::LABEL);
                let mut words = [(); 4].map(|()| random.pick(&WORDS).as_ptr());
                fmi3SetString(i, place!(0, vr.as_mut_ptr()), count, place!(1, words.as_mut_ptr()), values)
            }
            F::GetBinary => fmi3GetBinary(i, references(), count, sizes.as_mut_ptr(), binaries.as_mut_ptr(), values),
            F::SetBinary => fmi3SetBinary(i, references(), count, sizes.as_ptr(), binaries.as_ptr(), values),
            F::GetClock => {
                own!(toy::TICK, toy::SAMPLE);
                fmi3GetClock(i, place!(0, vr.as_mut_ptr()), count, place!(1, flags.as_mut_ptr()))
            }
            F::SetClock => {
                own!(toy::SAMPLE, toy::TRIGGER);
                flags = [(); 6].map(|()| random.pick(&[1, 1, 1, 0]));
                fmi3SetClock(i, place!(0, vr.as_mut_ptr()), count, place!(1, flags.as_mut_ptr()))
            }
            F::GetIntervalDecimal => {
                own!(toy::SAMPLE);
                let (vr, qualifiers) = (place!(0, vr.as_mut_ptr()), place!(2, qualifiers.as_mut_ptr()));
                fmi3GetIntervalDecimal(i, vr, count, place!(1, floats.as_mut_ptr()), qualifiers)
            }
            F::GetShiftDecimal => {
                own!(toy::SAMPLE);
                fmi3GetShiftDecimal(i, place!(0, vr.as_mut_ptr()), count, place!(1, floats.as_mut_ptr()))
            }
            F::SetShiftFraction => fmi3SetShiftFraction(i, references(), count, longs.as_ptr(), longs.as_ptr()),
            F::GetShiftFraction => fmi3GetShiftFraction(i, references(), count, longs.as_mut_ptr(), longs.as_mut_ptr()),
            F::GetFmuState => fmi3GetFMUState(i, null_mut()),
            F::SerializedFmuStateSize => fmi3SerializedFMUStateSize(i, token, place!(0, sizes.as_mut_ptr())),
            F::SerializeFmuState => fmi3SerializeFMUState(i, token, place!(0, bytes.as_mut_ptr()), bytes.len()),
            F::DeserializeFmuState => {
                let size = random.below(bytes.len());
                fmi3DeserializeFMUState(i, place!(0, bytes.as_mut_ptr()), size, place!(1, &raw mut state))
            }
            F::GetDirectionalDerivative | F::GetAdjointDerivative => {
                let knowns = [(); 4].map(|()| random.pick(&[toy::INPUT, toy::SWITCHED, toy::INTEGRAL, toy::GAIN]));
                own!(toy::DERIVATIVE, toy::INTEGRAL, toy::HELD);
                let forward = function == F::GetDirectionalDerivative;
                let call = if forward { fmi3GetDirectionalDerivative } else { fmi3GetAdjointDerivative };
                let (seed, mut out) = (place!(1, floats.as_mut_ptr()), [0.0; 4]);
                let out = place!(2, out.as_mut_ptr());
                call(i, place!(0, vr.as_mut_ptr()), count, knowns.as_ptr(), count, seed, values, out, count)
            }
            F::UpdateDiscreteStates => {
                let [a, b, c, d, e, _] = &mut flags;
                let (a, b, c, d) = (place!(0, a), place!(1, b), place!(2, c), place!(3, d));
                fmi3UpdateDiscreteStates(i, a, b, c, d, place!(4, e), place!(5, floats.as_mut_ptr()))
            }
            F::CompletedIntegratorStep => {
                let [a, b, ..] = &mut flags;
                fmi3CompletedIntegratorStep(i, 0, place!(0, a), place!(1, b))
            }
            F::SetTime => fmi3SetTime(i, floats[0]),
            F::SetContinuousStates => fmi3SetContinuousStates(i, place!(0, floats.as_mut_ptr()), count),
            F::GetContinuousStateDerivatives => {
                fmi3GetContinuousStateDerivatives(i, place!(0, floats.as_mut_ptr()), count)
            }
            F::GetEventIndicators => fmi3GetEventIndicators(i, place!(0, floats.as_mut_ptr()), count),
            F::GetContinuousStates => fmi3GetContinuousStates(i, place!(0, floats.as_mut_ptr()), count),
            F::GetNominals => fmi3GetNominalsOfContinuousStates(i, place!(0, floats.as_mut_ptr()), count),
            F::GetNumberOfEventIndicators => fmi3GetNumberOfEventIndicators(i, place!(0, sizes.as_mut_ptr())),
            F::GetNumberOfContinuousStates => fmi3GetNumberOfContinuousStates(i, place!(0, sizes.as_mut_ptr())),
            F::GetOutputDerivatives => {
                own!(toy::INTEGRAL);
                let (vr, orders) = (place!(0, vr.as_mut_ptr()), place!(1, orders.as_mut_ptr()));
                fmi3GetOutputDerivatives(i, vr, count, orders, place!(2, floats.as_mut_ptr()), values)
            }
            F::DoStep => {
                let [a, b, c, ..] = &mut flags;
                fmi3DoStep(i, f64::NAN, 1.0, 1, place!(0, a), place!(1, b), place!(2, c), floats.as_mut_ptr())
            }
            _ => call(i, function, token),
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

/// Calls that make, take or free FMU states, and what becomes known by them.
fn states(host: &Host, known: &mut Known, function: Function, random: &mut Random) -> Option<fmi3Status> {
    use Function as F;
    let (i, mut token) = (host.instance, known.token(random));
    let position = known.saved.iter().position(|saved| saved.token == token);
    Some(match function {
        F::GetFmuState if known.saved.len() < 4 => {
            let mut token = null_mut();
            let status = unsafe { fmi3GetFMUState(i, &raw mut token) };
            if status == fmi3OK {
                let integral = (known.state == CallState::StepMode).then(|| host.float(toy::INTEGRAL));
                known.saved.push(Saved { token, state: known.state, time: known.time, integral });
            }
            status
        }
        F::SetFmuState => {
            let status = host.restore(token);
            if status == fmi3OK {
                let saved = &known.saved[position.expect("a state that was given out")];
                (known.state, known.time) = (saved.state, saved.time);
                if let Some(integral) = saved.integral {
                    assert_eq!(host.float(toy::INTEGRAL), integral, "what was saved comes back");
                }
            }
            status
        }
        F::FreeFmuState => {
            let status = unsafe { fmi3FreeFMUState(i, &raw mut token) };
            if let Some(position) = position.filter(|_| status == fmi3OK) {
                known.saved.remove(position);
                assert!(token.is_null());
            }
            status
        }
        F::DeserializeFmuState if known.saved.len() < 4 && position.is_some() && known.state != CallState::Fatal => {
            let Saved { state, time, integral, .. } = known.saved[position?];
            let bytes = host.serialize(token);
            let (status, token) = host.deserialize(&bytes);
            assert_eq!(status, fmi3OK, "{:?}", host.lines());
            known.saved.push(Saved { token, state, time, integral });
            status
        }
        _ => return None,
    })
}

/// What was called within steps, and what came of it.
type Inside = Rc<RefCell<Vec<(Function, fmi3Status)>>>;

/// Within a step the importer calls what comes to its mind.
fn look(host: &Host, token: fmi3FMUState, random: &mut Random) -> Inside {
    let (instance, inside) = (host.instance, Inside::default());
    let (list, mut random) = (inside.clone(), Random::seeded(random.bits()));
    host.on_look(move |time, _| {
        let function = random.pick(Function::ALL);
        if function == Function::FreeInstance {
            unsafe { fmi3FreeInstance(instance) }; // no instance is freed there
        } else if random.once_in(2) {
            list.borrow_mut().push((function, wild(instance, function, &mut random, token)));
        } else {
            list.borrow_mut().push((function, call(instance, function, null_mut())));
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

#[test]
fn a_hundred_thousand_random_call_sequences_go_as_the_table_says() {
    let mut cells = HashSet::new();
    let mut statuses = [0_u64; 5];
    let mut restored = 0;
    let hook = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |info| {
        // The toy panics often.
        if !info.to_string().contains("panic in ") {
            hook(info);
        }
    }));
    for seed in 0..SEQUENCES {
        let mut random = Random::seeded(seed);
        let mut is = || random.once_in(2);
        let session = Session { exchange: is(), event_mode: is(), early_return: is(), looks: is() };
        let session = if session.exchange { Session::EXCHANGE } else { session };
        let (host, mut known) = (Host::new(session), Known::new(session));
        for _ in 0..random.below(80) {
            let function = known.choose(&mut random);
            if function == Function::FreeInstance {
                continue;
            }
            let (before, token) = (known.state, known.token(&mut random));
            let legality = function.legality(known.interface(), before);
            cells.insert((function as usize, session.exchange, before as usize));
            host.on_look(|_, _| None);
            let looks = session.looks && random.once_in(3);
            let inside = if looks { look(&host, token, &mut random) } else { Inside::default() };
            let managed = if random.once_in(8) { None } else { states(&host, &mut known, function, &mut random) };
            let status = match (managed, function) {
                (Some(status), _) => status,
                (None, Function::DoStep) if !random.once_in(16) => step(&host, &mut known, &mut random),
                // What these change would not be known.
                (None, Function::SetFmuState | Function::FreeFmuState | Function::GetFmuState) => {
                    wild(host.instance, function, &mut random, null_mut())
                }
                (None, _) if random.once_in(3) => call(host.instance, function, null_mut()),
                (None, _) => wild(host.instance, function, &mut random, token),
            };
            let lines = host.lines();
            statuses[usize::try_from(status).expect("a status")] += 1;
            for (called, answer) in inside.take() {
                let state = CallState::IntermediateUpdateMode;
                let illegal = called.legality(Interface::CoSimulation, state) == Legality::Illegal;
                assert!(!illegal || answer == fmi3Error && status == fmi3Error, "{called:?} within a step");
                assert_eq!(says(&lines, called, "illegal", state), illegal, "{called:?} within a step: {lines:?}");
                cells.insert((called as usize, false, state as usize));
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
                fmi3OK | fmi3Warning if function == Function::SetFmuState => restored += 1,
                fmi3OK | fmi3Warning => known.follow(function),
                fmi3Error => known.state = CallState::Terminated,
                fmi3Fatal => known.state = CallState::Fatal,
                _ => {}
            }
        }
    }
    drop(std::panic::take_hook());
    if !cfg!(miri) {
        assert!(statuses.iter().all(|count| *count > 200) && restored > 1000, "{statuses:?}, {restored}");
        // Six states of model exchange, six of co-simulation, and what is called within a step.
        assert_eq!(cells.len(), 70 * (6 + 6 + 1), "every function in every state");
    }
}
