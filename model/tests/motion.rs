//! The event-driven motion: against brute force, without missed impacts, independent of the steps.

#![allow(clippy::unwrap_used, clippy::panic, clippy::cast_possible_truncation, clippy::cast_sign_loss)]

#[path = "common/brute.rs"]
mod brute;
#[path = "common/mounts.rs"]
mod mounts;

use brute::Brute;
use mounts::{follow_brute_force, sensitivity};
use proptest::prelude::*;
use std::f64::consts::TAU;
use videg_model::{Case, Event, Harvester, ModelError, NoiseModel, Parameters, Side};

/// Times and speeds of the impacts up to `until`, found by going from one predicted impact to the next.
fn impacts(harvester: &mut Harvester, until: f64) -> Vec<(f64, f64)> {
    let at_start = harvester.present_impact().map(|impact| (impact.time, impact.speed));
    let mut list = Vec::from_iter(at_start);
    while harvester.time() < until {
        let target = harvester.next_impact().unwrap_or(until).min(harvester.time() + 0.05).min(until);
        let show = |shown: &Event| {
            let Event::Impact(impact) = shown else { return };
            assert_eq!(impact.time, target, "not predicted");
            list.push((impact.time, impact.speed));
        };
        harvester.advance_with(target, show).unwrap();
    }
    list
}

