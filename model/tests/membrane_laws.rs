//! Laws of the membrane: tables of Eq. (2), films of Gent and Ogden.
#![allow(clippy::unwrap_used)]

#[path = "common/brute.rs"]
mod brute;

use core::f64::consts::PI;

use brute::rk4;
use proptest::prelude::*;
use videg_model::{Case, ContactLaw, Direction, ForceTable, Harvester, Membrane, MembraneLaw, Parameters, Setup, Side};

/// Eq. (2) at `points` places, spaced evenly up to `end`, m.
fn sampled(p: &Parameters, points: usize, end: f64) -> ForceTable {
    let places = (0..points).map(|k| end * k as f64 / (points - 1) as f64);
    let force = |x: f64| p.stiffness * x.powf(p.stiffness_exponent);
    let (places, forces) = places.map(|x| (x, force(x))).unzip();
    ForceTable::new(places, forces, None).unwrap()
}

fn fig14() -> Parameters {
    (Case::ALL.iter().find(|case| case.name == "fig14").unwrap().parameters)()
}

/// `<U>`, V/s, and the sums of voltage gain and energy, from 30 to 60 s.
fn means<'a>(setup: impl Into<Setup<'a>>) -> [f64; 2] {
    let mut harvester = Harvester::new(setup, 0.0).unwrap();
    harvester.advance(30.0).unwrap();
    let before = *harvester.totals();
    harvester.advance(60.0).unwrap();
    let after = harvester.totals();
    [(after.voltage_gain - before.voltage_gain) / 30.0, (after.energy - before.energy) / 30.0]
}

#[test]
fn a_table_of_equation_2_gives_figure_14() {
    for contact_law in [ContactLaw::Impulsive, ContactLaw::Compliant] {
        let p = Parameters { contact_law, ..fig14() };
        let closed = means(&p);
        let measured = Parameters { membrane_law: MembraneLaw::Table, ..p };
        let errors = [250, 1000].map(|points| {
            let table = sampled(&p, points, 0.008);
            let sampled = means(measured.with_table(Some(&table)));
            let error = |k: usize| (sampled[k] / closed[k] - 1.0).abs();
            error(0).max(error(1))
        });
        assert!(errors[0] < 3e-9 && errors[1] < 2e-11 && errors[1] < errors[0] / 100.0, "{errors:?}");
    }
}

/// The value of 2 L^2 + L^-4 - 3.
fn invariant(stretch: f64) -> f64 {
    2.0 * stretch.powi(2) + stretch.powi(-4) - 3.0
}

prop_compose! {
    /// A film of Gent or Ogden in a frame a little or much larger than the ball, stretched a little or much.
    fn any_film()(
        (is_gent, prestretch, size) in (any::<bool>(), 1.05..4.0_f64, 1.02..4.0_f64),
        (shear_modulus, limit) in (1e4..1e6_f64, 1.2..50.0_f64),
        (m1, m2, m3) in (1e3..1e5_f64, 0.0..1e4_f64, 0.0..1e4_f64),
        (a1, a2, a3) in (1.0..4.0_f64, -3.0..-0.5_f64, 0.5..6.0_f64),
    ) -> Parameters {
        let p = Parameters::default();
        Parameters {
            membrane_law: if is_gent { MembraneLaw::Gent } else { MembraneLaw::Ogden },
            prestretch,
            initial_radius: size * p.ball_radius / prestretch,
            shear_modulus,
            // Next to its limit a film takes little energy.
            stretch_limit: limit * invariant(prestretch) + 10.0,
            ogden_modulus_1: m1,
            ogden_exponent_1: a1,
            ogden_modulus_2: -m2,
            ogden_exponent_2: a2,
            ogden_modulus_3: m3,
            ogden_exponent_3: a3,
            amplitude: 0.0,
            frequency: 0.01,
            ..p
        }
    }
}

