//! Directional derivatives through the C interface.

use crate::common::toy::{COUNT, DERIVATIVE, DOUBLED, GAIN, HELD, INPUT, INTEGRAL, SEED, SWITCHED};
use crate::common::*;
use core::ptr::{null, null_mut};

fn derivative(host: &Host, unknowns: &[u32], knowns: &[u32], seeds: &[f64]) -> Result<Vec<f64>, String> {
    host.directional_derivative(unknowns, knowns, seeds).map_err(|_| host.error())
}

#[test]
fn during_initialisation_seeds_are_weighted_with_the_partial_derivatives() {
    let host = Host::initializing();
    assert_eq!(derivative(&host, &[DOUBLED, INTEGRAL], &[GAIN], &[0.25]), Ok(vec![0.5, 0.0]));
    assert_eq!(derivative(&host, &[DOUBLED], &[INPUT, GAIN], &[3.0, -1.0]), Ok(vec![-2.0]));
    assert_eq!(derivative(&host, &[DOUBLED], &[], &[]), Ok(vec![0.0]));
}

#[test]
fn in_model_exchange_an_unknown_depends_on_what_the_table_says_and_nothing_else() {
    for host in [Host::at_event(), Host::exchanging()] {
        let unknowns = [INTEGRAL, DERIVATIVE];
        assert_eq!(derivative(&host, &unknowns, &[INPUT, INTEGRAL], &[1.0, 1.0]), Ok(vec![0.0, 2.0]));
    }
}

#[test]
fn in_co_simulation_an_input_acts_through_the_step_whatever_depends_on_it_at_one_point() {
    let host = Host::initialized();
    assert_eq!(derivative(&host, &[INTEGRAL, DERIVATIVE], &[INPUT], &[3.0]), Ok(vec![6.0, 6.0]));
}

/// Between events a discrete variable is constant; at events and in co-simulation the model is asked.
#[test]
fn derivatives_of_and_for_discrete_variables_are_zero_between_events() {
    for (host, at_event) in [(Host::at_event(), 1.0), (Host::exchanging(), 0.0), (Host::initialized(), 1.0)] {
        assert_eq!(derivative(&host, &[HELD, DERIVATIVE], &[SWITCHED], &[1.0]), Ok(vec![at_event; 2]));
    }
}

#[test]
fn each_mode_has_the_unknowns_and_knowns_that_the_standard_lists() {
    type Mode = fn() -> Host;
    // Variable, then whether it is an unknown and a known: initialisation, steps, events, between events.
    let modes: [Mode; 4] = [Host::initializing, Host::initialized, Host::at_event, Host::exchanging];
    let rows = [
        (GAIN, [false; 4], [true, false, false, false]),
        (DOUBLED, [true, false, false, false], [false; 4]),
        (INPUT, [false; 4], [true; 4]),
        (INTEGRAL, [true; 4], [false, true, true, true]),
        (DERIVATIVE, [true; 4], [false; 4]),
        (SWITCHED, [false; 4], [true; 4]),
        (HELD, [true; 4], [false; 4]),
        (COUNT, [false; 4], [false; 4]),
    ];
    for (variable, unknown, known) in rows {
        for (k, mode) in modes.iter().enumerate() {
            let given = |unknown, known| derivative(&mode(), &[unknown], &[known], &[1.0]).is_ok();
            assert_eq!(given(variable, INPUT), unknown[k], "variable {variable} as unknown, mode {k}");
            assert_eq!(given(INTEGRAL, variable), known[k], "variable {variable} as known, mode {k}");
        }
    }
}

#[test]
fn a_variable_that_is_no_known_or_no_unknown_of_the_state_is_refused_by_name() {
    let refusals = [
        (Host::initializing(), DOUBLED, SEED, "variable seed (Integer, fixed parameter) is no known"),
        (Host::initializing(), GAIN, GAIN, "variable toy.gain (Real, fixed parameter) is no unknown"),
        (Host::initializing(), COUNT, GAIN, "variable count (Integer, discrete output) is no unknown"),
        (Host::initialized(), INTEGRAL, GAIN, "variable toy.gain (Real, fixed parameter) is no known"),
        (Host::initialized(), DOUBLED, INPUT, "variable doubled (Real, fixed calculatedParameter) is no unknown"),
        (Host::initialized(), 99, INPUT, "no variable has value reference 99"),
    ];
    for (host, unknown, known, reason) in refusals {
        let error = derivative(&host, &[unknown], &[known], &[1.0]).expect_err(reason);
        assert!(error.contains(reason), "{error}");
    }
}

#[test]
fn a_seed_that_is_not_finite_is_blamed_on_itself() {
    for seed in [f64::NAN, f64::INFINITY] {
        let error = derivative(&Host::initializing(), &[DOUBLED], &[GAIN], &[seed]).expect_err("no derivative");
        assert_eq!(error, format!("fmi2GetDirectionalDerivative: dvKnown = {seed}: it must be finite"));
    }
}

#[test]
fn null_arrays_are_errors() {
    let host = Host::initialized();
    let (vr, mut value) = (INTEGRAL, 0.0);
    let status = unsafe {
        fmi2GetDirectionalDerivative(host.component, &raw const vr, 1, &raw const vr, 1, null(), &raw mut value)
    };
    host.refused(status, "argument dvKnown is NULL");
    let host = Host::initialized();
    let status =
        unsafe { fmi2GetDirectionalDerivative(host.component, &raw const vr, 1, null(), 0, null(), null_mut()) };
    host.refused(status, "argument dvUnknown is NULL");
}
