//! Model exchange through the C interface.

use crate::common::toy::{DERIVATIVE, INPUT, INTEGRAL, LIMIT};
use crate::common::*;
use core::ptr::null_mut;
use fmu_export::abi::*;

type Get = unsafe extern "C" fn(fmi2Component, *mut fmi2Real, usize) -> fmi2Status;

/// The only derivative, event indicator or state.
fn only(host: &Host, get: Get) -> f64 {
    let mut value = UNTOUCHED;
    assert_eq!(unsafe { get(host.component, &raw mut value, 1) }, fmi2OK);
    value
}

fn derivative(host: &Host) -> f64 {
    only(host, fmi2GetDerivatives)
}

fn indicator(host: &Host) -> f64 {
    only(host, fmi2GetEventIndicators)
}

fn state(host: &Host) -> f64 {
    only(host, fmi2GetContinuousStates)
}

fn place(host: &Host, time: f64, state: f64) -> fmi2Status {
    host.place(time, &[state])
}

#[test]
fn derivatives_and_indicators_follow_states_and_inputs() {
    let host = Host::exchanging();
    assert_eq!((state(&host), derivative(&host)), (0.0, 2.0));
    assert_eq!(place(&host, 0.25, 0.5), fmi2OK);
    assert_eq!((state(&host), host.real(INTEGRAL)), (0.5, 0.5));
    assert_eq!(host.set_real(INPUT, 3.0), fmi2OK);
    assert_eq!((derivative(&host), host.real(DERIVATIVE)), (6.0, 6.0));
    assert_eq!(indicator(&host), f64::INFINITY, "no limit was set");
    assert_eq!(host.real(crate::common::toy::TIME), 0.25);
}

#[test]
fn an_event_changes_states_and_announces_the_next_one() {
    let host = Host::of_kind(fmi2ModelExchange);
    assert_eq!(host.set_real(LIMIT, 1.0), fmi2OK);
    assert_eq!((host.setup(0.0, None), host.initialize(), host.enter_continuous_time_mode()), (fmi2OK, fmi2OK, fmi2OK));
    assert_eq!(place(&host, 0.5, 1.0), fmi2OK);
    assert_eq!(indicator(&host), 0.0);
    assert_eq!(host.enter_event_mode(), fmi2OK);
    let (status, info) = host.new_discrete_states();
    assert_eq!(status, fmi2OK);
    let flags = [info.newDiscreteStatesNeeded, info.terminateSimulation, info.nominalsOfContinuousStatesChanged];
    assert_eq!(flags, [fmi2False; 3]);
    assert_eq!(info.valuesOfContinuousStatesChanged, fmi2True);
    assert_eq!((info.nextEventTimeDefined, info.nextEventTime), (fmi2True, 1.0));
    assert_eq!(state(&host), 0.0);
    assert_eq!(host.new_discrete_states().1.valuesOfContinuousStatesChanged, fmi2False);
    assert_eq!(host.enter_continuous_time_mode(), fmi2OK);
}

#[test]
fn a_continuous_state_can_be_set_by_name_between_events_with_inputs_or_without() {
    let host = Host::exchanging();
    assert_eq!(host.set_real(INTEGRAL, 0.75), fmi2OK);
    assert_eq!((state(&host), host.real(INTEGRAL)), (0.75, 0.75));
    let (references, values) = ([INPUT, INTEGRAL], [4.0, 0.5]);
    assert_eq!(host.set_reals(&references, &values), fmi2OK);
    assert_eq!((state(&host), derivative(&host)), (0.5, 8.0));
    for (references, values, reason) in [
        ([INPUT, INTEGRAL], [7.0, f64::NAN], "variable integral = NaN: it must be finite"),
        ([INTEGRAL, INPUT], [7.0, f64::NAN], "variable u = NaN: it must be finite"),
    ] {
        let host = Host::exchanging();
        host.refused(host.set_reals(&references, &values), &format!("fmi2SetReal: {reason}"));
        assert_eq!((host.real(INPUT), host.real(INTEGRAL)), (1.0, 0.0), "all or nothing");
    }
    assert_eq!(Host::at_event().set_real(INTEGRAL, 0.5), fmi2Error, "only between events");
}