prop_compose! {
    fn any_parameters()(
        amplitude in 0.0..2.0,
        frequency in 0.5..5.0,
        phase in 0.0..TAU,
        restitution in prop_oneof![Just(1.0), Just(0.0), 0.1..1.0],
        position in -0.9..0.9,
        velocity in -0.5..0.5,
    ) -> Parameters {
        let p = Parameters { amplitude, frequency, phase, restitution, ..Parameters::default() };
        Parameters { ball_position: position * p.travel() / 2.0, ball_velocity: velocity, ..p }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn the_motion_is_that_of_brute_force_until_chaos_separates_them(p in any_parameters()) {
        let harvester = Harvester::new(&p, 0.0).unwrap();
        follow_brute_force(harvester, Brute::new(p, 5e-6), [1e-9, 1e-5], |time| sensitivity(p, 1e-7, time))?;
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn the_ball_never_leaves_the_gap(p in any_parameters(), steps in prop::collection::vec(1e-4..0.05, 200)) {
        let mut harvester = Harvester::new(&p, 0.0).unwrap();
        for step in steps {
            harvester.advance(harvester.time() + step).unwrap();
            let beyond = harvester.relative_displacement().abs() - p.travel() / 2.0;
            prop_assert!(beyond < 1e-12, "{beyond:e} m beyond a membrane at {} s", harvester.time());
        }
    }

    #[test]
    fn splitting_a_run_changes_no_bit(
        p in any_parameters(),
        noise in prop_oneof![Just(0.0), Just(0.5)],
        wiener in any::<bool>(),
        cuts in prop::collection::vec(0.0..4.0, 0..40),
    ) {
        let noise_model = if wiener { NoiseModel::Wiener } else { NoiseModel::Held };
        let p = Parameters { phase_noise: noise, noise_hold: 1e-3, noise_model, ..p };
        let mut straight = Harvester::new(&p, 0.0).unwrap();
        straight.advance(4.0).unwrap();
        let mut split = Harvester::new(&p, 0.0).unwrap();
        let mut cuts = cuts;
        cuts.sort_by(f64::total_cmp);
        for cut in cuts {
            split.advance(cut).unwrap();
            split.set_external_force(0.0, 0.0).unwrap(); // what it is already
        }
        split.advance(4.0).unwrap();
        for harvester in [&mut straight, &mut split] {
            harvester.set_external_force(0.0, 0.0).unwrap(); // sensitivities are counted from here in both
        }
        // Equal in every field, to the last bit, what is predicted included.
        prop_assert_eq!(straight, split);
    }

    #[test]
    fn splitting_a_run_with_the_noise_of_the_paper_changes_no_bit(
        p in any_parameters(),
        noise in prop_oneof![Just(0.02), Just(0.5), Just(1.0), Just(4.0), Just(10.0)],
        seed in any::<i32>(),
        cuts in prop::collection::vec(0.0..0.4, 0..40),
        on_grid in any::<bool>(),
        force in -0.05..0.05,
    ) {
        let p = Parameters { phase_noise: noise, seed, ..p };
        let mut cuts = cuts;
        cuts.sort_by(f64::total_cmp);
        let runs = [&cuts[..], &[]].map(|cuts| {
            let mut harvester = Harvester::new(&p, 0.0).unwrap();
            harvester.set_external_force(force, -0.1).unwrap();
            for cut in cuts {
                // At the ends of hold intervals and in between; one step after the other through a block.
                let time = if on_grid { (cut / 1e-5).round() * 1e-5 } else { *cut };
                harvester.advance(time.max(harvester.time())).unwrap();
                harvester.advance(harvester.time() + 3e-6).unwrap();
            }
            harvester.advance(0.41).unwrap();
            harvester
        });
        prop_assert_eq!(&runs[0], &runs[1]);
    }

    #[test]
    fn a_graze_is_found_or_passed_by_as_the_exact_extremum_says(
        drift in -0.3_f64..0.3, excess in prop_oneof![-1e-6..-1e-12_f64, 1e-12..1e-6_f64], phase in 0.0..TAU,
    ) {
        // dz = drift t - swing (cos(wt + phase) - cos(phase)) + dz0: place its first maximum at s/2 + excess.
        let base = Parameters { amplitude: 0.3, phase, restitution: 1.0, ..Parameters::default() };
        let omega = TAU * base.frequency;
        let swing = base.cylinder_amplitude();
        prop_assume!(drift.abs() < 0.9 * swing * omega);
        let dz = |t: f64| drift * t - swing * ((omega * t + phase).cos() - phase.cos());
        // First maximum after the start: dz' = drift + swing w sin = 0 with cos < 0.
        let angle = std::f64::consts::PI - (-drift / (swing * omega)).asin();
        let mut time = (angle - phase) / omega;
        while time < 0.02 { time += TAU / omega; }
        let level = base.travel() / 2.0 + excess;
        let start: f64 = level - dz(time);
        // Only if the start and all before the maximum stay well inside.
        let inside = (0..2000).map(|k| start + dz(time * f64::from(k) / 2000.0)).take(1900).all(|z: f64| z.abs() < 0.0219);
        prop_assume!(inside);
        // Ball velocity such that z_M' - z_m' = drift + swing w sin(wt + phase).
        let p = Parameters { ball_position: -start, ball_velocity: -drift - swing * omega * phase.sin(), ..base };
        let mut harvester = Harvester::new(&p, 0.0).unwrap();
        harvester.advance(time + 1e-4).unwrap();
        prop_assert_eq!(harvester.totals().impacts > 0, excess > 0.0, "start {}, maximum at {} s", start, time);
    }

    #[test]
    fn a_linear_external_force_moves_the_cylinder_as_newton_says(
        p in any_parameters(), force in -0.5..0.5, rate in -1.0..1.0, when in 0.1..0.9,
    ) {
        let mut harvester = Harvester::new(&p, 0.0).unwrap();
        harvester.advance(when).unwrap();
        harvester.set_external_force(force, rate).unwrap();
        let mut free = Harvester::new(&p, 0.0).unwrap();
        for k in 1..40 {
            let time = when + 0.05 * f64::from(k);
            harvester.advance(time).unwrap();
            free.advance(time).unwrap();
            let tau = time - when;
            let shift = (force / 2.0 + rate * tau / 6.0) * tau * tau / p.cylinder_mass;
            let found = harvester.cylinder_position() - free.cylinder_position();
            prop_assert!((found - shift).abs() < 1e-12 * (1.0 + shift.abs()));
            let beyond = harvester.relative_displacement().abs() - p.travel() / 2.0;
            prop_assert!(beyond < 1e-11, "{beyond:e} m beyond a membrane");
        }
    }
}

#[test]
fn an_external_force_alone_drives_the_ball_to_the_membrane_at_the_time_of_free_fall() {
    let p = Parameters { amplitude: 0.0, restitution: 0.0, ..Parameters::default() };
    let mut harvester = Harvester::new(&p, 0.0).unwrap();
    harvester.set_external_force(0.1245, 0.0).unwrap(); // 1 m/s^2
    let expected = (2.0 * p.travel() / 2.0_f64).sqrt();
    assert!((harvester.next_impact().unwrap() - expected).abs() < 1e-14);
    harvester.advance(1.0).unwrap();
    assert_eq!(harvester.resting(), Some(Side::Left));
    harvester.set_external_force(-0.1245, 0.0).unwrap();
    harvester.advance(1.2).unwrap();
    assert_eq!(harvester.resting(), None, "released when the push turns");
    assert!((harvester.ball_velocity() - 1.0).abs() < 1e-14, "the ball keeps the velocity of the release");
}

#[test]
fn an_hour_long_run_loses_nothing_of_the_phase() {
    let p = (Case::find("fig9").unwrap().parameters)();
    let mut harvester = Harvester::new(&p, 0.0).unwrap();
    harvester.advance(1.0e6 + 0.125).unwrap(); // a whole number of periods and a quarter
    assert!((harvester.cylinder_velocity() - p.cylinder_amplitude() * TAU * 2.0).abs() < 1e-15);
    assert_eq!(harvester.next_impact(), None);
}

#[test]
fn times_and_forces_that_make_no_sense_are_errors() {
    let mut harvester = Harvester::new(&Parameters::default(), 0.0).unwrap();
    harvester.advance(1.0).unwrap();
    assert_eq!(harvester.advance(0.5), Err(ModelError::Backwards { from: 1.0, to: 0.5 }));
    assert!(matches!(harvester.advance(f64::NAN), Err(ModelError::NotFinite { name: "time", .. })));
    assert!(harvester.set_external_force(f64::INFINITY, 0.0).is_err());
    assert!(harvester.set_external_force(0.0, f64::NAN).is_err());
    assert_eq!(harvester.time(), 1.0);
    let noisy = Parameters { phase_noise: 1.0, noise_hold: 1e-9, ..Parameters::default() };
    let beyond = [1e9_f64.next_up(), -1e9_f64.next_up(), 1e15, f64::INFINITY, f64::NAN];
    for (p, start) in beyond.map(|start| (Parameters::default(), start)).into_iter().chain([(noisy, 5e8)]) {
        let error = Harvester::new(&p, start).unwrap_err().to_string();
        assert!(error.starts_with(&format!("start time = {start} s is outside")), "{error}");
    }
    assert!(Harvester::new(&noisy, 1e6).is_ok() && Harvester::new(&noisy, -1.0).is_ok());
}

#[test]
fn parameters_that_contradict_each_other_are_named() {
    let error = Harvester::new(&Parameters { ball_radius: 0.007, ..Parameters::default() }, 0.0).unwrap_err();
    assert_eq!(error.to_string(), "membrane.radius = 0.0063 m must be greater than ball.radius = 0.007 m");
    let error = Harvester::new(&Parameters { cylinder_length: 0.0, frame_width: 0.001, ..Parameters::default() }, 0.0);
    assert!(error.unwrap_err().to_string().contains("ball.travel"));
}

#[test]
fn stable_cases_have_the_impacts_of_brute_force_one_by_one() {
    for (case, until, slowest) in [("fig14", 10.0, 0.0), ("fig15", 10.0, 0.0), ("table3-2hz", 2.0, 1e-2)] {
        let p = (Case::find(case).unwrap().parameters)();
        let mut brute = Brute::new(p, 1e-5);
        brute.run(until);
        let resolved = |list: &[(f64, f64)]| list.iter().copied().filter(|i| i.1 > slowest).collect::<Vec<_>>();
        let ours = resolved(&impacts(&mut Harvester::new(&p, 0.0).unwrap(), until));
        let theirs = resolved(&brute.impacts);
        assert!(ours.len() > 20 && ours.len() == theirs.len(), "{case}: {} against {}", ours.len(), theirs.len());
        for (a, b) in ours.iter().zip(&theirs) {
            assert!((a.0 - b.0).abs() < 1e-6 && (a.1 - b.1).abs() < 1e-6, "{case}: {a:?} {b:?}");
        }
    }
}
