//! Random call sequences with random arguments: whatever a host does, it gets a status back.
#![allow(clippy::expect_used, clippy::panic)] // Helpers outside of #[test] functions fail a test, too.

mod common;

use common::*;
use core::ptr::{null, null_mut, without_provenance_mut};
use fmi2_export::abi::*;

/// `SplitMix64` (Steele, Lea, Flood 2014): a few lines, and the same on every platform.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn below(&mut self, bound: u64) -> u64 {
        self.next() % bound
    }

    fn pick<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[usize::try_from(self.below(choices.len() as u64)).expect("an index")]
    }

    fn reference(&mut self) -> u32 {
        u32::try_from(self.below(18)).expect("a reference")
    }

    fn real(&mut self) -> f64 {
        self.pick(&[0.0, 1.0, 2.5, -1.0, 1e300, -0.0, 1e-300, f64::NAN, f64::INFINITY, f64::NEG_INFINITY])
    }

    fn integer(&mut self) -> i32 {
        self.pick(&[0, 1, 2, 3, -1, i32::MIN, i32::MAX])
    }
}

/// What a host remembers between its calls.
struct Memory {
    time: f64,
    states: Vec<fmi2FMUstate>,
    bytes: Vec<fmi2Byte>,
}

fn random_state(random: &mut Random, memory: &Memory) -> fmi2FMUstate {
    match random.below(8) {
        0 => null_mut(),
        1 => without_provenance_mut(usize::try_from(random.next() >> 8).expect("an address")),
        _ if memory.states.is_empty() => null_mut(),
        _ => random.pick(&memory.states),
    }
}

fn life_call(host: &Host, random: &mut Random, memory: &mut Memory) -> fmi2Status {
    let c = host.component;
    unsafe {
        match random.below(12) {
            0 => {
                fmi2SetupExperiment(c, random.integer(), random.real(), random.real(), random.integer(), random.real())
            }
            1 => host.setup(0.0, None),
            2 | 3 => fmi2EnterInitializationMode(c),
            4 | 5 => fmi2ExitInitializationMode(c),
            6 if random.below(4) == 0 => fmi2Terminate(c),
            7 if random.below(4) == 0 => fmi2Reset(c),
            8 => fmi2DoStep(c, random.real(), random.real(), fmi2True),
            9 => fmi2SetDebugLogging(c, fmi2True, 0, null()),
            _ => {
                let status = host.step(memory.time, 0.25);
                if status <= fmi2Warning {
                    memory.time += 0.25;
                }
                status
            }
        }
    }
}

fn value_call(host: &Host, random: &mut Random) -> fmi2Status {
    let c = host.component;
    let references = [random.reference(), random.reference()];
    let count = usize::try_from(random.below(3)).expect("a count");
    let (mut reals, mut integers) = ([random.real(), random.real()], [random.integer(), random.integer()]);
    let text = [random.pick(&[c"", c"text", c"discard step", c"error step", c"\xff"]).as_ptr(), null()];
    let mut texts = text;
    let vr = if random.below(20) == 0 { null() } else { references.as_ptr() };
    unsafe {
        match random.below(10) {
            0 => fmi2GetReal(c, vr, count, reals.as_mut_ptr()),
            1 => fmi2SetReal(c, vr, count, reals.as_ptr()),
            2 => fmi2GetInteger(c, vr, count, integers.as_mut_ptr()),
            3 => fmi2SetInteger(c, vr, count, integers.as_ptr()),
            4 => fmi2GetBoolean(c, vr, count, integers.as_mut_ptr()),
            5 => fmi2SetBoolean(c, vr, count, integers.as_ptr()),
            6 => fmi2GetString(c, vr, count, texts.as_mut_ptr()),
            7 => fmi2SetString(c, vr, count.min(1), text.as_ptr()),
            8 => fmi2SetRealInputDerivatives(c, vr, count, integers.as_ptr(), reals.as_ptr()),
            _ => fmi2GetRealOutputDerivatives(c, vr, count, integers.as_ptr(), reals.as_mut_ptr()),
        }
    }
}

fn state_call(host: &Host, random: &mut Random, memory: &mut Memory) -> fmi2Status {
    let c = host.component;
    let mut state = random_state(random, memory);
    let mut size = 0;
    unsafe {
        match random.below(6) {
            0 | 1 => {
                let status = fmi2GetFMUstate(c, &raw mut state);
                memory.states.push(state);
                status
            }
            2 => fmi2SetFMUstate(c, state),
            3 => fmi2FreeFMUstate(c, &raw mut state),
            4 => {
                let status = fmi2SerializedFMUstateSize(c, state, &raw mut size);
                memory.bytes.resize(size, 0);
                status.max(fmi2SerializeFMUstate(c, state, memory.bytes.as_mut_ptr(), size))
            }
            _ => {
                if random.below(2) == 0 && !memory.bytes.is_empty() {
                    let position = usize::try_from(random.next() >> 8).expect("a position") % memory.bytes.len();
                    memory.bytes[position] ^= 1;
                }
                fmi2DeSerializeFMUstate(c, memory.bytes.as_ptr(), memory.bytes.len(), &raw mut state)
            }
        }
    }
}

fn status_call(host: &Host, random: &mut Random) -> fmi2Status {
    let c = host.component;
    let kind = random.integer();
    let (mut integer, mut text) = (0, null());
    unsafe {
        match random.below(6) {
            0 => fmi2GetStatus(c, kind, &raw mut integer),
            1 => host.real_status(kind).0,
            2 => fmi2GetIntegerStatus(c, kind, &raw mut integer),
            3 => host.boolean_status(kind).0,
            4 => fmi2GetStringStatus(c, kind, &raw mut text),
            _ => fmi2GetBooleanStatus(c, kind, null_mut()),
        }
    }
}

#[test]
fn a_hundred_thousand_random_call_sequences_end_in_a_status_each() {
    let mut seen = [0_u32; 5];
    for seed in 0..100_000 {
        let mut random = Random(seed);
        let host = if seed % 2 == 0 { Host::new() } else { Host::initialized() };
        let mut memory = Memory { time: 0.0, states: Vec::new(), bytes: Vec::new() };
        for _ in 0..random.below(16) {
            let status = match random.below(8) {
                0..4 => life_call(&host, &mut random, &mut memory),
                4 | 5 => value_call(&host, &mut random),
                6 => state_call(&host, &mut random, &mut memory),
                _ => status_call(&host, &mut random),
            };
            seen[usize::try_from(status).expect("a status")] += 1;
            let lines = host.lines();
            assert!(status == fmi2OK || !lines.is_empty(), "seed {seed}: status {status} without a reason");
            assert!(lines.iter().all(|line| !line.message.contains("internal error")), "seed {seed}: {lines:?}");
        }
    }
    assert!(seen[..4].iter().all(|count| *count > 100), "all sorts of status occurred: {seen:?}");
}
