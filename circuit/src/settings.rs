//! Parameters by name: the table from which an FMU lists them and a command line sets them.

use crate::parameters::{DiodeParameters, Diodes, Parameters, Release, Topology, names};

/// The parameters laid out flat: those of the exponential diodes keep their values while ideal diodes are chosen.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Settings {
    /// All but the diodes.
    pub circuit: Parameters,
    /// Parameters of exponential diodes.
    pub diode: DiodeParameters,
    /// Exponential diodes instead of ideal ones.
    pub exponential: bool,
}

/// One real parameter.
#[derive(Debug, Clone, Copy)]
pub struct Quantity {
    /// Structured name.
    pub name: &'static str,
    /// SI unit; "1" for a pure number.
    pub unit: &'static str,
    /// Start value.
    pub start: f64,
    /// Smallest value allowed.
    pub min: f64,
    /// Largest value allowed; infinite only where infinity itself is a value.
    pub max: f64,
    /// Symbol and section of the paper, and meaning.
    pub description: &'static str,
    /// Reads the parameter.
    pub get: fn(&Settings) -> f64,
    /// Writes the parameter, unchecked.
    pub set: fn(&mut Settings, f64),
}

/// One parameter that chooses an item.
#[derive(Debug, Clone, Copy)]
pub struct Choice {
    /// Structured name.
    pub name: &'static str,
    /// Meaning.
    pub description: &'static str,
    /// Name and meaning of each item; the first is the default.
    pub items: &'static [(&'static str, &'static str)],
    /// Index of the chosen item.
    pub get: fn(&Settings) -> usize,
    /// Chooses the item with this index.
    pub set: fn(&mut Settings, usize),
}

macro_rules! quantities {
    ($($name:expr, $unit:literal, $start:expr, $min:expr, $max:expr, $field:ident . $($path:ident).+, $description:literal;)*) => {
        &[$(Quantity {
            name: $name, unit: $unit, start: $start, min: $min, max: $max, description: $description,
            get: |s| s.$field.$($path).+, set: |s, value| s.$field.$($path).+ = value,
        },)*]
    };
}

impl Settings {
    /// Every real parameter.
    pub const QUANTITIES: &'static [Quantity] = quantities! {
        names::SUPPLY_VOLTAGE, "V", 2000.0, 1e-3, 1e6, circuit.supply_voltage, "U_in: voltage of the supply, Section 4.1";
        names::ZENER_VOLTAGE, "V", 2000.0, 1e-3, 1e6, circuit.zener_voltage, "U_z: voltage at which charge is released to the load, at least U_in, Section 4.1";
        names::STORAGE_VOLTAGE, "V", 2450.0, 1e-3, 1e6, circuit.storage_voltage, "U_out: voltage of a storage in place of Zener diode and load, at least U_in; 2450 V is near the best for the default case on a shared node";
        names::LOAD_RESISTANCE, "Ohm", 1e9, 0.0, f64::INFINITY, circuit.load_resistance, "R: load resistance, 0 to infinity; the paper gives none";
        names::SATURATION_CURRENT, "A", 1e-13, 1e-30, 1e3, diode.saturation_current, "IS of exponential diodes";
        names::EMISSION_COEFFICIENT, "1", 0.01, 1e-6, 1e3, diode.emission_coefficient, "N of exponential diodes; 0.01 is near-ideal";
        names::TEMPERATURE, "K", 300.15, 1.0, 1e4, diode.temperature, "Temperature of exponential diodes";
        names::BREAKDOWN_CURRENT, "A", 1e-13, 1e-30, 1e3, diode.breakdown_current, "IBV of exponential Zener diodes";
        names::BREAKDOWN_EMISSION, "1", 0.01, 1e-6, 1e3, diode.breakdown_emission, "NBV of exponential Zener diodes";
        names::SWITCH_BAND, "V", 0.02, 1e-9, 1e3, diode.switch_band, "Voltage over which the switch turns on, with exponential diodes";
        names::RELATIVE_TOLERANCE, "1", 1e-9, 1e-14, 1e3, diode.solver.relative_tolerance, "Relative tolerance of the integrator of exponential diodes";
    };

    /// Every parameter that chooses.
    pub const CHOICES: &'static [Choice] = &[
        Choice {
            name: names::TOPOLOGY,
            description: "How the membranes are connected, Fig. 8(a)",
            items: &[
                ("sharedNode", "Both membranes on one node, as Fig. 8(a) is drawn"),
                ("isolated", "A diode and a release element for each membrane, as Eq. (12) assumes"),
            ],
            get: |s| usize::from(s.circuit.topology == Topology::Isolated),
            set: |s, item| s.circuit.topology = if item == 0 { Topology::SharedNode } else { Topology::Isolated },
        },
        Choice {
            name: names::RELEASE,
            description: "What releases the charge to the load, Section 4.1",
            items: &[
                ("zener", "A Zener diode in series; it burns U_z I"),
                ("switch", "An ideal switch, closed while the voltage exceeds U_z; it burns nothing"),
                ("storage", "A diode into a storage at U_out; no load resistance, and it burns nothing"),
            ],
            get: |s| s.circuit.release as usize,
            set: |s, item| {
                s.circuit.release = match item {
                    0 => Release::Zener,
                    1 => Release::Switch,
                    _ => Release::Storage,
                }
            },
        },
        Choice {
            name: names::DIODE_MODEL,
            description: "Model of the diodes",
            items: &[
                ("ideal", "No drop and no leakage, solved exactly"),
                ("exponential", "Shockley's exponential, as ngspice evaluates it"),
            ],
            get: |s| usize::from(s.exponential),
            set: |s, item| s.exponential = item == 1,
        },
    ];

    /// The parameters as the circuit takes them.
    pub fn parameters(&self) -> Parameters {
        let diodes = if self.exponential { Diodes::Exponential(self.diode) } else { Diodes::Ideal };
        Parameters { diodes, ..self.circuit }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_starts_with_the_defaults_and_reads_back_what_it_writes() {
        for quantity in Settings::QUANTITIES {
            let mut settings = Settings::default();
            assert_eq!((quantity.get)(&settings), quantity.start, "{}", quantity.name);
            (quantity.set)(&mut settings, 0.125);
            assert_eq!((quantity.get)(&settings), 0.125, "{}", quantity.name);
        }
        for choice in Settings::CHOICES {
            let mut settings = Settings::default();
            assert_eq!((choice.get)(&settings), 0, "{}", choice.name);
            for item in 0..choice.items.len() {
                (choice.set)(&mut settings, item);
                assert_eq!((choice.get)(&settings), item, "{}", choice.name);
            }
        }
    }
}
