//! Steps of FMI 3.0: events, early return, intermediate update, clocks, and what goes wrong.
#![allow(clippy::expect_used, clippy::panic)] // Helpers outside of #[test] functions fail a test, too.

mod common;

use common::fmi3::*;
use common::toy;
use core::cell::RefCell;
use core::ptr::null_mut;
use fmu_export::abi::fmi3::*;
use std::rc::Rc;

/// The integral of a step of `h` s.
fn grown(h: f64) -> f64 {
    2.0 * h
}

#[test]
fn without_permission_a_step_goes_through_all_events() {
    let host = Host::started(Session::PLAIN);
    assert_eq!(host.stepped(0.0, 3.5), (false, false, 3.5));
    assert_eq!(host.float(toy::INTEGRAL), grown(3.5));
    assert_eq!(host.float(toy::TIME), 3.5);
    assert_eq!(host.enter_event_mode(), fmi3Error);
}

#[test]
fn with_permission_it_ends_at_each_event() {
    for event_mode in [false, true] {
        let host = Host::started(Session { event_mode, early_return: true, ..Session::PLAIN });
        let mut time = 0.0;
        for wanted in [1.0, 2.0, 2.5] {
            let is_event = wanted < 2.5;
            assert_eq!(host.stepped(time, 2.5 - time), (is_event && event_mode, is_event, wanted));
            assert_eq!(host.float(toy::INTEGRAL), grown(wanted));
            time = wanted;
        }
        // An event at the very end ends no step early.
        assert_eq!(host.stepped(2.5, 0.5), (event_mode, false, 3.0));
    }
}

#[test]
fn an_importer_of_events_that_takes_whole_steps_hears_of_them_at_the_end() {
    let host = Host::started(Session { event_mode: true, ..Session::PLAIN });
    assert_eq!(host.stepped(0.0, 2.5), (true, false, 2.5));
    assert_eq!(host.stepped(2.5, 0.25), (false, false, 2.75));
}

#[test]
fn an_output_clock_ticks_at_its_event_until_the_discrete_states_are_updated() {
    let host = Host::started(Session::EVENTS);
    assert_eq!(host.stepped(0.0, 5.0), (true, true, 1.0));
    assert_eq!(host.enter_event_mode(), fmi3OK);
    assert!(host.clock(toy::TICK));
    let mut ticks = 0;
    assert_eq!(unsafe { fmi3GetUInt64(host.instance, &toy::TICKS, 1, &raw mut ticks, 1) }, fmi3OK);
    assert_eq!((ticks, host.lines()), (1, vec![]));
    assert_eq!(host.update(), (false, Some(2.0)));
    assert!(!host.clock(toy::TICK));
    assert_eq!(unsafe { fmi3EnterStepMode(host.instance) }, fmi3OK);
    // An importer may enter event mode for reasons of its own: no clock ticks.
    assert_eq!(host.stepped(1.0, 0.5), (false, false, 1.5));
    assert_eq!(host.enter_event_mode(), fmi3OK);
    assert!(!host.clock(toy::TICK));
    assert_eq!(unsafe { fmi3EnterStepMode(host.instance) }, fmi3OK);
    // Between events clocked variables are read all the same.
    assert_eq!(unsafe { fmi3GetUInt64(host.instance, &toy::TICKS, 1, &raw mut ticks, 1) }, fmi3OK);
    let lines = host.lines();
    assert_eq!(lines[0].category, "logTolerated");
    assert_eq!(lines[0].message, "FMI 3.0 forbids that output ticks be read in state stepMode; tolerated");
}

