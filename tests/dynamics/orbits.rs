//! Orbits against the saw-tooth orbit of Figure 10, long simulations, and differences of simulations.

use approx::assert_relative_eq;
use proptest::prelude::*;
use videg::dynamics::orbits::{self, Bifurcation, End, Orbit, Search};
use videg::dynamics::{Basins, Diagram, DynamicsError, Files, Flash, Motion, Periods, Problem, exponent};
use videg_model::{Case, ContactLaw, Event, Harvester, Impact, Parameters, Side};

use super::{at, over};

fn case(name: &str) -> Parameters {
    (Case::find(name).unwrap().parameters)()
}

/// Impacts of a run from `start` over `periods` more after `transient` periods.
fn impacts(p: &Parameters, transient: u32, periods: u32) -> Vec<Impact> {
    let period = 1.0 / p.frequency;
    let mut harvester = Harvester::new(p, 0.0).unwrap();
    harvester.advance(f64::from(transient) * period).unwrap();
    let mut seen = Vec::new();
    let keep = |event: &Event| {
        if let Event::Impact(impact) = event {
            seen.push(*impact);
        }
    };
    harvester.advance_with(f64::from(transient + periods) * period, keep).unwrap();
    seen
}

/// Parameters that start at the beginning of the first period after the orbit's point, on the orbit, the ball and its velocity
/// moved by these distances.
fn on_orbit(p: &Parameters, orbit: &Orbit, moved: [f64; 2]) -> Parameters {
    let [displacement, velocity] = orbit.flashes[0];
    let flash =
        Flash { displacement: displacement + moved[0], velocity: velocity + moved[1], cylinder: [0.0; 2], gain: 0.0 };
    let swing = p.harmonic_acceleration() / (std::f64::consts::TAU * p.frequency);
    flash.start(Parameters { cylinder_position: 0.0, cylinder_velocity: swing * p.phase.sin(), ..*p })
}

/// Trace and determinant of the derivative of the return map, by central differences of runs.
fn by_differences(p: &Parameters, orbit: &Orbit) -> [f64; 2] {
    // The error of the differences is least about here: of second order in the step, and rounding over it.
    const STEP: f64 = 1e-6;
    let end = |moved: [f64; 2]| {
        let p = on_orbit(p, orbit, moved);
        let mut harvester = Harvester::new(&p, 0.0).unwrap();
        harvester.advance(f64::from(orbit.period) / p.frequency).unwrap();
        let flash = Flash::of(&harvester);
        [flash.displacement, flash.velocity]
    };
    let column = |by: [f64; 2]| {
        let [ahead, behind] = [end(by), end(by.map(|step| -step))];
        [0, 1].map(|k| (ahead[k] - behind[k]) / (2.0 * STEP))
    };
    let [[a, c], [b, d]] = [column([STEP, 0.0]), column([0.0, STEP])];
    [a + d, a * d - b * c]
}

fn trace_and_determinant(orbit: &Orbit) -> [f64; 2] {
    let values = &orbit.multipliers.0;
    [(values[0] + values[1]).re, (values[0] * values[1]).re]
}

#[test]
fn figure_10_is_a_saddle_with_the_multiplier_of_the_closed_form() {
    let p = case("fig10");
    let found = orbits::orbits(&at(p), &Search { periods: 1, ..Search::default() }, &()).unwrap();
    // Half a period takes (delay, speed) through a matrix of determinant 1 and trace 2 + g T / V, g = A / M: V = 4 f0 z_m(0).
    let g = p.amplitude / p.cylinder_mass;
    let speed = 4.0 * p.frequency * (p.travel() / 2.0 - p.cylinder_amplitude());
    let trace = 2.0 + g / (p.frequency * speed);
    let half = 0.5 * (trace + (trace * trace - 4.0).sqrt());
    let saddle = found.iter().find(|orbit| !orbit.is_stable()).unwrap();
    assert_relative_eq!(saddle.multipliers.0[0].re, half * half, max_relative = 1e-9);
    assert_relative_eq!(saddle.multipliers.0[1].re, 1.0 / (half * half), max_relative = 1e-9);
    assert!((saddle.multipliers.0[0].re - 2.605).abs() < 1e-3);
    assert_relative_eq!(saddle.voltage_gain, 1_830.484_897_238_41, max_relative = 1e-9);
    // With the force of opposite sign it is a centre.
    assert!(found.iter().any(|orbit| (orbit.multipliers.largest() - 1.0).abs() < 1e-9));
}

