//! Directional derivatives through the C interface.
#![allow(clippy::expect_used)] // helpers outside of #[test] functions fail a test, too

mod common;

use common::toy::{COUNT, DOUBLED, GAIN, INPUT, INTEGRAL, SEED};
use common::*;
use core::ptr::{null, null_mut};
use fmi2_export::abi::*;

fn derivative(host: &Host, unknowns: &[u32], knowns: &[u32], seeds: &[f64]) -> Result<Vec<f64>, String> {
    let mut values = vec![-77.0; unknowns.len()];
    let status = unsafe {
        fmi2GetDirectionalDerivative(
            host.component,
            unknowns.as_ptr(),
            unknowns.len(),
            knowns.as_ptr(),
            knowns.len(),
            seeds.as_ptr(),
            values.as_mut_ptr(),
        )
    };
    if status == fmi2OK { Ok(values) } else { Err(host.error()) }
}

#[test]
fn during_initialisation_seeds_are_weighted_with_the_partial_derivatives() {
    let host = Host::initializing();
    assert_eq!(derivative(&host, &[DOUBLED, INTEGRAL], &[GAIN], &[0.25]), Ok(vec![0.5, 0.0]));
    assert_eq!(derivative(&host, &[DOUBLED], &[INPUT, GAIN], &[3.0, -1.0]), Ok(vec![-2.0]));
    assert_eq!(derivative(&host, &[DOUBLED], &[], &[]), Ok(vec![0.0]));
}

#[test]
fn afterwards_an_output_depends_on_what_the_table_says_and_nothing_else() {
    let host = Host::initialized();
    assert_eq!(derivative(&host, &[INTEGRAL], &[INPUT], &[1.0]), Ok(vec![0.0]));
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
fn null_arrays_and_panics_are_errors() {
    let host = Host::initialized();
    let (vr, mut value) = (INTEGRAL, 0.0);
    let status = unsafe {
        fmi2GetDirectionalDerivative(host.component, &raw const vr, 1, &raw const vr, 1, null(), &raw mut value)
    };
    assert_eq!(status, fmi2Error);
    assert!(host.error().contains("argument dvKnown is NULL"));
    let host = Host::initialized();
    let status =
        unsafe { fmi2GetDirectionalDerivative(host.component, &raw const vr, 1, null(), 0, null(), null_mut()) };
    assert_eq!(status, fmi2Error);
    assert!(host.error().contains("argument dvUnknown is NULL"));
    let host = Host::initializing();
    host.trouble("panic derivative");
    let error = derivative(&host, &[DOUBLED], &[GAIN], &[1.0]).expect_err("a panic");
    assert!(error.contains("panic in derivative"), "{error}");
}