#[test]
fn an_input_clock_makes_its_variables_count_at_its_ticks() {
    let host = Host::started(Session::EVENTS);
    let (mut interval, mut shift, mut qualifier) = (0.0, 1.0, 7);
    assert_eq!(host.enter_event_mode(), fmi3OK);
    let [clock, tick] = [toy::SAMPLE, 1];
    unsafe {
        let (interval, qualifier) = (&raw mut interval, &raw mut qualifier);
        assert_eq!(fmi3GetIntervalDecimal(host.instance, &raw const clock, 1, interval, qualifier), fmi3OK);
        assert_eq!(fmi3SetClock(host.instance, &raw const clock, 1, (&raw const tick).cast()), fmi3OK);
    }
    assert_eq!((interval, qualifier), (0.5, fmi3IntervalUnchanged));
    assert!(host.clock(toy::SAMPLE));
    assert_eq!(host.set_float(toy::SAMPLED, 4.0), fmi3OK);
    assert_eq!(host.update(), (false, Some(1.0)));
    assert!(!host.clock(toy::SAMPLE));
    let mut samples = 0;
    assert_eq!(unsafe { fmi3GetInt32(host.instance, &toy::SAMPLES, 1, &raw mut samples, 1) }, fmi3OK);
    assert_eq!(samples, 1);
    let host = Host::new(Session::EVENTS);
    assert_eq!(host.enter_initialization(None), fmi3OK);
    assert_eq!(unsafe { fmi3GetShiftDecimal(host.instance, &raw const clock, 1, &raw mut shift) }, fmi3OK);
    assert_eq!(shift, 0.0);
}

#[test]
fn clocks_that_cannot_be_set_say_so() {
    let refused = |reference: u32, ticks: &[u8], message: &str| {
        let host = Host::started(Session::EVENTS);
        assert_eq!(host.enter_event_mode(), fmi3OK);
        let set = |tick: &u8| unsafe { fmi3SetClock(host.instance, &raw const reference, 1, tick) };
        let statuses: Vec<_> = ticks.iter().map(set).collect();
        assert_eq!(statuses.last(), Some(&fmi3Error));
        assert!(host.error().contains(message));
    };
    refused(toy::TICK, &[1], "variable tick = active: an output clock ticks by itself");
    refused(toy::SAMPLE, &[1, 0], "variable sample = inactive: it ticks, and cannot be deactivated");
    refused(toy::INPUT, &[1], "variable u (value reference 3) is of type Float64, not Clock");
    let host = Host::started(Session::EVENTS);
    assert_eq!(host.enter_event_mode(), fmi3OK);
    let (mut interval, mut qualifier) = (0.0, 0);
    let status =
        unsafe { fmi3GetIntervalDecimal(host.instance, &toy::TRIGGER, 1, &raw mut interval, &raw mut qualifier) };
    assert_eq!(status, fmi3Error);
    assert!(host.error().contains("variable trigger = interval: this clock is triggered and has none"));
}

/// Times at which the importer looks, and what it reads there, in a step from 0 to 2.5 s.
fn looks(session: Session, wanted: impl Fn(f64) -> Option<f64> + 'static) -> (Vec<(f64, f64, bool)>, Host, Stepped) {
    let host = Host::started(session);
    let seen = Rc::new(RefCell::new(Vec::new()));
    let (instance, list) = (host.instance, seen.clone());
    host.on_look(move |time, can_return| {
        let mut value = f64::NAN;
        assert_eq!(unsafe { fmi3GetFloat64(instance, &toy::INTEGRAL, 1, &raw mut value, 1) }, fmi3OK);
        list.borrow_mut().push((time, value, can_return));
        wanted(time)
    });
    let stepped = host.step(0.0, 2.5);
    (seen.take(), host, stepped)
}

#[test]
fn the_importer_looks_at_each_event_and_at_the_end() {
    let (seen, _, stepped) = looks(Session { looks: true, ..Session::PLAIN }, |_| Some(1.0));
    assert_eq!(seen, [1.0, 2.0, 2.5].map(|time| (time, grown(time), false)), "and has no say without permission");
    assert_eq!(stepped, Stepped { status: fmi3OK, event: false, terminate: false, early: false, time: 2.5 });
}

#[test]
fn the_importer_says_where_a_step_ends() {
    let no_events = Session { early_return: true, looks: true, ..Session::PLAIN };
    // At an event it ends anyway.
    let (seen, _, stepped) = looks(no_events, |_| None);
    assert_eq!((seen.len(), stepped.early, stepped.time), (1, true, 1.0));
    let host = Host::started(no_events);
    host.on_look(|_, can_return| can_return.then_some(0.25));
    assert_eq!(host.stepped(0.0, 0.5), (false, false, 0.5), "the end is reached when it looks first");
    let host = Host::started(no_events);
    host.on_look(|_, _| Some(f64::NAN));
    assert_eq!(host.step(0.0, 0.5).status, fmi3Error);
    assert!(host.error().contains("earlyReturnTime = NaN: it must be a time of the step"));
}

