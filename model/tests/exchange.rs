//! The differential equations with events, run by a plain integrator, against the exact motion.
#![allow(clippy::expect_used)] // helpers outside of #[test] functions fail a test, too

use proptest::prelude::*;
use std::f64::consts::TAU;
use videg_model::{Case, ExcitationKind, Harvester, ModelError, Parameters};

fn case(name: &str) -> Parameters {
    (Case::find(name).expect("a case").parameters)()
}

/// A step of RK4 from the present states.
fn rk4(harvester: &mut Harvester, h: f64) {
    let (t, x) = (harvester.time(), harvester.states());
    let mut at = |t: f64, dx: [f64; 5], h: f64| {
        let mut states = x;
        states.iter_mut().zip(dx).for_each(|(state, slope)| *state += h * slope);
        harvester.place(t, states, 0.0).expect("finite states");
        harvester.derivatives()
    };
    let a = at(t, [0.0; 5], 0.0);
    let b = at(t + 0.5 * h, a, 0.5 * h);
    let c = at(t + 0.5 * h, b, 0.5 * h);
    let d = at(t + h, c, h);
    at(t + h, [0, 1, 2, 3, 4].map(|i| (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]) / 6.0), h);
}

/// Integrates to `end`, s, in steps of `h`; the instants of events are found by bisection.
fn integrate(parameters: &Parameters, end: f64, h: f64) -> Harvester {
    let (harvester, _) = integrate_with_work(parameters, end, h);
    harvester
}

/// Force of the excitation, N, its rate, N/s, and the velocity of the cylinder, m/s, and its rate, m/s^2.
fn excited(harvester: &Harvester) -> [f64; 4] {
    let p = harvester.parameters();
    let (sin, cos) = (TAU * p.frequency * harvester.time() + p.phase).sin_cos();
    let [velocity, acceleration, ..] = harvester.derivatives();
    [p.amplitude * cos, -TAU * p.frequency * p.amplitude * sin, velocity, acceleration]
}

/// Work of the excitation, J, in a step of `h`, s, to fourth order, from what [`excited`] says at its ends.
fn work([f, df, v, dv]: [f64; 4], [g, dg, w, dw]: [f64; 4], h: f64) -> f64 {
    0.5 * h * (f * v + g * w) + h * h / 12.0 * ((df * v + f * dv) - (dg * w + g * dw))
}

/// The same, and the work of the excitation, J, summed step by step.
fn integrate_with_work(parameters: &Parameters, end: f64, h: f64) -> (Harvester, f64) {
    let mut sum = 0.0;
    let mut harvester = Harvester::new(parameters, 0.0).expect("parameters");
    let start = harvester.states();
    harvester.place(0.0, start, 0.0).expect("finite states");
    harvester.handle_events().expect("events");
    while harvester.time() < end {
        let due = harvester.next_time_event().unwrap_or(f64::INFINITY);
        let mut size = h.min(end - harvester.time()).min(due - harvester.time());
        let (before, begin) = (harvester.clone(), excited(&harvester));
        let signs = before.event_indicators().map(|z| z > 0.0);
        let crossed = |harvester: &Harvester| harvester.event_indicators().map(|z| z > 0.0) != signs;
        rk4(&mut harvester, size);
        if crossed(&harvester) {
            let mut low = 0.0;
            for _ in 0..60 {
                let middle = 0.5 * (low + size);
                harvester = before.clone();
                rk4(&mut harvester, middle);
                if crossed(&harvester) { size = middle } else { low = middle }
            }
            harvester = before;
            rk4(&mut harvester, size);
        }
        sum += work(begin, excited(&harvester), size);
        harvester.handle_events().expect("events");
    }
    (harvester, sum)
}

/// Compares the sums over all impacts; returns how many impacts there were, integrated and exact.
fn assert_close(name: &str, end: f64, tolerance: f64) -> [u64; 2] {
    let parameters = case(name);
    let mut exact = Harvester::new(&parameters, 0.0).expect("parameters");
    exact.advance(end).expect("a step");
    let integrated = integrate(&parameters, end, 2e-4);
    let (found, expected) = (integrated.totals(), exact.totals());
    assert_eq!((found.chatters, found.releases), (expected.chatters, expected.releases), "{name}");
    for (found, expected) in [(found.voltage_gain, expected.voltage_gain), (found.energy, expected.energy)] {
        assert!((found / expected - 1.0).abs() < tolerance, "{name}: {found}, {expected}");
    }
    [integrated.totals().impacts, exact.totals().impacts]
}

#[test]
fn an_integrator_finds_the_impacts_of_the_exact_motion() {
    let [found, expected] = assert_close("fig14", 20.0, 1e-6);
    assert_eq!(found, expected);
}

#[test]
fn an_integrator_finds_chattering_rest_and_release() {
    // The tail of a chattering sequence is summed up earlier, so fewer of its impacts are counted.
    let [found, expected] = assert_close("table3-2hz", 3.0, 3e-4);
    assert!(found < expected && found > expected / 2, "{found}, {expected}");
}

#[test]
fn events_are_handled_once_and_leave_the_indicator_positive() {
    let mut harvester = Harvester::new(&case("fig14"), 0.0).expect("parameters");
    let before = harvester.totals().impacts;
    harvester.place(0.1, [0.022, 0.3, 0.0, -0.1, 0.0], 0.0).expect("finite states");
    assert!(harvester.handle_events().expect("an impact"));
    let after = harvester.clone();
    assert!(harvester.event_indicators()[0] > 0.0);
    assert!(harvester.event_indicators()[0] < 1e-14);
    assert_eq!(harvester.totals().impacts, before + 1);
    assert!(!harvester.handle_events().expect("nothing"));
    assert_eq!(harvester, after);
    assert!((harvester.ball_velocity() - (0.3 + 0.6 * 0.4)).abs() < 1e-15, "Eq. (11)");
}

