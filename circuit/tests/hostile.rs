//! Parameters and capacitances at their bounds and beyond: refused by name, or taken with every output finite.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a panic is how a test fails")]

use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use videg_circuit::{
    Circuit, CircuitSample, DiodeParameters, Diodes, Error, Failure, Parameters, Release, Settings, Topology,
};

#[path = "../../tests/support/edges.rs"]
mod edges;

/// Every circuit that the choices allow, by the names of their items.
fn kinds() -> Vec<(String, Settings)> {
    let mut kinds = vec![(String::new(), Settings::default())];
    for choice in Settings::CHOICES {
        let with = |(kind, settings): &(String, Settings), item: &str| {
            let mut settings = *settings;
            assert!(choice.choose(&mut settings, item));
            (format!("{kind} {item}"), settings)
        };
        kinds = kinds.iter().flat_map(|kind| choice.items.iter().map(move |(item, _)| with(kind, item))).collect();
    }
    kinds
}

fn assert_finite(circuit: &Circuit, what: &str) {
    let outputs = CircuitSample::NAMES.into_iter().zip(CircuitSample::from(circuit).columns());
    for (name, value) in outputs.chain([("converted energy", circuit.ledger().converted())]) {
        assert!(value.is_finite(), "{what}: {name} = {value} at {} s", circuit.time());
    }
}

/// Two pulses of C(t) with a jump between them.
const RAMPS: [(f64, [f64; 2]); 6] = [
    (5e-3, [25e-12, 15e-12]),
    (5e-3, [15e-12, 15e-12]),
    (0.0, [15e-12, 30e-12]),
    (0.1, [15e-12, 15e-12]),
    (1e-12, [14e-12, 16e-12]),
    (10.0, [15e-12, 15e-12]),
];

/// Runs a circuit through `ramps`; an error ends it and leaves what was before.
fn run(settings: &Settings, ramps: &[(f64, [f64; 2])], what: &str) -> Result<(), Error> {
    let mut circuit = Circuit::new(settings.parameters(), [15e-12; 2])?;
    assert_finite(&circuit, what);
    for (step, capacitance) in ramps {
        let before = circuit.clone();
        if let Err(error) = circuit.advance(*step, *capacitance) {
            assert_eq!(circuit, before, "{what}: an error changed the circuit");
            return Err(error);
        }
        assert_finite(&circuit, what);
    }
    Ok(())
}

/// That an error names the thing, its value and the bound.
fn assert_explained(error: &Error, what: &str) {
    let text = error.to_string();
    let bounded = [
        "not above 0",
        "below 0",
        "outside its bounds",
        "is below supply.voltage",
        "is below 0.000001 s",
        "not a finite number",
        "differs from",
    ];
    let ended =
        ["switching instants", "solver.relativeTolerance", "solver.maximumSteps", "trial voltages", "no solution"];
    assert!(bounded.iter().chain(&ended).any(|words| text.contains(words)), "{what}: {text}");
}

#[test]
fn each_parameter_at_and_beyond_its_bounds_is_refused_by_name_or_runs() {
    for (kind, base) in kinds() {
        for quantity in Settings::QUANTITIES {
            for value in edges::around(quantity.min, quantity.max) {
                let mut settings = base;
                (quantity.set)(&mut settings, value);
                let what = format!("{kind}, {} = {value:e}", quantity.name);
                match run(&settings, &RAMPS, &what) {
                    Ok(()) => {}
                    Err(Error::Bounds { name, .. }) => assert_eq!(name, quantity.name, "{what}"),
                    Err(error) => assert_explained(&error, &what),
                }
            }
        }
    }
}

#[test]
fn each_pair_of_bounds_is_refused_with_a_reason_or_runs() {
    for (kind, base) in kinds().into_iter().filter(|(kind, _)| kind.contains("isolated")) {
        for (i, one) in Settings::QUANTITIES.iter().enumerate() {
            for other in &Settings::QUANTITIES[..i] {
                for (a, b) in [(one.min, other.min), (one.min, other.max), (one.max, other.min), (one.max, other.max)] {
                    let mut settings = base;
                    (one.set)(&mut settings, a);
                    (other.set)(&mut settings, b);
                    let what = format!("{kind}, {} = {a:e}, {} = {b:e}", one.name, other.name);
                    if let Err(error) = run(&settings, &RAMPS, &what) {
                        assert_explained(&error, &what);
                    }
                }
            }
        }
    }
}

fn hostile_number() -> impl Strategy<Value = f64> {
    let values = [0.0, -0.0, 5e-324, 1e-310, 1e308, -1e308, f64::INFINITY, f64::NEG_INFINITY, f64::NAN, 1e9, 1e-12];
    prop_oneof![
        proptest::sample::select(values.to_vec()),
        (-30.0..30.0).prop_map(|e| 10_f64.powf(e)),
        (1.0..40.0).prop_map(|pf| 1e-12 * pf)
    ]
}

/// Internal steps are bounded, and so is the work for them.
#[test]
fn searches_in_place_of_newtons_method_are_bounded() {
    // A switch that turns on within a billionth of a volt into a short circuit.
    let diode = DiodeParameters { switch_band: 1e-9, ..DiodeParameters::default() };
    let parameters = Parameters {
        topology: Topology::Isolated,
        release: Release::Switch,
        load_resistance: 0.0,
        diodes: Diodes::Exponential(diode),
        ..Parameters::default()
    };
    let mut circuit = Circuit::new(parameters, [15e-12; 2]).unwrap();
    circuit.advance(5e-3, [25e-12, 15e-12]).unwrap();
    circuit.advance(5e-3, [15e-12; 2]).unwrap();
    circuit.advance(0.0, [15e-12, 30e-12]).unwrap();
    let before = circuit.clone();
    let error = circuit.advance(0.1, [15e-12; 2]).unwrap_err();
    assert!(matches!(error, Error::Integration { failure: Failure::Trials(2_000_000), .. }), "{error}");
    assert_eq!(circuit, before);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, rng_seed: RngSeed::Fixed(1), ..ProptestConfig::default() })]

    #[test]
    fn steps_and_capacitances_of_any_size_are_refused_by_name_or_leave_every_output_finite(
        kind in 0..kinds().len(),
        ramps in proptest::collection::vec((hostile_number(), [hostile_number(), hostile_number()]), 1..6),
    ) {
        let (kind, settings) = &kinds()[kind];
        let what = format!("{kind}, {ramps:?}");
        if let Err(error) = run(settings, &ramps, &what) {
            assert_explained(&error, &what);
        }
    }
}

/// Beside 1e98 F, a capacitance of some pF rounds to nothing, and a time over 1e-314 F overflows: the way takes a bounded number of pieces.
#[test]
fn a_leaking_capacitance_that_all_but_vanishes_ends_in_time() {
    for (kind, mut settings) in kinds().into_iter().filter(|(_, settings)| !settings.exponential) {
        settings.circuit.leakage_time_constant = 2.0;
        settings.circuit.load_resistance = 3.5e-6;
        for ramps in [
            [(1e-2, [2e98; 2]), (1e-2, [15e-12; 2])],
            [(1e-2, [2e98, 15e-12]), (1e-12, [1e-300, 15e-12])],
            [(1e-2, [2e-314; 2]), (1e-2, [15e-12; 2])],
        ] {
            let mut circuit = Circuit::new(settings.parameters(), [15e-12; 2]).unwrap();
            for (dt, capacitance) in ramps {
                if circuit.advance(dt, capacitance).is_err() {
                    break;
                }
            }
            assert_finite(&circuit, &kind);
        }
    }
}
