//! The capsule of the literature: its 1:1 orbits against their closed form, and what follows them.

#![allow(clippy::unwrap_used, clippy::panic)]

#[path = "common/capsule.rs"]
mod capsule;
#[path = "common/steady.rs"]
mod steady;

use std::f64::consts::{FRAC_PI_3, FRAC_PI_4, FRAC_PI_6, TAU};

use capsule::{Capsule, Orbit};
use proptest::prelude::*;
use steady::Motion;
use videg_model::{Case, Event, ExcitationKind, Harvester, Impact, Parameters, Side};

/// Periods after which a motion has settled.
const SETTLED: u32 = 500;

prop_compose! {
    /// A capsule that is free or on a shaker.
    fn any_capsule()(
        amplitude in 1.0..10.0,
        frequency in 1.0..4.0,
        restitution in 0.1..0.9,
        travel in 0.05..1.5,
        inclination in prop_oneof![Just(0.0), -1.2..1.2, 0.0..0.3, 0.01..0.1],
        friction in prop_oneof![Just(0.0), 0.0..0.3],
        reaction in any::<bool>(),
        is_driven in any::<bool>(),
    ) -> Parameters {
        let excitation_kind = if is_driven { ExcitationKind::Motion } else { ExcitationKind::Force };
        let p = Parameters {
            amplitude, frequency, restitution, inclination, friction, reaction, excitation_kind,
            acceleration: 8.0 * amplitude,
            ..Parameters::default()
        };
        of_travel(p, travel)
    }
}

/// The same with `ball.travel` of `travel`.
fn of_travel(p: Parameters, travel: f64) -> Parameters {
    Parameters { cylinder_length: travel - 2.0 * p.frame_width + 2.0 * p.ball_radius, ..p }
}

/// A start on the orbit, right after an impact on the left, `delay` s and `faster` m/s beside it.
fn start(p: Parameters, orbit: &Orbit, delay: f64, faster: f64) -> Parameters {
    let ball_velocity = p.restitution * orbit.speeds[0] - faster;
    let phase = orbit.phase + TAU * p.frequency * delay;
    Parameters { ball_position: -p.travel() / 2.0, ball_velocity, phase, ..p }
}

/// Impacts from the start until then.
fn impacts(p: &Parameters, until: f64) -> Vec<Impact> {
    let mut impacts = Vec::new();
    Harvester::new(p, 0.0)
        .unwrap()
        .advance_with(until, |event| {
            if let Event::Impact(impact) = event {
                impacts.push(*impact);
            }
        })
        .unwrap();
    impacts
}

/// Delay and speed after the impact on the left that ends the period, from both at its start.
fn after_a_period(p: Parameters, orbit: &Orbit, delay: f64, faster: f64) -> [f64; 2] {
    let impacts = impacts(&start(p, orbit, delay, faster), 1.5 / p.frequency);
    let last = impacts.iter().find(|impact| impact.side == Side::Left).unwrap();
    [delay + last.time - 1.0 / p.frequency, p.restitution * (orbit.speeds[0] - last.speed)]
}

/// Orbits of which rounding decides nothing, as it does near a graze, where friction nearly holds the ball, where disturbances
/// grow a hundredfold, and in the closed form of flights that are nearly equal.
fn resolved(p: &Parameters) -> impl Iterator<Item = Orbit> {
    let frequency = p.frequency;
    let is_resolved = move |orbit: &Orbit| {
        let difference = (orbit.flight * frequency - 0.5).abs();
        let is_well_posed = difference == 0.0 || difference > 1e-4;
        let is_fast = orbit.slowest.abs() > 0.05 && orbit.speeds.iter().all(|speed| *speed > 0.1);
        is_well_posed && is_fast && orbit.clearance > 1e-3 && orbit.trace.abs() < 1e2
    };
    Capsule::new(p).orbits().into_iter().filter(is_resolved)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    /// Stable or not: one period from a start on the orbit.
    #[test]
    fn a_start_on_an_orbit_of_the_closed_form_returns_to_it(p in any_capsule()) {
        let period = 1.0 / p.frequency;
        for orbit in resolved(&p) {
             let seen = impacts(&start(p, &orbit, 0.0, 0.0), 1.0001 * period);
            let expected = [(Side::Right, orbit.flight, orbit.speeds[1]), (Side::Left, period, orbit.speeds[0])];
            prop_assert_eq!(seen.len(), 2, "{:?} {:?}", orbit, seen);
            for (impact, (side, time, speed)) in seen.iter().zip(expected) {
                prop_assert_eq!(impact.side, side);
                prop_assert!((impact.time - time).abs() < 1e-9 * period, "{:?} {:?}", impact, orbit);
                prop_assert!((impact.speed - speed).abs() < 1e-9 * speed, "{:?} {:?}", impact, orbit);
            }
        }
    }

    #[test]
    fn multipliers_of_the_closed_form_are_those_of_differences(p in any_capsule()) {
        for orbit in resolved(&p) {
            let (period, step) = (1.0 / p.frequency, 1e-6);
            let column = |delay: f64, faster: f64| {
                let [ahead, behind] = [1.0, -1.0].map(|sign| after_a_period(p, &orbit, sign * delay, sign * faster));
                [0, 1].map(|k| (ahead[k] - behind[k]) / (2.0 * (delay + faster)))
            };
            let (first, second) = (column(step * period, 0.0), column(0.0, step * orbit.speeds[0]));
            let (trace, product) = (first[0] + second[1], first[0] * second[1]);
            let determinant = product - first[1] * second[0];
            let size = 1.0 + trace.abs() + product.abs();
            prop_assert!((trace - orbit.trace).abs() < 1e-4 * size, "{} {:?}", trace, orbit);
            prop_assert!((determinant - orbit.determinant).abs() < 1e-4 * size, "{} {:?}", determinant, orbit);
        }
    }
}

