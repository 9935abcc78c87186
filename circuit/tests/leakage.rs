//! Leakage through the films against closed forms, and none of it where there is none.
#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

mod common;

use approx::assert_relative_eq;
use common::{Ramp, TOPOLOGIES, U, kinds, moved, pulse, run};
use videg_circuit::{Circuit, DiodeParameters, Diodes, Ledger, Parameters, Release, Topology};

const C: [f64; 2] = [15e-12, 12e-12];
const OPEN: f64 = f64::INFINITY;

fn leaking(time_constant: f64) -> Parameters {
    Parameters { leakage_time_constant: time_constant, load_resistance: OPEN, ..Parameters::default() }
}

/// Both models of the diodes, each with how exact it is.
fn models(ideal: Parameters) -> [(Parameters, f64); 2] {
    [(ideal, 1e-12), (Parameters { diodes: Diodes::Exponential(DiodeParameters::default()), ..ideal }, 2e-6)]
}

/// All circuits, each with how exact it is.
fn circuits(base: Parameters) -> impl Iterator<Item = (Parameters, f64)> {
    kinds().into_iter().flat_map(move |(topology, release)| models(Parameters { topology, release, ..base }))
}

fn assert_closed(ledger: &Ledger) {
    assert!(ledger.residual().abs() < 3e-9 * moved(ledger), "{ledger:?}");
}

#[test]
fn a_charged_membrane_at_rest_decays_until_the_supply_holds_it() {
    for topology in TOPOLOGIES {
        for (parameters, exact) in models(Parameters { topology, zener_voltage: 5000.0, ..leaking(3.0) }) {
            let start = 3000.0;
            let mut circuit = Circuit::with_voltages(parameters, C, [start; 2]).unwrap();
            circuit.advance(0.6, C).unwrap();
            for voltage in circuit.voltage() {
                assert_relative_eq!(voltage, start * (-0.2_f64).exp(), max_relative = exact);
            }
            // U_in is reached after 3 ln 1.5 s; from then on the supply gives what leaks.
            let (at, until) = (3.0 * 1.5_f64.ln(), 4.0);
            circuit.advance(until - 0.6, C).unwrap();
            let capacitance = C[0] + C[1];
            let held = U * U * capacitance * (until - at) / 3.0;
            let ledger = circuit.ledger();
            assert_relative_eq!(ledger.supply, held, max_relative = 10.0 * exact);
            let lost = 0.5 * capacitance * (start * start - U * U);
            assert_relative_eq!(ledger.leakage, lost + held, max_relative = 10.0 * exact);
            assert_relative_eq!(circuit.supply_current(), U * capacitance / 3.0, max_relative = 10.0 * exact);
            assert_relative_eq!(circuit.voltage()[1], U, max_relative = 1e-5);
            assert_eq!((ledger.load, ledger.zener), (0.0, 0.0));
            assert_closed(&ledger);
        }
    }
}

#[test]
fn a_slow_sine_keeps_the_diode_conducting_and_the_supply_gives_all() {
    // With 1 s^-1 of leakage and 0.2 of relative amplitude, k + C / T stays above 0 below 0.7 Hz: no charge is released.
    for (parameters, exact) in circuits(Parameters { load_resistance: 1e9, ..leaking(1.0) }) {
        let (period, pieces) = (10.0_f64, 400_u32);
        let at = |i: u32| {
            let wave = (std::f64::consts::TAU * f64::from(i) / f64::from(pieces)).sin();
            [C[0] * (1.0 + 0.2 * wave), C[1] * (1.0 - 0.2 * wave)]
        };
        let mut circuit = Circuit::new(parameters, C).unwrap();
        let ramps: Vec<Ramp> = (1..=pieces).map(|i| (period / f64::from(pieces), at(i))).collect();
        run(&mut circuit, &ramps);
        let ledger = circuit.ledger();
        // The mean of a sine over its period is zero, of its chords, too.
        let leaked = U * U * (C[0] + C[1]) * period;
        assert_relative_eq!(ledger.leakage, leaked, max_relative = 10.0 * exact);
        assert_relative_eq!(ledger.supply, leaked, max_relative = 10.0 * exact);
        // Exponential diodes leak IS each.
        assert!(ledger.load.abs() < 1e-5 * leaked, "{ledger:?}");
        assert_closed(&ledger);
    }
}

