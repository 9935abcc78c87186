//! Closed forms of the impacts of a run, beside the run itself.
#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

use proptest::prelude::*;
use videg_circuit::{Release, Settings, Topology};
use videg_coupled::{Impacts, Times, run};
use videg_model::{Case, Event, Harvester, Parameters, Side};

fn fig14(restitution: f64) -> Parameters {
    Parameters { restitution, ..(Case::find("fig14").unwrap().parameters)() }
}

/// A window between impacts, of which a cycle is in or out with all of its charge: from the third second to the thirteenth or so, each
/// edge in the longest pause of its second. With it the voltage, V, that both membranes have reached before: from the first release on,
/// one cycle begins as the other.
fn window(p: &Parameters) -> ([f64; 2], f64) {
    let mut peaks = Vec::new();
    let mut harvester = Harvester::new(p, 0.0).unwrap();
    let membrane = harvester.membrane().clone();
    let note = |event: &Event| {
        if let Event::Peak(peak) = event {
            let ratio = membrane.capacitance(peak.deflection) / membrane.rest_capacitance();
            peaks.push((peak.time, peak.side, p.bias_voltage * ratio));
        }
    };
    harvester.advance_with(14.0, note).unwrap();
    let window = [3.0, 13.0].map(|second: f64| {
        let inside = peaks.windows(2).filter(|pair| (second..second + 1.0).contains(&pair[0].0));
        let longest = inside.max_by(|a, b| (a[1].0 - a[0].0).total_cmp(&(b[1].0 - b[0].0)));
        longest.map(|pair| 0.5 * (pair[0].0 + pair[1].0)).unwrap()
    });
    let reached = [Side::Left, Side::Right].map(|side| {
        let before = peaks.iter().filter(|peak| peak.0 < window[0] && peak.1 == side);
        before.map(|peak| peak.2).fold(p.bias_voltage, f64::max)
    });
    (window, reached[0].min(reached[1]))
}

/// Of an isolated circuit that releases its charge to a storage at `voltage`, V, and of the mechanics: net power, W, and `<U>`, V/s.
fn of_the_run(p: &Parameters, window: [f64; 2], voltage: f64) -> [f64; 2] {
    let mut settings = Settings::default();
    settings.circuit.supply_voltage = p.bias_voltage;
    settings.circuit.topology = Topology::Isolated;
    settings.circuit.release = Release::Storage;
    settings.circuit.storage_voltage = voltage;
    let results = run(p, &settings, &Times { until: window[1], window, tolerance: 1e-3 }).unwrap();
    [results.powers.net_power, results.averages.voltage_gain]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn a_quick_release_by_its_closed_form_is_the_net_power_of_the_run(
        // Below that, impacts follow each other before the membrane is flat again.
        restitution in 0.3..0.95_f64, share in 0.05..1.0_f64,
    ) {
        let p = fig14(restitution);
        let (window, reached) = window(&p);
        prop_assume!(reached > 1.1 * p.bias_voltage);
        let impacts = Impacts::of((&p).into(), window).unwrap();
        let voltage = p.bias_voltage + share * (reached - p.bias_voltage);
        let (closed, largest) = (impacts.quick_release(voltage, 0.0), impacts.largest_gain(0.0));
        let [net_power, voltage_gain] = of_the_run(&p, window, voltage);
        prop_assert!((net_power - closed).abs() <= 1e-9 * largest, "{net_power} and {closed} W");
        prop_assert!(closed <= largest && impacts.quick_release(1.001 * impacts.highest_voltage(), 0.0) == 0.0);
        // Eq. (15) from the same impacts.
        let gain = p.bias_voltage * impacts.ratios.iter().map(|ratio| ratio - 1.0).sum::<f64>() / impacts.time;
        prop_assert!((voltage_gain / gain - 1.0).abs() < 1e-9, "{voltage_gain} and {gain} V/s");
    }

    #[test]
    fn no_other_voltage_gains_more_than_the_best_one(restitution in 0.2..0.95_f64, idle in 0.0..2.0_f64, share in 0.0..1.0_f64) {
        let p = fig14(restitution);
        let impacts = Impacts::of((&p).into(), [2.0, 12.0]).unwrap();
        let voltage = p.bias_voltage + share * (impacts.highest_voltage() - p.bias_voltage);
        let best = impacts.quick_release(impacts.best_voltage(idle), idle);
        prop_assert!(best > 0.0 && impacts.quick_release(voltage, idle) <= best * (1.0 + 1e-12), "{voltage} V");
    }
}
