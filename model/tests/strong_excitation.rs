//! Slow and strong excitation, where the cylinder swings up to a million times as far as the ball can travel: against a
//! reference of its own in 128 bits.

#![allow(clippy::unwrap_used, clippy::panic)]

mod wide;

use std::f64::consts::TAU;
use std::ops::Range;

use videg_model::{Case, Harvester, ModelError, Parameters};
use wide::Reference;

/// Number `k` of a sequence that fills [0, 1) evenly, in each of a few dimensions in its own way.
fn spread(k: u32, dimension: i32) -> f64 {
    // Powers of the root of x^5 = x + 1, as in Roberts' sequences.
    (0.5 + f64::from(k) * 1.167_303_978_261_418_7_f64.powi(-dimension)).fract()
}

fn logarithmic(fraction: f64, [from, to]: [f64; 2]) -> f64 {
    from * (to / from).powf(fraction)
}

/// The paper's device from rest in the middle, with the cylinder's swing in units of s/2 (gamma, Eq. (16)).
fn device(gamma: f64, frequency: f64, restitution: f64) -> Parameters {
    let p = Parameters { frequency, restitution, ..Parameters::default() };
    let amplitude = gamma * 0.5 * p.travel() * p.cylinder_mass * (TAU * frequency).powi(2);
    Parameters { amplitude, ..p }
}

fn voltage_gain(p: &Parameters, until: f64) -> Result<f64, ModelError> {
    let mut harvester = Harvester::new(p, 0.0)?;
    harvester.advance(until)?;
    Ok(harvester.totals().voltage_gain)
}

/// Compares the gains of some cases of the sequence.
fn compare(cases: Range<u32>) {
    let (mut compared, count) = (0, cases.len());
    for k in cases {
        let gamma = logarithmic(spread(k, 1), [1.0, 1e6]);
        let frequency = logarithmic(spread(k, 2), [1e-3, 1.0]);
        let p = device(gamma, frequency, 0.95 * spread(k, 3));
        let until = 2.2 / frequency;
        let [expected, twin] = [0.0, 1e-11 * p.travel()].map(|moved| {
            let p = Parameters { ball_position: moved, ..p };
            Reference::new(p).voltage_gain(until)
        });
        if (twin / expected - 1.0).abs() > 1e-8 {
            continue; // the motion magnifies what no double resolves
        }
        let gain = voltage_gain(&p, until).unwrap();
        let error = gain / expected - 1.0;
        let Parameters { restitution, .. } = p;
        assert!(error.abs() <= 1e-8, "gamma {gamma}, {frequency} Hz, r = {restitution}: {gain} V for {expected} V");
        compared += 1;
    }
    assert!(compared >= count * 3 / 4, "{compared} of {count}");
}

#[test]
fn gains_are_those_of_a_reference_in_128_bits() {
    compare(0..8);
}

/// Some ten seconds.
#[test]
#[ignore = "slow"]
fn gains_of_more_cases_are_those_of_a_reference_in_128_bits() {
    compare(8..32);
}

#[test]
fn a_slow_force_lets_the_ball_rest_for_most_of_the_time() {
    // Averages over 1000 s that the stepping of rounding errors once multiplied, and the impacts that they were made of.
    for (frequency, expected, most) in [(0.02, 61.621, 1400), (0.01, 25.670, 700), (0.005, 12.205, 400)] {
        let fig13 = (Case::find("fig13").unwrap().parameters)();
        let mut harvester = Harvester::new(&Parameters { frequency, restitution: 0.7, ..fig13 }, 0.0).unwrap();
        harvester.advance(1000.0).unwrap();
        let mean = harvester.totals().voltage_gain / 1000.0;
        assert!((mean - expected).abs() < 1e-3, "{frequency} Hz: {mean} V/s");
        assert!(harvester.totals().impacts < most, "{frequency} Hz: {} impacts", harvester.totals().impacts);
    }
}
