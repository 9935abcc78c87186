//! Directional derivatives in initialization mode and in model exchange, by the C functions and against central differences.
#![allow(clippy::expect_used)] // helpers outside of #[test] functions fail a test, too

mod common;

use common::differences::{compare, natural_size};
use common::host::{Host, continuous_unknowns, initial_knowns, initial_unknowns, unknowns};
use fmu_export::abi::{fmi2CoSimulation, fmi2ModelExchange};
use fmu_host::{Random, ok};

type Settings = Vec<(&'static str, f64)>;

const STATES: [&str; 5] =
    ["cylinder.position", "cylinder.velocity", "ball.position", "ball.velocity", "energy.damping"];

/// Inside the bounds, so that a difference can be taken.
const INSIDE: [(&str, f64); 7] = [
    ("excitation.acceleration", 1.0),
    ("cylinder.inclination", 0.01),
    ("excitation.phaseNoise", 0.1),
    ("excitation.noiseHold", 700.0),
    ("membrane.prestretch", 2.2),
    ("membrane.restitution", 0.6),
    ("externalForce", 0.05),
];

/// At their lower bound: there are no central differences.
const AT_BOUND: [&str; 5] = [
    "ball.friction",
    "cylinder.suspensionStiffness",
    "cylinder.suspensionDamping",
    "membrane.viscousModulus",
    "membrane.relaxationTime",
];

fn with(more: &[(&'static str, f64)]) -> Settings {
    [&INSIDE[..], more].concat()
}

/// Compares every partial derivative of the initial values of a start at `start`, s. Returns the names, as unknown and
/// known, of those that are not zero, and of those that were not decided.
fn check_start(start: f64, settings: &[(&'static str, f64)]) -> [Vec<(&'static str, &'static str)>; 2] {
    let (names, mut not_zero, mut undecided) = (initial_unknowns(), Vec::new(), Vec::new());
    for kind in [fmi2CoSimulation, fmi2ModelExchange] {
        let host = Host::initializing(kind, start, settings);
        for known in initial_knowns().into_iter().filter(|known| !AT_BOUND.contains(known) || host.get(known) > 0.0) {
            let present = host.get(known);
            // A change of the frequency acts through the phase reached since t = 0.
            let turns = if known == "excitation.frequency" { 1.0 + start } else { 1.0 };
            let unit = if present == 0.0 { natural_size(known) } else { 0.1 * present.abs() / turns };
            let happened =
                |host: &Host| (host.count("impact.count"), host.rests(), host.get("impact.nextTime") == f64::MAX);
            let values = |distance: f64| {
                let moved = Host::initializing(kind, start, &[settings, &[(known, present + distance)]].concat());
                (happened(&moved) == happened(&host)).then(|| moved.get_all(&names))
            };
            let derivatives = host.derivatives(&names, known);
            let decided = compare(&names, &derivatives, unit, values, known);
            let list = |is_listed: &dyn Fn(usize) -> bool| {
                let listed = names.iter().enumerate().filter(|(k, _)| is_listed(*k));
                listed.map(|(_, name)| (*name, known)).collect::<Vec<_>>()
            };
            undecided.extend(list(&|k| !decided[k]));
            not_zero.extend(list(&|k| derivatives[k] != 0.0));
        }
    }
    [not_zero, undecided]
}

#[test]
fn derivatives_inside_the_gap_agree_with_central_differences() {
    let start = [("initial.cylinderPosition", 0.01), ("initial.ballPosition", 0.005), ("initial.ballVelocity", 0.1)];
    let [not_zero, undecided] = check_start(0.3, &with(&start));
    assert_eq!(undecided, []);
    for pair in [
        ("impact.nextTime", "excitation.frequency"),
        ("impact.nextTime", "externalForce"),
        ("pulse.nextKnot", "cylinder.length"),
        ("der(cylinder.velocity)", "excitation.phaseNoise"),
        ("der(cylinder.velocity)", "externalForce"),
        ("left.capacitance", "membrane.prestretch"),
    ] {
        assert!(not_zero.contains(&pair), "{pair:?}");
    }
}

#[test]
fn derivatives_of_another_mount_agree_with_central_differences() {
    let start = [
        ("initial.cylinderPosition", 0.01),
        ("initial.ballPosition", 0.005),
        ("initial.cylinderVelocity", 0.05),
        ("initial.ballVelocity", 0.1),
        ("ball.friction", 0.1),
        ("cylinder.suspensionStiffness", 20.0),
        ("cylinder.suspensionDamping", 0.3),
    ];
    for reaction in [0.0, 1.0] {
        let [not_zero, undecided] = check_start(0.3, &with(&[&start[..], &[("contact.reaction", reaction)]].concat()));
        assert_eq!(undecided, []);
        for pair in [
            ("impact.nextTime", "ball.friction"),
            ("impact.nextTime", "cylinder.suspensionStiffness"),
            ("mount.force", "cylinder.suspensionDamping"),
        ] {
            assert!(not_zero.contains(&pair), "{pair:?}");
        }
    }
}

#[test]
fn those_of_an_impact_some_noise_samples_ahead_agree_with_central_differences() {
    let start = [
        ("initial.ballPosition", -0.02),
        ("initial.ballVelocity", -0.3),
        ("excitation.phaseNoise", 1.5),
        ("excitation.noiseHold", 1e-3),
    ];
    let settings = with(&start);
    let next = Host::initializing(fmi2CoSimulation, 0.0, &settings).get("impact.nextTime");
    assert!((5e-3..1e-2).contains(&next), "{next}");
    let [not_zero, undecided] = check_start(0.0, &settings);
    assert_eq!(undecided, []);
    for known in ["phaseNoise", "noiseHold", "frequency", "phase", "amplitude"] {
        assert!(not_zero.iter().any(|(name, by)| *name == "impact.nextTime" && by.ends_with(known)), "{known}");
    }
}

#[test]
fn derivatives_of_a_start_beyond_a_membrane_agree_with_central_differences() {
    for side in [1.0, -1.0] {
        // The ball is put on the membrane and recedes from it.
        let start = [("initial.cylinderPosition", 0.03 * side), ("initial.ballVelocity", 0.3 * side)];
        let [not_zero, undecided] = check_start(0.0, &with(&start));
        assert_eq!(undecided, []);
        assert!(not_zero.contains(&("ball.position", "frame.width")));
    }
}

#[test]
fn derivatives_of_a_start_with_an_impact_agree_with_central_differences() {
    const START: f64 = 100.3;
    for side in [1.0, -1.0] {
        let start = [
            ("initial.cylinderPosition", 0.03 * side),
            ("initial.cylinderVelocity", 0.3 * side),
            ("initial.ballVelocity", -0.2 * side),
        ];
        let settings = with(&start);
        assert_eq!(Host::initializing(fmi2CoSimulation, START, &settings).count("impact.count"), 1);
        let [not_zero, undecided] = check_start(START, &settings);
        assert_eq!(undecided, []);
        for pair in [
            ("gain.voltage", "membrane.stiffnessExponent"),
            ("gain.energyEq13", "ball.radius"),
            ("impact.lastVelocity", "initial.ballVelocity"),
            ("pulse.nextKnot", "membrane.stiffnessExponent"),
            ("ball.velocity", "membrane.restitution"),
        ] {
            assert!(not_zero.contains(&pair), "{pair:?}");
        }
    }
}

#[test]
fn derivatives_of_a_start_that_ends_in_rest_agree_with_central_differences() {
    // The last bounces, of which the endless rest is summed.
    const START: f64 = 2e5;
    let start =
        [("initial.cylinderPosition", 0.03), ("initial.cylinderVelocity", 2e-5), ("excitation.phaseNoise", 0.01)];
    let settings = with(&start);
    let host = Host::initializing(fmi2CoSimulation, START, &settings);
    assert!(host.rests() && host.count("impact.count") == 1);
    let [not_zero, undecided] = check_start(START, &settings);
    assert_eq!(undecided, []);
    for pair in [("gain.voltage", "membrane.restitution"), ("der(ball.velocity)", "externalForce")] {
        assert!(not_zero.contains(&pair), "{pair:?}");
    }
}

#[test]
fn the_wall_brings_along_a_ball_that_starts_at_rest() {
    let start = [
        ("initial.cylinderPosition", 0.03),
        ("initial.cylinderVelocity", 0.2),
        ("initial.ballVelocity", 0.2),
        ("excitation.phaseNoise", 0.01),
    ];
    let settings = with(&start);
    let host = Host::initializing(fmi2CoSimulation, 0.0, &settings);
    assert!(host.rests() && host.count("impact.count") == 0);
    let energies = ["energy.kinetic", "energy.wall", "energy.impactLoss"];
    let momentum = 0.2 * host.get("ball.mass");
    assert_eq!(host.derivatives(&energies, "initial.cylinderVelocity"), [momentum, momentum, 0.0]);
    let [not_zero, _] = check_start(0.0, &settings);
    assert!(not_zero.contains(&("energy.kinetic", "ball.mass")));
}

/// Compares with respect to each state and the force at these states; returns how many derivatives are not zero.
fn check_point(host: &Host, names: &[&str], time: f64, states: [f64; 5], force: f64) -> usize {
    let mut not_zero = 0;
    for (k, known) in STATES.into_iter().chain(["externalForce"]).enumerate() {
        let values = |distance: f64| {
            let mut moved = states;
            moved.iter_mut().skip(k).take(1).for_each(|state| *state += distance);
            host.set("externalForce", if k == states.len() { force + distance } else { force });
            ok(host.place(time, &moved));
            Some(host.get_all(names))
        };
        values(0.0);
        let derivatives = host.derivatives(names, known);
        let decided = compare(names, &derivatives, natural_size(known), values, known);
        assert!(decided.into_iter().all(|decided| decided), "{known}");
        not_zero += derivatives.iter().filter(|derivative| **derivative != 0.0).count();
    }
    not_zero
}

#[test]
fn derivatives_in_model_exchange_agree_with_central_differences() {
    let mut random = Random::seeded(3);
    let mut resting = 0;
    for number in 0..60 {
        // Inside the gap, or at rest on the left membrane, pressed by the cylinder.
        let rests = number % 2 == 1;
        let start = if rests { [0.03, 0.0, 0.0, 0.0] } else { [0.0; 4] };
        let noise = if number % 3 == 0 { 0.5 } else { 0.0 };
        let host = Host::exchanging(&[
            ("initial.cylinderPosition", start[0]),
            ("excitation.phaseNoise", noise),
            ("excitation.noiseHold", 1e-3),
            ("cylinder.mass", random.between(0.05, 0.3)),
        ]);
        ok(host.new_discrete_states().0);
        resting += usize::from(host.rests());
        let position = random.between(-0.01, 0.01);
        let velocity = random.between(-0.3, 0.3);
        let ball = if rests { [position - 0.022, velocity] } else { [position - 0.01, random.between(-0.3, 0.3)] };
        let states = [position, velocity, ball[0], ball[1], random.between(0.0, 1e-3)];
        let force = random.between(-0.3, 0.3);
        ok(host.enter_continuous_time_mode());
        let not_zero = check_point(&host, &continuous_unknowns(), 0.01, states, force);
        assert!(not_zero >= 8, "{not_zero}");
        let table = |names: &[&str]| STATES.map(|state| host.derivatives(names, state));
        let between = table(&continuous_unknowns());
        ok(host.enter_event_mode());
        assert_eq!(table(&continuous_unknowns()), between);
        let is_discrete = |name: &&str| !continuous_unknowns().contains(name);
        let discrete: Vec<_> = unknowns().into_iter().filter(is_discrete).collect();
        // They have been set by events before, or will be by one that is still ahead.
        assert_eq!(table(&discrete), [0; 5].map(|_| vec![0.0; discrete.len()]));
        let fields = host.derivatives(&["left.electricField", "right.electricField"], "left.voltage");
        assert_eq!(fields, [1.0 / host.get("membrane.thickness"), 0.0]);
    }
    assert!(resting >= 20, "{resting}");
}

#[test]
fn the_power_of_the_damper_follows_the_velocity_in_model_exchange() {
    const DAMPING: f64 = 0.4;
    let host = Host::exchanging(&[("cylinder.suspensionDamping", DAMPING)]);
    ok(host.enter_continuous_time_mode());
    ok(host.place(0.01, &[0.001, 0.3, 0.002, 0.1, 0.02]));
    assert!((host.get("der(energy.damping)") - DAMPING * 0.09).abs() < 1e-15);
    assert!((host.get("energy.damping") - 0.02).abs() < 1e-15);
    let names = ["der(energy.damping)", "energy.damping", "energy.excitation"];
    let [power, lost, work]: [f64; 3] = host.derivatives(&names, "cylinder.velocity").try_into().unwrap();
    assert!((power - 2.0 * DAMPING * 0.3).abs() < 1e-9 && lost == 0.0, "{power}, {lost}");
    assert!((work - host.get("cylinder.mass") * 0.3).abs() < 1e-9, "{work}");
    assert_eq!(host.derivatives(&names, "energy.damping"), [0.0, 1.0, 1.0]);
}

/// A linearisation asks for all outputs between events, where discrete ones are constant.
#[test]
fn discrete_outputs_are_unknowns_everywhere_and_constant_between_events() {
    let initializing = Host::initializing(fmi2ModelExchange, 0.0, &[]);
    assert!(initializing.try_derivatives(&initial_unknowns(), "externalForce").is_ok());
    let is_answered = |host: &Host| host.try_derivatives(&unknowns(), "externalForce").is_ok();
    assert!(is_answered(&Host::stepping(&[])));
    let host = Host::exchanging(&[]);
    assert!(is_answered(&host));
    ok(host.enter_continuous_time_mode());
    for (unknown, derivative) in unknowns().iter().zip(host.derivatives(&unknowns(), "ball.velocity")) {
        assert!(derivative == 0.0 || continuous_unknowns().contains(unknown), "{unknown}: {derivative}");
    }
}
