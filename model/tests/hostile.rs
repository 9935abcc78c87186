//! Parameters and inputs at their bounds and beyond: refused with the bound, or run with every output finite, books that
//! close and bounded work.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a panic is how a test fails")]

#[path = "../../tests/support/extent.rs"]
mod extent;
#[path = "common/hostile.rs"]
mod hostile;

use extent::extent;
use hostile::{assert_balanced, assert_explained, assert_finite, duration, kinds, run, values, watched, with};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use videg_model::{
    Case, ContactLaw, Harvester, MembraneLaw, ModelError, NoiseModel, OutsideGap, Parameters, Quantity, Side,
};

/// That a value out of bounds is refused as that, and that one within them runs or ends with a reason.
fn assert_taken_or_refused(base: &Parameters, quantity: &Quantity, value: f64, what: &str) {
    let parameters = with(base, quantity, value);
    let inside = value >= quantity.min && value <= quantity.max;
    match run(&parameters, 0.0, what) {
        Err(ModelError::Bounds { name, value: named, min, max, .. }) if name == quantity.name => {
            assert!(!inside, "{what}: refused within its bounds");
            assert_eq!((named.to_bits(), min, max), (value.to_bits(), quantity.min, quantity.max), "{what}");
        }
        outcome => {
            assert!(inside, "{what}: not refused, though outside [{}, {}]", quantity.min, quantity.max);
            if let Err(error) = outcome {
                assert_explained(&error, what);
            }
        }
    }
}

/// The laws of contact; what else there is takes longer.
const LAWS: [&str; 2] = ["impulsive", "compliant"];

/// Each of these values of each parameter, in these kinds of runs.
fn assert_each_parameter_taken_or_refused(
    is_meant: impl Fn(&str) -> bool + Send + 'static,
    values: impl Fn(&Quantity) -> Vec<f64> + Send + 'static,
) {
    watched(move |label| {
        for (kind, base) in kinds().into_iter().filter(|(kind, _)| is_meant(kind)) {
            for quantity in Parameters::TABLE {
                for value in values(quantity) {
                    let what = format!("{kind}, {} = {value:e}", quantity.name);
                    label.set(what.clone());
                    assert_taken_or_refused(&base, quantity, value, &what);
                }
            }
        }
    });
}

#[test]
fn each_parameter_at_and_beyond_its_bounds_is_refused_by_name_or_runs() {
    assert_each_parameter_taken_or_refused(|kind| LAWS.contains(&kind), values);
}

#[test]
#[ignore = "slow"]
fn each_parameter_at_and_beyond_its_bounds_is_refused_by_name_or_runs_with_noise_and_on_mounts() {
    // The neighbours of a bound within it run as long as the bound itself: in the stage soak.
    let is_neighbour =
        |quantity: &Quantity, value: f64| [quantity.min.next_up(), quantity.max.next_down()].contains(&value);
    let chosen = move |quantity: &Quantity| {
        let kept = |value: &f64| extent(!is_neighbour(quantity, *value), true);
        values(quantity).into_iter().filter(kept).collect()
    };
    assert_each_parameter_taken_or_refused(|kind| !LAWS.contains(&kind), chosen);
}

#[test]
#[ignore = "slow"]
fn each_pair_of_bounds_is_refused_with_a_reason_or_runs() {
    watched(|label| {
        let bounds = |quantity: &Quantity| [quantity.min, quantity.max].into_iter().enumerate();
        for (kind, base) in kinds().into_iter().filter(|(kind, _)| LAWS.contains(kind)) {
            // The paper's force law has no film.
            let of_film = ["membrane.shearModulus", "membrane.stretchLimit", "membrane.ogden"];
            let counts = |quantity: &&Quantity| !of_film.iter().any(|name| quantity.name.starts_with(name));
            let table: Vec<&Quantity> = Parameters::TABLE.iter().filter(counts).collect();
            for (i, one) in table.iter().enumerate() {
                for (j, other) in table[..i].iter().enumerate() {
                    for ((k, a), (l, b)) in bounds(one).flat_map(|a| bounds(other).map(move |b| (a, b))) {
                        // Two of the four, by turns; all of them in the stage soak.
                        if !extent((i + j + k + l).is_multiple_of(2), true) {
                            continue;
                        }
                        let what = format!("{kind}, {} = {a:e}, {} = {b:e}", one.name, other.name);
                        label.set(what.clone());
                        if let Err(error) = run(&with(&with(&base, one, a), other, b), 0.0, &what) {
                            assert_explained(&error, &what);
                        }
                    }
                }
            }
        }
    });
}

