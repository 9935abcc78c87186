//! Voltages of a circuit that were left out, and averages, by their definitions.

use proptest::prelude::*;
use videg_circuit::{Ledger, Settings, Topology};
use videg_coupled::{Averages, Gains, Given, Powers, best_release_voltage};

const NAMES: [&str; 3] = ["supply.voltage", "zener.voltage", "storage.voltage"];

proptest! {
    #[test]
    fn no_other_voltage_of_release_earns_more(
        supply in 100.0..5000.0_f64, ratio in 1.0..8.0_f64, isolated: bool, other in 0.0..40_000.0_f64,
    ) {
        let mut settings = Settings::default();
        settings.circuit.supply_voltage = supply;
        settings.circuit.topology = if isolated { Topology::Isolated } else { Topology::SharedNode };
        // The other membrane is a capacitor beside the one that is hit, if they share a node.
        let idle = if isolated { 0.0 } else { 1.0 };
        // What flows to the storage comes from the supply, (pressed U - flat U_r) of it; in capacitances at rest.
        let gain = |release: f64| (release - supply) * ((ratio + idle) * supply - (1.0 + idle) * release);
        let best = best_release_voltage(&settings, ratio);
        prop_assert!(best >= supply && gain(best) >= gain(other) - 1e-9 * supply * supply, "{best}");
    }

    #[test]
    fn what_was_asked_for_stays_and_the_rest_follows(
        asked in prop::array::uniform3(any::<bool>()), voltages in prop::array::uniform3(100.0..5000.0_f64),
        bias in 100.0..5000.0_f64, ratio in 1.0..8.0_f64,
    ) {
        let given = Given::among(NAMES.into_iter().zip(asked).filter(|(_, asked)| *asked).map(|(name, _)| name));
        prop_assert_eq!([given.supply, given.zener, given.storage], asked);
        let mut settings = Settings::default();
        let circuit = &mut settings.circuit;
        [circuit.supply_voltage, circuit.zener_voltage, circuit.storage_voltage] = voltages;
        let circuit = given.complete(settings, bias, ratio).circuit;
        let supply = if asked[0] { voltages[0] } else { bias };
        prop_assert_eq!(circuit.supply_voltage, supply);
        prop_assert_eq!(circuit.zener_voltage, if asked[1] { voltages[1] } else { supply });
        settings.circuit.supply_voltage = supply;
        let best = best_release_voltage(&settings, ratio);
        prop_assert_eq!(circuit.storage_voltage, if asked[2] { voltages[2] } else { best });
    }

    #[test]
    fn averages_are_differences_over_the_window(
        from in 1.0..10.0_f64, window in 0.1..10.0_f64, before in prop::array::uniform2(0.0..1e3_f64),
        after in prop::array::uniform2(1e3..1e4_f64), impacts in 0..100_i32, more in 0..100_i32,
    ) {
        let gains = |[voltage, energy]: [f64; 2], impacts| Gains { voltage, energy, impacts };
        let (start, end) = (gains(before, impacts), gains(after, impacts + more));
        let averages = Averages::over([from, from + window], &start, &end);
        let close = |value: f64, k: usize| (value * window - (after[k] - before[k])).abs() < 1e-9;
        prop_assert!(close(averages.voltage_gain, 0) && close(averages.power, 1));
        prop_assert_eq!(averages.impacts, more);
        // An impact at the start of a run is in a window that begins there.
        prop_assert_eq!(Averages::over([0.0, window], &start, &end).impacts, impacts + more);
    }

    #[test]
    fn powers_are_differences_over_the_window_and_count_what_is_stored(
        from in 0.0..10.0_f64, window in 0.1..10.0_f64, before in prop::array::uniform3(0.0..1e3_f64),
        after in prop::array::uniform3(1e3..1e4_f64),
    ) {
        let ledger = |[load, supply, stored]: [f64; 3]| Ledger { load, supply, stored, ..Ledger::default() };
        let powers = Powers::over([from, from + window], &ledger(before), &ledger(after));
        let [load, supply, stored] = [0, 1, 2].map(|k| after[k] - before[k]);
        let close = |power: f64, energy: f64| (power * window - energy).abs() < 1e-8;
        prop_assert!(close(powers.load_power, load) && close(powers.supply_power, supply));
        prop_assert!(close(powers.net_power, load - supply + stored));
    }
}
