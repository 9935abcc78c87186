//! Impacts of a run, and what closed forms make of them.

use videg_circuit::formulas;
use videg_model::{Event, Harvester, ModelError, Setup};

/// Impacts in a time, and the films that they deflect.
#[derive(Debug, Clone, PartialEq)]
pub struct Impacts {
    /// `C_3` / `C_2` of each.
    pub ratios: Vec<f64>,
    /// Length of the time, s.
    pub time: f64,
    /// `C_2`, F.
    pub rest_capacitance: f64,
    /// `U_in`, V.
    pub bias_voltage: f64,
}

impl Impacts {
    /// Those that the harvester of `setup` has in the time `from` to `to`, s.
    ///
    /// # Errors
    /// Parameters that the harvester refuses; more events than can be resolved.
    pub fn of(setup: Setup<'_>, [from, to]: [f64; 2]) -> Result<Self, ModelError> {
        let mut harvester = Harvester::new(setup, 0.0)?;
        let membrane = harvester.membrane().clone();
        let rest_capacitance = membrane.rest_capacitance();
        let mut ratios = Vec::new();
        harvester.advance_with(to, |event| {
            if let Event::Peak(peak) = event
                && peak.time > from
            {
                ratios.push(membrane.capacitance(peak.deflection) / rest_capacitance);
            }
        })?;
        Ok(Self { ratios, time: to - from, rest_capacitance, bias_voltage: setup.parameters.bias_voltage })
    }

    /// The `C_3` / `C_2` for which the voltage of a quick release is chosen.
    pub fn best_ratio(&self) -> f64 {
        formulas::best_release_ratio(self.ratios.clone())
    }

    /// The voltage, V, with the largest net gain of a quick release from a node that holds `idle` further capacitances `C_2`.
    pub fn best_voltage(&self, idle: f64) -> f64 {
        formulas::best_release_voltage(self.bias_voltage, 1.0 + idle, self.best_ratio() + idle)
    }

    /// Net gain, W, by the closed form of a quick release at `voltage`, V: (`C_3` `U_in` - `C_2` `U_r`) (`U_r` - `U_in`) each.
    pub fn quick_release(&self, voltage: f64, idle: f64) -> f64 {
        self.mean(idle, |c2, c3| formulas::release_net_gain(self.bias_voltage, voltage, c2, c3))
    }

    /// Largest net gain, W, that each impact by itself allows: constant charge up to `U_DE4`, then slow discharge at `C_2`.
    pub fn largest_gain(&self, idle: f64) -> f64 {
        self.mean(idle, |c2, c3| formulas::largest_net_gain(self.bias_voltage, c2, c3))
    }

    /// Highest `U_DE4`, V, Eq. (12).
    pub fn highest_voltage(&self) -> f64 {
        self.bias_voltage * self.ratios.iter().copied().fold(1.0, f64::max)
    }

    /// Mean power of an `energy`, J, of each impact, with the idle capacitances.
    fn mean(&self, idle: f64, energy: impl Fn(f64, f64) -> f64) -> f64 {
        let c2 = self.rest_capacitance;
        self.ratios.iter().map(|ratio| energy(c2 * (1.0 + idle), c2 * (ratio + idle))).sum::<f64>() / self.time
    }
}
