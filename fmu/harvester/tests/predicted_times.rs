//! `impact.nextTime` and `pulse.nextKnot`: a master that steps to them passes over nothing.

#![allow(clippy::unwrap_used, clippy::panic)]

mod common;

use common::host::Host;
use proptest::prelude::*;

const FORCE: &str = "externalForce";

/// Longest step, s: shorter than a period, which is as far as anything is predicted.
fn longest_step(frequency: f64) -> f64 {
    0.5 / frequency
}

/// Steps of a master that goes to the predicted times, and no farther than `longest`, s, and sets this force anew at some of
/// its steps. Impacts, rests and releases lie at the ends of steps.
fn run(host: &Host, until: f64, longest: f64, force: impl Fn(u32) -> f64) -> Result<Tally, TestCaseError> {
    let (mut time, mut tally) = (0.0, Tally::default());
    for step in 0.. {
        if time >= until {
            break;
        }
        let is_set = step % 7 == 3;
        if is_set {
            host.set(FORCE, force(step));
        }
        let predicted = host.get_all(&["impact.nextTime", "pulse.nextKnot"]);
        prop_assert!(predicted.iter().all(|next| *next > time), "{predicted:?} at {time} s");
        let next = predicted[0].min(predicted[1]).min(time + longest);
        let (before, rested) = (host.count("impact.count"), host.rests());
        if next - time > 1e-6 {
            check_step(host, time, next, is_set)?;
        }
        let length = next - time;
        host.step(time, length);
        tally.impacts += host.count("impact.count") - before;
        tally.rests += u32::from(host.rests() && !rested);
        time += length;
    }
    Ok(tally)
}

/// Nothing happens within a step. At its begin something may, where a force has just been set.
fn check_step(host: &Host, time: f64, next: f64, may_begin: bool) -> Result<(), TestCaseError> {
    let look = |h: f64| {
        let start = host.save();
        host.step(time, h);
        let there = (host.count("impact.count"), host.rests());
        host.restore(start);
        host.free(start);
        there
    };
    let begin = if may_begin { look(1e-9 * (next - time)) } else { (host.count("impact.count"), host.rests()) };
    prop_assert_eq!(look((1.0 - 1e-9) * (next - time)), begin, "between {} and {} s", time, next);
    Ok(())
}

#[derive(Debug, Default)]
struct Tally {
    impacts: i32,
    rests: u32,
}

