//! Serialised states: the run goes on to the last bit, in this process or in another; nonsense is refused.
#![allow(clippy::expect_used)] // helpers outside of #[test] functions fail a test, too

use VibroImpactHarvester::Harvester;
use fmu_export::{Kind, Logger, Slave, StateError};
use fmu_host::slave::{self, bytes, fresh, get, initialized, outputs, row, set, step};
use std::process::Command;

/// Noise on, r = 0.6, at the paper's size.
const NOISY: &[(&str, f64)] = &[("excitation.phaseNoise", 0.7), ("excitation.noiseHold", 1e-3)];

const STATE: &str = "VIDEG_TEST_SERIALISED_STATE";

fn restored(bytes: &[u8]) -> Result<Harvester, StateError> {
    slave::restored(bytes, &Harvester::new())
}

/// Outputs after each of some steps of different size from `time`, s, with an external force on the way.
fn go_on(slave: &mut Harvester, mut time: f64) -> Vec<Vec<u64>> {
    let mut steps = Vec::new();
    for k in 1..=30_u32 {
        if k == 10 {
            set(slave, "externalForce", 0.02);
        }
        let h = 0.003 * f64::from(k);
        step(slave, time, h);
        time += h;
        steps.push(outputs(slave));
    }
    steps
}

fn run_to(reals: &[(&str, f64)], time: f64) -> Harvester {
    let mut slave = initialized(reals);
    if time > 0.0 {
        step(&mut slave, 0.0, time);
    }
    slave
}

fn assert_goes_on_alike(reals: &[(&str, f64)], time: f64) {
    let mut original = run_to(reals, time);
    let mut copy = restored(&bytes(&original)).expect("a state");
    assert_eq!(outputs(&copy), outputs(&original), "at {time} s");
    assert_eq!(go_on(&mut copy, time), go_on(&mut original, time), "from {time} s on");
}

#[test]
fn a_restored_slave_goes_on_to_the_last_bit_with_noise_and_in_the_middle_of_pulses() {
    let mut pressed = 0;
    for k in 0..40 {
        let time = 0.031 * f64::from(k);
        let slave = run_to(NOISY, time);
        pressed += u32::from(get(&slave, "left.deflection") + get(&slave, "right.deflection") > 0.0);
        assert_goes_on_alike(NOISY, time);
        assert_goes_on_alike(&[], time);
    }
    assert!(pressed > 3, "{pressed} of 40 states lie in a pulse");
}

#[test]
fn a_contact_of_the_compliant_law_goes_on_to_the_last_bit() {
    let mut original: Harvester = initialized(&[
        ("initial.ballVelocity", 0.3),
        ("contact.law", 2.0),
        ("contact.electrostaticFeedback", 1.0),
        ("contact.reaction", 1.0),
    ]);
    let mut pressed = 0;
    for k in 0..300_u32 {
        let time = 0.003 * f64::from(k);
        set(&mut original, "left.voltage", 1000.0 + 10.0 * f64::from(k % 7));
        let mut copy = restored(&bytes(&original)).expect("a state");
        step(&mut original, time, 0.003);
        step(&mut copy, time, 0.003);
        assert_eq!(outputs(&copy), outputs(&original), "from {time} s");
        pressed += u32::from(get(&original, "left.deflection") + get(&original, "right.deflection") > 0.0);
    }
    assert!(pressed > 10, "{pressed} of 300 states lie in a contact");
}

#[test]
fn a_state_before_initialisation_keeps_what_was_set_even_if_it_is_contradictory() {
    let mut slave: Harvester = fresh(&[]);
    set(&mut slave, "ball.radius", 0.5);
    let mut copy = restored(&bytes(&slave)).expect("a state");
    assert_eq!(get(&copy, "ball.radius"), 0.5);
    copy.update();
    assert!(get(&copy, "left.capacitance").is_nan());
    set(&mut copy, "ball.radius", 0.005);
    copy.update();
    assert_eq!(outputs(&copy), outputs::<Harvester>(&fresh(&[])));
}

