//! All parameters of the harvester as a scenario has them, for tools that start its FMU themselves.

use fmu_import::{Causality, FmiError, Kind, ModelDescription, Value, Variable};

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
    let text = set.map_or_else(|| start(variable), |setting| setting.value_for_fmu().into_owned());
    Ok(StartValue {
        name: variable.name.clone(),
        value: Value::parse(description, variable, &text)?,
        unit: variable.unit().filter(|unit| *unit != "1").map(str::to_owned),
        description: variable.description.clone().unwrap_or_default(),
    })
}

/// The start value as a user types it. Every parameter of the harvester has one.
fn start(variable: &Variable) -> String {
    match &variable.kind {
        Kind::Real { start, .. } => format!("{:?}", start.unwrap_or_default()),
        Kind::Integer { start, .. } => start.unwrap_or_default().to_string(),
        Kind::Enumeration { start } => start.unwrap_or_default().to_string(),
        Kind::Boolean { start } => start.unwrap_or_default().to_string(),
        Kind::String { start } => start.clone().unwrap_or_default(),
        Kind::Other => String::new(),
    }
}
