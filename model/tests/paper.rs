//! The numbers of Tables 2 and 3 of the paper, from the model.

#![allow(clippy::unwrap_used, clippy::panic, clippy::cast_possible_truncation, clippy::cast_sign_loss)]

mod common;

use approx::assert_relative_eq;
use common::{Stepper, averages};
use videg_model::{Case, Harvester, OutsideGap, Parameters};

fn parameters(case: &str) -> Parameters {
    (Case::find(case).unwrap().parameters)()
}

fn gain(case: &str) -> f64 {
    averages(&parameters(case), 50.0, 100.0).0
}

#[test]
fn fig9_has_no_impact() {
    let mut harvester = Harvester::new(&parameters("fig9"), 0.0).unwrap();
    harvester.advance(100.0).unwrap();
    assert_eq!(harvester.totals().impacts, 0);
    assert_eq!(harvester.next_impact(), None);
}

#[test]
fn fig10_follows_the_saw_tooth_orbit() {
    // Four impacts a second at 0.17193 m/s. Eqs. (3) to (6), (10) and (12) evaluated as printed give 457.62124 V for
    // each of them, 1830.48490 V/s; the paper has 1831.
    let (gain, _) = averages(&parameters("fig10"), 0.1, 20.1);
    assert_relative_eq!(gain, 1_830.484_90, max_relative = 1e-8);
    let mut harvester = Harvester::new(&parameters("fig10"), 0.0).unwrap();
    for k in 1..=80 {
        let time = harvester.next_impact().unwrap();
        assert_relative_eq!(time, 0.25 * f64::from(k), epsilon = 1e-9);
        harvester.advance(time).unwrap();
        assert_relative_eq!(harvester.totals().last_speed, -parameters("fig10").ball_velocity, max_relative = 1e-6);
    }
}

#[test]
fn fig14_agrees_with_the_paper_and_fig15_with_the_spread_of_nearby_starts() {
    assert_relative_eq!(gain("fig14"), 8078.9, max_relative = 1e-4);
    let gain = gain("fig15");
    assert!((8645.0..8670.0).contains(&gain), "{gain} V/s");
}

#[test]
fn the_chaotic_cases_have_one_distribution_whatever_the_start() {
    // With r = 1 the motion of Figures 11 to 13 is chaotic: nearby starts agree in the mean, not one by one. Two of the
    // paper's three values, 6749, 6730 and 6989 V/s, lie a little below the 5 % quantile, which is near 6820.
    for case in ["fig11", "fig12", "fig13"] {
        let p = parameters(case);
        let mut gains: Vec<f64> = (0..200)
            .map(|k| Parameters { ball_velocity: p.ball_velocity + 1e-7 * f64::from(k - 100), ..p })
            .map(|nudged| averages(&nudged, 50.0, 100.0).0)
            .collect();
        gains.sort_by(f64::total_cmp);
        let mean = gains.iter().sum::<f64>() / 200.0;
        assert_relative_eq!(mean, 7043.0, max_relative = 0.01);
        assert_relative_eq!(gains[10], 6825.0, max_relative = 0.02);
        assert_relative_eq!(gains[190], 7270.0, max_relative = 0.02);
    }
}

#[test]
fn fig12_starts_outside_the_gap_and_its_rule_decides_the_result() {
    let p = parameters("fig12");
    assert!((p.cylinder_position - p.ball_position).abs() > p.travel() / 2.0);
    let (projected, _) = averages(&p, 50.0, 100.0);
    let (free, _) = averages(&Parameters { outside_gap: OutsideGap::Free, ..p }, 50.0, 100.0);
    // The paper's 6730 V/s is that of the other chaotic cases, which the default rule gives; free, the ball keeps to a
    // much livelier motion (planning with RK4 at 1e-5 s: 10495 V/s).
    assert!((6500.0..7500.0).contains(&projected), "{projected} V/s");
    assert_relative_eq!(free, 10495.0, max_relative = 0.02);
}

#[test]
fn table3_agrees_at_5_hz_and_has_no_impacts_of_a_resting_ball_at_2_hz() {
    for (case, power, tolerance) in [("table3-5hz", 0.1321, 1e-3), ("table3-2hz", 0.0530, 5e-3)] {
        assert_relative_eq!(averages(&parameters(case), 50.0, 100.0).1, power, max_relative = tolerance);
    }
}

#[test]
fn table3_at_2_hz_stepped_as_in_the_paper_counts_an_impact_at_every_step_of_the_rest() {
    let mut stepper = Stepper::new(parameters("table3-2hz"), 1e-5);
    stepper.as_the_paper = true;
    stepper.run(100.0);
    assert_relative_eq!(stepper.power(50.0, 100.0), 0.0612, max_relative = 2e-3);
    assert!(stepper.impacts.len() > 2_000_000, "{} impacts", stepper.impacts.len());
}
