//! What several targets share.

use std::path::PathBuf;

use fmi2_export::{Experiment, Logger, Slave, StateReader, StateWriter};

/// Communication step, s, and number of steps that a restored slave must go on for.
const STEP: f64 = 0.01;
const STEPS: u32 = 20;

fn written<S: Slave>(slave: &S) -> Vec<u8> {
    let mut out = StateWriter::new();
    slave.write_state(&mut out);
    out.into_bytes()
}

/// A state that is taken must be one that can be lived with: written back it has the same bytes from then on, and a step
/// succeeds or says why not.
///
/// # Panics
/// If it is not.
pub fn state<S: Slave>(content: &[u8]) {
    let mut reader = StateReader::new(content);
    let Ok(mut slave) = S::read_state(&mut reader) else { return };
    if reader.finish().is_err() {
        return;
    }
    let bytes = written(&slave);
    let again = S::read_state(&mut StateReader::new(&bytes)).unwrap_or_else(|error| panic!("refused again: {error}"));
    assert_eq!(written(&again), bytes);
    for k in 0..STEPS {
        if slave.do_step(f64::from(k) * STEP, STEP, &Logger::silent()).is_err() {
            break;
        }
    }
}

/// Writes states to start from into the folder that `VIDEG_FUZZ_SEEDS` names, if it does: those at the start and after some
/// steps. They are worth writing anew when the layout of a state has changed.
///
/// # Panics
/// If a file cannot be written.
pub fn write_seeds<S: Slave>() {
    let Some(folder) = std::env::var_os("VIDEG_FUZZ_SEEDS").map(PathBuf::from) else { return };
    for (number, seed) in seeds::<S>().iter().enumerate() {
        std::fs::write(folder.join(format!("seed-{number:02}")), seed).unwrap_or_else(|error| panic!("{error}"));
    }
}

fn seeds<S: Slave>() -> Vec<Vec<u8>> {
    let mut slave = S::new();
    let log = Logger::silent();
    let experiment = Experiment { start_time: 0.0, stop_time: None, tolerance: None };
    let mut seeds = vec![written(&slave)];
    if slave.setup_experiment(&experiment, &log).is_err() || slave.initialize(&log).is_err() {
        return seeds;
    }
    for k in 0..STEPS {
        seeds.push(written(&slave));
        if slave.do_step(f64::from(k) * STEP, STEP, &log).is_err() {
            break;
        }
    }
    seeds
}
