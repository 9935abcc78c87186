//! The 1:1 orbits that are found and followed against their closed form.

use std::f64::consts::{FRAC_PI_4, PI, TAU};

use approx::assert_relative_eq;
use proptest::prelude::*;
use videg::dynamics::orbits::{self, Bifurcation, Orbit, Search};
use videg_model::{Case, Parameters, Side};

use super::capsule::{self, Capsule};
use super::{at, over};

/// The capsule of the literature.
fn inclined(travel: f64, inclination: f64) -> Parameters {
    with_travel(Parameters { inclination, ..(Case::find("capsule-1-1").unwrap().parameters)() }, travel)
}

fn with_travel(p: Parameters, travel: f64) -> Parameters {
    Parameters { cylinder_length: travel - 2.0 * p.frame_width + 2.0 * p.ball_radius, ..p }
}

/// The orbit with the strongest impact on the left: at the literature's parameters the stable one.
fn main_orbit(p: &Parameters) -> capsule::Orbit {
    let orbits = Capsule::new(p).orbits();
    orbits.into_iter().max_by(|a, b| a.speeds[0].total_cmp(&b.speeds[0])).unwrap()
}

/// Where the period of the main orbit doubles.
fn doubling(at: impl Fn(f64) -> Parameters, range: [f64; 2]) -> f64 {
    let first = main_orbit(&at(range[0]));
    capsule::root(|value| Capsule::new(&at(value)), first, capsule::Orbit::period_doubling, range)
}

/// Compares phase, speeds and multipliers of an orbit that was found with the closed form, to a relative `tolerance`.
fn compare(found: &Orbit, p: &Parameters, tolerance: f64) {
    let of = |side| found.impacts.iter().find(|impact| impact.side == side).unwrap();
    let (left, right) = (of(Side::Left), of(Side::Right));
    let across = (right.time - left.time).rem_euclid(1.0) / p.frequency;
    let distance = |orbit: &capsule::Orbit| (orbit.flight - across).abs();
    let solutions = Capsule::new(p).solutions();
    let exact = solutions.iter().min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap();
    assert_relative_eq!(across, exact.flight, max_relative = tolerance);
    let late = (left.time - exact.phase / TAU + 0.5).rem_euclid(1.0) - 0.5;
    assert!(late.abs() < tolerance, "phase {} against {}", left.time, exact.phase / TAU);
    assert_relative_eq!(left.speed, exact.speeds[0], max_relative = tolerance);
    assert_relative_eq!(right.speed, exact.speeds[1], max_relative = tolerance);
    let [one, two] = &found.multipliers.0[..] else { panic!("{:?}", found.multipliers) };
    let scale = 1.0 + exact.trace.abs();
    assert!((one + two).im.abs() < 1e-12 && ((one + two).re - exact.trace).abs() < tolerance * scale, "{exact:?}");
    assert!(((one * two).re - exact.determinant).abs() < tolerance * scale, "{exact:?}");
}

fn is_one_to_one(orbit: &Orbit) -> bool {
    orbit.period == 1 && orbit.pattern.letters() == "LR"
}

#[test]
fn the_orbit_of_the_literatures_capsule_is_the_closed_form() {
    let p = inclined(0.55, FRAC_PI_4);
    let found = orbits::orbits(&at(p), &Search::default(), &()).unwrap();
    let stable: Vec<_> = found.iter().filter(|orbit| orbit.is_stable()).collect();
    let [orbit] = stable[..] else { panic!("{} stable orbits", stable.len()) };
    assert!(is_one_to_one(orbit));
    compare(orbit, &p, 1e-9);
    // Brute force with bisected impacts: 6.431569 and 4.582409 m/s.
    let exact = main_orbit(&p).speeds;
    assert!((exact[0] - 6.431_569).abs() < 1e-6 && (exact[1] - 4.582_409).abs() < 1e-6, "{exact:?}");
}

