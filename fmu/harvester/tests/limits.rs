//! Warnings of what the membranes stand, through the FMU.
#![allow(clippy::expect_used, clippy::float_cmp)] // helpers outside of #[test] functions fail a test, too

mod common;

use common::host::Host;
use fmu_export::abi::fmi2CoSimulation;
use videg_model::{Case, Parameters};

/// The FMU with the parameters of a case, under contact law number `law`.
fn case(name: &str, law: i32) -> Host {
    let parameters = (Case::find(name).expect("a case").parameters)();
    let settings: Vec<_> =
        Parameters::TABLE.iter().map(|quantity| (quantity.name, (quantity.get)(&parameters))).collect();
    let host = Host::initializing(fmi2CoSimulation, 0.0, &settings);
    host.choose("contact.law", law);
    fmu_host::ok(host.exit_initialization());
    host
}

/// Number of steps of 0.1 s that warn, in 20 s.
fn warnings(host: &Host) -> usize {
    (0..200).filter(|k| host.step_warns(0.1 * f64::from(*k), 0.1)).count()
}

#[test]
fn the_flashlight_warns_and_the_periodic_case_does_not_under_both_laws() {
    for law in [1, 2] {
        assert_eq!(warnings(&case("fig14", law)), 0, "law {law}");
        let flashlight = case("table3-2hz", law);
        let found = warnings(&flashlight);
        assert!((1..=6).contains(&found), "law {law}: {found}"); // three limits, two membranes
    }
}

#[test]
fn a_ball_heavier_than_a_tenth_of_the_cylinder_warns_at_the_start() {
    for (mass, warns) in [(0.012, false), (0.013, true)] {
        let host = Host::initializing(fmi2CoSimulation, 0.0, &[("ball.mass", mass)]);
        assert_eq!(host.initialization_warns(), warns, "{mass} kg"); // cylinder.mass is 0.1245 kg
        assert!(!host.step_warns(0.0, 1e-3));
    }
}

#[test]
fn a_voltage_beyond_a_bound_warns_once() {
    let host = Host::stepping(&[]);
    host.set("right.voltage", 50e3);
    assert_eq!(host.get("right.electricField"), 2e8);
    assert_eq!(host.get("left.electricField"), 8e6);
    assert_eq!(host.get("left.stretch"), 2.0);
    assert!(host.step_warns(0.0, 1e-3));
    assert!(!host.step_warns(1e-3, 1e-3));
    host.set("left.voltage", -50e3);
    assert!(host.step_warns(2e-3, 1e-3));
    assert!(!host.step_warns(3e-3, 1e-3));
}

#[test]
fn voltages_set_at_the_last_point_are_checked_when_the_run_ends() {
    for (voltage, warns) in [(50e3, true), (2e3, false)] {
        let host = Host::stepping(&[]);
        assert!(!host.step_warns(0.0, 1e-3));
        host.set("left.voltage", voltage);
        assert_eq!(host.terminate_warns(), warns, "{voltage} V");
    }
}

#[test]
fn a_step_that_is_tried_again_does_not_warn_again() {
    let host = Host::stepping(&[]);
    let state = host.save();
    host.set("left.voltage", 50e3);
    assert!(host.step_warns(0.0, 1e-3));
    host.restore(state);
    host.set("left.voltage", 50e3);
    assert!(!host.step_warns(0.0, 0.5e-3));
    host.free(state);
}
