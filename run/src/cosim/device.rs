//! The harvester of a run with its parameters, as the FMU has them at the start.

use fmu_import::{Fmu, Value, Variable};
use videg_model::Parameters;

use super::{CosimError, HarvesterFmu};
use crate::scenario::{Scenario, Setting};

/// A harvester with its parameters.
#[derive(Debug, Clone)]
pub struct Device {
    /// The parameters and the file of the recording; none if the FMU is another model.
    pub parameters: Option<(Parameters, String)>,
    /// Every parameter of the FMU with its value.
    pub values: Vec<(Variable, Value)>,
}

impl Device {
    /// That of `scenario`.
    ///
    /// # Errors
    /// As [`HarvesterFmu::new`].
    pub fn of(fmu: &Fmu, scenario: &Scenario) -> Result<Self, CosimError> {
        // Settings of a circuit are no matter here.
        let is_mechanical = |setting: &&Setting| fmu.description().variable(&setting.name).is_ok();
        let mechanical: Vec<_> = scenario.settings.iter().filter(is_mechanical).cloned().collect();
        let harvester = HarvesterFmu::new(fmu, scenario, &mechanical)?;
        let values = harvester.settings().into_iter().map(|(variable, value)| (variable.clone(), value)).collect();
        Ok(Self { parameters: harvester.parameters(), values })
    }
}
