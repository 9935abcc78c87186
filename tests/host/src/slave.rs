//! A slave that is driven without the C interface, its variables by name.
#![allow(clippy::expect_used, clippy::panic, clippy::missing_panics_doc)] // as in a test

use fmu_export::{
    Causality, Experiment, Kind, Logger, Slave, StateError, StateReader, StateWriter, Variable, value_reference,
};

/// Row of the variable table.
pub fn row<S: Slave>(name: &str) -> &'static Variable<S> {
    let reference = value_reference(S::variables(), name).expect(name);
    &S::variables()[reference as usize]
}

/// Names of the parameters but for texts: the Reals, then those that choose or count, each in the order of the table.
pub fn parameters<S: Slave>() -> Vec<&'static str> {
    let is_text = |row: &Variable<S>| matches!(row.kind(), Kind::String(_));
    let rows = S::variables().iter().filter(|row| row.causality() == Causality::Parameter && !is_text(row));
    let (reals, others): (Vec<_>, Vec<_>) = rows.partition(|row| matches!(row.kind(), Kind::Real(_)));
    reals.into_iter().chain(others).map(Variable::name).collect()
}

/// Sets a Real, an item of an enumeration, or a Boolean, which is true unless the value is 0.
pub fn set<S: Slave>(slave: &mut S, name: &str, value: f64) {
    match row::<S>(name).kind() {
        Kind::Real(spec) => spec.set.expect("a setter").set(slave, value),
        Kind::Boolean(spec) => spec.set.expect("a setter").set(slave, value != 0.0),
        #[allow(clippy::cast_possible_truncation)]
        Kind::Enumeration(spec) => spec.set.expect("a setter").set(slave, value as i32),
        _ => panic!("{name} is no Real, Boolean or enumeration"),
    }
}

/// Sets a String.
pub fn set_text<S: Slave>(slave: &mut S, name: &str, text: &str) {
    match row::<S>(name).kind() {
        Kind::String(spec) => spec.set.expect("a setter").set(slave, text.to_owned()),
        _ => panic!("{name} is no String"),
    }
}

/// Value of a variable that is no String.
pub fn get<S: Slave>(slave: &S, name: &str) -> f64 {
    match row::<S>(name).kind() {
        Kind::Real(spec) => spec.get.get(slave),
        Kind::Integer(spec) => i32::try_from(spec.get.get(slave)).expect("a small number").into(),
        Kind::Boolean(spec) => f64::from(u8::from(spec.get.get(slave))),
        Kind::Clock(spec) => f64::from(u8::from(spec.get.get(slave))),
        Kind::Enumeration(spec) => f64::from(spec.get.get(slave)),
        Kind::String(_) => panic!("{name} is a text"),
    }
}

/// A slave with start values, and these set.
pub fn fresh<S: Slave>(settings: &[(&str, f64)]) -> S {
    let mut slave = S::new();
    for (name, value) in settings {
        set(&mut slave, name, *value);
    }
    let experiment = Experiment { start_time: 0.0, stop_time: None, tolerance: None };
    slave.setup_experiment(&experiment, &Logger::silent()).expect("an experiment");
    slave.update();
    slave
}

/// An initialised slave.
pub fn initialized<S: Slave>(settings: &[(&str, f64)]) -> S {
    let mut slave: S = fresh(settings);
    slave.initialize(&Logger::silent()).expect("parameters");
    slave
}

/// A step of `h` from `t`, both in s.
pub fn step<S: Slave>(slave: &mut S, t: f64, h: f64) {
    slave.do_step(t, h, &Logger::silent()).expect("a step");
}

/// Every output, bit for bit.
pub fn outputs<S: Slave>(slave: &S) -> Vec<u64> {
    let outputs = S::variables().iter().filter(|row| row.causality() == Causality::Output);
    outputs.map(|row| get(slave, row.name()).to_bits()).collect()
}

/// Its state, serialised.
pub fn bytes<S: Slave>(slave: &S) -> Vec<u8> {
    let mut out = StateWriter::default();
    slave.write_state(&mut out).expect("bytes");
    out.into_bytes()
}

/// A slave with this state, as an instance takes it whose slave is `present`.
///
/// # Errors
/// What is wrong with the bytes.
pub fn restored<S: Slave>(bytes: &[u8], present: &S) -> Result<S, StateError> {
    let mut reader = StateReader::new(bytes);
    let slave = S::read_state(&mut reader, present)?;
    reader.finish()?;
    Ok(slave)
}
