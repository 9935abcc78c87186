//! A storage in place of Zener diode and load: the circuit that gains.
#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

mod common;

use approx::assert_relative_eq;
use common::{C2, C3, TOPOLOGIES, U, moved, node, pulse, run, steady_cycle};
use videg_circuit::{Circuit, DiodeParameters, Diodes, Parameters, Release, Topology, formulas};

fn parameters(topology: Topology, storage_voltage: f64, diodes: Diodes) -> Parameters {
    Parameters { release: Release::Storage, topology, storage_voltage, diodes, ..Parameters::default() }
}

#[test]
fn a_cycle_gains_the_closed_form_and_the_most_at_the_best_voltage() {
    for topology in TOPOLOGIES {
        let (c2, c3) = node(topology);
        let best = formulas::best_release_voltage(U, c2, c3);
        let mut gains = Vec::new();
        for voltage in [0.5 * (U + best), best - 1.0, best, best + 1.0, 0.5 * (best + U * c3 / c2)] {
            let ledger = steady_cycle(parameters(topology, voltage, Diodes::Ideal)).1;
            let expected = formulas::release_net_gain(U, voltage, c2, c3);
            // A difference of two energies, each exact to rounding.
            assert_relative_eq!(ledger.surplus(), expected, epsilon = 1e-12 * ledger.supply);
            assert_relative_eq!(ledger.load_charge, c3 * U - c2 * voltage, max_relative = 1e-12);
            assert_relative_eq!(ledger.load, voltage * ledger.load_charge, max_relative = 1e-12);
            assert_eq!((ledger.zener, ledger.diode), (0.0, 0.0));
            gains.push(ledger.surplus());
        }
        assert!(gains.iter().all(|gain| *gain <= gains[2]), "{gains:?}");
        assert_relative_eq!(gains[2], formulas::best_release_net_gain(U, c2, c3), max_relative = 1e-12);
    }
}

#[test]
fn a_storage_at_the_supply_voltage_hands_on_what_the_supply_gives() {
    for topology in TOPOLOGIES {
        let ledger = steady_cycle(parameters(topology, U, Diodes::Ideal)).1;
        assert_relative_eq!(ledger.load_charge, formulas::cycle_charge(U, C2, C3), max_relative = 1e-12);
        assert!(ledger.surplus().abs() <= 1e-12 * ledger.supply, "{ledger:?}");
    }
}

#[test]
fn a_storage_out_of_reach_gets_nothing() {
    for topology in TOPOLOGIES {
        let (c2, c3) = node(topology);
        let voltage = formulas::peak_voltage(U, c2, c3) + 1e-6;
        let (circuit, ledger) = steady_cycle(parameters(topology, voltage, Diodes::Ideal));
        assert_eq!((circuit.ledger().load_charge, circuit.load_current()), (0.0, 0.0));
        // The first pulse has charged the membranes, the later ones run to and fro at constant charge.
        assert!(ledger.supply <= 1e-12 * circuit.ledger().supply, "{ledger:?}");
        assert_eq!(circuit.load_voltage(), voltage);
    }
}

#[test]
fn the_load_resistance_and_the_zener_voltage_do_not_enter() {
    for diodes in [Diodes::Ideal, Diodes::Exponential(DiodeParameters::default())] {
        let run_with = |load_resistance, zener_voltage| {
            let base = parameters(Topology::Isolated, 2500.0, diodes);
            let parameters = Parameters { load_resistance, zener_voltage, ..base };
            let mut circuit = Circuit::new(parameters, [C2; 2]).unwrap();
            run(&mut circuit, &pulse([C2; 2], C3 - C2, 0.03, 0.25, 20));
            circuit.state()
        };
        let expected = run_with(1e9, 2000.0);
        for (load_resistance, zener_voltage) in [(0.0, 2000.0), (f64::INFINITY, 1.0), (1e3, 3000.0)] {
            assert_eq!(run_with(load_resistance, zener_voltage), expected);
        }
    }
}

#[test]
fn the_current_into_the_storage_is_that_of_a_falling_capacitance() {
    let mut circuit = Circuit::new(parameters(Topology::Isolated, 2500.0, Diodes::Ideal), [C3, C2]).unwrap();
    assert_eq!((circuit.load_voltage(), circuit.load_current()), (2500.0, 0.0));
    circuit.advance(0.1, [C2, C2]).unwrap();
    assert_relative_eq!(circuit.load_current(), 2500.0 * (C3 - C2) / 0.1, max_relative = 1e-12);
    assert_eq!(circuit.load_voltage(), 2500.0);
    assert_relative_eq!(circuit.voltage()[0], 2500.0, max_relative = 1e-15);
    assert_relative_eq!(circuit.voltage()[1], U, max_relative = 1e-15);
    // The charging diode closes, the other one opens.
    assert_eq!(circuit.events(), 2);
}

#[test]
fn near_ideal_diodes_come_to_the_closed_form_and_the_ledger_closes() {
    for topology in TOPOLOGIES {
        let (c2, c3) = node(topology);
        let best = formulas::best_release_voltage(U, c2, c3);
        for voltage in [U, best, 0.5 * (best + U * c3 / c2)] {
            let diodes = Diodes::Exponential(DiodeParameters::default());
            let (circuit, ledger) = steady_cycle(parameters(topology, voltage, diodes));
            let lost = formulas::release_net_gain(U, voltage, c2, c3) - ledger.surplus();
            // Each diode drops up to N k T / q ln(1e-6 A / IS) = 4.2 mV, so that less charge passes and loses more; from
            // each membrane the storage leaks IS.
            let (drop, leak) = (4.2e-3, 2.0 * 1e-13 * 3.0);
            let allowed = 2.0 * drop * ledger.load_charge + ((c2 + c3) * drop + leak) * (voltage - U);
            let tolerance = 1e-9 * ledger.supply;
            assert!(lost >= -tolerance && lost <= allowed, "{lost} J lost, {allowed} J allowed");
            assert!(ledger.diode > 0.0 && ledger.zener == 0.0, "{ledger:?}");
            let whole = circuit.ledger();
            assert!(whole.residual().abs() < 1e-9 * moved(&whole), "{whole:?}");
            assert_eq!(circuit.load_voltage(), voltage);
        }
    }
}

#[test]
fn a_storage_loses_the_saturation_current_through_both_diodes() {
    let diodes = Diodes::Exponential(DiodeParameters::default());
    let mut circuit = Circuit::new(parameters(Topology::Isolated, 2500.0, diodes), [C2; 2]).unwrap();
    circuit.advance(100.0, [C2; 2]).unwrap();
    assert_relative_eq!(circuit.load_current(), -2e-13, max_relative = 1e-6);
    assert_relative_eq!(circuit.supply_current(), -2e-13, max_relative = 1e-6);
}