/// A parameter set of which each number is at a bound, near one or ordinary.
fn any_parameters() -> impl Strategy<Value = Parameters> {
    let number = |quantity: &'static Quantity| {
        let Quantity { start, min, max, .. } = *quantity;
        let logarithmic =
            move |part: f64| if min > 0.0 { min * (max / min).powf(part) } else { min + part * (max - min) };
        prop_oneof![6 => Just(start), 1 => Just(min), 1 => Just(max), 2 => (0.0..1.0).prop_map(logarithmic)]
    };
    let numbers: Vec<_> = Parameters::TABLE.iter().map(number).collect();
    let choices = (any::<bool>(), any::<bool>(), any::<bool>(), any::<bool>(), any::<bool>(), any::<bool>());
    let film = prop_oneof![Just(MembraneLaw::Power), Just(MembraneLaw::Gent), Just(MembraneLaw::Ogden)];
    (numbers, choices, film).prop_map(|(numbers, (compliant, free, wiener, quiet, reaction, feedback), film)| {
        let mut p = Parameters::default();
        for (quantity, number) in Parameters::TABLE.iter().zip(numbers) {
            (quantity.set)(&mut p, number);
        }
        p.contact_law = if compliant { ContactLaw::Compliant } else { ContactLaw::Impulsive };
        (p.reaction, p.electrostatic_feedback) = (compliant && reaction, compliant && feedback);
        p.membrane_law = film;
        p.viscous_modulus *= f64::from(u8::from(compliant && film != MembraneLaw::Power));
        p.outside_gap = if free { OutsideGap::Free } else { OutsideGap::Project };
        p.noise_model = if wiener { NoiseModel::Wiener } else { NoiseModel::Held };
        p.phase_noise *= f64::from(u8::from(!quiet));
        p
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: extent(30, 300), failure_persistence: None, rng_seed: RngSeed::Fixed(1), ..ProptestConfig::default() })]

    #[test]
    #[ignore = "slow"]
    fn any_parameters_within_their_bounds_run_or_end_with_a_reason(p in any_parameters(), start in 0_usize..4) {
        let start = [0.0, -1e9, 1.0 / 3.0, 1e9][start];
        watched(move |label| {
            let what = format!("{p:?} from {start} s");
            label.set(what.clone());
            if let Err(error) = run(&p, start, &what) {
                assert_explained(&error, &what);
            }
        });
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, rng_seed: RngSeed::Fixed(1), ..ProptestConfig::default() })]

    #[test]
    fn without_excitation_mechanical_energy_never_grows(
        r in prop_oneof![Just(0.0), Just(1.0), 0.0..1.0], n in prop_oneof![Just(1.0), Just(10.0), 1.0..4.0],
        mass in 1e-6_f64..1.0, stiffness in 1e2_f64..1e9, velocity in -2.0_f64..2.0, wall in -1.0_f64..1.0,
        compliant in any::<bool>(),
    ) {
        let p = Parameters {
            restitution: r, stiffness_exponent: n, ball_mass: mass, stiffness, ball_velocity: velocity,
            cylinder_velocity: wall, amplitude: 0.0, ..Parameters::default()
        };
        let p = Parameters { contact_law: if compliant { ContactLaw::Compliant } else { ContactLaw::Impulsive }, ..p };
        let mut harvester = Harvester::new(&p, 0.0).unwrap();
        // In the frame of the cylinder, whose velocity stays: that of the laboratory gains what the walls do.
        let energy = |h: &Harvester| {
            0.5 * mass * (h.ball_velocity() - h.cylinder_velocity()).powi(2) + h.energies().elastic
        };
        let (start, mut last) = (energy(&harvester), energy(&harvester));
        for k in 1..=200 {
            harvester.advance(0.013 * f64::from(k)).unwrap();
            let present = energy(&harvester);
            prop_assert!(present <= last + 1e-10 * start, "from {} to {} J at {} s", last, present, harvester.time());
            last = present;
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: extent(30, 300), failure_persistence: None, rng_seed: RngSeed::Fixed(1), ..ProptestConfig::default() })]

    #[test]
    #[ignore = "slow"]
    fn forces_and_voltages_of_any_size_are_refused_by_name_or_leave_every_output_finite(
        force in hostile_input(), rate in hostile_input(), voltage in hostile_input(), slope in hostile_input(),
        kind in 0..kinds().len(),
    ) {
        watched(move |label| {
            let (kind, p) = kinds()[kind];
            let what = format!("{kind}, force {force:e} N, {rate:e} N/s, voltage {voltage:e} V, {slope:e} V/s");
            label.set(what.clone());
            let mut harvester = Harvester::new(&p, 0.0).unwrap();
            harvester.advance(0.1 * duration(&p)).unwrap();
            let set = harvester.set_external_force(force, rate);
            let set = set.and_then(|()| harvester.set_voltages([voltage, -voltage], [slope, -slope]));
            let outcome = set.and_then(|()| {
                [0.11, 0.5, 1.0].into_iter().try_for_each(|part| {
                    harvester.advance(part * duration(&p))?;
                    assert_finite(&harvester, &what);
                    Ok(())
                })
            });
            match outcome {
                Err(ModelError::NotFinite { name, .. }) => assert!(what.contains("inf") || what.contains("NaN"), "{name}"),
                Err(error) => assert_explained(&error, &what),
                Ok(()) => {}
            }
            assert_finite(&harvester, &what);
        });
    }
}

