//! Directional derivatives in co-simulation, through a step, by the C functions and against central differences.
#![allow(clippy::expect_used)] // helpers outside of #[test] functions fail a test, too

mod common;

use common::differences::compare;
use common::host::{CLOCKED, Host, unknowns};
use fmu_export::abi::fmi2CoSimulation;
use fmu_host::{Random, ok};
use videg_model::{Case, GRAZING_SPEED, Parameters};

const FORCE: &str = "externalForce";

/// Natural size of the force, N: the amplitude of the excitation.
const UNIT: f64 = 0.5;

type Settings = Vec<(&'static str, f64)>;

/// Parameters at random: around the paper's, or a ball that chatters and rests (Table 3); every other with noise.
fn settings(random: &mut Random, number: u32) -> Settings {
    let mut settings: Settings = if number.is_multiple_of(3) {
        let parameters = (Case::find("table3-2hz").expect("a case").parameters)();
        Parameters::TABLE.iter().map(|quantity| (quantity.name, (quantity.get)(&parameters))).collect()
    } else {
        vec![
            ("cylinder.mass", random.between(0.05, 0.3)),
            ("membrane.restitution", random.between(0.2, 1.0)),
            ("membrane.stiffnessExponent", random.between(1.2, 4.0)),
            ("excitation.amplitude", random.between(0.2, 2.0)),
            ("excitation.frequency", random.between(1.0, 4.0)),
            ("initial.ballPosition", random.between(-0.02, 0.02)),
            ("initial.ballVelocity", random.between(-0.3, 0.3)),
        ]
    };
    settings.push(("excitation.phase", random.between(0.0, 6.0)));
    // Another mount, whose changes are taken by differences.
    if number % 4 == 1 {
        settings.push(("cylinder.inclination", random.between(-0.5, 0.5)));
        settings.push(("ball.friction", random.between(0.01, 0.3)));
        settings.push(("contact.reaction", random.between(0.0, 2.0).floor()));
    }
    if number % 8 < 4 {
        settings.push(("cylinder.suspensionStiffness", random.between(1.0, 100.0)));
        settings.push(("cylinder.suspensionDamping", random.between(0.01, 1.0)));
    }
    if number.is_multiple_of(2) {
        settings.push(("excitation.phaseNoise", random.between(0.1, 1.0)));
        settings.push(("excitation.noiseHold", random.between(1e-3, 0.05)));
    }
    settings
}

/// What happened up to now, besides the Reals.
fn happenings(host: &Host) -> (i32, i32, bool, [bool; 4]) {
    let none = |name| host.get(name) == f64::MAX;
    let flat = |name| host.get(name) == 0.0;
    let flags = [none("impact.nextTime"), none("pulse.nextKnot"), flat("left.deflection"), flat("right.deflection")];
    (host.count("impact.count"), host.count("solver.events"), host.rests(), flags)
}

/// Whether the changes are not carried along in closed form.
fn by_differences(host: &Host) -> bool {
    host.get("ball.friction") + host.get("cylinder.suspensionStiffness") > 0.0
}

/// A step of `h` from `t` under this force: value and rate.
fn step(host: &Host, [t, h]: [f64; 2], [force, rate]: [f64; 2]) {
    host.set(FORCE, force);
    host.set_rate(FORCE, rate);
    host.step(t, h);
}

/// How many of the derivatives that were decided are of a sort.
#[derive(Debug, Default)]
struct Tally {
    decided: u32,
    undecided: u32,
    steps_by_impacts: [u32; 3],
    at_rest: u32,
    in_old_pulse: u32,
    in_new_pulse: u32,
    noisy: u32,
}

/// Compares after one step and leaves the host behind it.
fn check_step(host: &Host, at: [f64; 2], force: [f64; 2], tally: &mut Tally, what: &str) {
    let before = host.save();
    let impacts = host.count("impact.count");
    step(host, at, force);
    // By differences, the speed of the last bounce before a rest keeps no digits: times of bounces have few.
    let of_bounce = ["impact.lastVelocity", CLOCKED[0], CLOCKED[1]];
    let is_lost = |name: &&str| of_bounce.contains(name) && host.get(of_bounce[0]) < 1e-3 && by_differences(host);
    let names: Vec<_> = unknowns().into_iter().chain(CLOCKED).filter(|name| !is_lost(name)).collect();
    let (after, happened, derivatives) = (host.save(), happenings(host), host.derivatives(&names, FORCE));
    let values = |distance: f64| {
        host.restore(before);
        step(host, at, [force[0] + distance, force[1]]);
        (happenings(host) == happened).then(|| host.get_all(&names))
    };
    let decided = compare(&names, &derivatives, UNIT, values, what);
    host.restore(after);
    host.free(before);
    host.free(after);
    let count = |is: bool| u32::try_from(decided.iter().filter(|decided| **decided == is).count()).expect("few");
    tally.decided += count(true);
    tally.undecided += count(false);
    if decided.contains(&true) {
        let new = usize::try_from(happened.0 - impacts).expect("impacts");
        tally.steps_by_impacts[new.min(2)] += 1;
        tally.at_rest += u32::from(happened.2);
        let pressed = host.get("left.deflection") + host.get("right.deflection") > 0.0;
        tally.in_old_pulse += u32::from(pressed && new == 0);
        tally.in_new_pulse += u32::from(pressed && new > 0);
    }
}

#[test]
#[ignore = "slow"]
fn derivatives_through_a_step_agree_with_central_differences() {
    let mut random = Random::seeded(7);
    let mut tally = Tally::default();
    for number in 0..120 {
        let settings = settings(&mut random, number);
        let host = Host::stepping(&settings);
        let mut time = 0.0;
        for k in 0..8 {
            let longest = if random.once_in(2) { 0.02 } else { 0.4 };
            let h = random.between(1e-4, longest);
            let rate = if random.once_in(2) { random.between(-2.0, 2.0) } else { 0.0 };
            let force = [random.between(-0.3, 0.3), rate];
            tally.noisy += u32::from(number.is_multiple_of(2));
            check_step(&host, [time, h], force, &mut tally, &format!("step {k} of run {number} at {time} s: {h} s"));
            time += h;
        }
    }
    println!("{tally:?}");
    let Tally { decided, undecided, steps_by_impacts, at_rest, in_old_pulse, in_new_pulse, noisy } = tally;
    assert!(undecided * 10 < decided, "{undecided} undecided, {decided} decided");
    assert!(steps_by_impacts.iter().all(|steps| *steps > 50), "{steps_by_impacts:?}");
    assert!(at_rest > 30 && in_old_pulse > 30 && in_new_pulse > 30 && noisy > 200);
}

#[test]
fn before_the_first_step_they_are_those_of_the_initial_values() {
    let host = Host::initializing(fmi2CoSimulation, 0.0, &[("initial.ballVelocity", 0.2), (FORCE, 0.1)]);
    let names = unknowns();
    let initial = host.derivatives(&names, FORCE);
    ok(host.exit_initialization());
    assert_eq!(host.derivatives(&names, FORCE), initial);
    let not_zero: Vec<_> = names.iter().zip(&initial).filter(|(_, d)| **d != 0.0).map(|(name, _)| *name).collect();
    assert_eq!(not_zero, ["impact.nextTime", "pulse.nextKnot", "der(cylinder.velocity)"]);
}

#[test]
fn they_come_back_with_a_state_and_through_serialisation_to_the_last_bit() {
    let mut random = Random::seeded(11);
    let names = unknowns();
    let bits = |host: &Host| host.derivatives(&names, FORCE).into_iter().map(f64::to_bits).collect::<Vec<_>>();
    for number in 0..30 {
        let settings = settings(&mut random, number);
        let (host, other) = (Host::stepping(&settings), Host::stepping(&[]));
        let (first, second) = (random.between(0.1, 1.0), random.between(0.01, 0.5));
        step(&host, [0.0, first], [0.1, 0.0]);
        step(&host, [first, second], [0.2, 0.3]);
        let (expected, state) = (bits(&host), host.save());
        let bytes = host.serialize(state);
        step(&host, [first + second, 0.1], [0.0, 0.0]);
        assert_ne!(bits(&host), expected);
        host.restore(state);
        assert_eq!(bits(&host), expected, "restored, run {number}");
        let mut copy = core::ptr::null_mut();
        ok(other.deserialize(&bytes, &mut copy));
        other.restore(copy);
        assert_eq!(bits(&other), expected, "through bytes, run {number}");
        for host in [&host, &other] {
            step(host, [first + second, 0.2], [-0.1, 0.0]);
        }
        assert_eq!(bits(&other), bits(&host), "a step later, run {number}");
        host.free(state);
    }
}

#[test]
fn voltages_have_no_influence_but_on_their_fields() {
    let host = Host::stepping(&[("initial.ballVelocity", 0.2)]);
    step(&host, [0.0, 0.7], [0.1, 0.0]);
    for (known, field) in [("left.voltage", "left.electricField"), ("right.voltage", "right.electricField")] {
        let voltage = host.get(known);
        for (name, derivative) in unknowns().iter().zip(host.derivatives(&unknowns(), known)) {
            let expected = if *name == field { host.get(field) / voltage } else { 0.0 };
            assert!((derivative - expected).abs() <= 1e-12 * expected, "{name}, {known}: {derivative}");
        }
    }
}

#[test]
fn those_with_respect_to_the_states_are_those_at_the_communication_point() {
    let start = [("initial.cylinderVelocity", 0.1), ("initial.ballVelocity", -0.2)];
    let host = Host::initializing(fmi2CoSimulation, 0.0, &start);
    let names = unknowns();
    let pairs = [
        ("cylinder.position", "initial.cylinderPosition"),
        ("cylinder.velocity", "initial.cylinderVelocity"),
        ("ball.position", "initial.ballPosition"),
        ("ball.velocity", "initial.ballVelocity"),
    ];
    let initial: Vec<_> = pairs.iter().map(|(_, parameter)| host.derivatives(&names, parameter)).collect();
    ok(host.exit_initialization());
    for ((state, _), expected) in pairs.iter().zip(initial) {
        let derivatives = host.derivatives(&names, state);
        let of = |name: &str| names.iter().zip(&derivatives).find(|(it, _)| **it == name).expect(name).1;
        // The parameter shifts where the work is counted from, too.
        let shift = |name: &str| if name == "energy.excitation" { *of("energy.cylinderKinetic") } else { 0.0 };
        for ((name, derivative), expected) in names.iter().zip(&derivatives).zip(expected) {
            let expected = expected + shift(name);
            assert!(
                (derivative - expected).abs() <= 1e-12 * expected.abs(),
                "{name}, {state}: {derivative} {expected}"
            );
        }
    }
    step(&host, [0.0, 0.9], [0.1, 0.0]);
    assert_eq!(host.derivatives(&["ball.position", "relativeDisplacement"], "ball.position"), [1.0, -1.0]);
}

#[test]
fn at_an_impact_on_the_communication_point_they_are_those_after_it() {
    let host = Host::stepping(&[("initial.ballVelocity", 0.2)]);
    let time = host.get("impact.nextTime");
    let start = host.save();
    let names = ["ball.position", "ball.velocity", "impact.lastVelocity", "gain.voltage"];
    let after_step = |h: f64| {
        host.restore(start);
        step(&host, [0.0, h], [0.0, 0.0]);
        (host.count("impact.count"), host.derivatives(&names, FORCE))
    };
    let (before, at, after) = (after_step(time - 1e-9), after_step(time), after_step(time + 1e-9));
    assert_eq!([before.0, at.0, after.0], [0, 1, 1]);
    assert_eq!(before.1, [0.0; 4]);
    for (at, after) in at.1.iter().zip(&after.1) {
        assert!(*at != 0.0 && (at - after).abs() < 1e-7 * at.abs(), "{at} {after}");
    }
    host.free(start);
}

/// A run of 0.2 s from this place of the ball; its impacts.
fn graze(ball_position: f64) -> (Host, i32) {
    let host = Host::stepping(&[
        ("initial.ballPosition", ball_position),
        ("excitation.phase", core::f64::consts::PI),
        ("initial.cylinderVelocity", 0.2),
    ]);
    step(&host, [0.0, 0.2], [0.0, 0.0]);
    let impacts = host.count("impact.count");
    (host, impacts)
}

#[test]
fn at_and_near_a_grazing_impact_they_are_finite_and_below_the_threshold_those_of_a_miss() {
    let (mut hit, mut miss) = (-0.02, -0.01);
    assert!(graze(hit).1 > 0 && graze(miss).1 == 0);
    let names = unknowns();
    let mut slowest = f64::MAX;
    while 0.5 * (hit + miss) != hit && 0.5 * (hit + miss) != miss {
        let middle = 0.5 * (hit + miss);
        let (host, impacts) = graze(middle);
        if impacts > 0 {
            hit = middle;
        } else {
            miss = middle;
        }
        let derivatives = host.derivatives(&names, FORCE);
        assert!(derivatives.iter().all(|derivative| derivative.is_finite()), "{derivatives:?}");
        slowest = if impacts > 0 { slowest.min(host.get("impact.lastVelocity")) } else { slowest };
    }
    assert!(slowest < GRAZING_SPEED, "{slowest} m/s");
    let motion = [
        "ball.position",
        "ball.velocity",
        "relativeDisplacement",
        "gain.voltage",
        "energy.kinetic",
        "energy.impactLoss",
        "energy.wall",
    ];
    let [hit, miss] = [hit, miss].map(|position| graze(position).0.derivatives(&motion, FORCE));
    for (hit, miss) in hit.iter().zip(&miss) {
        assert!((hit - miss).abs() <= 2.0 * f64::EPSILON, "{hit} {miss}");
    }
}

#[test]
fn they_stay_finite_through_a_long_chaotic_step() {
    let host = Host::stepping(&[
        ("membrane.restitution", 0.95),
        ("excitation.amplitude", 5.0),
        ("excitation.phaseNoise", 0.5),
        ("excitation.noiseHold", 0.01),
    ]);
    step(&host, [0.0, 2000.0], [0.01, 0.0]);
    assert!(host.count("impact.count") > 10_000);
    let derivatives = host.derivatives(&unknowns(), FORCE);
    assert!(derivatives.iter().all(|derivative| derivative.is_finite()), "{derivatives:?}");
    assert!(derivatives.iter().any(|derivative| derivative.abs() > 1e50), "{derivatives:?}");
}