fn case(name: &str) -> Parameters {
    (Case::find(name).unwrap().parameters)()
}

/// The orbit with the fastest impacts: the one that a ball reaches that was tossed up.
fn fastest(p: &Parameters) -> Orbit {
    Capsule::new(p).orbits().into_iter().max_by(|a, b| a.speeds[0].total_cmp(&b.speeds[0])).unwrap()
}

/// What came out of a brute-force integration with bisected impacts, of the closed form, and of a run from rest.
#[test]
fn the_capsule_settles_on_the_orbit_of_the_closed_form() {
    for (name, expected) in [("capsule-1-1", [6.431_569, 4.582_409]), ("capsule-friction", [5.702_423, 5.152_122])] {
        let (p, orbit) = (case(name), fastest(&case(name)));
        let motion = Motion::of(&p, SETTLED);
        assert_eq!((motion.sequence().as_str(), orbit.is_stable()), ("1:1", true), "{name}");
        for (k, side) in [Side::Left, Side::Right].into_iter().enumerate() {
            for speed in [orbit.speeds[k], motion.speeds(side)[0]] {
                assert!((speed - expected[k]).abs() < 1e-6 * speed, "{name}: {speed} against {}", expected[k]);
            }
            assert!((orbit.speeds[k] - motion.speeds(side)[0]).abs() < 1e-9, "{name}: {:?}", orbit.speeds);
        }
    }
}

#[test]
fn the_cases_move_as_their_names_say() {
    for (name, sequence) in [("capsule-2-1", "2:1"), ("capsule-3-1", "3:1"), ("capsule-soft", "1:1")] {
        assert_eq!(Motion::of(&case(name), SETTLED).sequence(), sequence, "{name}");
    }
}

/// Where the trace of the closed form is -1 - r^4 the simulation gets two periods.
#[test]
fn the_period_doubles_where_the_closed_form_says() {
    for (inclination, friction) in [(0.3, 0.0), (FRAC_PI_6, 0.0), (FRAC_PI_4, 0.0), (FRAC_PI_3, 0.0), (FRAC_PI_4, 0.1)]
    {
        let at = |travel| of_travel(Parameters { inclination, friction, ..case("capsule-1-1") }, travel);
        let capsule = |travel| Capsule::new(&at(travel));
        let first = fastest(&at(0.55));
        let found = capsule::root(capsule, first, Orbit::period_doubling, [0.55, 0.3]);
        let motion = |travel| {
            let orbit = capsule(travel).nearest(&first).unwrap();
            // Off the orbit, so that a stable one attracts it and an unstable one repels it.
            Motion::of(&start(at(travel), &orbit, 0.0, 1e-3), SETTLED).sequence()
        };
        // Disturbances fall and rise by some 1 % a period.
        assert_eq!(
            (motion(found + 0.004), motion(found - 0.004)),
            ("1:1".to_owned(), "2:2".to_owned()),
            "{inclination}"
        );
    }
}

/// Where the clearance of the closed form is 0 the ball meets the lower membrane once more.
#[test]
fn the_orbit_grazes_where_the_closed_form_says() {
    for (inclination, from) in [(0.1, 0.36), (FRAC_PI_6, 0.4), (FRAC_PI_4, 0.4), (FRAC_PI_3, 0.4)] {
        let at = |travel| of_travel(Parameters { inclination, ..case("capsule-1-1") }, travel);
        let capsule = |travel| Capsule::new(&at(travel));
        let first = fastest(&at(from));
        let found = capsule::root(capsule, first, |orbit| orbit.clearance, [from, 0.2]);
        let count = |travel: f64| {
            let orbit = capsule(travel).nearest(&first).unwrap();
            impacts(&start(at(travel), &orbit, 0.0, 0.0), 1.0001 / at(travel).frequency).len()
        };
        assert!(count(found + 1e-6) == 2 && count(found - 1e-6) > 2, "{inclination}: {found}");
    }
}
