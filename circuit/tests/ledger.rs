//! The ledger closes, charge is conserved and steps can be cut, whatever the signal.
#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

mod common;

use approx::assert_relative_eq;
use common::{Ramp, decades, kinds, moved};
use proptest::prelude::*;
use videg_circuit::{Circuit, Error, Parameters, Release, Topology};

const START: [f64; 2] = [15e-12, 12e-12];

/// Ramps, some of them jumps, over three decades of capacitance.
fn ramps() -> impl Strategy<Value = Vec<Ramp>> {
    let dt = prop_oneof![Just(0.0), 1e-9..1e-5_f64, 1e-4..1e-1_f64];
    let c = || prop_oneof![decades(-13.0..-10.0), Just(15e-12)];
    let ramp = (dt, c(), c()).prop_map(|(dt, l, r)| (dt, [l, r]));
    prop::collection::vec(ramp, 1..40)
}

fn parameters() -> impl Strategy<Value = Parameters> {
    let load = prop_oneof![Just(0.0), Just(f64::INFINITY), decades(-3.0..20.0), decades(8.0..11.0)];
    common::parameters(kinds(), 2.0, load, common::leakage(-6.0..4.0))
}

#[test]
fn knots_that_are_no_line_change_nothing_and_an_error_leaves_the_circuit() {
    let mut circuit = Circuit::new(Parameters::default(), START).unwrap();
    let before = circuit.state();
    circuit.advance_along(1.0, &[], |_, _| ()).unwrap();
    circuit.advance_along(1.0, &[START], |_, _| ()).unwrap();
    assert_eq!(circuit.state(), before);
    for bad in [f64::NAN, -1e-12, 0.0] {
        let refused = circuit.advance_along(1.0, &[START, [20e-12, 15e-12], [20e-12, bad]], |_, _| ());
        assert!(refused.unwrap_err().to_string().contains("right.capacitance"), "{bad}");
    }
    assert!(circuit.advance_along(-1.0, &[START, START], |_, _| ()).is_err());
    assert_eq!(circuit.state(), before);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1500, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn energy_and_charge_balance(parameters in parameters(), ramps in ramps()) {
        let mut circuit = Circuit::new(parameters, START).unwrap();
        let initial: f64 = circuit.state().charge.iter().sum();
        let mut throughput = 0.0;
        for &(dt, ends) in &ramps {
            let before = circuit.ledger();
            circuit.advance(dt, ends).unwrap();
            throughput += moved(&common::difference(&circuit.ledger(), &before));
        }
        let ledger = circuit.ledger();
        prop_assert!(ledger.residual().abs() <= 1e-9 * throughput, "{ledger:?} of {throughput}");
        let now: f64 = circuit.state().charge.iter().sum();
        let lost = initial + ledger.supply_charge - ledger.load_charge - now;
        // The ledger has the energy of what leaks, not the charge.
        prop_assert!(parameters.leakage_time_constant > 0.0 || lost.abs() <= 1e-12 * (initial + ledger.supply_charge), "{lost} C lost");
    }

    #[test]
    fn lines_in_one_call_are_those_of_a_call_each(
        parameters in parameters(),
        ramps in ramps(),
        length in prop_oneof![Just(0.0), 1e-6..1.0_f64],
    ) {
        let knots: Vec<[f64; 2]> = std::iter::once(START).chain(ramps.iter().map(|(_, ends)| *ends)).collect();
        let (mut one, mut many) = [(); 2].map(|()| Circuit::new(parameters, START).unwrap()).into();
        let (mut throughput, mut voltages) = (0.0, Vec::new());
        for ends in &knots[1..] {
            let before = many.ledger();
            many.advance(length * (1.0 / ramps.len() as f64), *ends).unwrap();
            throughput += moved(&common::difference(&many.ledger(), &before));
            voltages.push(many.voltage());
        }
        let mut ends = Vec::new();
        one.advance_along(length, &knots, |k, seen| ends.push((k, seen))).unwrap();
        prop_assert_eq!(ends.last().map(|end| end.0), Some(ramps.len()));
        let is_exact = parameters.leakage_time_constant > 0.0;
        prop_assert!(!is_exact || ends.len() == ramps.len());
        for (k, seen) in ends {
            for (a, b) in seen.into_iter().zip(voltages[k - 1]) {
                prop_assert!((a - b).abs() <= 1e-11 * b && (!is_exact || a == b), "{a} V and {b} V at knot {k}");
            }
        }
        let off = moved(&common::difference(&one.ledger(), &many.ledger()));
        prop_assert!(off <= 1e-11 * throughput && (!is_exact || off == 0.0), "{:?}, {:?}", one.ledger(), many.ledger());
        prop_assert_eq!(one.capacitance(), many.capacitance());
    }

    #[test]
    fn voltages_stay_between_the_elements(parameters in parameters(), ramps in ramps()) {
        let mut circuit = Circuit::new(parameters, START).unwrap();
        for &(dt, ends) in &ramps {
            circuit.advance(dt, ends).unwrap();
            for v in circuit.voltage() {
                prop_assert!(v >= 2000.0 * (1.0 - 1e-14), "{v} V is below the supply");
                if parameters.load_resistance == 0.0 || parameters.release == Release::Storage {
                    prop_assert!(v <= parameters.release_voltage() * (1.0 + 1e-14), "{v} V is above the release");
                }
            }
            prop_assert!(circuit.load_current() >= -1e-18 && circuit.supply_current() >= 0.0);
            prop_assert!(circuit.load_voltage().is_finite());
        }
    }

    #[test]
    fn cutting_a_ramp_changes_only_rounding(
        parameters in parameters(),
        ramps in ramps(),
        parts in 2..9_u32,
    ) {
        let mut whole = Circuit::new(parameters, START).unwrap();
        let mut cut = whole.clone();
        for &(dt, ends) in &ramps {
            let from = whole.capacitance();
            whole.advance(dt, ends).unwrap();
            for i in 1..parts {
                let part = f64::from(i) / f64::from(parts);
                let c = [0, 1].map(|j| from[j] + (ends[j] - from[j]) * part);
                cut.advance(dt / f64::from(parts), c).unwrap();
            }
            cut.advance(dt / f64::from(parts), ends).unwrap();
        }
        let (a, b) = (whole.ledger(), cut.ledger());
        let scale = whole.state().charge[0] + a.supply_charge;
        prop_assert!((a.load_charge - b.load_charge).abs() <= 1e-10 * scale, "{a:?} {b:?}");
        prop_assert!((a.supply_charge - b.supply_charge).abs() <= 1e-10 * scale, "{a:?} {b:?}");
    }

    #[test]
    fn one_step_is_as_good_as_any_way_where_the_circuit_says_so(
        parameters in parameters(),
        ramps in ramps(),
        mut shares in prop::collection::vec(0.0..1.0_f64, 1..9),
    ) {
        shares.sort_by(f64::total_cmp);
        let mut circuit = Circuit::new(parameters, START).unwrap();
        for &(dt, ends) in &ramps {
            if circuit.is_path_independent(ends) && dt > 0.0 {
                let (from, before) = (circuit.capacitance(), circuit.ledger());
                let [mut straight, mut winding] = [circuit.clone(), circuit.clone()];
                straight.advance(dt, ends).unwrap();
                let step = dt / (shares.len() + 1) as f64;
                for share in &shares {
                    winding.advance(step, [0, 1].map(|j| from[j] + (ends[j] - from[j]) * share)).unwrap();
                }
                winding.advance(step, ends).unwrap();
                let [one, many] = [&straight, &winding].map(Circuit::ledger);
                prop_assert_eq!(one.load_charge, before.load_charge);
                let scale = many.supply.abs() + one.stored.abs() + before.stored.abs() + circuit.state().initial_energy;
                for (one, many) in [(one.supply, many.supply), (one.mechanical, many.mechanical), (one.load, many.load), (one.stored, many.stored)] {
                    prop_assert!((one - many).abs() <= 1e-10 * scale, "{one:e} and {many:e} of {scale:e}");
                }
            }
            circuit.advance(dt, ends).unwrap();
        }
    }
}

