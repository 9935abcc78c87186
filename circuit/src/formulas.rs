//! Closed forms of one harvesting cycle between the rest capacitance `C2` and the peak capacitance `C3`.
//!
//! They hold for one membrane on a node of its own. With both membranes on one node (Fig. 8a) the idle one
//! lies in parallel: pass `C2 + C2` for `c2` and `C3 + C2` for `c3`. Capacitances in F, voltages in V,
//! energies in J, charges in C. Nothing is checked: they are for reports and tests. Eqs. (12) and (13) stand in the model, too,
//! of which the circuit knows nothing: the two can be compared.

/// `W = 1/2 U_in^2 (C3 - C2)`, Eq. (13) of the paper (J). Half of what the supply gives in a cycle, and the
/// change of the stored energy; not the net gain of a cycle.
pub fn eq13_energy(supply_voltage: f64, c2: f64, c3: f64) -> f64 {
    0.5 * supply_voltage * supply_voltage * (c3 - c2)
}

/// `U_DE4 = U_in C3 / C2`, Eq. (12) (V): the voltage that a constant charge reaches.
pub fn peak_voltage(supply_voltage: f64, c2: f64, c3: f64) -> f64 {
    supply_voltage * c3 / c2
}

/// `U_DE4` with both membranes on one node (V): `U_in (C3 + C2) / (2 C2)`, not Eq. (12).
pub fn peak_voltage_shared_node(supply_voltage: f64, c2: f64, c3: f64) -> f64 {
    peak_voltage(supply_voltage, c2 + c2, c3 + c2)
}

/// Charge moved from supply to load in a cycle with `U_z = U_in` and a discharge that is fast against the
/// cycle (C): `dQ = U_in (C3 - C2)`.
pub fn cycle_charge(supply_voltage: f64, c2: f64, c3: f64) -> f64 {
    supply_voltage * (c3 - c2)
}

/// Largest net gain of a cycle from and to `U_in` (J): constant charge up to `U_DE4`, then a slow discharge
/// into the load at `C2`; `1/2 U_in^2 dC^2 / C2`.
pub fn largest_net_gain(supply_voltage: f64, c2: f64, c3: f64) -> f64 {
    let dc = c3 - c2;
    0.5 * supply_voltage * supply_voltage * dc * dc / c2
}

/// Net gain of a cycle that releases its charge at `U_r`, from and to `U_in` (J):
/// `(C3 U_in - C2 U_r) (U_r - U_in)`, and zero when the constant charge does not reach `U_r`.
///
/// `U_r` is `U_z` of a Zener diode or a switch whose load holds the node there, or `U_out` of a storage. A storage and
/// a lossless switch earn it, a series Zener burns it.
pub fn release_net_gain(supply_voltage: f64, release_voltage: f64, c2: f64, c3: f64) -> f64 {
    (c3 * supply_voltage - c2 * release_voltage).max(0.0) * (release_voltage - supply_voltage)
}

/// The `U_r` of the largest [`release_net_gain`] (V): `U_in (C3 / C2 + 1) / 2`.
pub fn best_release_voltage(supply_voltage: f64, c2: f64, c3: f64) -> f64 {
    0.5 * supply_voltage * (c3 / c2 + 1.0)
}

/// The `C3 / C2` to take for the [`best_release_voltage`] of cycles that differ, from all of theirs; 1 without any.
///
/// A voltage that leaves small cycles out of reach may gain more from the large ones. Of the `n` largest, with the mean
/// `m`, the gain at the voltage best for them is proportional to `n (m - 1)^2`; cycles taken in that do not reach that
/// voltage only lower it, so that the largest of these is the maximum. On a shared node it is that of the same cycles.
pub fn best_release_ratio(mut ratios: Vec<f64>) -> f64 {
    ratios.sort_by(|a, b| b.total_cmp(a));
    let (mut count, mut sum) = (0.0, 0.0);
    let mut best = (0.0, 1.0);
    for ratio in ratios {
        count += 1.0;
        sum += ratio - 1.0;
        let gain = sum * sum / count;
        if gain > best.0 {
            best = (gain, 1.0 + sum / count);
        }
    }
    best.1
}

/// [`release_net_gain`] at [`best_release_voltage`] (J): `U_in^2 dC^2 / (4 C2)`, half of the largest net gain.
pub fn best_release_net_gain(supply_voltage: f64, c2: f64, c3: f64) -> f64 {
    0.5 * largest_net_gain(supply_voltage, c2, c3)
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    const U: f64 = 2000.0;
    const C2: f64 = 15e-12;
    const C3: f64 = 24e-12;

    #[test]
    fn the_best_release_voltage_is_the_top_of_the_net_gain() {
        let best = best_release_voltage(U, C2, C3);
        let gain = release_net_gain(U, best, C2, C3);
        assert_relative_eq!(gain, best_release_net_gain(U, C2, C3), max_relative = 1e-14);
        for nearby in [best - 1.0, best + 1.0] {
            assert!(release_net_gain(U, nearby, C2, C3) < gain);
        }
    }

    #[test]
    fn the_largest_net_gain_is_the_stored_energy_above_the_supply_minus_the_charge_drawn() {
        let peak = peak_voltage(U, C2, C3);
        let to_load = 0.5 * C2 * (peak * peak - U * U);
        let from_supply = U * cycle_charge(U, C2, C3);
        assert_relative_eq!(to_load - from_supply, largest_net_gain(U, C2, C3), max_relative = 1e-12);
    }

    #[test]
    fn the_shared_node_lowers_the_peak_voltage_and_eq13_is_half_the_supply_energy() {
        assert_relative_eq!(peak_voltage(U, C2, C3), 3200.0, max_relative = 1e-14);
        assert_relative_eq!(peak_voltage_shared_node(U, C2, C3), 2600.0, max_relative = 1e-14);
        assert_relative_eq!(2.0 * eq13_energy(U, C2, C3), U * cycle_charge(U, C2, C3), max_relative = 1e-14);
    }

    #[test]
    fn the_best_voltage_of_unequal_cycles_beats_every_other() {
        for idle in [0.0, C2] {
            for ratios in [vec![1.6], vec![1.1, 1.6, 1.5, 1.05], vec![1.5, 1.4, 1.3], vec![]] {
                let total = |voltage: f64| -> f64 {
                    ratios.iter().map(|r| release_net_gain(U, voltage, C2 + idle, r * C2 + idle)).sum()
                };
                let ratio = best_release_ratio(ratios.clone());
                let best = best_release_voltage(U, C2 + idle, ratio * C2 + idle);
                for step in 0..1000 {
                    let voltage = U + f64::from(step);
                    // Equal up to rounding where the scan meets the best.
                    assert!(total(voltage) <= total(best) * (1.0 + 1e-14), "{voltage} beats {best} of {ratios:?}");
                }
            }
        }
    }

    #[test]
    fn a_release_voltage_out_of_reach_gains_nothing() {
        assert_eq!(release_net_gain(U, 3201.0, C2, C3), 0.0);
    }
}