#[test]
fn the_period_doubling_is_the_root_of_the_closed_form() {
    let doublings = |problem: &videg::dynamics::Problem| -> Vec<f64> {
        let search = Search { periods: 1, ..Search::default() };
        let branches = orbits::branches(problem, &search, &()).unwrap();
        let marks = branches.iter().flat_map(|branch| &branch.marks);
        let marks = marks.filter(|mark| mark.kind == Bifurcation::PeriodDoubling && is_one_to_one(&mark.orbit));
        marks.map(|mark| mark.orbit.point.value).collect()
    };
    let by_travel = doubling(|s| inclined(s, FRAC_PI_4), [0.5, 0.45]);
    let length = inclined(by_travel, FRAC_PI_4).cylinder_length;
    let found = doublings(&over(inclined(0.55, FRAC_PI_4), "cylinder.length", 0.4, 0.6));
    assert!(found.iter().any(|value| (value - length).abs() < 1e-6), "{found:?} against {length}");
    let by_inclination = doubling(|beta| inclined(0.55, beta), [1.1, 1.3]);
    let found = doublings(&over(inclined(0.55, FRAC_PI_4), "cylinder.inclination", 0.5, 1.4));
    assert!(found.iter().any(|value| (value - by_inclination).abs() < 1e-6), "{found:?} against {by_inclination}");
}

#[test]
fn every_point_of_a_branch_is_the_closed_form() {
    let problem = over(inclined(0.55, FRAC_PI_4), "excitation.frequency", 2.2, 3.0);
    let search = Search { periods: 1, ..Search::default() };
    let branches = orbits::branches(&problem, &search, &()).unwrap();
    let points: Vec<_> =
        branches.iter().flat_map(|branch| &branch.orbits).filter(|orbit| is_one_to_one(orbit)).collect();
    assert!(points.len() > 40 && points.iter().any(|orbit| !orbit.is_stable()));
    // Near a grazing impact the closed form itself is badly conditioned.
    for orbit in points.into_iter().filter(|orbit| orbit.least_speed > 0.3) {
        compare(orbit, &problem.at(orbit.point.value), 1e-8);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    #[test]
    fn orbits_of_random_capsules_are_the_closed_form(
        travel in 0.02_f64..1.0, inclination in 0.1_f64..1.5, restitution in 0.2_f64..0.95,
        frequency in 0.5_f64..20.0, strength in 0.5_f64..4.0, mass in 0.02_f64..1.0, phase in -PI..PI,
    ) {
        // The swing of the cylinder is of the order of the travel, so that impacts on both sides are common.
        let w = TAU * frequency;
        let amplitude = mass * w * w * travel * strength / 4.0;
        let p = with_travel(
            Parameters { cylinder_mass: mass, amplitude, frequency, restitution, inclination, ..Parameters::default() },
            travel,
        );
        let found = orbits::orbits(&at(p), &Search { periods: 1, starts: 12, ..Search::default() }, &()).unwrap();
        // Beside a fold two orbits are too near to each other to be told apart, far from stability digits are lost.
        let is_clear = |orbit: &&Orbit| {
            let away = |value: &nalgebra::Complex<f64>| (value.re - 1.0).hypot(value.im) > 0.05;
            orbit.multipliers.largest() < 50.0 && orbit.multipliers.0.iter().all(away)
        };
        for orbit in found.iter().filter(|orbit| is_one_to_one(orbit)).filter(is_clear) {
            compare(orbit, &p, 1e-7);
        }
        // Times are counted from where the excitation has its initial phase.
        let shifted = orbits::orbits(&at(Parameters { phase, ..p }), &Search { periods: 1, starts: 12, ..Search::default() }, &());
        let stable = |orbits: &[Orbit]| {
            let stable: Vec<Orbit> = orbits.iter().filter(|orbit| is_one_to_one(orbit)).filter(|orbit| orbit.is_stable()).cloned().collect();
            stable
        };
        for (a, b) in stable(&found).iter().zip(stable(&shifted.unwrap())).take(1) {
            let time = |orbit: &Orbit| orbit.impacts.iter().find(|impact| impact.side == Side::Left).unwrap().time;
            if (a.voltage_gain - b.voltage_gain).abs() < 1e-9 * a.voltage_gain {
                let late = (time(a) - time(&b) - phase / TAU + 0.5).rem_euclid(1.0) - 0.5;
                prop_assert!(late.abs() < 1e-9, "{late}");
            }
        }
    }
}