#[test]
fn a_contradictory_or_broken_state_is_rejected_and_changes_nothing() {
    let mut circuit = Circuit::new(Parameters::default(), START).unwrap();
    let good = circuit.clone();
    let mut state = circuit.state();
    state.holding[0] = true;
    let error = circuit.restore(&state).unwrap_err();
    assert_eq!(error, Error::ContradictoryMode { node: 0 });
    state.holding[0] = false;
    state.charge[1] = f64::NAN;
    assert!(matches!(circuit.restore(&state), Err(Error::NotFinite { name: "right.charge", .. })));
    state = circuit.state();
    state.events = u64::MAX;
    let error = circuit.restore(&state).unwrap_err().to_string();
    assert_eq!(error, "changes of mode = 18446744073709551615 is above 9007199254740992");
    assert_eq!(circuit, good);
}

#[test]
fn a_jump_up_is_topped_up_and_a_jump_down_conserves_charge() {
    let mut circuit = Circuit::new(Parameters::default(), [15e-12; 2]).unwrap();
    circuit.advance(0.0, [20e-12, 15e-12]).unwrap();
    assert_relative_eq!(circuit.ledger().supply_charge, 1e-8, max_relative = 1e-12);
    assert_eq!(circuit.voltage(), [2000.0; 2]);
    circuit.advance(0.0, [15e-12, 15e-12]).unwrap();
    assert_eq!(circuit.ledger().load_charge, 0.0);
    assert_relative_eq!(circuit.voltage()[0], 2000.0 * 35.0 / 30.0, max_relative = 1e-14);
    assert_relative_eq!(circuit.load_voltage(), 2000.0 / 6.0, max_relative = 1e-12);
    circuit.advance(10.0, [15e-12, 15e-12]).unwrap();
    assert_relative_eq!(circuit.ledger().load_charge, 1e-8, max_relative = 1e-12);
}

