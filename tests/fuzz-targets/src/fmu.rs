//! What the targets of both FMUs share: serialised states, and calls of the C functions.

use fmu_export::{Experiment, Logger, Slave, StateReader, StateWriter};
use fmu_host::{Fmu, run_tape};

/// What the FMUs say of themselves.
pub const HARVESTER: &str = include_str!("../../../modelDescription/VibroImpactHarvester.xml");
/// As above.
pub const CIRCUIT: &str = include_str!("../../../modelDescription/HarvestingCircuit.xml");
/// The same of FMI 3.0.
pub(crate) const OF_FMI_3: [&str; 2] = [
    include_str!("../../../modelDescription/fmi3/HarvestingCircuit.xml"),
    include_str!("../../../fmu/import/src/testdata/good3.xml"),
];
/// A model description of a few lines, with variables of all types.
pub(crate) const SMALL_DESCRIPTION: &str = include_str!("../../../fmu/import/src/testdata/good.xml");

/// Communication step, s, and number of steps that a restored slave must go on for.
const STEP: f64 = 0.01;
const STEPS: u32 = 20;
/// Calls of a tape to start from, bytes.
const TAPE: usize = 400;

fn written<S: Slave>(slave: &S) -> Vec<u8> {
    let mut out = StateWriter::default();
    slave.write_state(&mut out).unwrap_or_else(|error| panic!("not written: {error}"));
    out.into_bytes()
}

/// A state, as it stands behind its checksum, that is taken must be one that can be lived with: written back it has the
/// same bytes from then on, and a step succeeds or says why not. Whether it was taken.
///
/// # Panics
/// If it is not.
pub fn state<S: Slave>(content: &[u8]) -> bool {
    let mut reader = StateReader::new(content);
    let Ok(mut slave) = S::read_state(&mut reader, &S::new()) else { return false };
    if reader.finish().is_err() {
        return false;
    }
    let bytes = written(&slave);
    let again =
        S::read_state(&mut StateReader::new(&bytes), &slave).unwrap_or_else(|error| panic!("refused again: {error}"));
    assert_eq!(written(&again), bytes);
    for k in 0..STEPS {
        // A step from before the time of the state is refused, one from there goes on.
        let _ = slave.do_step(f64::from(k) * STEP, STEP, &Logger::silent());
    }
    true
}

/// States at the start and after some steps.
pub fn states<S: Slave>() -> Vec<Vec<u8>> {
    let (mut slave, log) = (S::new(), Logger::silent());
    let experiment = Experiment { start_time: 0.0, stop_time: None, tolerance: None };
    let mut states = vec![written(&slave)];
    if slave.setup_experiment(&experiment, &log).is_err() || slave.initialize(&log).is_err() {
        return states;
    }
    for k in 0..STEPS {
        states.push(written(&slave));
        if slave.do_step(f64::from(k) * STEP, STEP, &log).is_err() {
            break;
        }
    }
    states
}

/// The C functions in any order and with any arguments: each answer must be what the tables of FMI 2.0 say.
///
/// # Panics
/// If one is not.
pub fn calls(fmu: &Fmu, tape: &[u8]) -> bool {
    run_tape(fmu, tape).unwrap_or_else(|what| panic!("{what}"));
    true
}

/// Tapes of calls, from a generator.
pub fn tapes() -> Vec<Vec<u8>> {
    let tape = |seed| {
        let mut random = fmu_host::Random::seeded(seed);
        (0..TAPE).map(|_| random.bits().to_le_bytes()[0]).collect()
    };
    (0..8).map(tape).collect()
}