#[test]
fn a_derivative_of_the_input_that_waits_for_the_next_step_is_part_of_the_state() {
    let mut original = run_to(&[], 0.3);
    let Kind::Real(spec) = row::<Harvester>("externalForce").kind() else { unreachable!() };
    spec.input_derivatives.expect("derivatives").1(&mut original, 1, 0.4);
    let mut copy = restored(&bytes(&original)).expect("a state");
    assert_eq!(go_on(&mut copy, 0.3), go_on(&mut original, 0.3));
}

#[test]
fn bytes_that_are_no_state_are_refused() {
    let good = bytes(&run_to(NOISY, 1.7));
    for length in 0..good.len() {
        assert!(restored(&good[..length]).is_err(), "{length} bytes");
    }
    assert!(restored(&[good.as_slice(), &[0]].concat()).is_err());
    let slave = run_to(NOISY, 1.7);
    for name in ["gain.voltage", "gain.energyEq13", "impact.lastVelocity", "ball.velocity", "excitation.noiseHold"] {
        let value = get(&slave, name).to_le_bytes();
        let offset = good.windows(8).position(|window| window == value).expect(name);
        for nonsense in [f64::NAN, f64::INFINITY] {
            let mut bad = good.clone();
            bad[offset..offset + 8].copy_from_slice(&nonsense.to_le_bytes());
            assert!(matches!(restored(&bad), Err(StateError::Invalid(_))), "{name} = {nonsense}");
        }
    }
}

/// Runs in the second process only: reads a state, goes on, prints what comes out.
#[test]
fn the_second_process() {
    let Ok(hex) = std::env::var(STATE) else { return };
    let pairs = hex.as_bytes().chunks(2).map(|pair| core::str::from_utf8(pair).expect("ASCII"));
    let bytes: Vec<u8> = pairs.map(|pair| u8::from_str_radix(pair, 16).expect("hexadecimal")).collect();
    let mut slave = restored(&bytes).expect("a state");
    println!("\nresult {:?}", go_on(&mut slave, 1.3));
}

#[test]
fn a_second_process_goes_on_to_the_last_bit() {
    let mut original = run_to(NOISY, 1.3);
    let hex = bytes(&original).iter().map(|byte| format!("{byte:02x}")).collect::<Vec<_>>().concat();
    let mut command = Command::new(std::env::current_exe().expect("a path"));
    let output = command.args(["--exact", "the_second_process", "--nocapture"]).env(STATE, hex).output();
    let text = String::from_utf8(output.expect("a process").stdout).expect("UTF-8");
    let line = text.lines().find_map(|line| line.strip_prefix("result ")).expect("a result");
    assert_eq!(line, format!("{:?}", go_on(&mut original, 1.3)));
}

#[test]
fn a_state_of_model_exchange_goes_on_to_the_last_bit() {
    let log = fmu_export::Logger::silent();
    let mut original: Harvester = initialized(NOISY);
    original.place(0.0, None).expect("the start");
    original.place(0.0005, Some(&[0.023, 0.3, 0.001, -0.1, 1e-4])).expect("states");
    assert!(original.handle_events(&log).expect("an impact").states_changed);
    original.place(0.0009, Some(&[0.0233, 0.3, 0.0013, 0.5, 1e-4])).expect("states");
    let mut copy = restored(&bytes(&original)).expect("a state");
    for slave in [&mut original, &mut copy] {
        assert!(get(slave, "left.deflection") > 0.0);
        slave.place(0.0011, Some(&[0.0236, 0.3, 0.0018, 0.5, 1e-4])).expect("states");
        slave.handle_events(&log).expect("a noise sample");
    }
    assert_eq!(outputs(&copy), outputs(&original));
    assert_eq!(copy.event_indicators(), original.event_indicators());
    assert_eq!(get(&copy, "der(cylinder.velocity)"), get(&original, "der(cylinder.velocity)"));
}

#[test]
fn no_step_begins_long_after_the_time_of_the_state() {
    let mut slave = restored(&bytes::<Harvester>(&initialized(&[]))).expect("a state");
    let refusal = slave.do_step(1000.0, 0.01, &Logger::silent()).expect_err("1000 s lie between").to_string();
    assert!(refusal.contains("t = 1000 s, but the state is of t = 0 s"), "{refusal}");
    step(&mut slave, 0.0, 0.01);
}
