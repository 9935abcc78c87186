//! What a run gives.

use videg_coupled::{CoupledError, OVER_LIMITS, Results, run_watched};
use wasm_bindgen::prelude::wasm_bindgen;

use crate::film::{FirstExcesses, Limits};
use crate::machine::{Machine, times};

/// Numbers of a run, in the order of [`Outcome::names`], and warnings about them.
#[wasm_bindgen]
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    values: Vec<f64>,
    warnings: Vec<String>,
}

/// Names of the numbers, those of `--json` and of the variables where there are such. Powers in W over the window, energies in J over
/// the run.
const NAMES: [&str; 22] = [
    "impacts",
    "average_voltage_gain",
    "average_power_eq13",
    "net_power",
    "load_power",
    "supply_power",
    "zener_power",
    "diode_power",
    "leakage_power",
    "stored_power",
    "mechanical_power",
    "load.energy",
    "supply.energy",
    "zener.energy",
    "stored.energy",
    "mechanical.energy",
    "largest_deflection",
    "highest_voltage",
    OVER_LIMITS[0],
    OVER_LIMITS[1],
    OVER_LIMITS[2],
    OVER_LIMITS[3],
];

#[wasm_bindgen]
impl Outcome {
    /// Names of the numbers.
    pub fn names() -> Vec<String> {
        NAMES.map(ToOwned::to_owned).to_vec()
    }

    /// The numbers.
    pub fn values(&self) -> Vec<f64> {
        self.values.clone()
    }

    /// Why they may not hold, in words.
    pub fn warnings(&self) -> Vec<String> {
        self.warnings.clone()
    }
}

#[wasm_bindgen]
impl Machine {
    /// Runs the machine up to `until`, s, and averages from `from` on.
    ///
    /// # Errors
    /// Parameters that harvester or circuit refuse; times that are none; more events than can be resolved.
    pub fn run(&self, from: f64, until: f64) -> Result<Outcome, String> {
        let (settings, times) = (self.settings(until)?, times(from, until));
        let failed = |error: CoupledError| error.to_string();
        let mut limits = Limits::default();
        let results = run_watched(self.setup(), &settings, &times, &mut limits).map_err(failed)?;
        let mut warnings: Vec<_> = self.values.parameters.neglected_mass().iter().map(ToString::to_string).collect();
        // Only a run that leaves them is asked where.
        if limits.over_limits().iter().any(|share| *share > 1.0) {
            let mut first = FirstExcesses::default();
            run_watched(self.setup(), &settings, &times, &mut first).map_err(failed)?;
            warnings.extend(first.found.iter().map(ToString::to_string));
        }
        Ok(Outcome { values: numbers(&results, &limits).to_vec(), warnings })
    }
}

fn numbers(results: &Results, limits: &Limits) -> [f64; NAMES.len()] {
    let Results { averages, powers, flows, circuit, .. } = results;
    let ledger = &circuit.ledger;
    let [area, field, stress, deflection] = limits.over_limits();
    [
        f64::from(averages.impacts),
        averages.voltage_gain,
        averages.power,
        powers.net_power,
        powers.load_power,
        powers.supply_power,
        flows.zener,
        flows.diode,
        flows.leakage,
        flows.stored,
        flows.mechanical,
        ledger.load,
        ledger.supply,
        ledger.zener,
        ledger.stored,
        ledger.mechanical,
        limits.deepest,
        limits.highest,
        area,
        field,
        stress,
        deflection,
    ]
}
