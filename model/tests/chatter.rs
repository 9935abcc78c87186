//! Impacts that accumulate, rest and release.

#![allow(clippy::unwrap_used, clippy::panic, clippy::cast_possible_truncation, clippy::cast_sign_loss)]

#[path = "common/brute.rs"]
mod brute;

use approx::assert_relative_eq;
use proptest::prelude::*;
use std::f64::consts::TAU;
use videg_model::{Case, Harvester, Membrane, Parameters, Side};

#[test]
fn a_ball_pushed_steadily_rests_after_the_endless_bounces_of_the_geometric_series() {
    // Constant push of 2 m/s^2, first impact at the speed v: the bounces last 2 v r / (a (1 - r)) in all.
    let p = Parameters { amplitude: 0.0, restitution: 0.7, ..Parameters::default() };
    let mut harvester = Harvester::new(&p, 0.0).unwrap();
    let push = 2.0;
    harvester.set_external_force(push * p.cylinder_mass, 0.0).unwrap();
    let first = harvester.next_impact().unwrap();
    harvester.advance(first).unwrap();
    let speed = harvester.totals().last_speed;
    assert_relative_eq!(speed, (2.0 * push * p.travel() / 2.0).sqrt(), max_relative = 1e-12);
    let end = first + 2.0 * speed * 0.7 / (push * (1.0 - 0.7));
    // What counts as rest begins when a bounce is lower than 1e-9 s/2, some hundred microseconds before the end.
    harvester.advance(end - 1e-3).unwrap();
    assert_eq!(harvester.resting(), None);
    harvester.advance(end).unwrap();
    assert_eq!(harvester.resting(), Some(Side::Left));
    let m = Membrane::new(&p);
    let all: f64 = (0..2000).map(|k| m.capacitance_excess(m.deflection(speed * 0.7_f64.powi(k)))).sum();
    assert_relative_eq!(harvester.totals().voltage_gain, p.bias_voltage * all, max_relative = 1e-9);
    harvester.advance(1e4).unwrap();
    assert_eq!(harvester.relative_displacement(), p.travel() / 2.0);
    assert!(harvester.totals().impacts < 100, "{:?}", harvester.totals());
}

#[test]
fn a_resting_ball_is_released_when_the_walls_acceleration_turns() {
    let p = (Case::find("table3-2hz").unwrap().parameters)();
    let mut harvester = Harvester::new(&p, 0.0).unwrap();
    let mut releases = 0;
    for k in 1..20_000 {
        let rested = harvester.resting();
        harvester.advance(1e-3 * f64::from(k)).unwrap();
        if let (Some(side), None) = (rested, harvester.resting()) {
            releases += 1;
            // cos(2 pi f0 t) = 0 at odd multiples of 1 / (4 f0) = 0.125 s; the step that passed it was 1 ms long.
            let quarter = (harvester.time() / 0.125).floor();
            assert!(harvester.time() - 0.125 * quarter <= 1.001e-3, "released before {} s", harvester.time());
            assert_eq!(quarter as i64 % 2, 1);
            assert!(side.sign() * harvester.cylinder_acceleration() <= 1e-9, "still pressed");
        }
    }
    assert!(releases > 70, "{releases} releases in 20 s: two in a period are expected");
    harvester.advance(100.0).unwrap();
    let totals = harvester.totals();
    assert!(totals.events() < 10_000, "{totals:?}; the stepped method counts millions");
    assert!(totals.chatters > 300, "{totals:?}");
}

#[test]
fn the_gain_of_a_chattering_motion_is_that_of_located_steps() {
    let p = (Case::find("table3-2hz").unwrap().parameters)();
    let mut brute = brute::Brute::new(p, 1e-5);
    brute.run(20.0);
    let mut harvester = Harvester::new(&p, 0.0).unwrap();
    harvester.advance(10.0).unwrap();
    let before = harvester.totals().energy;
    harvester.advance(20.0).unwrap();
    let counted = brute.impacts.iter().filter(|(time, _)| *time > 10.0 && *time <= 20.0);
    let energy: f64 = counted.map(|(_, speed)| harvester.membrane().impact_energy(p.bias_voltage, *speed)).sum();
    assert_relative_eq!(energy, harvester.totals().energy - before, max_relative = 1e-4);
}

#[test]
fn a_perfectly_plastic_ball_stays_on_the_membrane_and_leaves_it_again() {
    let p = Parameters { restitution: 0.0, ..Parameters::default() };
    let mut harvester = Harvester::new(&p, 0.0).unwrap();
    harvester.advance(100.0).unwrap();
    let totals = *harvester.totals();
    assert!(totals.releases > 300 && totals.chatters == totals.impacts, "{totals:?}");
}

#[test]
fn a_ball_that_starts_on_the_membrane_at_rest_is_carried() {
    for restitution in [0.0, 0.6, 1.0] {
        let p = Parameters { restitution, ..Parameters::default() };
        let p = Parameters { ball_position: -p.travel() / 2.0, ..p };
        let mut harvester = Harvester::new(&p, 0.0).unwrap();
        assert_eq!(harvester.resting(), Some(Side::Left), "r = {restitution}");
        harvester.advance(0.124).unwrap();
        assert_eq!(harvester.relative_displacement(), p.travel() / 2.0);
        harvester.advance(0.126).unwrap();
        assert_eq!(harvester.resting(), None);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn work_stays_bounded_for_any_restitution(
        restitution in prop_oneof![0.0..1.0, 0.99..1.0, Just(1.0 - 1e-8), Just(1.0 - 1e-16), Just(1.0)],
        amplitude in 0.1..20.0,
        frequency in 0.5..10.0,
        phase in 0.0..TAU,
    ) {
        let p = Parameters { restitution, amplitude, frequency, phase, ..Parameters::default() };
        let mut harvester = Harvester::new(&p, 0.0).unwrap();
        harvester.advance(5.0).unwrap();
        // A chattering end takes ln(depth) / (1 - r) bounces, so that r near 1 costs more.
        let bound = 5.0 * frequency * 2.0 * (50.0 + 20.0 / (1.0 - restitution).max(1e-2));
        prop_assert!((harvester.totals().events() as f64) < bound, "{:?}", harvester.totals());
    }
}

#[test]
fn bounces_that_never_die_away_end_in_rest_below_rounding_or_in_an_error() {
    for restitution in [1.0 - 1e-8, 1.0 - 1e-16, 1.0] {
        // A ball that touches the membrane with next to no speed while the wall pushes.
        let p = Parameters { restitution, cylinder_velocity: 1e-9, ..Parameters::default() };
        let p = Parameters { cylinder_position: p.travel() / 2.0, ..p };
        let mut harvester = Harvester::new(&p, 0.0).unwrap();
        match harvester.advance(1.0) {
            Ok(()) => assert!(harvester.totals().events() <= 1_000_000, "{:?}", harvester.totals()),
            Err(error) => assert!(error.to_string().contains("membrane.restitution = "), "{error}"),
        }
    }
}
