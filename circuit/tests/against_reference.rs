//! The exact solution against time stepping of the complementarity problem, which shares nothing with it.
#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

mod common;

use common::{Ramp, decades, leakage, parameters, reference, run};
use proptest::prelude::*;
use videg_circuit::{Circuit, Parameters, Release, Topology};

fn ramps() -> impl Strategy<Value = Vec<Ramp>> {
    let ramp = (1e-3..5e-2_f64, 5e-12..5e-11_f64, 5e-12..5e-11_f64).prop_map(|(dt, l, r)| (dt, [l, r]));
    prop::collection::vec(ramp, 1..7)
}

fn any(topology: Topology, release: Release) -> impl Strategy<Value = Parameters> {
    parameters(vec![(topology, release)], 1.8, decades(8.0..12.0), leakage(-3.0..2.0))
}

/// Largest deviation of charges and energies, relative to what one full membrane holds.
fn deviation(parameters: Parameters, ramps: &[Ramp]) -> f64 {
    let start = [15e-12, 12e-12];
    let mut circuit = Circuit::new(parameters, start).unwrap();
    run(&mut circuit, ramps);
    let expected = reference(&parameters, start, ramps, 20_000);
    let (ledger, state) = (circuit.ledger(), circuit.state());
    let charge = 3e-11 * parameters.supply_voltage;
    let energy = charge * parameters.supply_voltage;
    [
        (ledger.supply_charge - expected.supply_charge) / charge,
        (ledger.load_charge - expected.load_charge) / charge,
        (ledger.load - expected.load) / energy,
        (ledger.zener - expected.zener) / energy,
        (ledger.leakage - expected.leakage) / energy,
        (state.charge[0] - expected.charge[0]) / charge,
        (state.charge[1] - expected.charge[1]) / charge,
    ]
    .into_iter()
    .fold(0.0, |a: f64, b| a.max(b.abs()))
}

macro_rules! agrees {
    ($name:ident, $topology:expr, $release:expr) => {
        proptest! {
            #![proptest_config(ProptestConfig { cases: 24, failure_persistence: None, ..ProptestConfig::default() })]
            #[test]
            fn $name(parameters in any($topology, $release), ramps in ramps()) {
                let deviation = deviation(parameters, &ramps);
                prop_assert!(deviation < 1e-6, "deviation {deviation:e}");
            }
        }
    };
}

agrees!(a_shared_node_with_a_zener_agrees, Topology::SharedNode, Release::Zener);
agrees!(a_shared_node_with_a_switch_agrees, Topology::SharedNode, Release::Switch);
agrees!(isolated_membranes_with_zeners_agree, Topology::Isolated, Release::Zener);
agrees!(isolated_membranes_with_switches_agree, Topology::Isolated, Release::Switch);
agrees!(a_shared_node_with_a_storage_agrees, Topology::SharedNode, Release::Storage);
agrees!(isolated_membranes_with_a_storage_agree, Topology::Isolated, Release::Storage);
