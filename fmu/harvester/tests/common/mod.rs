//! The slave driven without the C interface, and through it (`host`).
#![allow(dead_code, clippy::expect_used)] // each test file uses its part; helpers fail a test, too

pub mod differences;
pub mod host;

use VibroImpactHarvester::Harvester;
use fmu_export::{Causality, Experiment, Kind, Logger, Slave, Variable, value_reference};

/// Row of the variable table.
pub fn row(name: &str) -> &'static Variable<Harvester> {
    let reference = value_reference(Harvester::variables(), name).expect(name);
    &Harvester::variables()[reference as usize]
}

/// A slave with start values, and these Reals set.
pub fn fresh(reals: &[(&str, f64)]) -> Harvester {
    fresh_at(0.0, reals)
}

/// The same for a run that starts at `start_time`, s.
pub fn fresh_at(start_time: f64, reals: &[(&str, f64)]) -> Harvester {
    let mut slave = Harvester::new();
    for (name, value) in reals {
        set(&mut slave, name, *value);
    }
    let experiment = Experiment { start_time, stop_time: None, tolerance: None };
    slave.setup_experiment(&experiment, &Logger::silent()).expect("an experiment");
    slave.update();
    slave
}

/// An initialised slave.
pub fn initialized(reals: &[(&str, f64)]) -> Harvester {
    let mut slave = fresh(reals);
    slave.initialize(&Logger::silent()).expect("parameters");
    slave
}

pub fn set(slave: &mut Harvester, name: &str, value: f64) {
    match row(name).kind() {
        Kind::Real(spec) => spec.set.expect("a setter").set(slave, value),
        _ => unreachable!("{name} is no Real"),
    }
}

/// Sets an item of an enumeration.
pub fn choose(slave: &mut Harvester, name: &str, item: i32) {
    match row(name).kind() {
        Kind::Enumeration(spec) => spec.set.expect("a setter").set(slave, item),
        _ => unreachable!("{name} is no enumeration"),
    }
}

pub fn get(slave: &Harvester, name: &str) -> f64 {
    match row(name).kind() {
        Kind::Real(spec) => spec.get.get(slave),
        Kind::Integer(spec) => i32::try_from(spec.get.get(slave)).expect("a small number").into(),
        Kind::Boolean(spec) => f64::from(u8::from(spec.get.get(slave))),
        Kind::Clock(spec) => f64::from(u8::from(spec.get.get(slave))),
        Kind::Enumeration(spec) => f64::from(spec.get.get(slave)),
        Kind::String(_) => unreachable!("{name} is a text"),
    }
}

pub fn step(slave: &mut Harvester, t: f64, h: f64) {
    slave.do_step(t, h, &Logger::silent()).expect("a step");
}

/// Every output, bit for bit.
pub fn outputs(slave: &Harvester) -> Vec<u64> {
    let outputs = Harvester::variables().iter().filter(|v| v.causality() == Causality::Output);
    outputs.map(|v| get(slave, v.name()).to_bits()).collect()
}
