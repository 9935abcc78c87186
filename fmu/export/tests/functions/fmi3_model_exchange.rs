//! Model exchange of FMI 3.0, and derivatives of both kinds.

use crate::common::fmi3::*;
use crate::common::toy;
use core::ptr::null_mut;
use fmu_export::abi::fmi3::*;

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
fn model_exchange_tells_of_its_states_and_refuses_what_does_not_fit() {
    let host = Host::started(Session::EXCHANGE);
    let i = host.instance;
    let (x, mut back, mut nominal, mut flags) = (0.5, 0.0, 0.0, [7_u8; 2]);
    let [enter, end] = &mut flags;
    unsafe {
        assert_eq!(fmi3SetContinuousStates(i, &raw const x, 1), fmi3OK);
        assert_eq!(fmi3GetContinuousStates(i, &raw mut back, 1), fmi3OK);
        assert_eq!(fmi3GetNominalsOfContinuousStates(i, &raw mut nominal, 1), fmi3OK);
        assert_eq!(fmi3CompletedIntegratorStep(i, fmi3True, enter, end), fmi3OK);
    }
    assert_eq!((back, nominal, flags), (0.5, 1.0, [fmi3False; 2]));
    assert_eq!(host.set_float(toy::INTEGRAL, 0.75), fmi3OK, "a state is set as a variable, too");
    assert_eq!(host.float(toy::INTEGRAL), 0.75);
    assert_eq!(host.set_float(toy::SWITCHED, 1.0), fmi3Error, "what is discrete is set at events");
    let two = [0.0; 2];
    let refused: [(&str, &dyn Fn(fmi3Instance) -> fmi3Status); 5] = [
        ("nx = 2", &|i| unsafe { fmi3SetContinuousStates(i, two.as_ptr(), 2) }),
        ("integral = NaN: it must be finite", &|i| unsafe { fmi3SetContinuousStates(i, &f64::NAN, 1) }),
        ("time = inf: it must be finite", &|i| unsafe { fmi3SetTime(i, f64::INFINITY) }),
        ("argument derivatives is NULL", &|i| unsafe { fmi3GetContinuousStateDerivatives(i, null_mut(), 1) }),
        ("argument enterEventMode is NULL", &|i| unsafe {
            fmi3CompletedIntegratorStep(i, fmi3True, null_mut(), null_mut())
        }),
    ];
    for (message, call) in refused {
        let host = Host::started(Session::EXCHANGE);
        assert_eq!(call(host.instance), fmi3Error, "{message}");
        let error = host.error();
        assert!(error.contains(message), "{error}");
    }
}

#[test]
fn a_clock_ticks_at_events_of_model_exchange_until_the_discrete_states_are_updated() {
    let host = Host::started(Session::EXCHANGE);
    for (time, ticks) in [(1.0, true), (1.5, false), (2.0, true)] {
        assert_eq!(unsafe { fmi3SetTime(host.instance, time) }, fmi3OK);
        assert_eq!(host.enter_event_mode(), fmi3OK);
        assert_eq!(host.clock(toy::TICK), ticks, "{time}");
        assert_eq!(host.update(), (false, Some(time.floor() + 1.0)));
        assert!(!host.clock(toy::TICK));
        assert_eq!(unsafe { fmi3EnterContinuousTimeMode(host.instance) }, fmi3OK);
    }
}

#[test]
fn a_saved_state_remembers_that_the_event_has_changed_states() {
    let host = Host::new(Session::EXCHANGE);
    assert_eq!(host.set_float(toy::LIMIT, 1.0), fmi3OK);
    host.start();
    // Memory that was used before: the copy is made into it.
    let mut used = host.save();
    assert_eq!(host.set_float(toy::INTEGRAL, 2.0), fmi3OK);
    assert_eq!(unsafe { fmi3FreeFMUState(host.instance, &raw mut used) }, fmi3OK);
    assert_eq!(host.enter_event_mode(), fmi3OK);
    let saved = host.save();
    let bytes = host.serialize(saved);
    assert_eq!(host.update(), (true, Some(1.0)));
    assert_eq!(host.update(), (false, Some(1.0)), "it is told once");
    assert_eq!(host.restore(saved), fmi3OK);
    assert_eq!(host.update(), (true, Some(1.0)));
    let other = Host::started(Session::EXCHANGE);
    let (status, state) = other.deserialize(&bytes);
    assert_eq!((status, other.restore(state)), (fmi3OK, fmi3OK));
    assert_eq!(other.update(), (true, Some(1.0)));
}

#[test]
fn derivatives_of_wrong_counts_and_seeds_are_refused() {
    let (u, k, seeds) = ([toy::DERIVATIVE; 2], [toy::INPUT; 2], [1.0; 3]);
    for function in [fmi3GetDirectionalDerivative, fmi3GetAdjointDerivative] {
        let refused = |seeds: *const f64, counts: [usize; 4], message: &str| {
            let host = Host::started(Session::EXCHANGE);
            let ([unknowns, knowns, seed, out], mut found) = (counts, [0.0; 3]);
            let (i, found) = (host.instance, found.as_mut_ptr());
            let status = unsafe { function(i, u.as_ptr(), unknowns, k.as_ptr(), knowns, seeds, seed, found, out) };
            assert_eq!(status, fmi3Error, "{message}");
            let error = host.error();
            assert!(error.contains(message), "{error}");
        };
        refused(seeds.as_ptr(), [1, 1, 2, 1], "nValues = 2");
        refused(seeds.as_ptr(), [1, 1, 1, 3], "nValues = 3");
        refused([f64::NAN; 2].as_ptr(), [2, 2, 2, 2], "= NaN: it must be finite");
        refused(core::ptr::null(), [1, 1, 1, 1], "argument seed is NULL");
    }
}

/// With seeds `a` for the knowns and `b` for the unknowns, b J a is the same both ways.
#[test]
fn both_derivatives_are_of_one_matrix() {
    let (unknowns, knowns) = ([toy::DERIVATIVE, toy::INTEGRAL, toy::HELD], [toy::INPUT, toy::SWITCHED]);
    let (a, b) = ([3.0, -0.5], [2.0, 7.0, 0.25]);
    let mut products = Vec::new();
    for session in [Session::EXCHANGE, Session::PLAIN] {
        for initializing in [true, false] {
            let host = Host::new(session);
            assert_eq!(host.enter_initialization(None), fmi3OK);
            if !initializing {
                assert_eq!(host.exit_initialization(), fmi3OK);
            }
            let (u, k, i) = (unknowns.as_ptr(), knowns.as_ptr(), host.instance);
            let (mut forward, mut backward) = ([f64::NAN; 3], [f64::NAN; 2]);
            unsafe {
                let status = fmi3GetDirectionalDerivative(i, u, 3, k, 2, a.as_ptr(), 2, forward.as_mut_ptr(), 3);
                assert_eq!(status, fmi3OK, "{:?}", host.lines());
                let status = fmi3GetAdjointDerivative(i, u, 3, k, 2, b.as_ptr(), 3, backward.as_mut_ptr(), 2);
                assert_eq!(status, fmi3OK, "{:?}", host.lines());
            }
            assert_eq!(forward[0], 3.0 * 2.0 - 0.5, "what the rows say");
            let dot = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| x * y).sum::<f64>();
            assert_eq!(dot(&b, &forward), dot(&a, &backward), "{session:?}, {forward:?}, {backward:?}");
            products.push(dot(&b, &forward));
        }
    }
    assert!(products.iter().all(|product| *product != 0.0), "{products:?}");
}