#[test]
fn an_idle_circuit_does_nothing_for_ever() {
    let mut circuit = Circuit::new(Parameters::default(), START).unwrap();
    for _ in 0..1000 {
        circuit.advance(1.0, START).unwrap();
    }
    assert_eq!(circuit.ledger(), videg_circuit::Ledger::default());
    assert_eq!(circuit.events(), 0);
}

#[test]
fn a_start_below_the_supply_or_above_the_release_is_recorded() {
    let isolated = Parameters { topology: Topology::Isolated, ..Parameters::default() };
    let shorted = Parameters { load_resistance: 0.0, ..isolated };
    let storage = Parameters { release: Release::Storage, storage_voltage: 2300.0, ..isolated };
    // Starting voltages, voltages then, and the energies of load, Zener and other diodes with 10 pF.
    for (parameters, start, voltage, [load, zener, diode]) in [
        (shorted, [500.0, 3000.0], [2000.0; 2], [0.5e6, 2000.0 * 1000.0, 0.5 * 1500.0 * 1500.0]),
        (storage, [2100.0, 3300.0], [2100.0, 2300.0], [2300.0 * 1000.0, 0.0, 0.5e6]),
    ] {
        let circuit = Circuit::with_voltages(parameters, [10e-12; 2], start).unwrap();
        let ledger = circuit.ledger();
        for (found, expected) in circuit.voltage().into_iter().zip(voltage) {
            assert_relative_eq!(found, expected, max_relative = 1e-15);
        }
        assert_relative_eq!(ledger.load, 10e-12 * load, max_relative = 1e-9);
        assert_relative_eq!(ledger.zener, 10e-12 * zener, max_relative = 1e-12);
        assert_relative_eq!(ledger.diode, 10e-12 * diode, max_relative = 1e-12);
        assert!(ledger.residual().abs() < 1e-12 * (ledger.supply + ledger.load));
    }
}

#[test]
fn a_storage_takes_what_a_jump_lifts_to_its_voltage() {
    let parameters = Parameters { release: Release::Storage, storage_voltage: 2300.0, ..Parameters::default() };
    let mut circuit = Circuit::new(parameters, [20e-12, 15e-12]).unwrap();
    circuit.advance(0.0, [15e-12, 15e-12]).unwrap();
    let ledger = circuit.ledger();
    assert_relative_eq!(ledger.load_charge, 2000.0 * 35e-12 - 2300.0 * 30e-12, max_relative = 1e-12);
    assert_relative_eq!(ledger.load, 2300.0 * ledger.load_charge, max_relative = 1e-14);
    assert_eq!((ledger.diode, ledger.zener, ledger.supply), (0.0, 0.0, 0.0));
    assert_eq!(circuit.voltage(), [2300.0; 2]);
}