#[test]
fn within_a_step_nothing_is_read_that_was_not_asked_for() {
    for reference in [toy::GAIN, toy::COUNT_OF_VARIABLES] {
        let host = Host::started(Session::LOOKS);
        let instance = host.instance;
        host.on_look(move |_, _| {
            let mut value = 0.0;
            assert_eq!(unsafe { fmi3GetFloat64(instance, &raw const reference, 1, &raw mut value, 1) }, fmi3Error);
            None
        });
        assert_eq!(host.step(0.0, 0.5).status, fmi3Error);
        assert!(host.lines()[0].message.contains("was not among the requiredIntermediateVariables"));
    }
}

#[test]
fn a_step_that_is_discarded_leaves_all_as_it_was_or_is_done_in_part() {
    let host = Host::started(Session::EVENTS);
    host.trouble("discard step");
    let stepped = host.step(0.0, 0.5);
    assert_eq!(stepped, Stepped { status: fmi3OK, event: false, terminate: false, early: true, time: 0.25 });
    let host = Host::started(Session::PLAIN);
    host.trouble("discard step");
    assert_eq!(host.step(0.0, 0.5).status, fmi3Error);
    assert!(host.error().contains("the step was done up to 0.25 s, and this importer takes no part of a step"));
    let host = Host::started(Session::PLAIN);
    host.trouble("refuse step");
    assert_eq!(host.step(0.0, 0.5).status, fmi3Discard);
    assert_eq!(host.lines()[0].category, "logStatusDiscard");
    host.trouble("");
    assert_eq!(host.stepped(0.0, 0.5), (false, false, 0.5), "another try");
}

#[test]
fn a_model_that_wants_to_end_says_so() {
    for (session, early) in [(Session::PLAIN, false), (Session::EVENTS, true)] {
        let host = Host::started(session);
        host.trouble("terminate step");
        let stepped = host.step(0.0, 0.5);
        assert_eq!(stepped, Stepped { status: fmi3OK, event: false, terminate: true, early, time: 0.125 });
    }
}

#[test]
fn errors_and_warnings_of_a_step_are_those_of_the_model() {
    for session in [Session::PLAIN, Session::EVENTS, Session::LOOKS] {
        for (trouble, wanted) in [("error step", fmi3Error), ("fatal step", fmi3Fatal), ("warning step", fmi3Warning)] {
            let host = Host::started(session);
            host.trouble(trouble);
            assert_eq!(host.step(0.0, 0.5).status, wanted, "{trouble}");
            assert_eq!(host.lines()[0].status, wanted, "{trouble}");
        }
    }
}

#[test]
fn steps_beyond_the_stop_time_and_without_a_place_for_the_outcome_are_refused() {
    let host = Host::new(Session::PLAIN);
    assert_eq!((host.enter_initialization(Some(1.0)), host.exit_initialization()), (fmi3OK, fmi3OK));
    assert_eq!(host.step(0.0, 1.5).status, fmi3Error);
    assert!(host.error().contains("ends behind the stop time 1 s"));
    let (mut flag, mut time) = (0, 0.0);
    let flag = &raw mut flag;
    for missing in 0..4 {
        let host = Host::started(Session::PLAIN);
        let pointer = |k| if k == missing { null_mut() } else { flag };
        let time = if missing == 3 { null_mut() } else { &raw mut time };
        let status = unsafe { fmi3DoStep(host.instance, 0.0, 0.5, 0, pointer(0), pointer(1), pointer(2), time) };
        assert_eq!(status, fmi3Error);
        assert!(host.error().ends_with("is NULL"));
    }
}