/// True stress of the film at this stretch, as printed, Pa.
fn stress(p: &Parameters, stretch: f64) -> f64 {
    if p.membrane_law == MembraneLaw::Gent {
        let room = 1.0 - invariant(stretch) / p.stretch_limit;
        return p.shear_modulus * (stretch.powi(2) - stretch.powi(-4)) / room;
    }
    let terms = [
        (p.ogden_modulus_1, p.ogden_exponent_1),
        (p.ogden_modulus_2, p.ogden_exponent_2),
        (p.ogden_modulus_3, p.ogden_exponent_3),
    ];
    terms.iter().map(|(modulus, exponent)| modulus * (stretch.powf(*exponent) - stretch.powf(-2.0 * exponent))).sum()
}

/// Time from the impact to the largest deflection, s, and deflections at eighths of it, m, by brute force.
fn brute_force(membrane: &Membrane, mass: f64, speed: f64, end: f64) -> Vec<f64> {
    const STEPS: u32 = 4000;
    let slope = |_, [x, v]: [f64; 2]| [v, -membrane.force(x) / mass];
    let (mut state, mut found) = ([0.0, speed], Vec::new());
    for step in 1..=STEPS {
        state = rk4(slope, 0.0, state, end / f64::from(STEPS));
        if step % (STEPS / 8) == 0 {
            found.push(state[0]);
        }
    }
    found
}

/// A ball that flies to the right at this speed, on a cylinder at rest, at the impact.
fn at_impact(setup: Setup<'_>) -> Harvester {
    let mut harvester = Harvester::new(setup, 0.0).unwrap();
    harvester.advance(harvester.next_impact().unwrap()).unwrap();
    harvester
}

/// That a pulse obeys the energy balance, that its rate is the derivative of its deflection, and that it is that of brute force.
fn assert_pulse(setup: Setup<'_>, tolerance: f64) -> Result<(), TestCaseError> {
    let (p, mut harvester) = (*setup.parameters, at_impact(setup));
    let (mass, speed, began) = (p.ball_mass, p.ball_velocity, harvester.time());
    let membrane = harvester.membrane().clone();
    let peak = membrane.deflection(speed);
    let energy = 0.5 * mass * speed * speed;
    prop_assert!((membrane.work(peak) / energy - 1.0).abs() < 1e-12);
    let loading = harvester.next_knot().unwrap() - began;
    let expected = brute_force(&membrane, mass, speed, loading);
    let at = |time: f64, harvester: &Harvester| {
        let mut copy = harvester.clone();
        copy.advance(began + time).unwrap();
        copy.deflection(Side::Right)
    };
    for (k, expected) in (1..).zip(&expected) {
        let time = loading * f64::from(k) / 8.0;
        let here = at(time, &harvester);
        prop_assert!((here.value - expected).abs() <= tolerance * peak, "{} {expected}", here.value);
        let balance = 0.5 * mass * here.rate * here.rate + membrane.work(here.value);
        prop_assert!((balance / energy - 1.0).abs() < 1e-10, "{balance} {energy}");
        if k < 8 {
            let h = 1e-3 * loading;
            let change = |h: f64| at(time + h, &harvester).value - at(time - h, &harvester).value;
            let rate = (8.0 * change(h) - change(2.0 * h)) / (12.0 * h);
            prop_assert!((rate - here.rate).abs() <= 1e-6 * speed, "{rate} {}", here.rate);
        }
        // The way back is the mirror image, stretched by 1/r.
        let back = at(loading + (loading - time) / p.restitution, &harvester);
        prop_assert!(
            (back.value - here.value).abs() <= 1e-9 * peak
                && (back.rate + p.restitution * here.rate).abs() <= 1e-7 * speed
        );
    }
    harvester.advance(began + loading * (1.0 + 1.0 / p.restitution) * 1.000_001).unwrap();
    prop_assert_eq!(harvester.deflection(Side::Right).value, 0.0);
    Ok(())
}

