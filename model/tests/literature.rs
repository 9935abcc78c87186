//! The capsule of the literature: its 1:1 orbits against their closed form, and what follows them.

#![allow(clippy::unwrap_used, clippy::panic)]

#[path = "common/capsule.rs"]
mod capsule;

use std::f64::consts::TAU;

use capsule::{Capsule, Orbit};
use proptest::prelude::*;
use videg_model::{Event, ExcitationKind, Harvester, Impact, Parameters, Side};

prop_compose! {
    /// A capsule that is free or on a shaker.
    fn any_capsule()(
        amplitude in 1.0..10.0,
        frequency in 1.0..4.0,
        restitution in 0.1..0.9,
        travel in 0.05..1.5,
        inclination in prop_oneof![Just(0.0), -1.2..1.2, 0.0..0.3],
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

/// Started on the orbit, right after an impact on the left, `delay` s and `faster` m/s beside it.
fn started(p: Parameters, orbit: &Orbit, delay: f64, faster: f64) -> Harvester {
    let ball_velocity = p.restitution * orbit.speeds[0] - faster;
    let phase = orbit.phase + TAU * p.frequency * delay;
    Harvester::new(&Parameters { ball_position: -p.travel() / 2.0, ball_velocity, phase, ..p }, 0.0).unwrap()
}

/// Impacts of a flight up and one down.
fn impacts(harvester: &mut Harvester, until: f64) -> Vec<Impact> {
    let mut impacts = Vec::new();
    harvester
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
    let mut harvester = started(p, orbit, delay, faster);
    let impacts = impacts(&mut harvester, 1.5 / p.frequency);
    let last = impacts.iter().find(|impact| impact.side == Side::Left).unwrap();
    [delay + last.time - 1.0 / p.frequency, p.restitution * (orbit.speeds[0] - last.speed)]
}

/// Orbits of which rounding decides nothing, as it does near a graze and where it is multiplied again and again.
fn resolved(p: &Parameters) -> impl Iterator<Item = Orbit> {
    let is_resolved = |orbit: &Orbit| {
        orbit.clearance > 1e-3 && orbit.speeds.iter().all(|speed| *speed > 0.1) && orbit.trace.abs() < 1e2
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
             let seen = impacts(&mut started(p, &orbit, 0.0, 0.0), 1.0001 * period);
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
            let (period, step) = (1.0 / p.frequency, 1e-5);
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
