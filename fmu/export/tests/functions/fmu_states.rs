//! Saving, restoring and serialising FMU states.

use crate::common::toy::*;
use crate::common::*;
use core::ptr::{dangling_mut, null, null_mut, without_provenance_mut};
use fmu_export::abi::*;
use fmu_export::{CallState, Experiment};

/// Everything that can be read, bit for bit.
fn fingerprint(host: &Host) -> (Vec<u64>, Vec<i32>, String) {
    let reals = [GAIN, LIMIT, DOUBLED, INPUT, INTEGRAL, TIME].map(|vr| host.real(vr).to_bits());
    let integers = [SEED, COUNT, LAW_VR, CHOSEN, UPDATES].map(|vr| host.integer(vr));
    (reals.to_vec(), integers.to_vec(), host.string(LABEL))
}

/// A host in the middle of a simulation, with an input derivative in force, at 0.3 s.
fn busy_host() -> Host {
    let host = Host::initializing();
    assert_eq!(host.set_real(GAIN, 1.1), fmi2OK);
    assert_eq!(host.set_string(LABEL, "busy"), fmi2OK);
    assert_eq!(host.exit_initialization(), fmi2OK);
    assert_eq!(host.set_derivative(INPUT, 1, 0.7), fmi2OK);
    assert_eq!(host.step(0.0, 0.3), fmi2OK);
    host
}

fn run_on(host: &Host) {
    for i in 0..50 {
        let t = 0.3 + 0.1 * f64::from(i);
        assert_eq!(host.set_real(INPUT, t.sin()), fmi2OK);
        assert_eq!(host.step(t, 0.1), fmi2OK);
    }
}

#[test]
fn a_restored_state_runs_on_bit_for_bit_after_a_reset_too() {
    let host = busy_host();
    let saved = host.save();
    run_on(&host);
    let first = fingerprint(&host);
    for reset in [false, true, false] {
        assert!(!reset || host.reset() == fmi2OK);
        assert_eq!(host.restore(saved), fmi2OK);
        run_on(&host);
        assert_eq!(fingerprint(&host), first);
    }
}

#[test]
fn a_state_holds_the_call_state_too() {
    let host = Host::initializing();
    let saved = host.save();
    assert_eq!(host.exit_initialization(), fmi2OK);
    assert_eq!(host.terminate(), fmi2OK);
    assert_eq!(host.restore(saved), fmi2OK);
    assert_eq!(host.set_real(GAIN, 3.0), fmi2OK, "back in initialization mode");
    assert_eq!(host.exit_initialization(), fmi2OK);
}

/// The state saved last shares the memory of the present one until that changes.
#[test]
fn states_stay_what_they_were_whatever_is_saved_restored_overwritten_and_freed_meanwhile() {
    const ROUNDS: u32 = if cfg!(miri) { 100 } else { 3000 };
    let host = Host::initialized();
    let mut held: Vec<(fmi2FMUstate, f64, _)> = Vec::new();
    let (mut time, mut random) = (0.0, fmu_host::Random::seeded(1));
    for round in 0..ROUNDS {
        let k = random.below(held.len());
        match random.below(8) {
            0 | 1 => held.push((host.save(), time, fingerprint(&host))),
            2 if !held.is_empty() => {
                let token = held[k].0;
                assert_eq!(host.save_in(&mut held[k].0), fmi2OK);
                assert_eq!(held[k].0, token, "a state given back is overwritten in place");
                (held[k].1, held[k].2) = (time, fingerprint(&host));
            }
            3 | 4 if !held.is_empty() => {
                assert_eq!(host.restore(held[k].0), fmi2OK);
                time = held[k].1;
                assert_eq!(fingerprint(&host), held[k].2, "round {round}");
            }
            5 if held.len() > 5 => {
                let mut freed = held.swap_remove(k).0;
                assert_eq!(host.free_state(&mut freed), fmi2OK);
            }
            _ => {
                assert_eq!(host.set_real(INPUT, time.sin() + f64::from(round)), fmi2OK);
                assert_eq!(host.step(time, 0.5), fmi2OK);
                time += 0.5;
            }
        }
    }
    assert!(held.len() > 5);
}