proptest! {
    #[test]
    fn the_force_of_a_film_is_the_derivative_of_its_energy(p in any_film(), speed in 1e-4..1.0_f64) {
        let membrane = Membrane::new(&p);
        let x = membrane.deflection(speed);
        let energy = 0.5 * p.ball_mass * speed * speed;
        // Next to the limit of a Gent film the last digit of the deflection is many of the work.
        let rounding = 1e-14 * x * membrane.force(x) / energy;
        prop_assert!((membrane.work(x) / energy - 1.0).abs() < 1e-12 + rounding);
        let h = 1e-4 * x;
        let change = |h: f64| membrane.work(x + h) - membrane.work(x - h);
        let slope = (8.0 * change(h) - change(2.0 * h)) / (12.0 * h);
        prop_assert!((membrane.force(x) / slope - 1.0).abs() < 1e-7, "{} {slope}", membrane.force(x));
        prop_assert_eq!(membrane.force(-x), -membrane.force(x));
    }

    #[test]
    fn a_gent_film_near_its_limit_takes_up_the_energy_of_the_impact_or_names_what_it_can(
        p in any_film(), part in 1.001..3.0_f64, speed in 0.05..10.0_f64,
    ) {
        let stretch_limit = part * invariant(p.prestretch);
        let p = Parameters { membrane_law: MembraneLaw::Gent, stretch_limit, ball_velocity: speed, ..p };
        let (membrane, energy) = (Membrane::new(&p), 0.5 * p.ball_mass * speed * speed);
        let x = membrane.deflection(speed);
        let (work, most) = (membrane.work(x), membrane.work(membrane.deflection(1e6)));
        let ended = Harvester::new(&p, 0.0).unwrap().advance(1.0);
        if energy > most {
            let error = ended.unwrap_err().to_string();
            prop_assert!(error.contains("membrane.stretchLimit") && error.contains(&format!("{most:.3e} J")), "{error}");
        } else {
            // As exact as x is, which is found by its logarithm.
            let tolerance = 1e-12 + 8.0 * f64::EPSILON * x.ln().abs().max(1.0) * x * membrane.force(x) / work;
            prop_assert!((work / energy - 1.0).abs() <= tolerance, "{} {tolerance}", work / energy - 1.0);
            prop_assert!(ended.is_ok());
        }
    }

    #[test]
    fn a_film_is_a_linear_spring_at_small_deflections(p in any_film(), scale in -9.0..-6.0_f64) {
        // E = pi R_2^2 h_2 sigma (A_3 / A_2 - 1) with A_3 / A_2 - 1 = (x / R_2)^2 / 2.
        let stiffness = PI * p.membrane_thickness() * stress(&p, p.prestretch);
        let x = p.membrane_radius() * 10_f64.powf(scale);
        let membrane = Membrane::new(&p);
        prop_assert!((membrane.force(x) / (stiffness * x) - 1.0).abs() < 1e-5);
        prop_assert!((membrane.work(x) / (0.5 * stiffness * x * x) - 1.0).abs() < 1e-5);
    }

    #[test]
    fn a_pulse_on_a_film_is_its_motion(p in any_film(), speed in 0.01..1.0_f64, restitution in 0.3..1.0_f64) {
        let p = Parameters { ball_velocity: speed, restitution, ..p };
        assert_pulse((&p).into(), 1e-8)?;
    }

    #[test]
    fn a_pulse_on_a_measured_membrane_is_its_motion(
        steps in proptest::collection::vec((0.2e-3..1e-3_f64, 0.01..0.3_f64), 2..30), speed in 0.01..1.0_f64,
    ) {
        let sums = |of: fn(&(f64, f64)) -> f64| {
            core::iter::once(0.0).chain(steps.iter().scan(0.0, |sum, it| { *sum += of(it); Some(*sum) })).collect::<Vec<_>>()
        };
        let (x, f) = (sums(|it| it.0), sums(|it| it.1));
        let table = ForceTable::new(x, f, None).unwrap();
        let p = Parameters { membrane_law: MembraneLaw::Table, amplitude: 0.0, frequency: 0.01, ball_velocity: speed, ..Parameters::default() };
        assert_pulse(p.with_table(Some(&table)), 1e-6)?;
    }

    #[test]
    fn refined_tables_converge_with_the_third_order_in_force_and_with_that_of_the_first_interval_in_work(
        exponent in 1.5..4.0_f64, place in 0.3..0.9_f64,
    ) {
        let p = Parameters { stiffness_exponent: exponent, stiffness: 1e3, membrane_law: MembraneLaw::Table, ..Parameters::default() };
        let exact = Membrane::new(&Parameters { membrane_law: MembraneLaw::Power, ..p });
        let errors = [100, 200].map(|intervals| {
            let table = sampled(&p, intervals + 1, 0.01);
            let membrane = Membrane::new(p.with_table(Some(&table)));
            let middle = 0.01 * ((place * intervals as f64).floor() + 0.3) / intervals as f64;
            let error = |a: f64, b: f64| (a / b - 1.0).abs();
            [error(membrane.force(middle), exact.force(middle)), error(membrane.work(middle), exact.work(middle))]
        });
        // Work keeps the error of the first interval, of the order n + 1, and has one of the fourth order elsewhere.
        let order = (exponent + 1.0).min(4.0);
        for (k, factor) in [(0, 5.0), (1, 0.9 * 2.0_f64.powf(order))] {
            prop_assert!(errors[1][k] < errors[0][k] / factor + 1e-13, "{errors:?}");
        }
        prop_assert!(errors[0][0] < 1e-4 && errors[0][1] < 1e-4, "{errors:?}");
    }
}

