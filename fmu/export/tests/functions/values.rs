//! Get and Set of variables through the C functions.

use crate::common::toy::*;
use crate::common::*;
use core::ptr::{null, null_mut};
use fmu_export::abi::*;

#[test]
fn start_values_come_from_the_table() {
    let host = Host::initializing();
    assert_eq!(host.real(GAIN), 2.0);
    assert_eq!(host.real(LIMIT), f64::INFINITY);
    assert_eq!(host.integer(SEED), 1);
    assert_eq!(host.boolean(ON), fmi2True);
    assert_eq!(host.string(LABEL), "toy");
    assert_eq!(host.integer(LAW_VR), 1);
}

#[test]
fn calculated_parameters_follow_a_set_and_are_updated_lazily() {
    let host = Host::initializing();
    assert_eq!(host.set_real(GAIN, 3.0), fmi2OK);
    assert_eq!(host.set_real(GAIN, 4.0), fmi2OK);
    assert_eq!(host.integer(UPDATES), 1);
    assert_eq!(host.real(DOUBLED), 8.0);
    assert_eq!(host.integer(UPDATES), 1);
    assert_eq!(host.set_real(GAIN, 5.0), fmi2OK);
    assert_eq!(host.exit_initialization(), fmi2OK);
    assert_eq!(host.integer(UPDATES), 2, "exitInitializationMode brings calculated values up to date");
    assert_eq!(host.real(DOUBLED), 10.0);
    assert_eq!(host.set_real(INPUT, 5.0), fmi2OK);
    assert_eq!(host.integer(UPDATES), 2, "update is for initialisation only");
}

#[test]
fn a_get_before_initialization_mode_is_tolerated() {
    let host = Host::new();
    assert_eq!(host.try_real(DOUBLED), (fmi2OK, 4.0));
    let lines = host.lines();
    assert_eq!(lines.len(), 1);
    assert_eq!((lines[0].status, lines[0].category.as_str()), (fmi2OK, "logTolerated"));
    assert_eq!(lines[0].instance, "toy");
    assert_eq!(lines[0].message, "fmi2GetReal: FMI 2.0 forbids it in state instantiated; tolerated");
}

#[test]
fn a_text_beyond_its_bound_is_refused_and_shown_in_part() {
    let host = Host::initializing();
    assert_eq!(host.set_string(LABEL, &"\u{e9}".repeat(500)), fmi2OK);
    let host = Host::initializing();
    let status = host.set_string(LABEL, &"\u{e9}".repeat(501));
    let shown = "\u{e9}".repeat(40);
    host.refused(
        status,
        &format!("fmi2SetString: variable label = \"{shown}\"...: 1002 bytes are too long; at most 1000"),
    );
}

#[test]
fn a_value_out_of_bounds_is_an_error_that_names_variable_value_and_bound() {
    let cases = [
        (0.25, "fmi2SetReal: variable toy.gain = 0.25: below its min 0.5 N/m"),
        (9.0, "fmi2SetReal: variable toy.gain = 9: above its max 8 N/m"),
        (f64::NAN, "fmi2SetReal: variable toy.gain = NaN: it must be finite"),
        (f64::NEG_INFINITY, "fmi2SetReal: variable toy.gain = -inf: it must be finite"),
    ];
    for (value, message) in cases {
        let host = Host::new();
        host.refused(host.set_real(GAIN, value), message);
        assert_eq!(host.reset(), fmi2OK);
        assert_eq!(host.real(GAIN), 2.0);
    }
}

#[test]
fn infinity_is_taken_where_the_variable_allows_it_but_nan_never() {
    let host = Host::new();
    assert_eq!(host.set_real(LIMIT, f64::INFINITY), fmi2OK);
    assert_eq!(host.set_real(LIMIT, f64::NAN), fmi2Error);
    let host = Host::new();
    host.refused(host.set_real(LIMIT, f64::NEG_INFINITY), "fmi2SetReal: variable limit = -inf: below its min 0");
}

#[test]
fn integers_and_enumerations_are_checked_against_their_range() {
    for (reference, value, message) in [
        (SEED, -1, "variable seed = -1: below its min 0"),
        (SEED, 10, "variable seed = 10: above its max 9"),
        (LAW_VR, 0, "variable law = 0: no item of Law; allowed: 1 (value), 2 (square)"),
        (LAW_VR, 3, "variable law = 3: no item of Law; allowed: 1 (value), 2 (square)"),
        (LAW_VR, i32::MIN, "variable law = -2147483648: no item of Law; allowed: 1 (value), 2 (square)"),
    ] {
        let host = Host::new();
        host.refused(host.set_integer(reference, value), &format!("fmi2SetInteger: {message}"));
    }
    let host = Host::initializing();
    assert_eq!(host.set_integer(LAW_VR, 2), fmi2OK);
    assert_eq!(host.integer(CHOSEN), 2);
}

