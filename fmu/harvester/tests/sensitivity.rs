//! Directional derivatives of the initial values, against central differences.

mod common;

use VibroImpactHarvester::Harvester;
use common::{fresh_at, get, row};
use fmi2_export::{Causality, Kind, Slave, Variability, Variable};

fn reals(causality: Causality) -> Vec<&'static str> {
    let rows = Harvester::variables().iter().filter(|v| v.causality() == causality);
    let continuous = rows.filter(|v| matches!(v.kind(), Kind::Real(_)) && v.variability() != Variability::Discrete);
    continuous.map(Variable::name).collect()
}

/// Compares every partial derivative at these parameters with a central difference, to 1e-6 and rounding. Returns how
/// many are not zero.
fn assert_agrees(start: f64, settings: &[(&'static str, f64)]) -> u32 {
    let slave = fresh_at(start, settings);
    let mut not_zero = 0;
    for unknown in [reals(Causality::CalculatedParameter), reals(Causality::Output)].concat() {
        for known in [reals(Causality::Parameter), reals(Causality::Input)].concat() {
            let present = get(&slave, known);
            let h = 1e-5 * present.abs().max(1e-3);
            let with = |value: f64| get(&fresh_at(start, &[settings, &[(known, value)]].concat()), unknown);
            let difference = (with(present + h) - with(present - h)) / (2.0 * h);
            let derivative = slave.partial_derivative(row(unknown), row(known));
            let rounding = 8.0 * f64::EPSILON * get(&slave, unknown).abs() / h;
            let allowed = 1e-6 * derivative.abs().max(difference.abs()) + rounding;
            assert!((derivative - difference).abs() <= allowed, "d {unknown} / d {known}: {derivative}, {difference}");
            not_zero += u32::from(derivative != 0.0);
        }
    }
    not_zero
}

/// Inside the bounds, so that a difference can be taken.
const INSIDE: [(&str, f64); 3] =
    [("excitation.phaseNoise", 0.1), ("membrane.prestretch", 2.2), ("membrane.restitution", 0.6)];

#[test]
fn derivatives_inside_the_gap_agree_with_central_differences() {
    let start = [("initial.cylinderPosition", 0.01), ("initial.ballPosition", 0.005), ("initial.ballVelocity", 0.1)];
    let settings = [&INSIDE[..], &start].concat();
    assert!(assert_agrees(0.0, &settings) >= 20);
}

#[test]
fn derivatives_of_a_start_beyond_a_membrane_agree_with_central_differences() {
    for side in [1.0, -1.0] {
        // The ball is put on the membrane and recedes from it.
        let start = [("initial.cylinderPosition", 0.03 * side), ("initial.ballVelocity", 0.1 * side)];
        assert!(assert_agrees(0.0, &[&INSIDE[..], &start].concat()) >= 20);
    }
}

#[test]
fn derivatives_of_a_start_with_an_impact_agree_with_central_differences() {
    // So late that time cannot tell a start on a membrane from the impact right after it.
    const START: f64 = 1e9;
    for side in [1.0, -1.0] {
        let start = [
            ("initial.cylinderPosition", 0.03 * side),
            ("initial.cylinderVelocity", 0.2 * side),
            ("initial.ballVelocity", -0.1 * side),
        ];
        let settings = [&INSIDE[..], &start].concat();
        assert_eq!(get(&fresh_at(START, &settings), "impact.count"), 1.0);
        assert!(assert_agrees(START, &settings) >= 22);
    }
}
