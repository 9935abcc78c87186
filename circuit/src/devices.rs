//! Currents of the exponential elements, as ngspice's `dio` model evaluates them with `RS = 0`, `CJO = 0`.
//!
//! With `v` the anode-to-cathode voltage, `Vt = k T / q`:
//! - charging diode: `I = IS (exp(v / (N Vt)) - 1)`, no breakdown;
//! - Zener diode, anode at the load: `I = -IS exp(-(BV' + v) / (NBV Vt))` for `v < -BV'`, and
//!   `I = IS (exp(v / (N Vt)) - 1)` for `-BV' <= v <= 0`. ngspice replaces the exponential below `-3 N Vt` by
//!   `-IS (1 + (3 N Vt / (e v))^3)`; both are `-IS` to rounding at hundreds of volts. `BV'` is `U_z` while
//!   `IBV < IS BV / Vt`, which makes the current at `U_z` equal to `IS`; otherwise it is the voltage for which the
//!   current at `U_z` is `IBV`;
//! - diode into a storage, `v` the node above `U_out`: as the charging diode;
//! - `v > 0` of the Zener diode, where a bare Zener diode conducts from load to node: blocked, `I = IS (1 - exp(-v / (N Vt)))`, as
//!   the ideal release elements are one-way. It takes isolated membranes one of which is more than `U_z` above
//!   the other to get there; without a blocking diode the one would charge the other through the load node;
//! - ngspice's `gmin` is left out, since it falsifies the energy by percents at 2 kV.
//!
//! Thus with `U_z = U_in` an idle node leaks `sqrt(IS IBV)`, here `IS`, from supply to load, and a storage above `U_in`
//! leaks `IS` through both diodes back to the supply.

use crate::parameters::{DiodeParameters, Parameters, Release};

/// `k/q` (V/K), CODATA 2018 (both constants are exact in the SI).
const BOLTZMANN_OVER_CHARGE: f64 = 1.380_649e-23 / 1.602_176_634e-19;

/// Largest exponent: keeps trial currents finite far from the solution, and is never reached at one. Of a blocking diode
/// it saves the exponential the detour of an underflow.
const EXPONENT: f64 = 600.0;

/// Exponent below which the exponential less 1 is -1 to rounding.
const BLOCKED: f64 = -40.0;

/// Largest conductance of a load behind a smooth switch (S). A switch is lossless: below 1 kohm, only the
/// nanoseconds in which a node falls to `U_z` depend on the load, while the band would shrink below the last bit of
/// the voltage.
const SWITCH_CONDUCTANCE: f64 = 1e-3;

/// Part of the band over which one node takes precedence over the other.
const PRECEDENCE: f64 = 0.25;

/// The elements around the nodes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Devices {
    /// `U_in` (V).
    pub supply: f64,
    /// Voltage of release (V): `U_z`, or `U_out` of a storage.
    pub threshold: f64,
    /// `R` (ohm), from 0 to infinity with both ends.
    pub resistance: f64,
    /// `1/R` (S), from 0 to infinity with both ends; bounded behind a switch.
    pub conductance: f64,
    /// Part of the charge that leaks through the film in a second (1/s), 0 for none.
    pub leak: f64,
    /// Kind of the release element.
    pub release: Release,
    saturation: f64,
    /// `N Vt` (V).
    forward: f64,
    /// `NBV Vt` (V).
    reverse: f64,
    /// `BV'` (V).
    breakdown: f64,
    band: f64,
}

impl Devices {
    pub fn new(parameters: &Parameters, diode: &DiodeParameters) -> Self {
        let thermal = BOLTZMANN_OVER_CHARGE * diode.temperature;
        let reverse = diode.breakdown_emission * thermal;
        let saturation = diode.saturation_current;
        let nominal = parameters.zener_voltage;
        let ratio = diode.breakdown_current / saturation;
        let breakdown = if ratio < nominal / thermal { nominal } else { nominal - reverse * ratio.ln() };
        Self {
            supply: parameters.supply_voltage,
            threshold: parameters.release_voltage(),
            resistance: parameters.resistance(),
            conductance: match parameters.release {
                Release::Zener | Release::Storage => parameters.conductance(),
                Release::Switch => parameters.conductance().min(SWITCH_CONDUCTANCE),
            },
            leak: parameters.leakage_rate(),
            release: parameters.release,
            saturation,
            forward: diode.emission_coefficient * thermal,
            reverse,
            breakdown,
            band: diode.switch_band,
        }
    }