#[test]
fn figure_14_is_an_orbit_of_two_periods_beside_its_mirror_image() {
    let p = case("fig14");
    let found = orbits::orbits(&at(p), &Search::default(), &()).unwrap();
    let stable: Vec<_> = found.iter().filter(|orbit| orbit.is_stable()).collect();
    let names: Vec<_> = stable.iter().map(|orbit| orbit.name()).collect();
    assert_eq!(names, ["4:2, 2 periods", "2:4, 2 periods"]);
    let motion = Motion::take(&p, 200, 60).unwrap();
    assert_eq!(motion.recurrence(), Some(2));
    assert!(exponent(&p, motion.last(), 100).unwrap().unwrap() < 0.0);
    for orbit in &stable {
        assert_relative_eq!(orbit.voltage_gain, 8_078.869_538_542_804, max_relative = 1e-9);
        let [a, b] = [trace_and_determinant(orbit), by_differences(&p, orbit)];
        assert!((a[0] - b[0]).abs() < 1e-5 && (a[1] - b[1]).abs() < 1e-5, "{a:?} {b:?}");
        // Each impact takes r^2 from the area of neighbouring states.
        assert_relative_eq!(a[1], 0.6_f64.powi(12), max_relative = 1e-6);
    }
}

/// Whether each impact of the run is one of the orbit, in time and speed.
fn is_on(orbit: &Orbit, run: &[Impact], period: f64) -> bool {
    let round = f64::from(orbit.period);
    let is_one = |impact: &Impact| {
        (0..orbit.period).any(|shift| {
            orbit.impacts.iter().any(|own| {
                let apart = (impact.time / period + f64::from(shift) - own.time).rem_euclid(round);
                apart.min(round - apart) < 1e-6 && (own.speed - impact.speed).abs() < 1e-6 * own.speed
            })
        })
    };
    run.iter().all(is_one)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 12, ..ProptestConfig::default() })]

    #[test]
    fn what_a_long_run_settles_on_is_among_the_orbits(
        travel in 0.02_f64..0.6, inclination in -1.2_f64..1.2, restitution in 0.2_f64..0.7,
        frequency in 1.0_f64..10.0, strength in 0.5_f64..3.0, friction in prop_oneof![Just(0.0), 0.01_f64..0.2],
        reaction: bool, stiffness in prop_oneof![Just(0.0), 1.0_f64..50.0],
    ) {
        let w = std::f64::consts::TAU * frequency;
        let mass = 0.1245;
        let base = Parameters::default();
        let p = Parameters {
            amplitude: mass * w * w * travel * strength / 4.0,
            cylinder_length: travel - 2.0 * base.frame_width + 2.0 * base.ball_radius,
            ball_mass: 0.1 * mass,
            suspension_stiffness: stiffness,
            suspension_damping: if stiffness > 0.0 { 2.0 } else { 0.0 },
            inclination, restitution, frequency, friction, reaction,
            ..base
        };
        let motion = Motion::take(&p, 600, 60).unwrap();
        let Some(period) = motion.recurrence().filter(|period| *period <= 2) else { return Ok(()) };
        let run = impacts(&p, 600, 2 * u32::try_from(period).unwrap());
        // A ball that rests for ever, or comes to rest, has no orbit of impacts to compare.
        prop_assume!(!run.is_empty() && run.iter().all(|impact| !impact.rests && impact.speed > 1e-3));
        // A weakly stable orbit is not reached yet.
        let (first, last) = (motion.flashes[0], motion.flashes[2 * period]);
        prop_assume!((first.displacement - last.displacement).abs() < 1e-9);
        let search = Search { periods: 2, starts: 6, ..Search::default() };
        let found = orbits::orbits(&at(p), &search, &()).unwrap();
        let orbit = found.iter().find(|orbit| is_on(orbit, &run, 1.0 / frequency));
        prop_assert!(orbit.is_some(), "none of {} orbits is the motion {:?}", found.len(), run.first());
        let orbit = orbit.unwrap();
        prop_assert!(orbit.is_stable(), "{:?}", orbit.multipliers);
        prop_assert!((orbit.voltage_gain - motion.own_gain()).abs() < 1e-6 * motion.own_gain());
        if stiffness == 0.0 && orbit.least_speed > 0.05 {
            let [a, b] = [trace_and_determinant(orbit), by_differences(&p, orbit)];
            prop_assert!((a[0] - b[0]).abs() < 1e-3 && (a[1] - b[1]).abs() < 1e-3, "{:?} {:?}", a, b);
        }
    }
}