#[test]
fn going_from_one_state_to_another_copies_nothing() {
    let host = busy_host();
    let mut held = Vec::new();
    for k in 0..4 {
        held.push((host.save(), fingerprint(&host)));
        assert_eq!(host.step(0.3 + 0.1 * f64::from(k), 0.1), fmi2OK);
    }
    PANIC_IN_CLONE.set(true);
    for k in [0, 3, 1, 1, 2, 0, 3] {
        assert_eq!(host.restore(held[k].0), fmi2OK);
        assert_eq!(fingerprint(&host), held[k].1, "{k}");
    }
    PANIC_IN_CLONE.set(false);
    for (state, here) in held {
        assert_eq!(host.restore(state), fmi2OK);
        assert_eq!(host.step(host.real(TIME), 0.1), fmi2OK);
        assert_eq!(host.restore(state), fmi2OK);
        assert_eq!(fingerprint(&host), here);
    }
}

#[test]
fn states_that_are_foreign_stale_or_null_are_refused() {
    let host = Host::initialized();
    let mut freed = host.save();
    let again = freed;
    unsafe {
        assert_eq!(fmi2FreeFMUstate(host.component, &raw mut freed), fmi2OK);
        assert!(freed.is_null(), "FreeFMUstate nulls the pointer");
        assert_eq!(fmi2FreeFMUstate(host.component, &raw mut freed), fmi2OK, "NULL is ignored");
        assert_eq!(fmi2FreeFMUstate(host.component, null_mut()), fmi2OK, "NULL is ignored");
    }
    let other = Host::initialized();
    let fresh = host.save();
    assert_ne!(fresh, again, "a token is never given out twice");
    let foreign = other.save();
    for bad in [again, foreign, dangling_mut(), without_provenance_mut(usize::MAX)] {
        let host = Host::initialized();
        host.refused(host.restore(bad), "is no FMU state of this instance");
        let mut bad = bad;
        let (mut size, mut bytes) = (0, [0; 512]);
        unsafe {
            assert_eq!(fmi2FreeFMUstate(host.component, &raw mut bad), fmi2Error);
            assert_eq!(fmi2GetFMUstate(host.component, &raw mut bad), fmi2Error);
            assert_eq!(fmi2SerializedFMUstateSize(host.component, bad, &raw mut size), fmi2Error);
            assert_eq!(fmi2SerializeFMUstate(host.component, bad, bytes.as_mut_ptr(), 512), fmi2Error);
        }
    }
    host.refused(host.restore(null_mut()), "fmi2SetFMUstate: argument FMUstate is NULL");
    assert_eq!(unsafe { fmi2GetFMUstate(host.component, null_mut()) }, fmi2Error);
    assert_eq!(host.restore(fresh), fmi2OK, "the right one still works");
}

#[test]
fn a_serialised_state_runs_on_in_another_instance() {
    let host = busy_host();
    let bytes = host.serialize(host.save());
    run_on(&host);
    let other = Host::new();
    let mut state = null_mut();
    assert_eq!(other.deserialize(&bytes, &mut state), fmi2OK);
    assert_eq!(other.serialize(state), bytes, "the bytes are the same again");
    assert_eq!(other.restore(state), fmi2OK);
    run_on(&other);
    assert_eq!(fingerprint(&other), fingerprint(&host));
    let before = state;
    assert_eq!(other.deserialize(&bytes, &mut state), fmi2OK);
    assert_eq!(state, before, "a state given back is overwritten");
}

#[test]
fn damaged_truncated_and_foreign_bytes_are_refused() {
    let host = busy_host();
    let good = host.serialize(host.save());
    let refused = |bytes: &[fmi2Byte], what: &str| {
        let mut state = null_mut();
        assert_eq!(host.deserialize(bytes, &mut state), fmi2Error, "{what}");
        assert!(state.is_null(), "{what}");
        assert!(host.error().contains("the serialised state is refused"), "{what}");
    };
    // Each bit and each length: the unit tests of the envelope.
    let mut damaged = good.clone();
    damaged[good.len() / 2] ^= 0x10;
    refused(&damaged, "a bit");
    refused(&good[..good.len() - 1], "a byte too few");
    refused(&[good.as_slice(), &[0]].concat(), "a byte too many");
    refused(&vec![0; good.len()], "zeros");
    let mut state = null_mut();
    unsafe {
        assert_eq!(fmi2DeSerializeFMUstate(host.component, null(), 10, &raw mut state), fmi2Error);
        assert_eq!(fmi2DeSerializeFMUstate(host.component, good.as_ptr(), good.len(), null_mut()), fmi2Error);
    }
    assert_eq!(host.deserialize(&good, &mut state), fmi2OK);
}

/// What the exporter keeps about a model: call state, model exchange, time and that of the last event, whether something was set,
/// experiment, and status, time and end of the last step.
type Record = (CallState, bool, [f64; 2], bool, Option<Experiment>, (fmi2Status, Option<f64>, bool));