fn hostile_input() -> impl Strategy<Value = f64> {
    let values = [0.0, -0.0, 5e-324, 1e-310, 1e308, -1e308, f64::INFINITY, f64::NEG_INFINITY, f64::NAN, 1e18, -1e18];
    prop_oneof![proptest::sample::select(values.to_vec()), -10.0..10.0, (-30.0..30.0).prop_map(|e| 10_f64.powf(e))]
}

#[test]
fn a_gap_of_zero_is_refused_and_one_of_an_ulp_runs_or_ends_with_the_bound() {
    watched(|label| {
        let touching =
            Parameters { cylinder_length: 0.01, frame_width: 0.0, ball_radius: 0.005, ..Parameters::default() };
        for law in [ContactLaw::Impulsive, ContactLaw::Compliant] {
            for (length, wide) in [(0.01_f64.next_down(), false), (0.01, false), (0.01_f64.next_up(), true)] {
                let p = Parameters { cylinder_length: length, contact_law: law, ..touching };
                let what = format!("{law:?}, cylinder.length = {length:e}");
                label.set(what.clone());
                match run(&p, 0.0, &what) {
                    Err(ModelError::Order { name: "ball.travel", value, .. }) => {
                        assert!(!wide && value <= 0.0, "{what}: ball.travel = {value}");
                    }
                    Err(error) => assert_explained(&error, &what),
                    Ok(_) => assert!(wide, "{what}"),
                }
            }
        }
    });
}

#[test]
fn a_trillion_impacts_a_second_end_with_an_error_that_names_the_bound() {
    watched(|_| {
        // 1 km/s across 2 nm.
        let length = 0.01 + 2e-9;
        let p = Parameters {
            cylinder_length: length,
            frame_width: 0.0,
            ball_velocity: 1e3,
            amplitude: 0.0,
            ..Parameters::default()
        };
        let mut harvester = Harvester::new(&Parameters { restitution: 1.0, ..p }, 0.0).unwrap();
        let error = harvester.advance(1.0).unwrap_err();
        let text = error.to_string();
        assert!(text.contains("more than 1000000 events") && text.contains("ball.travel = 0.00000000"), "{text}");
        assert!(harvester.totals().events() <= 1_000_001);
        assert!(harvester.advance(1.0).is_err(), "it would go on");
        assert_finite(&harvester, "after the error");
    });
}

#[test]
fn steps_of_nothing_change_nothing_and_odd_ones_are_refused() {
    for (kind, p) in kinds() {
        let mut harvester = Harvester::new(&p, 0.0).unwrap();
        harvester.advance(0.7 * duration(&p)).unwrap();
        let (before, time) = (harvester.clone(), harvester.time());
        for _ in 0..1000 {
            harvester.advance(time).unwrap();
            harvester.advance(time + 5e-324).unwrap();
        }
        assert_eq!(harvester, before, "{kind}");
        for odd in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, time.next_down(), -1e308] {
            assert!(harvester.advance(odd).is_err(), "{kind}, to {odd}");
        }
        assert_eq!(harvester.time(), time, "{kind}");
        harvester.advance(duration(&p)).unwrap();
        assert_balanced(&harvester, &p, kind);
    }
}

