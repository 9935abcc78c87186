//! Steps, their communication points, discarded steps, derivatives and the status functions.

use crate::common::toy::*;
use crate::common::*;
use core::ptr::{null, null_mut};
use fmu_export::abi::*;

#[test]
fn steps_advance_the_model() {
    let host = Host::initialized();
    assert_eq!(host.step(0.0, 0.5), fmi2OK);
    assert_eq!(host.set_real(INPUT, 3.0), fmi2OK);
    assert_eq!(host.step(0.5, 0.5), fmi2OK);
    assert_eq!(host.real(INTEGRAL), 2.0 * 0.5 + 2.0 * 3.0 * 0.5);
    assert_eq!((host.integer(COUNT), host.real(TIME)), (2, 1.0));
}

#[test]
fn a_wrong_communication_point_is_an_error_that_names_both_times() {
    let host = Host::initialized();
    assert_eq!(host.step(0.0, 0.5), fmi2OK);
    host.refused(host.step(0.75, 0.5), "currentCommunicationPoint = 0.75 s, but the slave is at 0.5 s");
}

#[test]
fn rounding_and_nanosecond_clocks_do_not_disturb() {
    const STEPS: i32 = if cfg!(miri) { 200 } else { 10_000 };
    let host = Host::initialized();
    for i in 0..STEPS {
        assert_eq!(host.step(f64::from(i) * 0.1, 0.1), fmi2OK, "step {i}");
    }
    let host = Host::initialized();
    let mut sum = 0.0;
    for _ in 0..STEPS {
        assert_eq!(host.step(sum, 0.1), fmi2OK);
        sum += 0.1;
    }
    let host = Host::initialized();
    for i in 0..STEPS {
        let t = f64::from(i) / 3e4;
        let nanoseconds = (t * 1e9).round() * 1e-9;
        assert_eq!(host.step(nanoseconds, 1.0 / 3e4), fmi2OK, "step {i}");
    }
}

/// The clock counts in single precision, as `n * h` or as a sum, and the size of a step is what its ends differ by.
#[test]
fn a_clock_in_single_precision_does_not_disturb() {
    const STEPS: u16 = if cfg!(miri) { 200 } else { 10_000 };
    let product = |step: u16| f32::from(step) * 0.01;
    let sums: Vec<f32> = (0..=STEPS).scan(0.0, |sum: &mut f32, _| Some(core::mem::replace(sum, *sum + 0.01))).collect();
    for times in [(0..=STEPS).map(product).collect(), sums] {
        let (size, differences) = (Host::initialized(), Host::initialized());
        for ends in times.windows(2) {
            let t = f64::from(ends[0]);
            assert_eq!(size.step(t, f64::from(0.01_f32)), fmi2OK, "{t} s");
            assert_eq!(differences.step(t, f64::from(ends[1] - ends[0])), fmi2OK, "{t} s");
        }
    }
}

#[test]
fn a_communication_point_off_by_a_good_part_of_a_step_is_refused() {
    for size in [1e-6, 1e-3, 0.01, 10.0] {
        for part in [-0.5, -0.11, 0.11, 0.5, 1.0] {
            let host = Host::started(100.0, None);
            assert_eq!(host.step(100.0, size), fmi2OK);
            host.refused(host.step(100.0 + (1.0 + part) * size, size), "currentCommunicationPoint = ");
        }
    }
}

#[test]
fn a_step_size_that_is_no_step_is_refused() {
    for h in [0.0, -0.0, -1.0, f64::NAN, f64::INFINITY, 1e-320] {
        let host = Host::started(1.0, None);
        host.refused(host.step(1.0, h), "communicationStepSize = ");
    }
    let host = Host::initialized();
    host.refused(host.step(f64::NAN, 1.0), "currentCommunicationPoint = NaN");
}

#[test]
fn the_stop_time_is_kept_to_within_the_tolerance() {
    let host = Host::started(0.0, Some(0.3));
    for i in 0..3 {
        assert_eq!(host.step(f64::from(i) * 0.1, 0.1), fmi2OK, "0.2 + 0.1 is above 0.3 by rounding");
    }
    host.refused(host.step(0.3, 0.1), "the step from 0.3 s to 0.4 s ends behind the stop time 0.3 s");
}

