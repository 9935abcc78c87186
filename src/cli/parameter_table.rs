//! The section of a report with all parameters of a run.

use fmu_import::{Causality, Kind, ModelDescription, Value, Variable};
use videg_circuit::Settings;
use videg_report::{Column, Section, Table};

use crate::cosim::Device;
use crate::scenario::{Scenario, Setting};

/// A parameter with its value, and that of the case if it differs.
struct Parameter<'a> {
    name: &'a str,
    description: &'a str,
    unit: &'a str,
    value: String,
    case: Option<String>,
}

impl Parameter<'_> {
    /// The paper's symbol, with which a description begins.
    fn symbol(&self) -> &str {
        let parts = self.description.split_once(": ").filter(|(symbol, _)| !symbol.contains(' '));
        parts.map_or("", |(symbol, _)| symbol)
    }
}

/// The parameters of the harvester.
pub fn section(device: &Device, scenario: &Scenario) -> Section {
    let [case, changes] = settings(scenario);
    let parameters = device.values.iter().map(|(variable, value)| {
        let before = last(case, &variable.name).map_or_else(|| start(variable), |setting| setting.value.clone());
        let is_changed = last(changes, &variable.name).is_some() && differs(value, &before);
        Parameter {
            name: &variable.name,
            description: variable.description.as_deref().unwrap_or_default(),
            unit: variable.unit().unwrap_or_default(),
            value: if let Value::Real(number) = value { shown(*number) } else { value.to_string() },
            case: is_changed.then_some(before),
        }
    });
    let legend = "Rows that stand out differ from the case. videg fmu info says what each parameter means.";
    Section::new("Parameters").text(legend).table(table(parameters))
}

/// Adds those of our circuit.
pub fn with_circuit(section: Section, circuit: &Settings, scenario: &Scenario) -> Section {
    let [_, changes] = settings(scenario);
    let of_default = Settings::default();
    let changed = |name: &str, before: String| last(changes, name).map(|_| before);
    let numbers = Settings::QUANTITIES.iter().map(|quantity| Parameter {
        name: quantity.name,
        description: quantity.description,
        unit: quantity.unit,
        value: shown((quantity.get)(circuit)),
        case: changed(quantity.name, shown(quantity.start)),
    });
    let choices = Settings::CHOICES.iter().map(|choice| Parameter {
        name: choice.name,
        description: choice.description,
        unit: "",
        value: choice.chosen(circuit).to_owned(),
        case: changed(choice.name, choice.chosen(&of_default).to_owned()),
    });
    section.table(table(numbers.chain(choices)))
}

/// Adds those of a circuit FMU of the user, of which `set` are set.
pub fn with_fmu(section: Section, circuit: &ModelDescription, set: &[Setting]) -> Section {
    let parameters = circuit.variables.iter().filter(|variable| variable.causality == Causality::Parameter);
    let parameters = parameters.map(|variable| {
        let set = last(set, &variable.name).map(|setting| setting.value.clone());
        Parameter {
            name: &variable.name,
            description: variable.description.as_deref().unwrap_or_default(),
            unit: variable.unit().unwrap_or_default(),
            case: set.as_ref().map(|_| start(variable)),
            value: set.unwrap_or_else(|| start(variable)),
        }
    });
    section.table(table(parameters))
}

fn table<'a>(parameters: impl Iterator<Item = Parameter<'a>>) -> Table {
    let columns = [
        Column::words("name"),
        Column::words("symbol"),
        Column::numbers("value"),
        Column::words("unit"),
        Column::numbers("in the case"),
    ];
    parameters.fold(Table::new(columns), |table, parameter| {
        let unit = if parameter.unit == "1" { "" } else { parameter.unit };
        let case = parameter.case.as_deref().unwrap_or_default();
        let cells = [parameter.name, parameter.symbol(), &parameter.value, unit, case];
        if parameter.case.is_some() { table.marked(cells) } else { table.row(cells) }
    })
}

/// Those of the case, and those of the user.
fn settings(scenario: &Scenario) -> [&[Setting]; 2] {
    let (case, changes) = scenario.settings.split_at(scenario.settings.len() - scenario.changes().len());
    [case, changes]
}

/// The last setting of a name wins.
fn last<'a>(settings: &'a [Setting], name: &str) -> Option<&'a Setting> {
    settings.iter().rfind(|setting| setting.name == name)
}

/// The start value of a variable, as a user would write it.
fn start(variable: &Variable) -> String {
    match &variable.kind {
        Kind::Real { start, .. } => start.map(shown),
        Kind::Integer { start, .. } => start.map(|number| number.to_string()),
        Kind::Enumeration { start } => start.map(|number| number.to_string()),
        Kind::Boolean { start } => start.map(|on| on.to_string()),
        Kind::String { start } => start.clone(),
        Kind::Other => None,
    }
    .unwrap_or_default()
}

/// Whether `text` stands for another value.
fn differs(value: &Value, text: &str) -> bool {
    match value {
        Value::Real(number) => text.trim().parse() != Ok(*number),
        Value::Enumeration { value, name } => text != name && text != value.to_string(),
        Value::Boolean(on) => text != on.to_string() && text != i32::from(*on).to_string(),
        other => text != other.to_string(),
    }
}

/// A number without rounding, and without many zeros.
fn shown(value: f64) -> String {
    let size = value.abs();
    if size != 0.0 && size.is_finite() && !(1e-5..1e7).contains(&size) {
        format!("{value:e}")
    } else {
        format!("{value}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_symbol_is_what_the_description_begins_with() {
        let of = |description| Parameter { name: "", description, unit: "", value: String::new(), case: None };
        assert_eq!(of("M: mass of the outer structure").symbol(), "M");
        assert_eq!(of("What is prescribed: the force").symbol(), "");
    }

    #[test]
    fn values_are_compared_as_what_they_are() {
        let item = Value::Enumeration { value: 2, name: "compliant".to_owned() };
        assert!(!differs(&item, "compliant") && !differs(&item, "2") && differs(&item, "impulsive"));
        assert!(!differs(&Value::Real(0.6), "0.60") && differs(&Value::Real(0.6), "0.7"));
        assert!(!differs(&Value::Boolean(true), "1") && differs(&Value::Boolean(true), "false"));
        assert_eq!([0.0, 1e-13, 0.5, 1e9, f64::INFINITY].map(shown), ["0", "1e-13", "0.5", "1e9", "inf"]);
    }
}
