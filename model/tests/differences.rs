//! Changes by differences against those in closed form, and against longer differences, at random.
#![allow(clippy::unwrap_used)]

use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;
use videg_model::{Direction, Harvester, Parameters, Sensitivities};

prop_compose! {
    fn any_capsule()(
        (restitution, amplitude, frequency, phase) in (0.2..0.95_f64, 0.2..2.0_f64, 1.0..5.0_f64, 0.0..6.3_f64),
        (ball_velocity, ball_mass) in (-0.3..0.3_f64, 1e-3..0.05_f64),
        (inclination, is_inclined) in (-1.5..1.5_f64, any::<bool>()),
    ) -> Parameters {
        let inclination = if is_inclined { inclination } else { 0.0 };
        Parameters { restitution, amplitude, frequency, phase, ball_velocity, ball_mass, inclination, ..Parameters::default() }
    }
}

/// What a user looks at, with the size it has.
fn list(it: &Sensitivities) -> [f64; 14] {
    [
        it.cylinder[0],
        it.cylinder[1],
        it.cylinder[2],
        it.ball[0],
        it.ball[1],
        it.relative_displacement,
        it.capacitance[0],
        it.capacitance[1],
        it.last_speed,
        it.voltage_gain,
        it.energy,
        it.energies.ball,
        it.energies.wall,
        it.energies.impact_loss,
    ]
}

/// What these typically are, in SI units.
const SIZES: [f64; 14] = [1e-2, 0.1, 4.0, 1e-2, 0.1, 1e-2, 1e-11, 1e-11, 0.1, 100.0, 1e-5, 1e-4, 1e-4, 1e-4];

fn counts(harvester: &Harvester) -> [u64; 3] {
    let totals = harvester.totals();
    [totals.impacts, totals.chatters, totals.releases]
}

/// How far the changes of two harvesters differ at most, relative to their sizes and over what rounding usually leaves.
fn disagreement(a: &Harvester, b: &Harvester) -> f64 {
    // Of the bounces before a rest a double resolves some digits only, and how many are summed in closed form varies.
    let bounces = a.totals().chatters > 0;
    let usual = if bounces { 1e-4 } else { 3e-6 };
    let lists = [a, b].map(|it| list(&it.sensitivities()));
    let pairs = lists[0].iter().zip(lists[1]).zip(SIZES).enumerate().filter(|(k, _)| !bounces || !(6..9).contains(k));
    pairs.map(|(_, ((a, b), size))| (a - b).abs() / (usual * (a.abs() + b.abs() + size))).fold(0.0, f64::max)
}

/// Both harvesters of [`CASES`] random ones agree, but for few, near an event or in the middle of a chattering sequence, which agree to
/// fewer digits.
fn agree<S: Strategy>(strategy: S, pair: impl Fn(S::Value) -> [Harvester; 2]) {
    const CASES: usize = 200;
    const FEW: usize = 2;
    const FEWER_DIGITS: f64 = 100.0;
    let mut runner = TestRunner::default();
    let mut disagreements = Vec::new();
    while disagreements.len() < CASES {
        let [closed, by_differences] = pair(strategy.new_tree(&mut runner).unwrap().current());
        if counts(&closed) == counts(&by_differences) {
            disagreements.push(disagreement(&closed, &by_differences));
        }
    }
    disagreements.sort_by(f64::total_cmp);
    let [usual, worst] = [disagreements[CASES - FEW - 1], disagreements[CASES - 1]];
    assert!(usual <= 1.0 && worst <= FEWER_DIGITS, "{usual} {worst}");
}

/// A friction that moves nothing, but that the closed form does not know.
fn with_and_without_friction(p: Parameters) -> [Parameters; 2] {
    [p, Parameters { friction: 1e-250, ..p }]
}

#[test]
fn differences_are_the_closed_form_where_that_exists() {
    agree((any_capsule(), 1e-3..0.6_f64, -0.1..0.1_f64), |(p, step, force)| {
        let pair = with_and_without_friction(p).map(|p| {
            let mut harvester = Harvester::new(&p, 0.0).unwrap();
            harvester.advance(1.3).unwrap();
            harvester.set_external_force(force, 0.05).unwrap();
            harvester.advance(1.3 + step).unwrap();
            harvester
        });
        assert!(pair[0].has_closed_changes() && !pair[1].has_closed_changes());
        pair
    });
}

/// What the changes are taken along.
const NAMES: [&str; 5] = [
    "excitation.amplitude",
    "initial.ballVelocity",
    "initial.cylinderVelocity",
    "membrane.restitution",
    "excitation.frequency",
];

#[test]
fn so_they_are_along_parameters() {
    agree((any_capsule(), 0.0..0.8_f64, prop::sample::select(&NAMES)), |(p, until, name)| {
        let direction = Direction::of_parameter(name).unwrap();
        with_and_without_friction(p).map(|p| {
            let mut harvester = Harvester::along(&p, 0.0, 0.01, &direction).unwrap();
            harvester.advance(until).unwrap();
            harvester
        })
    });
}

/// Where neither the harmonic force nor the present external one tells what a large force is.
#[test]
fn a_force_that_is_over_and_an_amplitude_of_zero_have_changes() {
    let p = Parameters { amplitude: 0.0, suspension_stiffness: 1e-9, ball_velocity: 0.0, ..Parameters::default() };
    let mut harvester = Harvester::new(&p, 0.0).unwrap();
    harvester.advance(0.01).unwrap();
    harvester.set_external_force(0.0, 0.0).unwrap();
    harvester.advance(0.02).unwrap();
    let (found, expected) =
        (harvester.sensitivities().cylinder, [0.01_f64.powi(2) / 2.0, 0.01].map(|it| it / p.cylinder_mass));
    for (found, expected) in found.into_iter().zip(expected) {
        assert!((found / expected - 1.0).abs() < 1e-6, "{found} {expected}");
    }
    let along = Direction::of_parameter("excitation.amplitude").unwrap();
    let begun = Harvester::along(&p, 0.0, 0.0, &along).unwrap().sensitivities().cylinder[2];
    assert!((begun * p.cylinder_mass - 1.0).abs() < 1e-6, "{begun}");
}
