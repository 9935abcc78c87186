//! Parameters by name: the table that the circuit checks them against, an FMU lists them from and a command line sets
//! them by.

use crate::error::Error;
use crate::parameters::{DiodeParameters, Diodes, Parameters, Release, Topology, names};

/// The parameters laid out flat: those of the exponential diodes keep their values while ideal diodes are chosen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// All but the diodes.
    pub circuit: Parameters,
    /// Parameters of exponential diodes.
    pub diode: DiodeParameters,
    /// Exponential diodes instead of ideal ones.
    pub exponential: bool,
}

/// One real parameter, as it is reached in `S`: the settings themselves or what holds them.
#[derive(Debug, Clone, Copy)]
pub struct Quantity<S = Settings> {
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
    pub get: fn(&S) -> f64,
    /// Writes the parameter, unchecked.
    pub set: fn(&mut S, f64),
}

/// One parameter that chooses an item, as it is reached in `S`.
#[derive(Debug, Clone, Copy)]
pub struct Choice<S = Settings> {
    /// Structured name.
    pub name: &'static str,
    /// Meaning.
    pub description: &'static str,
    /// Name and meaning of each item; the first is the default.
    pub items: &'static [(&'static str, &'static str)],
    /// Number of the chosen item, from 1 as in FMI 2.0.
    pub get: fn(&S) -> i32,
    /// Chooses the item with this number; a number that is no item counts as the last.
    pub set: fn(&mut S, i32),
}

macro_rules! quantities {
    ($($name:expr, $unit:literal, $min:expr, $max:expr, $field:ident . $($path:ident).+, $description:literal;)*) => {
        &[$(Quantity {
            name: $name, unit: $unit, start: Settings::DEFAULT.$field.$($path).+, min: $min, max: $max,
            description: $description,
            get: |s| s.as_ref().$field.$($path).+, set: |s, value| s.as_mut().$field.$($path).+ = value,
        },)*]
    };
}

impl Quantity {
    fn check(&self, settings: &Settings) -> Result<(), Error> {
        let value = (self.get)(settings);
        // NaN fails the comparison, too.
        if value >= self.min && value <= self.max {
            return Ok(());
        }
        Err(Error::Bounds { name: self.name, value, unit: self.unit, min: self.min, max: self.max })
    }
}

impl<S: AsRef<Settings> + AsMut<Settings> + 'static> Quantity<S> {
    /// Every real parameter.
    pub const TABLE: &'static [Self] = quantities! {
        names::SUPPLY_VOLTAGE, "V", 1e-3, 1e6, circuit.supply_voltage, "U_in: voltage of the supply, Section 4.1";
        names::ZENER_VOLTAGE, "V", 1e-3, 1e6, circuit.zener_voltage, "U_z: voltage at which charge is released to the load, at least U_in, Section 4.1";
        names::STORAGE_VOLTAGE, "V", 1e-3, 1e6, circuit.storage_voltage, "U_out: voltage of a storage in place of Zener diode and load, at least U_in; 2450 V is near the best for the default case on a shared node";
        names::LOAD_RESISTANCE, "Ohm", 0.0, f64::INFINITY, circuit.load_resistance, "R: load resistance, 0 to infinity; the paper gives none";
        names::SATURATION_CURRENT, "A", 1e-30, 1e3, diode.saturation_current, "IS of exponential diodes";
        names::EMISSION_COEFFICIENT, "1", 1e-6, 1e3, diode.emission_coefficient, "N of exponential diodes; 0.01 is near-ideal";
        names::TEMPERATURE, "K", 1.0, 1e4, diode.temperature, "Temperature of exponential diodes";
        names::BREAKDOWN_CURRENT, "A", 1e-30, 1e3, diode.breakdown_current, "IBV of exponential Zener diodes";
        names::BREAKDOWN_EMISSION, "1", 1e-6, 1e3, diode.breakdown_emission, "NBV of exponential Zener diodes";
        names::SWITCH_BAND, "V", 1e-9, 1e3, diode.switch_band, "Voltage over which the switch turns on, with exponential diodes";
        names::RELATIVE_TOLERANCE, "1", 1e-14, 1e3, diode.solver.relative_tolerance, "Relative tolerance of the integrator of exponential diodes";
        names::LEAKAGE_TIME_CONSTANT, "s", 0.0, f64::INFINITY, circuit.leakage_time_constant, "Resistivity times permittivity of the film: each membrane has the conductance C over this beside its capacitance; at least 1e-6 s, 0 and infinity: no leakage";
    };
}