#[test]
fn an_open_membrane_follows_its_capacitance_and_the_leak() {
    // C falls to a half: the voltage rises above U_in, where nothing but the film takes charge.
    for (parameters, exact) in
        models(Parameters { zener_voltage: 9000.0, topology: Topology::Isolated, ..leaking(5.0) })
    {
        let mut circuit = Circuit::new(parameters, C).unwrap();
        for i in 1..=100 {
            let angle = std::f64::consts::FRAC_PI_2 * f64::from(i) / 100.0;
            circuit.advance(2e-3, C.map(|c| c * (1.0 - 0.5 * angle.sin().powi(2)))).unwrap();
        }
        let before = circuit.voltage();
        circuit.advance(0.4, C.map(|c| 0.45 * c)).unwrap();
        for (voltage, before) in circuit.voltage().into_iter().zip(before) {
            assert_relative_eq!(voltage, before * (0.5 / 0.45) * (-0.4_f64 / 5.0).exp(), max_relative = exact);
        }
        assert_closed(&circuit.ledger());
    }
}

#[test]
fn a_leaking_node_behind_a_load_divides_the_voltage() {
    // V - U_z tends to (g U_z / (g + C / T)) - U_z < 0: a Zener diode ends; a switch at constant C discharges with both.
    let (time_constant, load) = (0.1, 1e9);
    for (parameters, exact) in
        models(Parameters { release: Release::Switch, load_resistance: load, ..leaking(time_constant) })
    {
        let mut circuit = Circuit::with_voltages(parameters, C, [3000.0; 2]).unwrap();
        circuit.advance(5e-3, C).unwrap();
        let capacitance = C[0] + C[1];
        let whole = 1.0 / load + capacitance / time_constant;
        let decay = (-5e-3 * whole / capacitance).exp();
        assert_relative_eq!(circuit.voltage()[0], 3000.0 * decay, max_relative = exact);
        let released = 0.5 * capacitance * 3000.0 * 3000.0 * (1.0 - decay * decay);
        let ledger = circuit.ledger();
        assert_relative_eq!(ledger.load, released / load / whole, max_relative = 10.0 * exact);
        assert_relative_eq!(ledger.leakage, released * (1.0 - 1.0 / load / whole), max_relative = 10.0 * exact);
        assert_closed(&ledger);
    }
}

#[test]
fn an_endless_time_constant_is_none_and_a_long_one_tends_to_it() {
    let ramps = pulse(C, 12e-12, 0.03, 0.25, 50);
    for (base, _) in circuits(Parameters::default()) {
        let ended = |leakage_time_constant| {
            let mut circuit = Circuit::new(Parameters { leakage_time_constant, ..base }, C).unwrap();
            run(&mut circuit, &ramps);
            circuit
        };
        let (none, long) = (ended(0.0), ended(1e9));
        assert_eq!(ended(f64::INFINITY).state(), none.state());
        assert_eq!(none.ledger().leakage, 0.0);
        let (a, b) = (none.ledger(), long.ledger());
        for (a, b) in [(a.supply, b.supply), (a.load, b.load), (a.zener, b.zener), (a.mechanical, b.mechanical)] {
            assert_relative_eq!(a, b, max_relative = 1e-6, epsilon = 1e-15);
        }
        assert!(b.leakage > 0.0 && b.leakage < 1e-8 * b.supply, "{b:?}");
    }
}

#[test]
fn a_circuit_goes_on_from_its_state_to_the_last_bit() {
    let ramps = pulse(C, 12e-12, 0.03, 0.25, 50);
    for time_constant in [0.0, 0.3] {
        for (parameters, _) in circuits(Parameters { load_resistance: 1e10, ..leaking(time_constant) }) {
            let mut circuit = Circuit::new(parameters, C).unwrap();
            run(&mut circuit, &ramps[..30]);
            let mut other = Circuit::new(parameters, [1e-12; 2]).unwrap();
            other.restore(&circuit.state()).unwrap();
            run(&mut circuit, &ramps);
            run(&mut other, &ramps);
            assert_eq!(circuit, other);
            assert_eq!(circuit.ledger().leakage > 0.0, time_constant > 0.0);
        }
    }
}