fn settings(frequency: f64, amplitude: f64, restitution: f64) -> Vec<(&'static str, f64)> {
    vec![
        ("excitation.frequency", frequency),
        ("excitation.amplitude", amplitude),
        ("membrane.restitution", restitution),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn no_impact_rest_or_release_lies_within_a_step_to_the_predicted_times(
        frequency in 0.5..8.0_f64, amplitude in 0.3..5.0_f64, restitution in prop_oneof![Just(0.0), 0.0..0.95_f64],
        forces in prop::collection::vec(-2.0..2.0_f64, 5), place in prop_oneof![Just(0.0), -0.03..0.03_f64],
        velocity in -0.5..0.5_f64,
    ) {
        let mut settings = settings(frequency, amplitude, restitution);
        settings.extend([("initial.ballPosition", place), ("initial.ballVelocity", velocity)]);
        let host = Host::stepping(&settings);
        run(&host, 6.0 / frequency, longest_step(frequency), |step| forces[step as usize % forces.len()])?;
    }

    #[test]
    fn under_phase_noise_neither_does_if_no_step_is_longer_than_what_is_predicted(
        frequency in 0.5..8.0_f64, amplitude in 0.3..5.0_f64, restitution in 0.0..0.95_f64,
        noise in 0.1..2.0_f64, exponent in -3.5..-1.7_f64, forces in prop::collection::vec(-2.0..2.0_f64, 5),
    ) {
        let hold = 10.0_f64.powf(exponent) / frequency;
        let mut settings = settings(frequency, amplitude, restitution);
        settings.extend([("excitation.phaseNoise", noise), ("excitation.noiseHold", hold)]);
        let host = Host::stepping(&settings);
        let longest = longest_step(frequency).min(200.0 * hold);
        run(&host, 4.0 / frequency, longest, |step| forces[step as usize % forces.len()])?;
    }

    #[test]
    fn contacts_that_last_begin_and_end_where_they_are_predicted(
        frequency in 1.0..6.0_f64, amplitude in 0.3..5.0_f64, restitution in 0.0..1.0_f64,
        forces in prop::collection::vec(-2.0..2.0_f64, 5),
    ) {
        let host = Host::initializing(fmu_export::abi::fmi2CoSimulation, 0.0, &settings(frequency, amplitude, restitution));
        host.choose("contact.law", 2);
        fmu_host::ok(host.exit_initialization());
        run(&host, 3.0 / frequency, longest_step(frequency), |step| forces[step as usize % forces.len()])?;
    }
}

#[test]
fn a_ball_without_rebound_meets_the_membranes_where_it_is_predicted_while_it_rests() {
    // It rests for part of each half period: a master that steps 0.1 s, but to the predicted times, sees each impact.
    let host = Host::stepping(&settings(5.0, 3.0, 0.0));
    let tally = run(&host, 10.0, 0.1, |_| 0.0).unwrap();
    assert!(tally.impacts > 95 && tally.rests > 90, "{tally:?}");
}

#[test]
fn while_the_ball_rests_the_next_impact_is_that_after_its_release() {
    let host = Host::stepping(&settings(5.0, 3.0, 0.0));
    let (mut time, mut seen) = (0.0, 0);
    while time < 2.0 {
        host.step(time, 1e-3);
        time += 1e-3;
        if !host.rests() {
            continue;
        }
        let [impact, knot] = host.get_all(&["impact.nextTime", "pulse.nextKnot"])[..] else { panic!() };
        let (release, count) = (knot.min(impact), host.count("impact.count"));
        let start = host.save();
        host.step(time, impact - 1e-9 - time);
        assert_eq!(host.count("impact.count"), count);
        assert!(!host.rests() && release < impact);
        host.step(impact - 1e-9, 2e-9);
        assert_eq!(host.count("impact.count"), count + 1, "at {impact} s");
        host.restore(start);
        host.free(start);
        seen += 1;
    }
    assert!(seen > 100, "{seen}");
}

#[test]
fn the_predicted_times_follow_the_force_that_is_set_at_once() {
    let host = Host::stepping(&settings(2.0, 0.5, 0.6));
    host.step(0.0, 0.01);
    let free = host.get("impact.nextTime");
    host.set(FORCE, 3.0);
    let pushed = host.get("impact.nextTime");
    assert!(pushed < free, "{pushed} {free}");
    host.step(0.01, 1e-4);
    assert!((host.get("impact.nextTime") - pushed).abs() < 1e-14);
    // What is predicted in between leaves no trace in what happens.
    let twin = Host::stepping(&settings(2.0, 0.5, 0.6));
    twin.step(0.0, 0.01);
    twin.set(FORCE, 3.0);
    twin.step(0.01, 1e-4);
    for (host, force) in [(&host, -1.0), (&twin, -1.0)] {
        host.set(FORCE, force);
    }
    host.get("impact.nextTime");
    host.set(FORCE, 3.0);
    twin.set(FORCE, 3.0);
    for host in [&host, &twin] {
        host.step(0.0101, 1.0);
    }
    assert_eq!(host.get_all(&common::host::unknowns()), twin.get_all(&common::host::unknowns()));
}

/// With the Maxwell force a contact ends where the voltages take it, which are set with their rates, read in between or not, set
/// again, and held after a step. What an instance predicts is what one predicts that has just taken over its state, and has been
/// asked for nothing before.
#[test]
fn the_predicted_times_follow_the_voltages_that_are_set_at_once() {
    let predicted = ["pulse.nextKnot", "impact.nextTime"];
    let settings = [settings(4.0, 1.5, 0.6), vec![("membrane.stiffness", 2e4)]].concat();
    let make = || {
        let host = Host::initializing(fmu_export::abi::fmi2CoSimulation, 0.0, &settings);
        host.choose("contact.law", 2);
        fmu_host::ok(host.set_boolean(common::host::reference("contact.electrostaticFeedback"), 1));
        fmu_host::ok(host.exit_initialization());
        host
    };
    let (host, fresh) = (make(), make());
    let mut random = fmu_host::Random::seeded(1);
    let (mut time, mut in_contact, mut moved) = (0.0, 0, 0);
    while time < 2.0 {
        let before = host.get("pulse.nextKnot");
        for name in ["left.voltage", "right.voltage"] {
            if random.once_in(3) {
                host.set(name, random.between(0.0, 6000.0));
            }
            if random.once_in(3) {
                host.set_rate(name, random.between(-1e6, 1e6));
            }
            if random.once_in(3) {
                host.get_all(&predicted);
            }
        }
        let state = host.save();
        let mut taken = std::ptr::null_mut();
        fmu_host::ok(fresh.deserialize(&host.serialize(state), &mut taken));
        fresh.restore(taken);
        fresh.free(taken);
        host.free(state);
        let now = host.get_all(&predicted);
        assert_eq!(now, fresh.get_all(&predicted), "at {time} s");
        let touches = ["left.deflection", "right.deflection"].iter().any(|name| host.get(name) > 0.0);
        in_contact += u32::from(touches);
        moved += u32::from(touches && now[0] != before);
        let length = random.between(1e-5, if touches { 1e-3 } else { 1e-2 });
        host.step(time, length);
        time += length;
    }
    assert!(in_contact > 100 && moved > 50, "{in_contact} {moved}");
}

/// The end of the contact of a ball that starts on a membrane is predicted under voltages that are set after the initialisation as
/// under those that the instance was initialised with.
#[test]
fn a_contact_from_the_start_on_is_predicted_under_the_voltages_that_are_set() {
    let settings = [settings(4.0, 1.5, 0.6), vec![("membrane.stiffness", 2e4), ("initial.ballPosition", 1.0)]].concat();
    let settings = [settings, vec![("initial.ballVelocity", 0.3)]].concat();
    let apply = |host: &Host, volts: f64| {
        for name in ["left.voltage", "right.voltage"] {
            host.set(name, volts);
        }
    };
    let make = |volts: f64| {
        let host = Host::initializing(fmu_export::abi::fmi2CoSimulation, 0.0, &settings);
        host.choose("contact.law", 2);
        fmu_host::ok(host.set_boolean(common::host::reference("contact.electrostaticFeedback"), 1));
        apply(&host, volts);
        fmu_host::ok(host.exit_initialization());
        host
    };
    let flat = make(0.0);
    let mut before = flat.get("pulse.nextKnot");
    for volts in [3000.0, 6000.0, 9000.0] {
        apply(&flat, volts);
        let now = flat.get("pulse.nextKnot");
        assert_eq!(now, make(volts).get("pulse.nextKnot"), "{volts} V");
        assert_ne!(now, std::mem::replace(&mut before, now), "{volts} V act");
    }
}

#[test]
fn a_ball_that_is_put_on_a_membrane_meets_it_at_the_start() {
    let host = Host::stepping(&[("initial.ballPosition", 1.0), ("initial.ballVelocity", 0.3)]);
    assert_eq!((host.count("impact.count"), host.get("impact.lastVelocity")), (1, 0.3));
    assert!(host.get("impact.nextTime") > 1e-3, "the first impact is at the start, and not ahead");
}