#[test]
fn what_is_read_after_the_end_is_of_the_last_time_and_inputs() {
    let host = Host::exchanging();
    assert_eq!(unsafe { fmi2SetTime(host.component, 0.25) }, fmi2OK);
    assert_eq!(host.set_real(INPUT, 3.0), fmi2OK);
    assert_eq!(host.terminate(), fmi2OK);
    assert_eq!((host.real(crate::common::toy::TIME), derivative(&host), host.real(INPUT)), (0.25, 6.0, 3.0));
}

#[test]
fn an_integrator_may_look_beyond_the_stop_time() {
    let host = Host::of_kind(fmi2ModelExchange);
    host.start(0.0, Some(1.0));
    assert_eq!(host.enter_continuous_time_mode(), fmi2OK);
    assert_eq!(place(&host, 1.5, 0.5), fmi2OK);
}

#[test]
fn only_a_restored_state_leads_back_behind_an_event() {
    let host = Host::exchanging();
    assert_eq!(place(&host, 0.5, 0.25), fmi2OK);
    assert_eq!(place(&host, 0.25, 0.25), fmi2OK, "an integrator looks for the event");
    assert_eq!(place(&host, 0.5, 0.25), fmi2OK);
    let before = host.save();
    unsafe { assert_eq!(fmi2EnterEventMode(host.component), fmi2OK) };
    assert_eq!(host.enter_continuous_time_mode(), fmi2OK);
    assert_eq!(place(&host, 0.5_f64.next_down(), 0.25), fmi2OK, "rounding");
    assert_eq!(host.real(crate::common::toy::TIME), 0.5);
    host.refused(
        unsafe { fmi2SetTime(host.component, 0.25) },
        "fmi2SetTime: time = 0.25 s: it must not lie before the last event, at 0.5 s",
    );
    assert_eq!(host.restore(before), fmi2OK);
    assert_eq!(place(&host, 0.25, 0.25), fmi2OK);
}

#[test]
fn counts_and_values_that_make_no_sense_are_refused() {
    let mut values = [0.0; 3];
    let host = Host::exchanging();
    host.refused(
        unsafe { fmi2GetDerivatives(host.component, values.as_mut_ptr(), 3) },
        "fmi2GetDerivatives: nx = 3: this FMU has 1",
    );
    let host = Host::exchanging();
    host.refused(
        unsafe { fmi2GetEventIndicators(host.component, values.as_mut_ptr(), 2) },
        "fmi2GetEventIndicators: ni = 2: this FMU has 1",
    );
    let host = Host::exchanging();
    host.refused(unsafe { fmi2GetDerivatives(host.component, null_mut(), 1) }, "derivatives is NULL");
    for bad in [f64::NAN, f64::INFINITY] {
        let host = Host::exchanging();
        assert_eq!(place(&host, 0.5, bad), fmi2Error);
        assert!(host.error().contains("variable integral"));
        let host = Host::exchanging();
        assert_eq!(unsafe { fmi2SetTime(host.component, bad) }, fmi2Error);
    }
}

#[test]
fn panics_and_errors_in_the_model_become_statuses() {
    let host = Host::at_event();
    host.trouble("error event handler");
    host.refused(host.new_discrete_states().0, "asked for an error");
    let host = Host::at_event();
    host.trouble("panic place");
    host.refused(host.new_discrete_states().0, "panic in place");
}

#[test]
fn a_saved_state_leads_back_and_does_not_fit_the_other_interface() {
    let host = Host::exchanging();
    assert_eq!(place(&host, 0.5, 0.75), fmi2OK);
    let saved = host.save();
    assert_eq!(place(&host, 0.6, 2.0), fmi2OK);
    assert_eq!(host.restore(saved), fmi2OK);
    assert_eq!((state(&host), host.real(crate::common::toy::TIME)), (0.75, 0.5));
    let bytes = host.serialize(saved);
    assert_eq!(Host::exchanging().deserialize(&bytes, &mut null_mut()), fmi2OK);
    let other = Host::initialized();
    other.refused(other.deserialize(&bytes, &mut null_mut()), "the other interface type");
}