#[test]
fn a_run_that_starts_at_1e9_s_is_that_from_zero_to_the_digits_of_time() {
    // 2e9 whole periods: the force is the same. Times there are multiples of 1.2e-7 s.
    let p = (Case::find("fig14").unwrap().parameters)();
    let gains = [0.0, 1e9].map(|start| {
        let mut harvester = Harvester::new(&p, start).unwrap();
        harvester.advance(start + 20.0).unwrap();
        assert_balanced(&harvester, &p, "fig14");
        (harvester.totals().voltage_gain, harvester.totals().impacts)
    });
    assert_eq!(gains[0].1, gains[1].1);
    let deviation = (gains[1].0 / gains[0].0 - 1.0).abs();
    assert!(deviation < 1e-5, "{deviation}");
}

#[test]
fn a_run_of_1e9_s_keeps_the_rhythm_of_its_first_hundred_periods() {
    watched(|_| {
        // Fig. 14 slowed down two thousand times: a million periods of the same motion.
        let fast = (Case::find("fig14").unwrap().parameters)();
        let slow = 1e-3 / fast.frequency;
        let p = Parameters {
            frequency: 1e-3,
            amplitude: fast.amplitude * slow * slow,
            ball_velocity: fast.ball_velocity * slow,
            ..fast
        };
        let mut harvester = Harvester::new(&p, 0.0).unwrap();
        harvester.advance(1e5).unwrap();
        let rhythm = harvester.totals().impacts as f64 / 100.0;
        harvester.advance(1e9).unwrap();
        let kept = harvester.totals().impacts as f64 / 1e6;
        assert!((kept / rhythm - 1.0).abs() < 0.02, "{rhythm} impacts a period, then {kept}");
        assert_finite(&harvester, "after 1e9 s");
        assert_balanced(&harvester, &p, "after 1e9 s");
    });
}

#[test]
fn a_membrane_pressed_in_without_bound_keeps_a_capacitance() {
    let soft = Parameters { stiffness: 1e-6, stiffness_exponent: 1.0, ball_mass: 1e6, ..Parameters::default() };
    let membrane = Harvester::new(&soft, 0.0).unwrap().membrane().clone();
    let mut last = 1.0;
    for exponent in 0..40 {
        let ratio = membrane.area_ratio(1e-3 * 10_f64.powi(exponent));
        assert!(ratio.is_finite() && ratio > last, "{ratio} after {last} at 1e{} m", exponent - 3);
        last = ratio;
    }
    // (R_2^2 - r_b^2) / cos(alpha) / R_2^2 with cos(alpha) -> (R_2 - r_b) / delta: Eqs. (4) and (5).
    let (r2, rb) = (soft.membrane_radius(), soft.ball_radius);
    assert!((membrane.area_ratio(1e20) / ((r2 + rb) * 1e20 / (r2 * r2)) - 1.0).abs() < 1e-12);
}

#[test]
fn both_membranes_serve_alike_whatever_is_extreme() {
    // The mirror image: every force and every start with the other sign.
    for (kind, p) in kinds().into_iter().filter(|(_, p)| p.phase_noise == 0.0) {
        let start = Parameters { ball_velocity: 0.3, amplitude: 0.0, acceleration: 0.0, ..p };
        let mirrored = Parameters { ball_velocity: -0.3, inclination: -p.inclination, ..start };
        let [mut one, mut other] = [start, mirrored].map(|p| Harvester::new(&p, 0.0).unwrap());
        for time in [0.1, 0.5, 3.0] {
            one.advance(time).unwrap();
            other.advance(time).unwrap();
            // The search for an impact starts where the harmonic force is steepest, which the mirror does not turn.
            let [left, right] = [one.capacitance(Side::Left), other.capacitance(Side::Right)];
            assert!((left / right - 1.0).abs() < 1e-14, "{kind}: {left}, {right}");
        }
    }
}
