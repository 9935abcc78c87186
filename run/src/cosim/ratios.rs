//! By how much impacts raise the capacitances, and the voltage of release that suits them.

use videg_circuit::formulas;

use super::{CosimError, HarvesterFmu, Schedule};
use crate::scenario::{Scenario, Setting};
use fmu_import::Fmu;

/// `C_3` / `C_2` of the impacts of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CapacitanceRatios {
    /// The one for which a voltage of release is chosen.
    pub best: f64,
    /// The largest, at least 1.
    pub largest: f64,
}

impl CapacitanceRatios {
    /// Runs the mechanics of `scenario` alone. Impacts within one communication step count as equal.
    pub fn of(fmu: &Fmu, scenario: &Scenario, mechanical: &[Setting]) -> Result<Self, CosimError> {
        let mut harvester = HarvesterFmu::new(fmu, scenario, mechanical)?;
        let schedule = Schedule::new(scenario.step, scenario.until, scenario.window);
        let (mut now, mut gain, mut impacts) = (0.0, 0.0, 0);
        let mut ratios = Vec::new();
        while now < scenario.until {
            let next = schedule.next(now, f64::INFINITY);
            harvester.step(now, next - now)?;
            let [count, _] = harvester.counts()?;
            if count > impacts {
                let (total, number) = (harvester.sample()?.voltage_gain(), count - impacts);
                let ratio = 1.0 + (total - gain) / (f64::from(number) * harvester.bias_voltage());
                ratios.extend((0..number).map(|_| ratio));
                (gain, impacts) = (total, count);
            }
            now = next;
        }
        let largest = ratios.iter().copied().fold(1.0, f64::max);
        Ok(Self { best: formulas::best_release_ratio(ratios), largest })
    }
}
