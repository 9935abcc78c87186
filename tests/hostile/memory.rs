//! What comes in through the library, not the command line: serialised states, and raw files that ngspice should have left.

use fmu_import::{Fmu, FmuState, Instance, Logging};
use videg::ngspice::RawReader;
use videg::package::{Options, build_all};

use super::instance;
use super::sandbox::{Given, Input};

const DESERIALIZE: &str = "Instance::deserialize_state";

/// A harvester after one step, its state, and that as bytes.
fn saved() -> (Instance, FmuState, Vec<u8>) {
    let fmu = Fmu::open(&build_all(&Options::default()).unwrap()[0]).unwrap();
    let mut instance = instance::initialised(&fmu, "harvester", Logging::default(), &[]);
    instance.do_step(0.0, 0.3).unwrap();
    let state = instance.save_state().unwrap();
    let bytes = instance.serialize_state(&state).unwrap();
    (instance, state, bytes)
}

/// What the harvester says to a state that was changed.
fn state(change: impl FnOnce(&mut Vec<u8>)) -> String {
    let (mut instance, state, mut bytes) = saved();
    let whole = bytes.len().to_string();
    change(&mut bytes);
    let told = match instance.deserialize_state(&bytes) {
        Ok(_) => panic!("a changed state was taken"),
        Err(error) => error.to_string(),
    };
    // No harm is done.
    instance.restore_state(&state).unwrap();
    instance.do_step(0.3, 0.3).unwrap();
    // The size of a state is that of this version.
    let given = bytes.len().to_string();
    if given.len() < 2 { told } else { told.replace(&given, "(given)").replace(&whole, "(whole)") }
}

fn raw(bytes: &[u8]) -> String {
    let read = || {
        let mut reader = RawReader::new(bytes)?;
        let mut values = Vec::new();
        while reader.next_point(&mut values)? {}
        Ok::<_, videg::ngspice::RawError>(())
    };
    read().unwrap_err().to_string()
}

fn raw_file(variables: &str, points: &str, numbers: &[f64]) -> Vec<u8> {
    let header = format!(
        "Title: a title\nFlags: real\nNo. Variables: {variables}\nNo. Points: {points}\nVariables:\n\t0\ttime\ttime\n\
         \t1\tv(de)\tvoltage\nBinary:\n"
    );
    header.bytes().chain(numbers.iter().flat_map(|number| number.to_le_bytes())).collect()
}

fn call(what: &'static str, name: &'static str, call: fn() -> String) -> Input {
    Input { what, given: Given::Call(name, call), code: 0 }
}

/// All of them.
pub fn inputs() -> Vec<Input> {
    vec![
        call("an empty state", DESERIALIZE, || state(Vec::clear)),
        call("half of a state", DESERIALIZE, || state(|bytes| bytes.truncate(bytes.len() / 2))),
        call("a state and one byte", DESERIALIZE, || state(|bytes| bytes.push(0))),
        call("a bit of a state changed", DESERIALIZE, || {
            state(|bytes| {
                let middle = bytes.len() / 2;
                bytes[middle] ^= 1;
            })
        }),
        call("a state of ones", DESERIALIZE, || state(|bytes| bytes.fill(0xff))),
        call("an empty raw file", "RawReader", || raw(b"")),
        call("a line without end", "RawReader", || raw(&[b'x'; 100_000])),
        call("2^60 variables", "RawReader", || raw(&raw_file("1152921504606846976", "1", &[]))),
        call("2^60 points", "RawReader", || raw(&raw_file("2", "1152921504606846976", &[]))),
        call("points that are not there", "RawReader", || raw(&raw_file("2", "1000000000", &[0.0, 1.0]))),
        call("no number", "RawReader", || raw(&raw_file("2", "1", &[0.0, f64::NAN]))),
        call("more variables than lines", "RawReader", || raw(&raw_file("3", "1", &[]))),
    ]
}
