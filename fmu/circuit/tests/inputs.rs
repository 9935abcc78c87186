//! Capacitances that a master has not handed over yet.
#![allow(clippy::expect_used)] // helpers outside of #[test] functions fail a test, too

use HarvestingCircuit::Harvesting;
use fmu_export::{Logger, Slave};
use fmu_host::slave::{self, get, set, step};

const INPUTS: [&str; 2] = ["left.capacitance", "right.capacitance"];

fn inputs(slave: &Harvesting) -> [f64; 2] {
    INPUTS.map(|name| get(slave, name))
}

/// All outputs after initialisation and after each step.
fn outputs(slave: &mut Harvesting, capacitances: [[f64; 2]; 3]) -> Vec<Vec<u64>> {
    let mut at = |k: usize, capacitance| {
        for (name, value) in INPUTS.into_iter().zip(capacitance) {
            set(slave, name, value);
        }
        if k == 0 {
            slave.update();
            slave.initialize(&Logger::silent()).expect("initial values");
        } else {
            step(slave, 1e-3 * k as f64, 1e-3);
        }
        slave::outputs(slave)
    };
    capacitances.into_iter().enumerate().map(|(k, capacitance)| at(k, capacitance)).collect()
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
