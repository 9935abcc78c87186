//! Voltages of a circuit that were left out follow from the harvester.

use videg_circuit::{Settings, Topology, formulas, names};

/// Which voltages of a circuit were asked for.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Given {
    /// `supply.voltage`
    pub supply: bool,
    /// `zener.voltage`
    pub zener: bool,
    /// `storage.voltage`
    pub storage: bool,
}

impl Given {
    /// Those among the `names` of variables that were set.
    pub fn among<'a>(names: impl IntoIterator<Item = &'a str>) -> Self {
        let mut given = Self::default();
        names.into_iter().for_each(|name| given.add(name));
        given
    }

    /// Adds the variable called `name`, if it is one of them.
    pub fn add(&mut self, name: &str) {
        self.supply |= name == names::SUPPLY_VOLTAGE;
        self.zener |= name == names::ZENER_VOLTAGE;
        self.storage |= name == names::STORAGE_VOLTAGE;
    }

    /// The `settings` of a circuit beside a harvester of `bias_voltage`, V: supplied at it and released at the supply voltage, as in
    /// Section 4.1, or into a storage at the voltage with the largest net gain at the capacitance `ratio` `C_3` / `C_2`,
    /// unless something else was asked for.
    pub fn complete(self, mut settings: Settings, bias_voltage: f64, ratio: f64) -> Settings {
        let circuit = &mut settings.circuit;
        if !self.supply {
            circuit.supply_voltage = bias_voltage;
        }
        if !self.zener {
            circuit.zener_voltage = circuit.supply_voltage;
        }
        if !self.storage {
            settings.circuit.storage_voltage = best_release_voltage(&settings, ratio);
        }
        settings
    }
}

/// The voltage of release with the largest net gain, V, where an impact multiplies the capacitance of a membrane by `ratio`.
pub fn best_release_voltage(settings: &Settings, ratio: f64) -> f64 {
    let idle = match settings.circuit.topology {
        Topology::SharedNode => 1.0,
        Topology::Isolated => 0.0,
    };
    formulas::best_release_voltage(settings.circuit.supply_voltage, 1.0 + idle, ratio + idle)
}