#[test]
fn a_saved_state_brings_an_event_back_with_its_clock() {
    let host = Host::started(Session::EVENTS);
    host.stepped(0.0, 5.0);
    assert_eq!(host.enter_event_mode(), fmi3OK);
    let saved = host.save();
    let bytes = host.serialize(saved);
    host.update();
    assert!(!host.clock(toy::TICK));
    assert_eq!(host.restore(saved), fmi3OK);
    assert!(host.clock(toy::TICK));
    // Another instance goes on from the bytes; one without event mode, or of model exchange, cannot.
    let other = Host::started(Session::EVENTS);
    let (status, state) = other.deserialize(&bytes);
    assert_eq!((status, other.restore(state)), (fmi3OK, fmi3OK));
    assert!(other.clock(toy::TICK));
    assert_eq!(other.float(toy::INTEGRAL), grown(1.0));
    let other = Host::started(Session::PLAIN);
    assert_eq!(other.deserialize(&bytes).0, fmi3Error);
    assert!(other.error().contains("no state that is saved is in state eventMode"));
    let other = Host::started(Session::EXCHANGE);
    assert_eq!(other.deserialize(&bytes).0, fmi3Error);
    assert!(other.error().contains("of an instance of the other interface type"));
}

#[test]
fn model_exchange_integrates_the_toy_up_to_its_limit() {
    let host = Host::new(Session::EXCHANGE);
    assert_eq!(host.set_float(toy::LIMIT, 1.0), fmi3OK);
    assert_eq!((host.enter_initialization(None), host.exit_initialization()), (fmi3OK, fmi3OK));
    assert_eq!(host.update(), (false, Some(1.0)));
    let i = host.instance;
    let (mut states, mut indicators) = (0, 0);
    unsafe {
        assert_eq!(fmi3GetNumberOfContinuousStates(i, &raw mut states), fmi3OK);
        assert_eq!(fmi3GetNumberOfEventIndicators(i, &raw mut indicators), fmi3OK);
        assert_eq!(fmi3EnterContinuousTimeMode(i), fmi3OK);
    }
    assert_eq!((states, indicators), (1, 1));
    let (mut x, mut rate, mut indicator) = (0.0, 0.0, 1.0);
    let mut step = 0;
    while indicator > 0.0 {
        step += 1;
        unsafe {
            assert_eq!(fmi3GetContinuousStateDerivatives(i, &raw mut rate, 1), fmi3OK);
            x += 0.125 * rate;
            assert_eq!(fmi3SetTime(i, f64::from(step) * 0.125), fmi3OK);
            assert_eq!(fmi3SetContinuousStates(i, &raw const x, 1), fmi3OK);
            assert_eq!(fmi3GetEventIndicators(i, &raw mut indicator, 1), fmi3OK);
        }
        assert_eq!(host.float(toy::COUNT_OF_VARIABLES), indicator, "the variable of the indicator");
    }
    assert_eq!((step, host.float(toy::TIME)), (4, 0.5));
    assert_eq!(host.enter_event_mode(), fmi3OK);
    assert_eq!(host.float(toy::INTEGRAL), 0.0, "what is read in event mode comes after the event");
    assert_eq!(host.set_float(toy::INTEGRAL, 1.0), fmi3Error, "a state that jumps is the model's there");
    assert!(host.error().contains("cannot be set in state eventMode"));
    let host = Host::started(Session::EXCHANGE);
    assert_eq!(host.enter_event_mode(), fmi3OK);
    assert_eq!(host.update(), (false, Some(1.0)));
}

#[test]
fn directional_and_adjoint_derivatives_are_those_of_the_rows() {
    let host = Host::started(Session::EXCHANGE);
    let (unknowns, knowns) = ([toy::DERIVATIVE], [toy::INPUT, toy::INTEGRAL]);
    let mut forward = [0.0];
    let mut backward = [0.0; 2];
    unsafe {
        let seed = [3.0, 0.0];
        let (u, k) = (unknowns.as_ptr(), knowns.as_ptr());
        let status = fmi3GetDirectionalDerivative(host.instance, u, 1, k, 2, seed.as_ptr(), 2, forward.as_mut_ptr(), 1);
        assert_eq!(status, fmi3OK, "{:?}", host.lines());
        let seed = [5.0];
        let status = fmi3GetAdjointDerivative(host.instance, u, 1, k, 2, seed.as_ptr(), 1, backward.as_mut_ptr(), 2);
        assert_eq!(status, fmi3OK);
        assert_eq!((forward, backward), ([6.0], [10.0, 0.0]));
        let status = fmi3GetAdjointDerivative(host.instance, u, 1, k, 2, seed.as_ptr(), 2, backward.as_mut_ptr(), 2);
        assert_eq!(status, fmi3Error);
    }
    assert!(host.error().contains("nValues = 2"));
}