    /// A voltage over which currents change by a factor, to start searches with (V).
    pub fn reach(&self) -> f64 {
        8.0 * self.steepest()
    }

    /// Shortest voltage over which a current changes by a factor (V).
    pub fn steepest(&self) -> f64 {
        self.forward.min(self.reverse).min(PRECEDENCE * self.band)
    }

    /// Current of a charging diode (A) and its conductance (S) at a node voltage.
    pub fn charging(&self, voltage: f64) -> (f64, f64) {
        self.diode(self.supply - voltage)
    }

    /// Current of a diode into the storage (A) and its conductance (S) at a node voltage.
    pub fn storing(&self, voltage: f64) -> (f64, f64) {
        self.diode(voltage - self.threshold)
    }

    /// Current of the release element to a constant voltage (A) and its slope (S): that of the switch or into the storage.
    /// A Zener diode has the load behind it.
    pub fn holding(&self, voltage: f64) -> (f64, f64) {
        match self.release {
            Release::Zener => (0.0, 0.0),
            Release::Switch => self.switch(voltage),
            Release::Storage => self.storing(voltage),
        }
    }

    /// Node voltage at which the charging diode passes a current above `-IS` (V), and its conductance there (S).
    pub fn supplying_at(&self, current: f64) -> (f64, f64) {
        (self.supply - self.forward * (current / self.saturation).ln_1p(), (current + self.saturation) / self.forward)
    }

    /// Node voltage at which the release element to a constant voltage passes a current above 0 (V), and its slope there
    /// (S): of a storage, a switch within its band, or a Zener diode without a load behind it.
    pub fn held_at(&self, current: f64) -> (f64, f64) {
        match self.release {
            Release::Storage => {
                let above = self.forward * (current / self.saturation).ln_1p();
                (self.threshold + above, (current + self.saturation) / self.forward)
            }
            Release::Zener => (self.zener_drop(current), current / self.reverse),
            Release::Switch => {
                let half = 0.5 * self.threshold;
                let voltage = half + (half * half + current * (self.band / self.conductance)).sqrt();
                (voltage, self.switch(voltage).1)
            }
        }
    }

    /// Voltage across a Zener diode that passes a current above 0 (V).
    pub fn zener_drop(&self, current: f64) -> f64 {
        self.breakdown + self.reverse * (current / self.saturation).ln()
    }

    /// `NBV Vt` (V): by how much the drop of a Zener diode grows when its current grows by the factor e.
    pub fn zener_slope(&self) -> f64 {
        self.reverse
    }

    /// Node voltage, above that of the load behind a Zener diode, from which on the release element conducts (V).
    pub fn release_edge(&self) -> f64 {
        match self.release {
            Release::Zener => self.breakdown,
            Release::Switch | Release::Storage => self.threshold,
        }
    }

    /// Node voltage from which on a switch is closed, above its band (V).
    pub fn closed_from(&self) -> f64 {
        self.threshold + self.band
    }

    /// How far another node has to be below one for a switch to follow this one alone, to rounding (V).
    pub fn clearance(&self) -> f64 {
        -BLOCKED * PRECEDENCE * self.band
    }

    /// Current of a diode without breakdown (A) and its conductance (S), from anode to cathode.
    fn diode(&self, across: f64) -> (f64, f64) {
        let exponent = across / self.forward;
        if exponent < BLOCKED {
            return (-self.saturation, 0.0);
        }
        let grown = if exponent > EXPONENT { EXPONENT } else { exponent }.exp_m1();
        (self.saturation * grown, self.saturation * (1.0 + grown) / self.forward)
    }

