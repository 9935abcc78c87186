//! Documentation in an FMU: a page about the model.

use askama::Template;

use super::error::{PackageError, Result};
use fmu_import::{Causality, EnumerationItem, Kind, ModelDescription, Variable};

/// Headings, in the order in which a user needs them.
const GROUPS: [(Causality, &str); 5] = [
    (Causality::Parameter, "Parameters"),
    (Causality::CalculatedParameter, "Calculated parameters"),
    (Causality::Input, "Inputs"),
    (Causality::Output, "Outputs"),
    (Causality::Local, "Local variables"),
];

#[derive(Template)]
#[template(path = "documentation.html")]
struct Page<'a> {
    description: &'a ModelDescription,
    groups: Vec<Group>,
    text: &'a str,
}

struct Group {
    heading: &'static str,
    rows: Vec<Row>,
}

struct Row {
    name: String,
    unit: String,
    start: String,
    range: String,
    meaning: String,
}

/// The page about a model: name and facts, `text`, which is HTML, and tables of the variables.
///
/// # Errors
/// When it cannot be written.
pub(crate) fn page(description: &ModelDescription, text: &str) -> Result<String> {
    let groups = GROUPS.iter().filter_map(|(causality, heading)| group(description, *causality, heading)).collect();
    let page = Page { description, groups, text };
    page.render().map_err(|cause| {
        let document = format!("the documentation of {}", description.co_simulation.model_identifier);
        PackageError::Template { document, cause }
    })
}

fn group(description: &ModelDescription, causality: Causality, heading: &'static str) -> Option<Group> {
    let variables = description.variables.iter().filter(|variable| variable.causality == causality);
    let rows: Vec<_> = variables.map(|variable| row(description, variable)).collect();
    (!rows.is_empty()).then_some(Group { heading, rows })
}

fn row(description: &ModelDescription, variable: &Variable) -> Row {
    let mut meaning = variable.description.clone().unwrap_or_default();
    let (unit, start, range) = match &variable.kind {
        Kind::Real { start, min, max, .. } => {
            (variable.unit().unwrap_or("1"), start.map(number), range(min.map(number), max.map(number)))
        }
        Kind::Integer { start, min, max } => (
            "integer",
            start.map(|value| value.to_string()),
            range(min.map(|value| value.to_string()), max.map(|value| value.to_string())),
        ),
        Kind::Boolean { start } => ("boolean", start.map(|value| value.to_string()), String::new()),
        Kind::String { start } => ("text", start.clone(), String::new()),
        Kind::Enumeration { start } => {
            let items = description.enumeration(variable).map(|it| it.items.as_slice()).unwrap_or_default();
            let explained = |item: &EnumerationItem| {
                format!(". {} ({}): {}", item.name, item.value, item.description.as_deref().unwrap_or_default())
            };
            meaning.extend(items.iter().map(explained));
            let chosen = items.iter().find(|item| Some(item.value) == *start);
            ("enumeration", chosen.map(|item| item.name.clone()), String::new())
        }
        Kind::Other => ("clock", None, String::new()),
    };
    Row { name: variable.name.clone(), unit: unit.to_owned(), start: start.unwrap_or_default(), range, meaning }
}

/// A number as people write it.
fn number(value: f64) -> String {
    if value == 0.0 || (1e-3..1e5).contains(&value.abs()) { value.to_string() } else { format!("{value:e}") }
}

fn range(min: Option<String>, max: Option<String>) -> String {
    match (min, max) {
        (None, None) => String::new(),
        (Some(min), None) => format!("at least {min}"),
        (None, Some(max)) => format!("at most {max}"),
        (Some(min), Some(max)) => format!("{min} to {max}"),
    }
}
