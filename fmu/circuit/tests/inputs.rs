//! Capacitances that a master has not handed over yet.
#![allow(clippy::expect_used)] // helpers outside of #[test] functions fail a test, too

use HarvestingCircuit::Harvesting;
use fmu_export::{Causality, Kind, Logger, RealSpec, Slave};

const INPUTS: [&str; 2] = ["left.capacitance", "right.capacitance"];

/// The real variables that `is` says.
fn reals(is: impl Fn(&str, Causality) -> bool) -> impl Iterator<Item = &'static RealSpec<Harvesting>> {
    Harvesting::variables().iter().filter_map(move |row| match row.kind() {
        Kind::Real(spec) if is(row.name(), row.causality()) => Some(spec),
        _ => None,
    })
}

fn inputs(slave: &Harvesting) -> Vec<f64> {
    reals(|_, causality| causality == Causality::Input).map(|spec| spec.get.get(slave)).collect()
}

fn set(slave: &mut Harvesting, capacitance: [f64; 2]) {
    for (name, value) in INPUTS.into_iter().zip(capacitance) {
        reals(|it, _| it == name).for_each(|spec| spec.set.expect("a setter").set(slave, value));
    }
}

/// All outputs after initialisation and after each step.
fn outputs(slave: &mut Harvesting, capacitances: [[f64; 2]; 3]) -> Vec<Vec<f64>> {
    let log = Logger::silent();
    let mut step = |k: usize, capacitance| {
        set(slave, capacitance);
        if k == 0 {
            slave.update();
            slave.initialize(&log).expect("initial values");
        } else {
            slave.do_step(1e-3 * k as f64, 1e-3, &log).expect("a step");
        }
        reals(|_, causality| causality == Causality::Output).map(|spec| spec.get.get(slave)).collect()
    };
    capacitances.into_iter().enumerate().map(|(k, capacitance)| step(k, capacitance)).collect()
}

/// As from masters that start all signals at 0.
#[test]
fn a_capacitance_of_zero_means_that_none_has_been_handed_over() {
    let [mut unknown, mut known] = [Harvesting::new(), Harvesting::new()];
    let rest = inputs(&unknown)[1];
    let found = outputs(&mut unknown, [[20e-12, 0.0], [0.0; 2], [0.0, 16e-12]]);
    assert_eq!(found, outputs(&mut known, [[20e-12, rest], [20e-12, rest], [20e-12, 16e-12]]));
    assert_ne!(found[1], found[2], "a change of the capacitance acts");
    assert_eq!(inputs(&unknown), [20e-12, 16e-12]);
}
