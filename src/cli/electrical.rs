//! Settings of the circuit that goes with a harvester.

use videg_circuit::{Settings, Topology, formulas, names};

use crate::cosim::{EmbeddedCircuit, HarvesterFmu, Schedule};
use crate::scenario::{Scenario, Setting};
use fmu_import::Fmu;

/// The circuit's parameters: supplied at the bias voltage of the harvester and released at the supply voltage, as in
/// Section 4.1, or into a storage at the voltage that gains most, unless the settings say otherwise.
pub fn resolve(electrical: &[Setting], bias: f64, ratio: f64) -> anyhow::Result<Settings> {
    let mut settings = Settings::default();
    settings.circuit.supply_voltage = bias;
    for setting in electrical {
        EmbeddedCircuit::apply(&mut settings, setting)?;
    }
    let given = |name| electrical.iter().any(|setting| setting.name == name);
    if !given(names::ZENER_VOLTAGE) {
        settings.circuit.zener_voltage = settings.circuit.supply_voltage;
    }
    if !given(names::STORAGE_VOLTAGE) {
        settings.circuit.storage_voltage = best_release_voltage(&settings, ratio);
    }
    Ok(settings)
}

/// The voltage of release that gains most, V, where an impact multiplies the capacitance of a membrane by `ratio`.
pub fn best_release_voltage(settings: &Settings, ratio: f64) -> f64 {
    let idle = match settings.circuit.topology {
        Topology::SharedNode => 1.0,
        Topology::Isolated => 0.0,
    };
    formulas::best_release_voltage(settings.circuit.supply_voltage, 1.0 + idle, ratio + idle)
}

/// `C_3` / `C_2` of the impacts of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ratios {
    /// The one to choose a voltage of release by.
    pub best: f64,
    /// The largest, at least 1.
    pub largest: f64,
}

/// The ratios of a scenario, from a run of the mechanics ahead. Impacts within one communication step count as equal.
pub fn capacitance_ratios(fmu: &Fmu, scenario: &Scenario, mechanical: &[Setting]) -> anyhow::Result<Ratios> {
    let mut ahead = HarvesterFmu::new(fmu, scenario, mechanical)?;
    let schedule = Schedule::new(scenario.step, scenario.until, scenario.window);
    let (mut now, mut gain, mut impacts) = (0.0, 0.0, 0);
    let mut ratios = Vec::new();
    while now < scenario.until {
        let next = schedule.next(now, f64::INFINITY);
        ahead.step(now, next - now)?;
        let [count, _] = ahead.counts()?;
        if count > impacts {
            let (total, number) = (ahead.sample()?.voltage_gain(), count - impacts);
            let ratio = 1.0 + (total - gain) / (f64::from(number) * ahead.bias_voltage());
            ratios.extend((0..number).map(|_| ratio));
            (gain, impacts) = (total, count);
        }
        now = next;
    }
    let largest = ratios.iter().copied().fold(1.0, f64::max);
    Ok(Ratios { best: formulas::best_release_ratio(ratios), largest })
}

/// The settings as text, for an FMU. Numbers read back to the same bits.
pub fn every_setting(settings: &Settings) -> Vec<Setting> {
    let quantities = Settings::QUANTITIES.iter().map(|q| (q.name, format!("{:?}", (q.get)(settings))));
    let choices = Settings::CHOICES.iter().map(|c| (c.name, c.chosen(settings).to_owned()));
    quantities.chain(choices).map(|(name, value)| Setting::new(name, value)).collect()
}
