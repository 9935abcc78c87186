//! Inclination, suspension, friction, momentum-keeping impacts and prescribed motion, in any combination: against small steps of
//! Runge and Kutta with bisected events, and in the energy books.

#![allow(clippy::unwrap_used, clippy::panic, clippy::cast_possible_truncation, clippy::cast_sign_loss)]

#[path = "common/brute.rs"]
mod brute;
#[path = "common/mounts.rs"]
mod mounts;

use brute::{Brute, Recorded, small_steps};
use mounts::{
    any_mount, close_books, compliant, follow_brute_force, follow_small_steps, meet_predictions, positions,
    sensitivity, straight_and_split,
};
use proptest::prelude::*;
use std::f64::consts::FRAC_PI_4;
use videg_model::{Case, Event, ExcitationKind, Harvester, ModelError, NoiseModel, Parameters, Side};

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    #[test]
    fn the_motion_is_that_of_brute_force_until_chaos_separates_them(p in any_mount()) {
        let harvester = Harvester::new(&p, 0.0).unwrap();
        follow_brute_force(harvester, Brute::new(p, 2e-5), [3e-5; 2], |time| sensitivity(p, 1e-7, time))?;
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    #[test]
    fn the_energy_books_close(p in any_mount(), force in -0.5..0.5_f64, is_compliant in any::<bool>()) {
        let p = if is_compliant { compliant(p) } else { p };
        close_books(Harvester::new(&p, 0.0).unwrap(), force)?;
    }

    #[test]
    fn splitting_a_run_changes_no_bit(
        p in any_mount(),
        noise in prop_oneof![Just(0.0), Just(0.5)],
        wiener in any::<bool>(),
        cuts in prop::collection::vec(0.0..2.0, 0..40),
        is_compliant in any::<bool>(),
    ) {
        let p = if is_compliant { compliant(p) } else { p };
        let noise_model = if wiener { NoiseModel::Wiener } else { NoiseModel::Held };
        let p = Parameters { phase_noise: noise, noise_hold: 1e-2, noise_model, ..p };
        let [straight, split] = straight_and_split(&p, cuts);
        prop_assert_eq!(straight, split);
    }

    #[test]
    fn an_impact_comes_when_it_was_predicted_and_none_before(p in any_mount(), steps in prop::collection::vec(1e-3..0.05, 40)) {
        meet_predictions(Harvester::new(&p, 0.0).unwrap(), &steps)?;
    }

    #[test]
    fn the_ball_never_leaves_the_gap(p in any_mount(), steps in prop::collection::vec(1e-4..0.05, 100)) {
        let mut harvester = Harvester::new(&p, 0.0).unwrap();
        for step in steps {
            harvester.advance(harvester.time() + step).unwrap();
            let beyond = harvester.relative_displacement().abs() - p.travel() / 2.0;
            prop_assert!(beyond < 1e-12, "{beyond:e} m beyond a membrane at {} s", harvester.time());
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(10))]

    #[test]
    fn contacts_that_take_time_are_those_of_small_steps(p in any_mount()) {
        let p = compliant(Parameters { excitation_kind: ExcitationKind::Force, ..p });
        let until = 0.3;
        prop_assume!(sensitivity(p, 1e-7, until) < 1e-5);
        let steps = [2e-6, 1e-6].map(|dt| small_steps(&p, &Recorded::default(), until, dt));
        follow_small_steps(Harvester::new(&p, 0.0).unwrap(), &steps, until)?;
    }
}

#[test]
fn friction_lowers_the_voltage_gain_of_figure_14() {
    let p = Parameters {
        friction: 0.05,
        ball_velocity: 0.0,
        ball_position: 0.0,
        cylinder_position: 0.0,
        ..(Case::find("fig14").unwrap().parameters)()
    };
    let mut harvester = Harvester::new(&p, 0.0).unwrap();
    harvester.advance(30.0).unwrap();
    let gained = harvester.totals().voltage_gain;
    harvester.advance(60.0).unwrap();
    let gain = (harvester.totals().voltage_gain - gained) / 30.0;
    assert!((gain - 7112.094).abs() < 1e-3, "{gain}");
}

#[test]
fn gravity_makes_a_ball_rest_for_ever_on_the_lower_membrane() {
    let p = Parameters { inclination: 0.5, amplitude: 0.1, ..Parameters::default() };
    let mut harvester = Harvester::new(&p, 0.0).unwrap();
    harvester.advance(1e5).unwrap();
    assert_eq!(harvester.resting(), Some(Side::Left));
    assert!(harvester.totals().events() < 100, "{:?}", harvester.totals());
    assert_eq!(harvester.next_impact(), None);
}