impl<S: AsRef<Settings> + AsMut<Settings> + 'static> Choice<S> {
    /// Every parameter that chooses.
    pub const TABLE: &'static [Self] = &[Self::TOPOLOGY, Self::RELEASE, Self::DIODE_MODEL];

    /// `topology`
    pub const TOPOLOGY: Self = Self {
        name: names::TOPOLOGY,
        description: "How the membranes are connected, Fig. 8(a)",
        items: &[
            ("sharedNode", "Both membranes on one node, as Fig. 8(a) is drawn"),
            ("isolated", "A diode and a release element for each membrane, as Eq. (12) assumes"),
        ],
        get: |s| s.as_ref().circuit.topology as i32 + 1,
        set: |s, item| {
            s.as_mut().circuit.topology = if item == 1 { Topology::SharedNode } else { Topology::Isolated };
        },
    };

    /// `release`
    pub const RELEASE: Self = Self {
        name: names::RELEASE,
        description: "What releases the charge to the load, Section 4.1",
        items: &[
            ("zener", "A Zener diode in series; it burns U_z I"),
            ("switch", "An ideal switch, closed while the voltage exceeds U_z; it burns nothing"),
            ("storage", "A diode into a storage at U_out; no load resistance, and it burns nothing"),
        ],
        get: |s| s.as_ref().circuit.release as i32 + 1,
        set: |s, item| {
            s.as_mut().circuit.release = match item {
                1 => Release::Zener,
                2 => Release::Switch,
                _ => Release::Storage,
            }
        },
    };

    /// `diode.model`
    pub const DIODE_MODEL: Self = Self {
        name: names::DIODE_MODEL,
        description: "Model of the diodes",
        items: &[
            ("ideal", "No drop and no leakage, solved exactly"),
            ("exponential", "Shockley's exponential, as ngspice evaluates it"),
        ],
        get: |s| i32::from(s.as_ref().exponential) + 1,
        set: |s, item| s.as_mut().exponential = item != 1,
    };

    /// Name of the chosen item.
    pub fn chosen(&self, settings: &S) -> &'static str {
        let number = usize::try_from((self.get)(settings)).unwrap_or_default();
        self.items.get(number.wrapping_sub(1)).map_or("", |item| item.0)
    }

    /// Chooses the item of this name; says whether there is one.
    pub fn choose(&self, settings: &mut S, name: &str) -> bool {
        let number = (1..).zip(self.items).find(|(_, item)| item.0 == name);
        number.map(|(number, _)| (self.set)(settings, number)).is_some()
    }
}

impl AsRef<Self> for Settings {
    fn as_ref(&self) -> &Self {
        self
    }
}

impl AsMut<Self> for Settings {
    fn as_mut(&mut self) -> &mut Self {
        self
    }
}

impl Default for Settings {
    fn default() -> Self {
        Self::DEFAULT
    }
}

impl Settings {
    const DEFAULT: Self = Self { circuit: Parameters::DEFAULT, diode: DiodeParameters::DEFAULT, exponential: false };

    /// Every real parameter.
    pub const QUANTITIES: &'static [Quantity] = Quantity::<Self>::TABLE;

    /// Every parameter that chooses.
    pub const CHOICES: &'static [Choice] = Choice::<Self>::TABLE;

    /// The parameters as the circuit takes them.
    pub fn parameters(&self) -> Parameters {
        let diodes = if self.exponential { Diodes::Exponential(self.diode) } else { Diodes::Ideal };
        Parameters { diodes, ..self.circuit }
    }
}

impl Parameters {
    /// Checks every bound.
    ///
    /// # Errors
    /// The first parameter out of the bounds of [`Settings::QUANTITIES`], too fast a leakage, or a
    /// voltage of release below `U_in`.
    pub fn validate(&self) -> Result<(), Error> {
        let (diode, exponential) = match self.diodes {
            Diodes::Ideal => (DiodeParameters::DEFAULT, false),
            Diodes::Exponential(diode) => (diode, true),
        };
        let settings = Settings { circuit: *self, diode, exponential };
        Settings::QUANTITIES.iter().try_for_each(|quantity| quantity.check(&settings))?;
        let leakage = self.leakage_time_constant;
        if leakage > 0.0 && leakage < Self::FASTEST_LEAKAGE {
            return Err(Error::LeakageTooFast { time_constant: leakage, min: Self::FASTEST_LEAKAGE });
        }
        let (supply, release) = (self.supply_voltage, self.release_voltage());
        if release >= supply {
            return Ok(());
        }
        Err(match self.release {
            Release::Zener | Release::Switch => Error::ZenerBelowSupply { zener: release, supply },
            Release::Storage => Error::StorageBelowSupply { storage: release, supply },
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_reads_back_what_it_writes() {
        for quantity in Settings::QUANTITIES {
            let mut settings = Settings::default();
            assert!(quantity.min <= quantity.start && quantity.start <= quantity.max, "{}", quantity.name);
            (quantity.set)(&mut settings, 0.125);
            assert_eq!((quantity.get)(&settings), 0.125, "{}", quantity.name);
        }
        for choice in Settings::CHOICES {
            let mut settings = Settings::default();
            assert_eq!(choice.chosen(&settings), choice.items[0].0, "{}", choice.name);
            for (item, _) in choice.items {
                assert!(choice.choose(&mut settings, item));
                assert_eq!(choice.chosen(&settings), *item, "{}", choice.name);
            }
            assert!(!choice.choose(&mut settings, "nonsense"));
        }
    }
}