/// The parameters of Fig. 14 with each other law; the table has a capacitance of its own.
fn other_laws() -> (Vec<Parameters>, ForceTable) {
    let p = fig14();
    let x: Vec<f64> = (0..=60).map(|k| 1e-4 * f64::from(k)).collect();
    let forces = x.iter().map(|x| 60.0 * x + 3e4 * x.powi(2)).collect();
    let capacitances = x.iter().map(|x| 1.5e-11 * (1.0 + (x / 0.006).powi(2))).collect();
    let table = ForceTable::new(x, forces, Some(capacitances)).unwrap();
    let laws = [MembraneLaw::Table, MembraneLaw::Gent, MembraneLaw::Ogden];
    (laws.map(|membrane_law| Parameters { membrane_law, ..p }).to_vec(), table)
}

fn with<'a>(p: &'a Parameters, table: &'a ForceTable) -> Setup<'a> {
    p.with_table((p.membrane_law == MembraneLaw::Table).then_some(table))
}

#[test]
fn runs_go_on_from_snapshots_and_do_not_depend_on_their_steps() {
    let (laws, table) = other_laws();
    for p in &laws {
        for contact_law in [ContactLaw::Impulsive, ContactLaw::Compliant] {
            let p = Parameters { contact_law, ..*p };
            let setup = with(&p, &table);
            let mut whole = Harvester::new(setup, 0.0).unwrap();
            let mut split = whole.clone();
            for k in 1..=3000 {
                let time = 1e-3 * f64::from(k);
                split.advance(time).unwrap();
                if k % 100 == 37 {
                    split = Harvester::restore(setup, &split.snapshot()).unwrap();
                }
            }
            whole.advance(3.0).unwrap();
            assert_eq!(whole.snapshot(), split.snapshot(), "{:?} {contact_law:?}", p.membrane_law);
            assert_eq!(whole.deflection(Side::Left), split.deflection(Side::Left));
            assert!(whole.totals().impacts > 10);
            let other = ForceTable::new(vec![0.0, 1e-3, 2e-3], vec![0.0, 0.1, 0.3], None).unwrap();
            if p.membrane_law == MembraneLaw::Table {
                assert!(Harvester::restore(p.with_table(Some(&other)), &whole.snapshot()).is_err());
            }
        }
    }
}