#[test]
fn a_discarded_step_tells_how_far_it_got() {
    let host = Host::initialized();
    assert_eq!(host.step(0.0, 1.0), fmi2OK);
    let saved = host.save();
    host.trouble("discard step");
    assert_eq!(host.step(1.0, 1.0), fmi2Discard);
    let line = host.lines().pop().expect("a message");
    assert_eq!((line.status, line.category.as_str()), (fmi2Discard, "logStatusDiscard"));
    assert_eq!(host.real_status(fmi2LastSuccessfulTime), (fmi2OK, 1.25));
    assert_eq!(host.boolean_status(fmi2Terminated), (fmi2OK, fmi2False));
    let mut status = -1;
    assert_eq!(unsafe { fmi2GetStatus(host.component, fmi2DoStepStatus, &raw mut status) }, fmi2OK);
    assert_eq!(status, fmi2Discard);
    assert_eq!(host.restore(saved), fmi2OK);
    assert_eq!(host.step(1.0, 0.5), fmi2OK, "a smaller step after going back");
    assert_eq!(host.real_status(fmi2LastSuccessfulTime), (fmi2OK, 1.5));
}

#[test]
fn a_slave_can_ask_for_the_end() {
    let host = Host::initialized();
    host.trouble("terminate step");
    assert_eq!(host.step(0.0, 1.0), fmi2Discard);
    assert_eq!(host.boolean_status(fmi2Terminated), (fmi2OK, fmi2True));
    assert_eq!(host.real_status(fmi2LastSuccessfulTime), (fmi2OK, 0.125));
    host.lines();
    assert_eq!(host.terminate(), fmi2OK);
    assert_eq!(host.real_status(fmi2LastSuccessfulTime), (fmi2OK, 0.125));
}

#[test]
fn a_warning_of_the_model_becomes_the_status() {
    let host = Host::initialized();
    host.trouble("warning step");
    assert_eq!(host.step(0.0, 1.0), fmi2Warning);
    let mut status = -1;
    assert_eq!(unsafe { fmi2GetStatus(host.component, fmi2DoStepStatus, &raw mut status) }, fmi2OK);
    assert_eq!(status, fmi2Warning);
    host.trouble("");
    assert_eq!(host.step(1.0, 1.0), fmi2OK);
}

#[test]
fn a_status_that_is_not_there_is_discarded_and_nothing_else_happens() {
    let host = Host::initialized();
    let c = host.component;
    assert_eq!(host.real_status(fmi2LastSuccessfulTime), (fmi2OK, 0.0), "before the first step");
    assert_eq!(host.real_status(fmi2Terminated), (fmi2Discard, UNTOUCHED));
    assert_eq!(host.boolean_status(99).0, fmi2Discard);
    let (mut integer, mut text) = (0, null());
    unsafe {
        assert_eq!(fmi2GetStatus(c, fmi2PendingStatus, &raw mut integer), fmi2Discard);
        assert_eq!(fmi2GetIntegerStatus(c, fmi2DoStepStatus, &raw mut integer), fmi2Discard);
        assert_eq!(fmi2GetStringStatus(c, fmi2PendingStatus, &raw mut text), fmi2Discard);
    }
    assert_eq!(host.step(0.0, 1.0), fmi2OK);
    host.refused(
        unsafe { fmi2GetRealStatus(c, fmi2LastSuccessfulTime, null_mut()) },
        "fmi2GetRealStatus: argument value is NULL",
    );
}

#[test]
fn input_derivatives_reach_the_model_and_outputs_have_theirs() {
    let host = Host::initialized();
    assert_eq!(host.set_derivative(INPUT, 1, 2.0), fmi2OK);
    assert_eq!(host.step(0.0, 1.0), fmi2OK);
    assert_eq!(host.real(INTEGRAL), 2.0 * (1.0 + 0.5 * 2.0));
    assert_eq!(host.output_derivative(INTEGRAL, 1), (fmi2OK, 2.0));
}

#[test]
fn derivatives_that_do_not_exist_are_refused() {
    let cases = [
        (INPUT, 0, 1.0, "variable u = derivative of order 0: allowed: 1 to 1"),
        (INPUT, 2, 1.0, "variable u = derivative of order 2: allowed: 1 to 1"),
        (INPUT, 1, f64::NAN, "variable u = derivative NaN: it must be finite"),
        (LIMIT, 1, 1.0, "variable limit = time derivative: this variable has none"),
        (SEED, 1, 1.0, "variable seed (value reference 5) is of type Integer, not Real"),
        (99, 1, 1.0, "no variable has value reference 99"),
    ];
    for (reference, order, value, reason) in cases {
        let host = Host::initialized();
        host.refused(host.set_derivative(reference, order, value), reason);
    }
    for (reference, order) in [(INTEGRAL, 0), (INTEGRAL, 2), (INPUT, 1), (COUNT, 1), (99, 1)] {
        assert_eq!(Host::initialized().output_derivative(reference, order).0, fmi2Error);
    }
}