#[test]
fn a_branch_turns_at_folds_and_ends_where_the_ball_grazes() {
    let base = Parameters::default();
    let p = Parameters {
        amplitude: 5.0,
        frequency: 2.5,
        restitution: 0.5,
        inclination: std::f64::consts::FRAC_PI_4,
        cylinder_length: 0.55,
        ball_mass: 0.012_45,
        ..base
    };
    let problem = over(p, "cylinder.length", 0.2, 0.5);
    let branches = orbits::branches(&problem, &Search { periods: 2, ..Search::default() }, &()).unwrap();
    let simple = branches.iter().find(|branch| branch.name() == "2:1").unwrap();
    let fold = simple.marks.iter().find(|mark| mark.kind == Bifurcation::Fold).unwrap();
    // Beyond the fold there is none of it, before it there are two.
    let value = fold.orbit.point.value;
    let others = simple.orbits.iter().map(|orbit| orbit.point.value);
    assert!(others.fold(f64::NEG_INFINITY, f64::max) <= value + 1e-9);
    assert!(fold.orbit.multipliers.0.iter().any(|value| (value.re - 1.0).abs() < 1e-6), "{:?}", fold.orbit.multipliers);
    assert_eq!(simple.ends, [End::Grazing; 2]);
    let grazing = |mark: &&orbits::Mark| mark.kind == Bifurcation::Grazing;
    for mark in simple.marks.iter().filter(grazing) {
        assert!(mark.orbit.least_speed < 1e-4 || mark.orbit.least_gap < 1e-6, "{:?}", mark.orbit.least_gap);
        // A step further the order of impacts is another.
        let side = if mark.orbit.point.value < value { [-1e-6, 1e-6] } else { [1e-6, -1e-6] };
        let there = |step: f64| {
            let beyond = at(problem.at(mark.orbit.point.value + step));
            orbits::orbits(&beyond, &Search { periods: 1, ..Search::default() }, &()).unwrap()
        };
        let near = |orbit: &Orbit| (orbit.voltage_gain - mark.orbit.voltage_gain).abs() < 1e-2 * orbit.voltage_gain;
        let has = |step: f64| there(step).iter().any(|orbit| orbit.pattern == mark.orbit.pattern && near(orbit));
        assert!(side.iter().any(|step| !has(*step)), "at {}", mark.orbit.point.value);
    }
    // The doubled orbit goes on from where the simple one loses stability.
    let doubled = branches.iter().find(|branch| branch.name() == "2:2, 2 periods").unwrap();
    assert_eq!(doubled.ends[0], End::Bifurcation);
    assert!(doubled.orbits[0].is_stable());
}

#[test]
fn a_ball_that_comes_to_rest_forgets_where_it_was() {
    // Nearly plastic impacts: the ball rests until the wall lets it go.
    let p = Parameters { restitution: 0.05, amplitude: 1.0, frequency: 2.0, ..Parameters::default() };
    let found = orbits::orbits(&at(p), &Search { periods: 1, ..Search::default() }, &()).unwrap();
    let resting = found.iter().find(|orbit| orbit.pattern.rests()).unwrap();
    assert!(resting.is_stable() && resting.multipliers.largest() < 1e-9, "{:?}", resting.multipliers);
    assert_eq!(resting.pattern.counts(), [1, 1]);
    assert!(impacts(&p, 50, 1).iter().any(|impact| impact.rests && impact.side == Side::Left));
}