#[test]
fn changes_with_parameters_of_a_film_are_those_of_differences() {
    let (laws, table) = other_laws();
    for (p, name) in
        [(&laws[0], "ball.mass"), (&laws[1], "membrane.shearModulus"), (&laws[2], "membrane.ogdenExponent1")]
    {
        let quantity = Parameters::TABLE.iter().find(|it| it.name == name).unwrap();
        let gain = |value: f64| {
            let mut p = *p;
            (quantity.set)(&mut p, value);
            let mut harvester = Harvester::new(with(&p, &table), 0.0).unwrap();
            harvester.advance(1.2).unwrap();
            harvester.totals().voltage_gain
        };
        let direction = Direction::of_parameter(name).unwrap();
        let mut harvester = Harvester::along(with(p, &table), 0.0, 0.0, &direction).unwrap();
        harvester.advance(1.2).unwrap();
        let (value, h) = ((quantity.get)(p), 1e-4 * (quantity.get)(p));
        let change = |h: f64| gain(value + h) - gain(value - h);
        let slope = (8.0 * change(h) - change(2.0 * h)) / (12.0 * h);
        let found = harvester.sensitivities().voltage_gain;
        assert!(slope != 0.0 && (found / slope - 1.0).abs() < 1e-6, "{name}: {found} {slope}");
    }
}

#[test]
fn a_gent_film_has_the_force_of_virtual_work_in_the_frame_of_the_paper() {
    let p = Parameters { membrane_law: MembraneLaw::Gent, ..Parameters::default() };
    let membrane = Membrane::new(&p);
    for (x, force) in [(1e-3, 0.170), (3e-3, 0.668), (5e-3, 1.186), (7e-3, 1.482), (10e-3, 1.653)] {
        assert!((membrane.force(x) - force).abs() < 1e-3, "{x}: {}", membrane.force(x));
    }
}

#[test]
fn a_table_in_millimetres_is_refused_with_the_depth_that_it_would_have() {
    let table = |unit: f64| ForceTable::new(vec![0.0, 3.0 * unit, 6.0 * unit], vec![0.0, 0.2, 1.0], None).unwrap();
    let p = Parameters { membrane_law: MembraneLaw::Table, ..fig14() };
    assert!(Harvester::new(p.with_table(Some(&table(1e-3))), 0.0).is_ok());
    let error = Harvester::new(p.with_table(Some(&table(1.0))), 0.0).unwrap_err().to_string();
    assert!(error.starts_with("membrane.file: the last deflection is 6 m; at most 0.126 m"), "{error}");
}

#[test]
fn no_motion_reaches_the_limit_of_a_gent_film() {
    let stiff = Parameters { membrane_law: MembraneLaw::Gent, stretch_limit: 6.0, ..fig14() };
    let limit = |p: &Parameters| Membrane::new(p).deflection(1e6);
    for speed in [0.3, 3.0, 30.0] {
        for contact_law in [ContactLaw::Impulsive, ContactLaw::Compliant] {
            let p = Parameters { ball_velocity: speed, contact_law, ..stiff };
            let Ok(mut harvester) = Harvester::new(&p, 0.0) else {
                assert!(speed > 3.0, "a film that takes up less than the ball has");
                continue;
            };
            for k in 1..500 {
                // A contact that is too hard to be resolved is an error.
                if harvester.advance(1e-4 * f64::from(k)).is_err() {
                    assert!(speed > 3.0);
                    break;
                }
                for side in Side::BOTH {
                    let deflection = harvester.deflection(side);
                    assert!(deflection.value <= limit(&p) && deflection.rate.is_finite());
                }
            }
        }
    }
    let locked = Parameters { stretch_limit: 5.0, ..stiff };
    let error = Harvester::new(&locked, 0.0).unwrap_err().to_string();
    assert!(error.starts_with("membrane.stretchLimit = 5 must be greater than 2 L^2 + L^-4 - 3 = 5.0625"), "{error}");
    let ogden = Parameters { membrane_law: MembraneLaw::Ogden, ..fig14() };
    for (p, part) in [
        (
            Parameters { ogden_modulus_2: -1e3, ..ogden },
            "membrane.ogdenModulus2 = -1000 Pa must have the sign of its exponent, 2",
        ),
        (Parameters { ogden_modulus_1: 0.0, ..ogden }, "is 0 Pa: at least 1e-3 Pa"),
        (Parameters { membrane_law: MembraneLaw::Table, ..ogden }, "set membrane.file"),
    ] {
        let error = Harvester::new(&p, 0.0).unwrap_err().to_string();
        assert!(error.contains(part), "{error}");
    }
}
