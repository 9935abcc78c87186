//! Steps of FMI 3.0: events, early return, intermediate update, clocks, and what goes wrong.

use crate::common::fmi3::*;
use crate::common::toy;
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

/// The importer may go on without event mode; what ticked then is over, and the next event makes it tick again.
#[test]
fn an_output_clock_that_nobody_looked_at_does_not_tick_in_the_next_step() {
    let host = Host::started(Session::EVENTS);
    assert_eq!(host.stepped(0.0, 1.0), (true, false, 1.0));
    assert_eq!(host.stepped(1.0, 0.5), (false, false, 1.5));
    assert_eq!(host.enter_event_mode(), fmi3OK);
    assert!(!host.clock(toy::TICK));
    assert_eq!(unsafe { fmi3EnterStepMode(host.instance) }, fmi3OK);
    assert_eq!(host.stepped(1.5, 4.0), (true, true, 2.0));
    assert_eq!(host.enter_event_mode(), fmi3OK);
    assert!(host.clock(toy::TICK) && host.clock(toy::TICK), "reading does not stop it");
    assert_eq!(unsafe { fmi3EnterStepMode(host.instance) }, fmi3OK);
    assert_eq!(host.enter_event_mode(), fmi3OK);
    assert!(!host.clock(toy::TICK), "the event is over");
}

/// A discarded step leaves all as it was, what is ticking among it.
#[test]
fn a_step_that_is_refused_stops_no_clock() {
    let host = Host::started(Session::EVENTS);
    assert_eq!(host.stepped(0.0, 1.0), (true, false, 1.0));
    host.trouble("refuse step");
    assert_eq!(host.step(1.0, 0.5).status, fmi3Discard);
    assert_eq!(host.enter_event_mode(), fmi3OK);
    assert!(host.clock(toy::TICK));
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
    assert!(host.error().contains("variable trigger = interval and shift: this clock is triggered and has neither"));
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
fn a_step_that_may_end_early_does_so_at_each_event() {
    let no_events = Session { early_return: true, looks: true, ..Session::PLAIN };
    // At an event it ends anyway.
    let (seen, _, stepped) = looks(no_events, |_| None);
    assert_eq!((seen.len(), stepped.early, stepped.time), (1, true, 1.0));
    let host = Host::started(no_events);
    host.on_look(|_, can_return| can_return.then_some(0.25));
    assert_eq!(host.stepped(0.0, 0.5), (false, false, 0.5), "the end is reached when it looks first");
}

#[test]
fn an_early_return_is_asked_for_at_once_or_for_a_later_time() {
    for wanted in [1.0, 1.75, 9.0, 0.0] {
        let host = Host::started(Session::LOOKS);
        host.on_look(move |_, can_return| can_return.then_some(wanted));
        assert_eq!(host.stepped(0.0, 2.5), (true, true, 1.0), "{wanted}: it ends at its events, asked or not");
        assert_eq!(host.float(toy::TIME), 1.0);
    }
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

/// The same holds for derivatives of outputs (section 4.2.2 of FMI 3.0).
#[test]
fn within_a_step_no_derivative_is_read_that_was_not_asked_for() {
    for (required, wanted) in [(&[toy::INTEGRAL][..], fmi3OK), (&[], fmi3Error)] {
        let host = Host::requiring(Session::LOOKS, required);
        host.start();
        let (instance, order) = (host.instance, 1);
        let seen = Rc::new(RefCell::new(None));
        let status = seen.clone();
        host.on_look(move |_, _| {
            let mut value = f64::NAN;
            let read =
                unsafe { fmi3GetOutputDerivatives(instance, &toy::INTEGRAL, 1, &raw const order, &raw mut value, 1) };
            *status.borrow_mut() = Some(read);
            None
        });
        host.step(0.0, 0.5);
        assert_eq!(*seen.borrow(), Some(wanted));
    }
}

#[test]
fn in_every_session_a_step_that_is_refused_may_be_tried_again() {
    let whole = Session { event_mode: true, ..Session::PLAIN };
    let looks = Session { looks: true, ..Session::PLAIN };
    for session in [Session::PLAIN, Session::EVENTS, Session::LOOKS, whole, looks] {
        let host = Host::started(session);
        host.trouble("refuse step");
        assert_eq!(host.step(0.0, 0.5).status, fmi3Discard, "{session:?}");
        let line = &host.lines()[0];
        assert_eq!((line.status, line.category.as_str()), (fmi3Discard, "logStatusDiscard"));
        assert_eq!((host.float(toy::INTEGRAL), host.float(toy::TIME)), (0.0, 0.0));
        host.trouble("");
        assert_eq!(host.stepped(0.0, 0.5), (false, false, 0.5), "{session:?}");
        // What is done in part is an error where no step may end early.
        host.trouble("discard step");
        let stepped = host.step(0.5, 0.5);
        if session.early_return {
            let wanted = Stepped { status: fmi3OK, event: false, terminate: false, early: true, time: 0.75 };
            assert_eq!(stepped, wanted, "{session:?}");
        } else {
            assert_eq!(stepped.status, fmi3Error, "{session:?}");
            assert!(host.error().contains("the step was done up to 0.75 s, and this importer takes no part of a step"));
        }
    }
}

#[test]
fn steps_that_begin_elsewhere_or_go_nowhere_are_refused_in_every_session() {
    for session in [Session::PLAIN, Session::EVENTS, Session::LOOKS] {
        for (t, h, message) in [
            (0.5, 0.5, "currentCommunicationPoint = 0.5 s"),
            (f64::NAN, 0.5, "currentCommunicationPoint = NaN: it must be finite"),
            (0.0, 0.0, "communicationStepSize = 0: it must be finite and positive"),
            (0.0, -1.0, "communicationStepSize = -1: it must be finite and positive"),
            (0.0, f64::INFINITY, "communicationStepSize = inf: it must be finite and positive"),
        ] {
            let host = Host::started(session);
            assert_eq!(host.step(t, h).status, fmi3Error);
            let error = host.error();
            assert!(error.contains(message), "{error}");
        }
    }
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
    for session in [Session::PLAIN, Session { early_return: true, looks: true, ..Session::PLAIN }] {
        let host = Host::new(session);
        assert_eq!((host.enter_initialization(Some(1.0)), host.exit_initialization()), (fmi3OK, fmi3OK));
        assert_eq!(host.step(0.0, 1.5).status, fmi3Error);
        assert!(host.error().contains("ends behind the stop time 1 s"));
    }
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
    other.update();
    assert!(!other.clock(toy::TICK));
    assert_eq!(unsafe { fmi3EnterStepMode(other.instance) }, fmi3OK);
    assert_eq!(other.stepped(1.0, 5.0), (true, true, 2.0));
    // The state itself stays with its instance.
    assert_eq!(other.restore(saved), fmi3Error);
    assert!(other.error().starts_with("fmi3SetFMUState: "));
    let other = Host::started(Session::PLAIN);
    assert_eq!(other.deserialize(&bytes).0, fmi3Error);
    assert!(other.error().contains("no state that is saved is in state eventMode"));
    let other = Host::started(Session::EXCHANGE);
    assert_eq!(other.deserialize(&bytes).0, fmi3Error);
    assert!(other.error().contains("of an instance of the other interface type"));
}
