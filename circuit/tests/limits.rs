//! Limits in which a cycle has a closed form.
#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

mod common;

use approx::assert_relative_eq;
use common::{C2, C3, TOPOLOGIES, U, node, pulse, run, steady_cycle};
use videg_circuit::{Circuit, Parameters, Release, Topology, formulas};

fn parameters(topology: Topology, release: Release, zener: f64, resistance: f64) -> Parameters {
    Parameters { zener_voltage: zener, load_resistance: resistance, topology, release, ..Parameters::default() }
}

const RELEASES: [Release; 2] = [Release::Zener, Release::Switch];

#[test]
fn a_fast_discharge_moves_dq_and_gains_nothing_at_the_supply_voltage() {
    for topology in TOPOLOGIES {
        for release in RELEASES {
            let ledger = steady_cycle(parameters(topology, release, U, 1e6)).1;
            let charge = formulas::cycle_charge(U, C2, C3);
            assert_relative_eq!(ledger.load_charge, charge, max_relative = 1e-9);
            assert_relative_eq!(ledger.supply_charge, charge, max_relative = 1e-9);
            assert_relative_eq!(ledger.supply, 2.0 * formulas::eq13_energy(U, C2, C3), max_relative = 1e-9);
            assert!(ledger.mechanical.abs() < 1e-4 * ledger.supply, "{ledger:?}");
        }
    }
}

#[test]
fn a_release_at_the_zener_voltage_converts_the_formula() {
    for topology in TOPOLOGIES {
        for release in RELEASES {
            let (c2, c3) = node(topology);
            let zener = formulas::best_release_voltage(U, c2, c3);
            let ledger = steady_cycle(parameters(topology, release, zener, 1e4)).1;
            let gain = formulas::release_net_gain(U, zener, c2, c3);
            assert_relative_eq!(ledger.converted(), gain, max_relative = 1e-5);
            assert_relative_eq!(gain, formulas::best_release_net_gain(U, c2, c3), max_relative = 1e-12);
            // The switch hands all of it to the user, the Zener burns more than that.
            if release == Release::Switch {
                assert_relative_eq!(ledger.surplus(), gain, max_relative = 1e-5);
            } else {
                assert!(ledger.surplus() < -0.9 * ledger.supply);
            }
        }
    }
}

#[test]
fn constant_charge_reaches_u_de4_and_then_gains_the_most() {
    for topology in TOPOLOGIES {
        let (c2, c3) = node(topology);
        // The pulse is far too quick for this load, and the rest is long enough.
        let parameters = parameters(topology, Release::Switch, U, 1e12);
        let mut circuit = Circuit::new(parameters, [C2; 2]).unwrap();
        circuit.advance(1e-9, [C3, C2]).unwrap();
        circuit.advance(1e-9, [C2, C2]).unwrap();
        let peak = match topology {
            Topology::SharedNode => formulas::peak_voltage_shared_node(U, C2, C3),
            Topology::Isolated => formulas::peak_voltage(U, C2, C3),
        };
        assert_relative_eq!(circuit.voltage()[0], peak, max_relative = 1e-9);
        circuit.advance(1e4, [C2, C2]).unwrap();
        let ledger = circuit.ledger();
        assert_relative_eq!(ledger.surplus(), formulas::largest_net_gain(U, c2, c3), max_relative = 1e-8);
        assert_relative_eq!(ledger.stored, 0.0, epsilon = 1e-15);
    }
}

#[test]
fn an_infinite_load_never_releases() {
    for topology in TOPOLOGIES {
        for release in RELEASES {
            let parameters = parameters(topology, release, U, f64::INFINITY);
            let mut circuit = Circuit::new(parameters, [C2; 2]).unwrap();
            run(&mut circuit, &pulse([C2; 2], C3 - C2, 0.03, 0.25, 50));
            let ledger = circuit.ledger();
            let (c2, c3) = node(topology);
            assert_eq!((ledger.load_charge, ledger.load, ledger.zener), (0.0, 0.0, 0.0));
            assert_relative_eq!(circuit.voltage()[0], U * c3 / c2, max_relative = 1e-13);
            let drop = if release == Release::Zener { U } else { 0.0 };
            assert_relative_eq!(circuit.load_voltage(), U * c3 / c2 - drop, max_relative = 1e-12);
            // The second pulse runs along the first one's path: nothing more is drawn.
            run(&mut circuit, &pulse([C2; 2], C3 - C2, 0.03, 0.25, 50));
            assert_relative_eq!(circuit.ledger().supply_charge, ledger.supply_charge, max_relative = 1e-13);
        }
    }
}

