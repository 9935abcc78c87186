//! All parameters of the harvester as a scenario has them, for tools that start its FMU themselves.

use fmu_import::{Causality, FmiError, ModelDescription, Value, Variable};

use super::Scenario;
use super::harvester::harvester_description;

/// A parameter of the FMU and its value.
#[derive(Debug, Clone, PartialEq)]
pub struct StartValue {
    /// Name of the variable.
    pub name: String,
    /// Its value.
    pub value: Value,
    /// Its unit, if it has one.
    pub unit: Option<String>,
    /// What it is.
    pub description: String,
}

/// Every parameter of the harvester with its value in `scenario`, in the order of the FMU.
///
/// # Errors
/// A setting that does not suit its variable.
pub fn start_values(scenario: &Scenario) -> Result<Vec<StartValue>, FmiError> {
    let description = harvester_description()?;
    let parameters = description.variables.iter().filter(|variable| variable.causality == Causality::Parameter);
    parameters.map(|variable| start_value(&description, variable, scenario)).collect()
}

fn start_value(
    description: &ModelDescription,
    variable: &Variable,
    scenario: &Scenario,
) -> Result<StartValue, FmiError> {
    let set = scenario.settings.iter().rfind(|setting| setting.name == variable.name);
    let value = match set {
        Some(setting) => Value::parse(description, variable, &setting.value_for_fmu())?,
        // Every parameter of the harvester has one.
        None => description.start(variable).unwrap_or(Value::String(String::new())),
    };
    Ok(StartValue {
        name: variable.name.clone(),
        value,
        unit: variable.unit().filter(|unit| *unit != "1").map(str::to_owned),
        description: variable.description.clone().unwrap_or_default(),
    })
}
