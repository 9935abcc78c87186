//! Exponential diodes with the default tolerance: as exact as they promise, on every variant and in every extreme.
#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

mod common;

use approx::assert_relative_eq;
use common::{Ramp, decades, kinds, moved, run};
use proptest::prelude::*;
use videg_circuit::{Circuit, DiodeParameters, Diodes, Parameters, Release, Solver, Topology};

const REST: f64 = 15e-12;

fn exponential(ideal: Parameters, relative_tolerance: f64) -> Parameters {
    let solver = Solver { relative_tolerance, maximum_steps: 1_000_000 };
    Parameters { diodes: Diodes::Exponential(DiodeParameters { solver, ..DiodeParameters::default() }), ..ideal }
}

fn parameters() -> impl Strategy<Value = Parameters> {
    common::parameters(kinds(), 1.3, decades(8.0..11.0), common::leakage(-2.0..2.0))
}

/// Pulses `C2 + dC sin^n` of 200 ramps on alternating membranes, as of impacts, with rests between; all of them reach
/// 2600 V on a shared node, too.
fn pulses() -> impl Strategy<Value = Vec<Ramp>> {
    let pulse = (10e-12..16e-12_f64, 0.02..0.04_f64, 1.0..1.5_f64, 0.01..0.4_f64);
    prop::collection::vec(pulse, 5..8).prop_map(|pulses| {
        let mut ramps = Vec::new();
        for (i, (height, length, exponent, rest)) in pulses.into_iter().enumerate() {
            ramps.extend(contact(i % 2, REST, height, length, exponent, 200));
            ramps.push((rest, [REST; 2]));
        }
        ramps
    })
}

fn contact(side: usize, rest: f64, height: f64, length: f64, exponent: f64, pieces: u32) -> impl Iterator<Item = Ramp> {
    (1..=pieces).map(move |i| {
        let phase = std::f64::consts::PI * f64::from(i) / f64::from(pieces);
        let mut c = [rest; 2];
        if i < pieces {
            c[side] += height * phase.sin().powf(exponent);
        }
        (length / f64::from(pieces), c)
    })
}