#[test]
fn an_integrator_follows_any_mount() {
    let base = Parameters { ball_position: 0.005, ball_velocity: 0.1, ball_mass: 0.02, ..Parameters::default() };
    let inclined = Parameters { inclination: 0.02, reaction: true, ..base };
    let rubbing = Parameters { friction: 0.05, ..inclined };
    let sticking = Parameters { friction: 0.5, amplitude: 0.8, ..inclined };
    let suspended = Parameters { suspension_stiffness: 20.0, suspension_damping: 0.3, ..rubbing };
    let driven = Parameters { excitation_kind: ExcitationKind::Motion, acceleration: 4.0, friction: 0.1, ..base };
    for p in [inclined, rubbing, sticking, suspended, driven] {
        let mut exact = Harvester::new(&p, 0.0).expect("parameters");
        exact.advance(1.0).expect("a step");
        let integrated = integrate(&p, 1.0, 2e-4);
        assert_eq!(integrated.is_stuck(), exact.is_stuck());
        for (found, expected) in integrated.states().into_iter().zip(exact.states()) {
            assert!((found - expected).abs() < 1e-6, "{found}, {expected}: {p:?}");
        }
        let (found, expected) = (integrated.energies(), exact.energies());
        let difference = (found.friction - expected.friction).abs();
        assert!(difference < 1e-4 * (expected.friction + 1e-3), "{found:?}, {expected:?}: {p:?}");
    }
}

prop_compose! {
    /// A suspended cylinder with a damper, and a ball that takes part.
    fn any_damped()(
        amplitude in 0.1..1.0,
        frequency in 1.0..4.0,
        phase in 0.0..TAU,
        stiffness in prop_oneof![Just(0.0), 1.0..60.0],
        damping in 0.02..1.0,
        velocity in -0.3..0.3,
        ball in (-0.8..0.8, -0.3..0.3, 0.002..0.1),
        inclination in -0.05..0.05,
        friction in prop_oneof![Just(0.0), 0.0..0.2],
        reaction in any::<bool>(),
    ) -> Parameters {
        let p = Parameters {
            amplitude, frequency, phase, inclination, friction, reaction,
            suspension_stiffness: stiffness,
            suspension_damping: damping,
            cylinder_velocity: velocity,
            ball_velocity: ball.1,
            ball_mass: ball.2,
            ..Parameters::default()
        };
        Parameters { ball_position: ball.0 * p.travel() / 2.0, ..p }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(30))]

    #[test]
    fn an_integrator_closes_the_books_of_a_damped_cylinder(p in any_damped()) {
        let (integrated, work) = integrate_with_work(&p, 1.0, 2e-4);
        let found = integrated.energies();
        prop_assert!(found.damping > 0.0);
        // Less than that cannot be in motion: what rounding and bisection leave at an impact.
        let moved = found.damping + found.cylinder + found.suspension + found.excitation.abs() + 1e-6;
        prop_assert!((found.excitation - work).abs() < 1e-6 * moved, "{work}: {found:?}");
        let mut exact = Harvester::new(&p, 0.0).expect("parameters");
        exact.advance(1.0).expect("a step");
        // A grazing impact may fall on either side.
        prop_assume!(difference(integrated.states(), exact.states()) < 1e-6);
        let expected = exact.energies();
        for (found, expected) in [(found.damping, expected.damping), (found.excitation, expected.excitation)] {
            prop_assert!((found - expected).abs() < 1e-5 * moved, "{found}, {expected}");
        }
    }
}

fn difference(a: [f64; 5], b: [f64; 5]) -> f64 {
    a.iter().zip(b).take(4).fold(0.0, |largest: f64, (a, b)| largest.max((a - b).abs()))
}

#[test]
fn noise_samples_are_time_events() {
    let parameters = Parameters { phase_noise: 0.5, noise_hold: 1e-2, ..case("fig14") };
    let mut exact = Harvester::new(&parameters, 0.0).expect("parameters");
    exact.advance(2.0).expect("a step");
    let integrated = integrate(&parameters, 2.0, 1e-3);
    for (found, expected) in integrated.states().into_iter().zip(exact.states()) {
        assert!((found - expected).abs() < 1e-7, "{found}, {expected}");
    }
}

#[test]
fn states_that_are_not_finite_are_refused() {
    let mut harvester = Harvester::new(&case("fig14"), 0.0).expect("parameters");
    let refused = harvester.place(0.0, [0.0, f64::NAN, 0.0, 0.0, 0.0], 0.0);
    assert!(matches!(refused, Err(ModelError::NotFinite { .. })));
}

#[test]
fn an_integrator_that_passes_over_the_samples_of_the_phase_noise_is_told_where_it_should_have_stopped() {
    let p = Parameters { phase_noise: 0.5, noise_hold: 1e-6, ..Parameters::default() };
    let mut harvester = Harvester::new(&p, 0.0).unwrap();
    let states = harvester.states();
    harvester.place(0.5, states, 0.0).unwrap();
    harvester.handle_events().unwrap();
    // 1e15 samples later.
    harvester.place(1e9, states, 0.0).unwrap();
    let error = harvester.handle_events().unwrap_err().to_string();
    assert!(error.contains("more than 1000000 hold intervals of excitation.noiseHold = 0.000001 s"), "{error}");
}