#[test]
fn a_load_of_zero_ohm_clamps_at_the_zener_voltage() {
    for topology in TOPOLOGIES {
        for release in RELEASES {
            let (c2, c3) = node(topology);
            let zener = 1.1 * U;
            let parameters = parameters(topology, release, zener, 0.0);
            let mut circuit = Circuit::new(parameters, [C2; 2]).unwrap();
            run(&mut circuit, &pulse([C2; 2], C3 - C2, 0.03, 0.25, 50));
            let ledger = circuit.ledger();
            let passed = c3 * U - c2 * zener;
            assert_relative_eq!(circuit.voltage()[0], zener, max_relative = 1e-14);
            assert_relative_eq!(ledger.load_charge, passed, max_relative = 1e-12);
            let (load, burnt) = if release == Release::Zener { (0.0, zener * passed) } else { (zener * passed, 0.0) };
            assert_relative_eq!(ledger.load, load, max_relative = 1e-12);
            assert_relative_eq!(ledger.zener, burnt, max_relative = 1e-12);
            assert_eq!(circuit.load_voltage(), 0.0);
        }
    }
}

#[test]
fn a_duty_cycled_switch_passes_the_current_that_holds_the_voltage() {
    let parameters = parameters(Topology::SharedNode, Release::Switch, U, 1e9);
    let mut circuit = Circuit::new(parameters, [C3, C2]).unwrap();
    circuit.advance(0.1, [C2, C2]).unwrap();
    let current = U * (C3 - C2) / 0.1;
    assert_relative_eq!(circuit.voltage()[0], U, max_relative = 1e-15);
    assert_relative_eq!(circuit.load_current(), current, max_relative = 1e-12);
    assert_relative_eq!(circuit.load_voltage(), current * 1e9, max_relative = 1e-12);
    assert_relative_eq!(circuit.ledger().load, U * current * 0.1, max_relative = 1e-12);
    assert_eq!(circuit.events(), 1);
}

#[test]
fn two_switches_share_one_load_in_time() {
    // Each alone could be held (1.2 uA against 2 uA), both together cannot.
    let parameters = parameters(Topology::Isolated, Release::Switch, U, 1e9);
    let mut circuit = Circuit::new(parameters, [27e-12; 2]).unwrap();
    circuit.advance(0.01, [21e-12, 27e-12]).unwrap();
    assert_relative_eq!(circuit.voltage()[0], U, max_relative = 1e-14);
    circuit.advance(0.01, [15e-12, 21e-12]).unwrap();
    assert!(circuit.voltage()[0] > U);
    assert_relative_eq!(circuit.load_current() * 1e9, circuit.voltage()[0], max_relative = 1e-12);
}

#[test]
fn a_blocked_membrane_keeps_its_charge_until_it_meets_the_leader() {
    let parameters = parameters(Topology::Isolated, Release::Zener, U, 1e9);
    let mut circuit = Circuit::new(parameters, [27e-12, 18e-12]).unwrap();
    circuit.advance(0.0, [15e-12; 2]).unwrap();
    assert_relative_eq!(circuit.voltage()[0], 3600.0, max_relative = 1e-12);
    assert_relative_eq!(circuit.voltage()[1], 2400.0, max_relative = 1e-12);
    // w falls from 1600 V to 400 V in RC ln 4.
    let meeting = 0.015 * 4.0_f64.ln();
    circuit.advance(0.99 * meeting, [15e-12; 2]).unwrap();
    assert_relative_eq!(circuit.voltage()[1], 2400.0, max_relative = 1e-12);
    assert_eq!(circuit.state().releasing, [true, false]);
    circuit.advance(0.02 * meeting, [15e-12; 2]).unwrap();
    assert_eq!(circuit.state().releasing, [true, true]);
    let w = 400.0 * (-0.01 * meeting / 0.030).exp();
    assert_relative_eq!(circuit.load_voltage(), w, max_relative = 1e-12);
    assert_relative_eq!(circuit.voltage()[0], circuit.voltage()[1], max_relative = 1e-14);
}

#[test]
fn membranes_far_above_the_zener_still_find_the_supply_within_one_step() {
    // The discharge takes picoseconds of a step of 73 ms; then the left membrane has to be topped up.
    let parameters = parameters(Topology::Isolated, Release::Zener, U, 0.094_307_529_448_023_5);
    let mut circuit = Circuit::new(parameters, [1e-10; 2]).unwrap();
    circuit.advance(0.0, [6.4e-13, 7.9e-13]).unwrap();
    circuit.advance(0.0734, [6.7e-13, 3.4e-13]).unwrap();
    assert_relative_eq!(circuit.ledger().supply_charge, U * 0.3e-13, max_relative = 1e-9);
}