/// Supply, load and Zener energy (J), supply and load charge (C).
fn sums(circuit: &Circuit) -> [f64; 5] {
    let ledger = circuit.ledger();
    [ledger.supply, ledger.load, ledger.zener, ledger.supply_charge, ledger.load_charge]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 16, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn near_ideal_diodes_agree_with_ideal_ones_and_with_a_thousandth_of_the_tolerance(
        ideal in parameters(),
        ramps in pulses(),
    ) {
        let start = |parameters| Circuit::new(parameters, [REST; 2]).unwrap();
        let mut exact = start(ideal);
        let mut real = start(exponential(ideal, Solver::default().relative_tolerance));
        let mut tight = start(exponential(ideal, 1e-12));
        let (mut deviation, mut time) = (0.0, 0.0);
        for ramp in &ramps {
            for circuit in [&mut exact, &mut real, &mut tight] {
                run(circuit, std::slice::from_ref(ramp));
            }
            let apart = [0, 1].map(|j| (real.voltage()[j] - exact.voltage()[j]).powi(2));
            deviation += ramp.0 * apart[0].max(apart[1]);
            time += ramp.0;
        }
        // Every diode leaks IS, and each of two nodes has two; that is no error.
        let leak = 4.0 * DiodeParameters::default().saturation_current * time;
        // To go from the supply's diode to that of the load, or to the switch, a node rises by its band and the drop of both
        // diodes, which ideal ones do not take: a charge for each contact of a capacitance of up to 31 pF.
        let contacts = (ramps.len() / 200) as f64;
        let swing = contacts * 31e-12 * (DiodeParameters::default().switch_band + 0.01);
        let scales = [2000.0, ideal.release_voltage(), ideal.release_voltage(), 1.0, 1.0];
        for ((a, b), (c, scale)) in sums(&exact).into_iter().zip(sums(&real)).zip(sums(&tight).into_iter().zip(scales)) {
            prop_assert!((b - a).abs() <= 1e-4 * a + (leak + swing) * scale, "{b} instead of {a} with ideal diodes");
            prop_assert!((b - c).abs() <= 1e-6 * c.abs(), "{b} instead of {c} with a tight tolerance");
        }
        let ledger = real.ledger();
        prop_assert!(ledger.residual().abs() < 3e-9 * moved(&ledger) && ledger.diode > 0.0, "{ledger:?}");
        let deviation = (deviation / time).sqrt();
        prop_assert!(deviation < 0.1, "{deviation} V RMS");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 4, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn contacts_that_grow_150_fold_to_300_kv_are_followed(
        (topology, release) in prop::sample::select(kinds()),
        load_resistance in decades(8.0..13.0),
        emission in prop_oneof![Just(0.01), Just(1e-5)],
        contacts in prop::collection::vec((0.01..1.0_f64, 1e-4..2e-2_f64, 0.0..1.0_f64, 0_usize..2), 1000..1500),
    ) {
        let ideal = Parameters { load_resistance, topology, release, ..Parameters::default() };
        let rest = 7e-12;
        let mut ramps = Vec::new();
        for (height, length, pause, side) in contacts {
            // Every other contact begins before the last one ends, with the other membrane still stretched.
            ramps.extend(contact(side, rest, 149.0 * rest * height, length, 1.3, 5).take(if pause < 0.5 { 4 } else { 5 }));
            if pause > 0.8 {
                ramps.push((pause, [1.01 * rest, rest]));
            }
        }
        ramps.push((1.0, [rest; 2]));
        let diode = DiodeParameters { emission_coefficient: emission, breakdown_emission: emission, ..DiodeParameters::default() };
        let mut exact = Circuit::new(ideal, [rest; 2]).unwrap();
        let mut real = Circuit::new(Parameters { diodes: Diodes::Exponential(diode), ..ideal }, [rest; 2]).unwrap();
        run(&mut exact, &ramps);
        run(&mut real, &ramps);
        let (a, b) = (exact.ledger(), real.ledger());
        assert_relative_eq!(b.supply, a.supply, max_relative = 1e-4);
        assert_relative_eq!(b.load, a.load, max_relative = 1e-4);
        assert_relative_eq!(b.load_charge, a.load_charge, max_relative = 1e-4);
        prop_assert!(b.residual().abs() < 3e-9 * moved(&b), "{b:?}");
    }
}

#[test]
fn a_membrane_that_meets_the_leader_early_in_a_long_step_is_seen() {
    // 3600 V and 2400 V, which meet after RC ln 4: anywhere in the step, its first quarter and its first stage included.
    for part in [0.001, 0.003, 0.01, 0.03, 0.1, 0.2, 0.24, 0.3, 0.6, 0.9, 0.99] {
        for release in [Release::Zener, Release::Switch] {
            let ideal =
                Parameters { topology: Topology::Isolated, release, load_resistance: 1e11, ..Parameters::default() };
            let charges = |parameters| {
                let mut circuit = Circuit::new(parameters, [27e-12, 18e-12]).unwrap();
                circuit.advance(0.0, [REST; 2]).unwrap();
                circuit.advance(1.5 * 4.0_f64.ln() / part, [REST; 2]).unwrap();
                circuit.ledger()
            };
            let (a, b) = (charges(ideal), charges(exponential(ideal, 1e-9)));
            let c = charges(exponential(ideal, 1e-12));
            assert_relative_eq!(b.load_charge, c.load_charge, max_relative = 1e-6);
            assert_relative_eq!(b.load, c.load, max_relative = 1e-6);
            // Two diodes leak 0.1 pA into the load all the time.
            let leak = 2e-13 * 1.5 * 4.0_f64.ln() / part;
            assert_relative_eq!(b.load_charge, a.load_charge, epsilon = leak, max_relative = 1e-4);
        }
    }
}

#[test]
fn a_diode_that_ceases_to_conduct_within_nanoseconds_passes_its_last_charge() {
    // N = 1: some C N Vt = 1 pC of 60 nC, in less than a microsecond of a ramp of a millisecond.
    let lossy = |relative_tolerance| DiodeParameters {
        emission_coefficient: 1.0,
        breakdown_emission: 1.0,
        solver: Solver { relative_tolerance, ..Solver::default() },
        ..DiodeParameters::default()
    };
    let ledger = |relative_tolerance| {
        let diodes = Diodes::Exponential(lossy(relative_tolerance));
        let mut circuit = Circuit::new(Parameters { diodes, ..Parameters::default() }, [REST; 2]).unwrap();
        for _ in 0..20 {
            circuit.advance(1e-3, [2.0 * REST, REST]).unwrap();
            circuit.advance(1e-3, [REST; 2]).unwrap();
        }
        circuit.ledger()
    };
    let (loose, tight) = (ledger(1e-9), ledger(1e-13));
    assert_relative_eq!(loose.supply_charge, tight.supply_charge, max_relative = 1e-6);
    assert_relative_eq!(loose.load_charge, tight.load_charge, max_relative = 1e-6);
}