/// A serialised state with `change` made to its record, and length and checksum that are right again.
fn changed(good: &[fmi2Byte], change: impl FnOnce(&mut Record)) -> Vec<fmi2Byte> {
    const HEADER: usize = 36;
    const CHECKSUM: usize = 8;
    let bytes: Vec<u8> = good.iter().map(|byte| byte.to_ne_bytes()[0]).collect();
    let content = &bytes[HEADER..bytes.len() - CHECKSUM];
    let (mut record, model): (Record, _) = postcard::take_from_bytes(content).expect("a record");
    change(&mut record);
    let content = [&postcard::to_stdvec(&record).expect("bytes"), model].concat();
    let mut bytes = [&bytes[..HEADER - 8], &(content.len() as u64).to_le_bytes(), &content].concat();
    // FNV-1a
    let step = |hash: u64, &byte: &u8| (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
    bytes.extend(bytes.iter().fold(0xcbf2_9ce4_8422_2325, step).to_le_bytes());
    bytes.into_iter().map(|byte| fmi2Byte::from_ne_bytes([byte])).collect()
}

/// A number that switches checks off, or that no call leads to, behind a checksum that is right.
#[test]
fn bytes_that_are_intact_but_tell_of_no_possible_state_are_refused() {
    let host = busy_host();
    let good = host.serialize(host.save());
    assert_eq!(host.deserialize(&changed(&good, |_| ()), &mut null_mut()), fmi2OK, "the checksum is right");
    let refused = |what: &str, change: &dyn Fn(&mut Record)| {
        let mut state = null_mut();
        assert_eq!(host.deserialize(&changed(&good, change), &mut state), fmi2Error, "{what}");
        let error = host.error();
        assert!(state.is_null() && error.contains(what), "{what}: {error}");
    };
    let experiment = Experiment { start_time: 0.0, stop_time: None, tolerance: None };
    for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        refused(&format!("time = {value}"), &|record| record.2[0] = value);
        let start = Experiment { start_time: value, ..experiment };
        refused(&format!("startTime = {value}"), &|record| record.4 = Some(start));
        refused(&format!("last successful time = {value}"), &|record| record.5.1 = Some(value));
    }
    for value in [f64::NAN, f64::INFINITY] {
        refused(&format!("the last event was at {value} s"), &|record| record.2[1] = value);
    }
    for value in [f64::NAN, -1.0] {
        let stop = Experiment { stop_time: Some(value), ..experiment };
        refused(&format!("stopTime = {value}"), &|record| record.4 = Some(stop));
    }
    for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -1.0] {
        let tolerance = Experiment { tolerance: Some(value), ..experiment };
        refused(&format!("tolerance = {value}"), &|record| record.4 = Some(tolerance));
    }
    refused("77 is no status of a step", &|record| record.5.0 = 77);
}

#[test]
fn call_states_that_are_never_saved_are_refused() {
    use CallState::*;
    let of_steps = [StepComplete, StepFailed];
    let of_exchange = [EventMode, ContinuousTimeMode];
    for (host, wrong) in [(Host::initialized(), of_exchange), (Host::exchanging(), of_steps)] {
        let good = host.serialize(host.save());
        for state in CallState::ALL {
            let bytes = changed(&good, |record| record.0 = state);
            let refused = wrong.contains(&state)
                || matches!(state, StepInProgress | StepCanceled | Fatal | StepMode | IntermediateUpdateMode);
            let status = host.deserialize(&bytes, &mut null_mut());
            assert_eq!(status, if refused { fmi2Error } else { fmi2OK }, "{state}");
            assert!(!refused || host.error().contains(&format!("no state that is saved is in state {state}")));
        }
    }
}

#[test]
fn a_buffer_that_is_too_small_or_null_is_refused_and_untouched() {
    let host = busy_host();
    let state = host.save();
    let size = host.serialize(state).len();
    let mut buffer = vec![0x55; size];
    let c = host.component;
    assert_eq!(unsafe { fmi2SerializeFMUstate(c, state, buffer.as_mut_ptr(), size - 1) }, fmi2Error);
    assert!(buffer.iter().all(|b| *b == 0x55));
    assert!(host.error().contains(&format!("size = {}: the state takes {size} bytes", size - 1)));
    assert_eq!(unsafe { fmi2SerializeFMUstate(c, state, null_mut(), size) }, fmi2Error);
    assert_eq!(unsafe { fmi2SerializedFMUstateSize(c, state, null_mut()) }, fmi2Error);
}