/// Accelerations that friction just holds, or just does not: neither is left by rounding, again and again.
#[test]
fn a_ball_at_the_limit_of_friction_does_not_set_out_and_halt_for_ever() {
    let mu_g = 0.39 * 9.80665;
    for amplitude in
        [3.824_593_5, mu_g, f64::next_up(mu_g), f64::next_down(mu_g), mu_g * (1.0 + 1e-13), mu_g * (1.0 + 1e-9)]
    {
        let p = Parameters { cylinder_mass: 1.0, amplitude, friction: 0.39, ..Parameters::default() };
        let mut harvester = Harvester::new(&p, 0.0).unwrap();
        harvester.advance(2.0).unwrap();
        assert!(harvester.relative_displacement().abs() < 1e-6, "{}", harvester.relative_displacement());
    }
    // As steep as friction holds, with the cylinder at rest: a push starts the ball, friction never stops it.
    for beta in [0.3_f64, FRAC_PI_4, 0.2] {
        let p = Parameters {
            inclination: beta,
            friction: beta.tan(),
            ball_velocity: -0.01,
            amplitude: 0.05,
            ..Parameters::default()
        };
        let mut brute = Brute::new(p, 1e-5);
        brute.run(4.0);
        let mut harvester = Harvester::new(&p, 0.0).unwrap();
        harvester.advance(brute.time).unwrap();
        let expected = brute.state[0] - brute.state[2];
        assert!(
            (harvester.relative_displacement() - expected).abs() < 1e-5,
            "{beta}: {} {expected}",
            harvester.relative_displacement()
        );
    }
}

/// A force that jumps and is over before the piece of a suspended motion is.
#[test]
fn a_stuck_ball_is_torn_off_by_a_jump_of_force_that_a_damper_takes_back() {
    let p = Parameters {
        cylinder_mass: 1.0,
        suspension_damping: 1.0,
        amplitude: 0.0,
        frequency: 0.01,
        gravity: 10.0,
        friction: 0.1,
        ..Parameters::default()
    };
    let mut harvester = Harvester::new(&p, 0.0).unwrap();
    harvester.advance(0.5).unwrap();
    assert!(harvester.is_stuck());
    harvester.set_external_force(1.2, 0.0).unwrap();
    harvester.advance(3.0).unwrap();
    // The cylinder has the acceleration 1.2 e^-t, the ball 1: until both are as fast again.
    let velocity = |t: f64| 1.2 * (1.0 - (-t).exp()) - t;
    let (mut low, mut high) = (0.2, 1.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if velocity(middle) > 0.0 { low = middle } else { high = middle }
    }
    let way = 1.2 * (low + (-low).exp() - 1.0) - 0.5 * low * low;
    assert!(
        way > 4e-3 && (harvester.relative_displacement() - way).abs() < 1e-12,
        "{}",
        harvester.relative_displacement()
    );
    assert!(harvester.is_stuck());
}

#[test]
fn an_external_force_moves_no_shaker_with_or_without_noise() {
    for noise in [0.0, 0.5] {
        let p = Parameters {
            excitation_kind: ExcitationKind::Motion,
            acceleration: 4.0,
            phase_noise: noise,
            noise_hold: 1e-3,
            ..Parameters::default()
        };
        let [mut pushed, mut alone] = [p, p].map(|p| Harvester::new(&p, 0.0).unwrap());
        pushed.set_external_force(1.0, 0.5).unwrap();
        for time in [0.1, 0.5, 2.0] {
            pushed.advance(time).unwrap();
            alone.advance(time).unwrap();
            assert_eq!(positions(&pushed), positions(&alone));
            let taken = pushed.mount_force() - alone.mount_force();
            assert!((taken + 1.0 + 0.5 * time).abs() < 1e-12, "{taken} N at {time} s");
        }
    }
}

#[test]
fn friction_without_weight_is_none() {
    let p = Parameters { friction: 0.1, gravity: 0.0, ..(Case::find("fig14").unwrap().parameters)() };
    let [mut with, mut without] = [p, Parameters { friction: 0.0, ..p }].map(|p| Harvester::new(&p, 0.0).unwrap());
    with.advance(5.0).unwrap();
    without.advance(5.0).unwrap();
    assert_eq!(positions(&with), positions(&without));
    assert_eq!(Harvester::restore(&p, &with.snapshot()).unwrap(), with);
}

#[test]
fn a_suspension_needs_a_force_and_a_mass_that_it_can_move() {
    let stiff = Parameters { suspension_stiffness: 10.0, ..Parameters::default() };
    let driven = Parameters { excitation_kind: ExcitationKind::Motion, ..stiff };
    assert!(matches!(driven.validate(), Err(ModelError::NeedsForce { name: "cylinder.suspensionStiffness", .. })));
    let too_stiff = Parameters { cylinder_mass: 1e-3, suspension_damping: 1e3, ..stiff };
    let error = too_stiff.validate().unwrap_err().to_string();
    assert!(error.starts_with("cylinder.suspensionDamping = 1e3 N.s/m is too large for cylinder.mass"), "{error}");
}

/// The pieces of its series are of 8 us here, the period of 1000 s: a search of all of that takes a minute before the first step ends.
#[test]
fn a_suspension_of_short_pieces_announces_impacts_a_million_pieces_ahead() {
    let p = Parameters { suspension_damping: 1e4, frequency: 1e-3, ball_velocity: 2.2e-3, ..Parameters::default() };
    let [mut whole, mut split] = [(); 2].map(|()| Harvester::new(&p, 0.0).unwrap());
    let horizon = whole.known_until();
    assert!((8.0..8.2).contains(&horizon), "{horizon} s");
    assert_eq!(whole.next_impact(), None);
    split.advance(4.0).unwrap();
    let announced = split.next_impact().unwrap();
    assert!((9.0..12.0).contains(&announced), "{announced} s");
    let mut came = Vec::new();
    let mut note =
        |event: &Event| came.extend(if let Event::Impact(impact) = event { Some(impact.time) } else { None });
    whole.advance_with(12.0, &mut note).unwrap();
    assert_eq!(came.first(), Some(&announced));
    split.advance(12.0).unwrap();
    assert_eq!(whole, split);
}