#[test]
fn a_set_is_all_or_nothing() {
    let host = Host::new();
    let (references, values) = ([LIMIT, GAIN], [7.0, 99.0]);
    assert_eq!(host.set_reals(&references, &values), fmi2Error);
    assert_eq!(host.real(LIMIT), f64::INFINITY);
}

#[test]
fn the_last_of_several_values_for_one_variable_counts() {
    let host = Host::initializing();
    let (references, values) = ([GAIN, GAIN], [3.0, 4.0]);
    assert_eq!(host.set_reals(&references, &values), fmi2OK);
    assert_eq!(host.real(GAIN), 4.0);
}

#[test]
fn a_variable_of_another_type_or_beyond_the_table_is_refused() {
    let host = Host::initializing();
    assert_eq!(host.try_real(SEED), (fmi2Error, UNTOUCHED));
    assert_eq!(host.error(), "fmi2GetReal: variable seed (value reference 5) is of type Integer, not Real");
    let host = Host::initializing();
    host.refused(
        host.set_integer(GAIN, 1),
        "fmi2SetInteger: variable toy.gain (value reference 0) is of type Real, not Integer",
    );
    for reference in [COUNT_OF_VARIABLES, u32::MAX] {
        let host = Host::initializing();
        assert_eq!(host.try_real(reference).0, fmi2Error);
        let message = format!("fmi2GetReal: no variable has value reference {reference}; allowed: 0 to 33");
        assert_eq!(host.error(), message);
    }
}

#[test]
fn what_may_be_set_depends_on_causality_variability_and_state() {
    let host = Host::initialized();
    assert_eq!(host.set_real(INPUT, 2.0), fmi2OK);
    assert_eq!(host.set_real(LIMIT, 5.0), fmi2OK, "a tunable parameter");
    assert_eq!(host.set_boolean(ON, fmi2False), fmi2OK);
    host.refused(
        host.set_real(GAIN, 3.0),
        "fmi2SetReal: variable toy.gain (fixed parameter) cannot be set in state stepComplete",
    );
    for (reference, what) in [(DOUBLED, "fixed calculatedParameter"), (INTEGRAL, "continuous output")] {
        let host = Host::new();
        host.refused(host.set_real(reference, 1.0), what);
    }
}

#[test]
fn strings_travel_both_ways_and_a_nul_inside_is_replaced() {
    let host = Host::initializing();
    assert_eq!(host.set_string(LABEL, "Gr\u{fc}\u{df}e, 100 %s"), fmi2OK);
    assert_eq!(host.string(LABEL), "Gr\u{fc}\u{df}e, 100 %s");
    assert_eq!(host.string(ECHO), "Gr\u{fc}\u{df}e, 100 %s\u{fffd}");
}

#[test]
fn strings_live_until_the_next_call() {
    let host = Host::initialized();
    let references = [LABEL, ECHO, LABEL];
    let mut values = [null(); 3];
    let status = unsafe { fmi2GetString(host.component, references.as_ptr(), 3, values.as_mut_ptr()) };
    assert_eq!(status, fmi2OK);
    let texts = values.map(|v| unsafe { core::ffi::CStr::from_ptr(v) }.to_str().unwrap());
    assert_eq!(texts, ["toy", "toy\u{fffd}", "toy"]);
}

#[test]
fn a_string_that_is_null_or_no_utf8_is_refused_by_name() {
    let (bad, reference) = (c"\xff\xfe", LABEL);
    for (pointer, reason) in [(null(), "it is NULL"), (bad.as_ptr(), "it is not UTF-8")] {
        let host = Host::new();
        let status = unsafe { fmi2SetString(host.component, &raw const reference, 1, &raw const pointer) };
        host.refused(status, &format!("fmi2SetString: variable label = ?: {reason}"));
    }
}

#[test]
fn any_nonzero_boolean_is_true_and_comes_back_as_one() {
    let host = Host::initializing();
    assert_eq!(host.set_boolean(ON, fmi2False), fmi2OK);
    assert_eq!(host.boolean(IS_ON), 0);
    assert_eq!(host.set_boolean(ON, 42), fmi2OK);
    assert_eq!(host.boolean(IS_ON), 1);
}

#[test]
fn null_arrays_are_refused_unless_empty() {
    let host = Host::initializing();
    let c = host.component;
    let (vr, mut real) = ([GAIN], 0.0);
    unsafe {
        assert_eq!(fmi2GetReal(c, null(), 0, null_mut()), fmi2OK);
        assert_eq!(fmi2SetReal(c, null(), 0, null()), fmi2OK);
        assert_eq!(fmi2GetReal(c, null(), 1, &raw mut real), fmi2Error);
    }
    assert_eq!(host.error(), "fmi2GetReal: argument vr is NULL");
    let host = Host::initializing();
    host.refused(unsafe { fmi2SetReal(host.component, vr.as_ptr(), 1, null()) }, "fmi2SetReal: argument value is NULL");
    let host = Host::initializing();
    let status = unsafe { fmi2GetReal(host.component, vr.as_ptr(), usize::MAX, &raw mut real) };
    host.refused(status, "more than memory holds");
}