    /// Current of a Zener diode from node to load (A) and its conductance (S), at `V_de - V_out`.
    pub fn zener(&self, across: f64) -> (f64, f64) {
        if across > self.breakdown {
            let x = ((across - self.breakdown) / self.reverse).min(EXPONENT);
            let current = self.saturation * x.exp();
            (current, current / self.reverse)
        } else {
            let (current, slope) = self.diode(-across.abs());
            (-current * across.signum(), slope)
        }
    }

    /// Current of a smooth switch into the load (A) and its slope (S): `V / R` times a ramp from 0 to 1
    /// between `U_z` and `U_z` + band.
    pub fn switch(&self, voltage: f64) -> (f64, f64) {
        let on = (voltage - self.threshold) / self.band;
        let g = self.conductance;
        if on <= 0.0 {
            (0.0, 0.0)
        } else if on < 1.0 {
            (g * voltage * on, g * (on + voltage / self.band))
        } else {
            (g * voltage, g)
        }
    }

    /// Part of its switch current that a node may have beside another node, and its slope (1/V): the higher
    /// node takes the load, as with ideal switches, smoothed over [`PRECEDENCE`] of the band.
    pub fn precedence(&self, voltage: f64, other: f64) -> (f64, f64) {
        let scale = PRECEDENCE * self.band;
        let part = 1.0 / (1.0 + ((other - voltage) / scale).min(EXPONENT).exp());
        (part, part * (1.0 - part) / scale)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    fn devices(breakdown_current: f64) -> Devices {
        let diode = DiodeParameters { breakdown_current, ..DiodeParameters::default() };
        Devices::new(&Parameters::default(), &diode)
    }

    #[test]
    fn the_current_at_the_zener_voltage_is_is_or_a_large_ibv() {
        assert_relative_eq!(devices(1e-13).zener(2000.0).0, 1e-13, max_relative = 1e-12);
        assert_relative_eq!(devices(1e-3).zener(2000.0).0, 1e-3, max_relative = 1e-8);
    }

    #[test]
    fn currents_grow_by_e_over_the_emission_coefficient_times_25_9_mv() {
        let diode =
            DiodeParameters { breakdown_emission: 2.0, emission_coefficient: 3.0, ..DiodeParameters::default() };
        let d = Devices::new(&Parameters::default(), &diode);
        // k 300.15 K / q.
        let thermal = 0.025_864_92;
        assert_relative_eq!(d.zener(2000.0 + 2.0 * thermal).0, 1e-13 * 1.0_f64.exp(), max_relative = 1e-6);
        assert_relative_eq!(d.charging(2000.0 - 3.0 * thermal).0, 1e-13 * 1.0_f64.exp_m1(), max_relative = 1e-6);
    }

    #[test]
    fn conductances_are_the_derivatives() {
        let d = devices(1e-13);
        let h = 1e-7;
        let slope = |f: &dyn Fn(f64) -> f64, v: f64| (f(v + h) - f(v - h)) / (2.0 * h);
        let v = 2000.004;
        assert_relative_eq!(d.zener(v).1, slope(&|x| d.zener(x).0, v), max_relative = 1e-5);
        let v = 1999.996;
        assert_relative_eq!(-d.charging(v).1, slope(&|x| d.charging(x).0, v), max_relative = 1e-5);
        let v = 2000.01;
        assert_relative_eq!(d.switch(v).1, slope(&|x| d.switch(x).0, v), max_relative = 1e-5);
        let part = |x: f64| d.precedence(x, 2000.009).0;
        assert_relative_eq!(d.precedence(v, 2000.009).1, slope(&part, v), max_relative = 1e-5);
    }

    #[test]
    fn a_zener_leaks_no_more_than_is_below_breakdown_either_way() {
        for across in [-1e4, -1.0, 1.0, 1999.0] {
            assert_relative_eq!(devices(1e-13).zener(across).0, 1e-13_f64.copysign(across), max_relative = 1e-12);
        }
        assert_eq!(devices(1e-13).zener(0.0).0, 0.0);
    }
}