#[test]
#[ignore = "slow"]
fn orbits_between_soft_membranes_have_the_multipliers_of_differences() {
    let p = case("capsule-soft");
    let found = orbits::orbits(&at(p), &Search { periods: 1, ..Search::default() }, &()).unwrap();
    let orbit = found.iter().find(|orbit| orbit.is_stable() && orbit.pattern.counts() == [1, 1]).unwrap();
    // In a membrane the ball turns, too, but not in flight.
    assert!(orbit.least_gap > 0.0, "{}", orbit.least_gap);
    for (ours, theirs) in trace_and_determinant(orbit).into_iter().zip(by_differences(&p, orbit)) {
        assert_relative_eq!(ours, theirs, max_relative = 1e-5, epsilon = 1e-6);
    }
    let speeds = |impacts: Vec<Impact>| {
        let mut speeds: Vec<_> = impacts.iter().map(|impact| impact.speed).collect();
        speeds.sort_by(f64::total_cmp);
        speeds
    };
    let settled = speeds(impacts(&p, 300, 1));
    let on_orbit = speeds(impacts(&on_orbit(&p, orbit, [0.0; 2]), 0, 1));
    assert_eq!((settled.len(), on_orbit.len()), (2, 2));
    for (settled, on_orbit) in settled.iter().zip(&on_orbit) {
        assert_relative_eq!(settled, on_orbit, max_relative = 1e-9);
    }
}

#[test]
fn the_same_search_gives_the_same_orbits() {
    let problem = over(case("fig14"), "membrane.restitution", 0.5, 0.7);
    let search = Search { periods: 2, ..Search::default() };
    let names = || -> Vec<_> {
        let branches = orbits::branches(&problem, &search, &()).unwrap();
        branches.iter().map(|branch| (branch.name(), branch.orbits.len(), branch.ends)).collect()
    };
    assert_eq!(names(), names());
}

#[test]
fn what_has_no_orbits_is_refused_by_name() {
    let message = |problem: &Problem| orbits::branches(problem, &Search::default(), &()).unwrap_err().to_string();
    let p = case("fig14");
    let noisy = Parameters { phase_noise: 0.1, ..p };
    assert!(message(&over(noisy, "membrane.restitution", 0.5, 0.7)).starts_with("excitation.phaseNoise = 0.1"));
    assert!(message(&over(p, "initial.ballPosition", 0.0, 0.01)).starts_with("--vary initial.ballPosition"));
    assert!(matches!(orbits::branches(&at(p), &Search::default(), &()), Err(DynamicsError::NoRange { .. })));
}

#[test]
fn diagrams_and_basins_work_with_soft_membranes_suspension_and_friction() {
    let p = Parameters {
        contact_law: ContactLaw::Compliant,
        friction: 0.02,
        suspension_stiffness: 5.0,
        suspension_damping: 0.5,
        ..case("fig14")
    };
    let periods = Periods { transient: 20, taken: 10 };
    let xs = vec![0.4, 0.5, 0.6];
    let at = |restitution: f64| Parameters { restitution, ..p };
    let diagram = Diagram::new(xs, (at, &Files::default()), periods, &()).unwrap();
    assert!(diagram.ways.iter().all(|motions| motions.len() == 3 && motions.iter().all(|it| it.flashes.len() == 11)));
    let basins = Basins::new(&p, 4, 0.3, periods, &()).unwrap();
    let shares: f64 = basins.attractors.iter().map(|(_, share)| share).sum();
    assert!(basins.ends.len() == 16 && (shares - 1.0).abs() < 1e-12);
    let motion = Motion::take(&p, 20, 10).unwrap();
    assert!(exponent(&p, motion.last(), 50).unwrap().unwrap().is_finite());
    // A parameter beyond its bound is named.
    let refused = Diagram::new(vec![0.5, 1.5], (at, &Files::default()), periods, &()).unwrap_err().to_string();
    assert!(refused.contains("membrane.restitution = 1.5"), "{refused}");
}
