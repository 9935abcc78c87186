//! The compliant law through the FMU: states in the middle of a contact, and what is refused.
#![allow(clippy::expect_used, clippy::panic)] // helpers outside of #[test] functions fail a test, too

mod common;

use VibroImpactHarvester::Harvester;
use common::{choose, fresh, get, outputs, row, set, step};
use fmu_export::{Kind, Logger, Slave, StateReader, StateWriter};

/// fig14's masses and membranes from the zero start, with the options of the compliant law that are named.
fn compliant(options: &[&str]) -> Harvester {
    let mut slave = fresh(&[("initial.ballVelocity", 0.3)]);
    choose(&mut slave, "contact.law", 2);
    for name in options {
        let Kind::Boolean(option) = row(name).kind() else { panic!("{name} is no Boolean") };
        option.set.expect("a setter")(&mut slave, true);
    }
    slave.update();
    slave
}

fn restored(slave: &Harvester) -> Harvester {
    let mut out = StateWriter::default();
    slave.write_state(&mut out).expect("bytes");
    let bytes = out.into_bytes();
    Harvester::read_state(&mut StateReader::new(&bytes)).expect("a state")
}

#[test]
fn a_serialised_contact_goes_on_to_the_last_bit() {
    let mut pressed = 0;
    let mut original = compliant(&["contact.electrostaticFeedback", "contact.reaction"]);
    original.initialize(&Logger::silent()).expect("valid parameters");
    for k in 0..300_u32 {
        let time = 0.003 * f64::from(k);
        set(&mut original, "left.voltage", 1000.0 + 10.0 * f64::from(k % 7));
        let mut copy = restored(&original);
        step(&mut original, time, 0.003);
        step(&mut copy, time, 0.003);
        assert_eq!(outputs(&copy), outputs(&original), "from {time} s");
        assert_eq!(get(&copy, "energy.wall").to_bits(), get(&original, "energy.wall").to_bits());
        pressed += u32::from(get(&original, "left.deflection") + get(&original, "right.deflection") > 0.0);
    }
    assert!(pressed > 10, "{pressed} of 300 states lie in a contact");
    let sum = |name: &str| get(&original, name);
    let stored = sum("energy.kinetic") + sum("energy.elastic") + sum("energy.impactLoss");
    let start = 0.5 * get(&original, "ball.mass") * 0.09;
    assert!((stored - start - sum("energy.wall") - sum("energy.electrical")).abs() < 1e-9 * stored);
    assert!(sum("energy.electrical") != 0.0);
}

#[test]
fn model_exchange_and_directional_derivatives_are_refused() {
    let mut slave = compliant(&[]);
    slave.initialize(&Logger::silent()).expect("valid parameters");
    let Kind::Real(ball) = row("ball.position").kind() else { panic!("no Real") };
    assert!(ball.partial_derivative.expect("a derivative")(&slave, row("externalForce")).is_nan());
    let error = slave.place(0.0, None).expect_err("model exchange").to_string();
    assert!(error.starts_with("contact.law = compliant cannot be run by model exchange"), "{error}");
}
