//! The device in a browser: one page that computes what it shows with the library itself.
//!
//! ```no_run
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! use videg::{explorer, package, scenario::Request};
//!
//! let page = explorer::page(&Request::default().resolve()?, &package::Options::default())?;
//! std::fs::write("explorer.html", page)?;
//! # Ok(())
//! # }
//! ```

use std::collections::BTreeMap;
use std::path::Path;

use fmu_import::{Causality, FmiError, Kind, ModelDescription, Value, Variable};
use serde::Serialize;
use thiserror::Error;
use videg_circuit::Settings;
use videg_model::Case;

use crate::package::{self, PackageError};
use crate::scenario::{Request, Scenario, ScenarioError, Setting, harvester_description};
use crate::sweep::system_description;

/// Largest file of a scenario that goes into a page, bytes.
const LARGEST_FILE: u64 = 64 << 20;

/// Why there is no page. Each message names the setting and its value.
#[derive(Debug, Error)]
#[allow(missing_docs, reason = "the message of each variant names its fields")]
pub enum ExplorerError {
    #[error(transparent)]
    Package(#[from] PackageError),
    #[error("{place}: {reason}")]
    Setting { place: String, reason: String },
    #[error("{place} = {path}: {cause}")]
    File { place: String, path: String, cause: std::io::Error },
    #[error("{place} = {path}: {size} bytes; a page takes at most {LARGEST_FILE}")]
    TooLarge { place: String, path: String, size: u64 },
    #[error(transparent)]
    Case(#[from] ScenarioError),
    #[error(transparent)]
    Description(#[from] FmiError),
    #[error("the page has no place for what it must know of variables and cases; build it anew")]
    NoPlace,
    #[error("cannot write what the page knows: {0}")]
    Json(#[from] serde_json::Error),
}

/// What the page knows of the program that made it.
#[derive(Serialize)]
struct Description<'a> {
    version: &'static str,
    variables: Vec<Parameter<'a>>,
    cases: Vec<Published>,
    state: State,
}

/// A parameter, as the reference lists it.
#[derive(Serialize)]
struct Parameter<'a> {
    name: &'a str,
    /// `harvester` or `circuit`.
    part: &'static str,
    kind: &'static str,
    unit: Option<&'a str>,
    start: Option<Number>,
    min: Option<f64>,
    max: Option<f64>,
    items: Vec<Item<'a>>,
    description: &'a str,
}

#[derive(Serialize)]
struct Item<'a> {
    name: &'a str,
    value: i32,
    description: Option<&'a str>,
}

/// A value of a parameter; choices by name.
#[derive(Serialize)]
#[serde(untagged)]
enum Number {
    Real(f64),
    /// Numbers that JSON does not have.
    Text(String),
    Integer(i64),
    Switch(bool),
}

/// A published case.
#[derive(Serialize)]
struct Published {
    name: &'static str,
    description: &'static str,
    source: &'static str,
    settings: BTreeMap<String, Number>,
}

/// What the page begins with.
#[derive(Serialize)]
struct State {
    case: &'static str,
    set: BTreeMap<String, Number>,
    files: BTreeMap<String, File>,
    until: f64,
    from: f64,
    begin: f64,
}

#[derive(Serialize)]
struct File {
    name: String,
    text: String,
}

/// The page, which begins with `scenario`.
///
/// # Errors
/// A setting that neither harvester nor circuit takes; a file that cannot be read; a page that cannot be built.
pub fn page(scenario: &Scenario, options: &package::Options) -> Result<String, ExplorerError> {
    let description = system_description()?;
    let description = Description {
        version: env!("CARGO_PKG_VERSION"),
        variables: parameters(&description)?,
        cases: Case::ALL.iter().map(|case| published(&description, case)).collect::<Result<_, _>>()?,
        state: state(&description, scenario)?,
    };
    let json = videg_report::inert(&serde_json::to_string(&description)?);
    with_description(&package::explorer(options)?, &json).ok_or(ExplorerError::NoPlace)
}

/// The `page` with another description: it has one element for that, which may be empty or of another machine.
fn with_description(page: &str, json: &str) -> Option<String> {
    const BEGIN: &str = "<script type=\"application/json\" id=\"description\">";
    let (head, rest) = page.split_once(BEGIN)?;
    let tail = &rest[rest.find("</script>")?..];
    Some(format!("{head}{BEGIN}{json}{tail}"))
}

/// Parameters of the harvester, then those of the circuit that can be set without an FMU.
fn parameters(description: &ModelDescription) -> Result<Vec<Parameter<'_>>, ExplorerError> {
    let harvester = harvester_description()?;
    let quantities = Settings::QUANTITIES.iter().map(|it| it.name);
    let of_circuit: Vec<_> = quantities.chain(Settings::CHOICES.iter().map(|it| it.name)).collect();
    let part = |variable: &Variable| {
        let is_harvester = harvester.variable(&variable.name).is_ok();
        let is_circuit = of_circuit.contains(&variable.name.as_str());
        if is_harvester { Some("harvester") } else { is_circuit.then_some("circuit") }
    };
    let are_set = description.variables.iter().filter(|variable| variable.causality == Causality::Parameter);
    Ok(are_set.filter_map(|variable| Some(parameter(description, variable, part(variable)?))).collect())
}

fn parameter<'a>(description: &'a ModelDescription, variable: &'a Variable, part: &'static str) -> Parameter<'a> {
    let enumeration = description.enumeration(variable);
    let items = enumeration.map_or(&[][..], |enumeration| &enumeration.items).iter();
    let item = |value: i32| items.clone().find(|item| item.value == value).map(|item| Number::Text(item.name.clone()));
    let (kind, start) = match &variable.kind {
        Kind::Real { start, .. } => ("real", start.map(real)),
        Kind::Integer { start, .. } => ("integer", start.map(Number::Integer)),
        Kind::Boolean { start } => ("boolean", start.map(Number::Switch)),
        Kind::String { .. } | Kind::Other => ("string", None),
        Kind::Enumeration { start } => ("enumeration", start.and_then(item)),
    };
    let [min, max] = variable.kind.bounds();
    Parameter {
        name: &variable.name,
        part,
        kind,
        unit: variable.unit().filter(|unit| *unit != "1"),
        start,
        min,
        max,
        items: items
            .clone()
            .map(|item| Item { name: &item.name, value: item.value, description: item.description.as_deref() })
            .collect(),
        description: variable.description.as_deref().unwrap_or_default(),
    }
}

fn published(description: &ModelDescription, case: &'static Case) -> Result<Published, ExplorerError> {
    let scenario = Request { case: Some(case.name.to_owned()), ..Request::default() }.resolve()?;
    let settings = scenario.settings.iter().map(|setting| Ok((setting.name.clone(), number(description, setting)?)));
    let settings = settings.collect::<Result<_, ExplorerError>>()?;
    Ok(Published { name: case.name, description: case.description, source: case.source, settings })
}

fn state(description: &ModelDescription, scenario: &Scenario) -> Result<State, ExplorerError> {
    let (mut set, mut files) = (BTreeMap::new(), BTreeMap::new());
    for setting in scenario.changes() {
        let is_file = description.variable(&setting.name).is_ok_and(|it| matches!(it.kind, Kind::String { .. }));
        if !is_file {
            set.insert(setting.name.clone(), number(description, setting)?);
        } else if !setting.value.is_empty() {
            files.insert(setting.name.clone(), file(setting)?);
        }
    }
    let [from, until] = [scenario.window[0], scenario.until];
    Ok(State { case: scenario.case, set, files, until, from, begin: from })
}

/// The value of a setting, of the type of its variable.
fn number(description: &ModelDescription, setting: &Setting) -> Result<Number, ExplorerError> {
    let failed = |reason: String| ExplorerError::Setting { place: setting.place(), reason };
    let variable = description.variable(&setting.name).map_err(|error| failed(error.to_string()))?;
    Ok(match Value::parse(description, variable, &setting.value).map_err(|error| failed(error.to_string()))? {
        Value::Real(value) => real(value),
        Value::Integer(value) => Number::Integer(value.into()),
        Value::Boolean(on) => Number::Switch(on),
        Value::Enumeration { name, .. } => Number::Text(name),
        Value::String(text) => Number::Text(text),
    })
}

fn real(value: f64) -> Number {
    if value == f64::INFINITY { Number::Text("Infinity".to_owned()) } else { Number::Real(value) }
}

fn file(setting: &Setting) -> Result<File, ExplorerError> {
    let path = setting.value_for_fmu();
    let failed = |cause| ExplorerError::File { place: setting.place(), path: setting.value.clone(), cause };
    let size = std::fs::metadata(&*path).map_err(failed)?.len();
    if size > LARGEST_FILE {
        return Err(ExplorerError::TooLarge { place: setting.place(), path: setting.value.clone(), size });
    }
    let text = videg_input::read_text(Path::new(&*path)).map_err(failed)?;
    let name =
        Path::new(&setting.value).file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    Ok(File { name, text })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_gets_another_description_and_stays_the_same_otherwise() {
        let page =
            "<p>a</p><script type=\"application/json\" id=\"description\">{{ description }}</script><script>b</script>";
        let one = with_description(page, "{\"a\":1}").unwrap();
        assert_eq!(one, page.replace("{{ description }}", "{\"a\":1}"));
        assert_eq!(with_description(&one, "{{ description }}").unwrap(), page);
        assert_eq!(with_description("<p>a</p>", "1"), None);
    }

    #[test]
    fn every_parameter_of_harvester_and_circuit_is_on_the_page_once() {
        let description = system_description().unwrap();
        let parameters = parameters(&description).unwrap();
        let names: Vec<_> = parameters.iter().map(|it| it.name).collect();
        let model = videg_model::Parameters::TABLE.iter().map(|it| it.name);
        let model = model.chain(videg_model::Parameters::CHOICES.iter().map(|it| it.name));
        let circuit = Settings::QUANTITIES.iter().map(|it| it.name).chain(Settings::CHOICES.iter().map(|it| it.name));
        for name in model.chain(circuit).chain(["excitation.file", "membrane.file"]) {
            assert_eq!(names.iter().filter(|known| **known == name).count(), 1, "{name}");
        }
    }

    #[test]
    fn a_scenario_is_the_state_of_the_page() {
        let settings = ["topology=isolated", "load.resistance=inf", "contact.reaction=true", "excitation.seed=7"];
        let settings = settings.map(|text| Setting::parse(text).unwrap()).to_vec();
        let request = Request { case: Some("fig15".to_owned()), settings, until: Some(20.0), ..Request::default() };
        let state = state(&system_description().unwrap(), &request.resolve().unwrap()).unwrap();
        let expected = concat!(
            "{\"case\":\"fig15\",\"set\":{\"contact.reaction\":true,\"excitation.seed\":7,\"load.resistance\":\"Infinity\",",
            "\"topology\":\"isolated\"},\"files\":{},\"until\":20.0,\"from\":10.0,\"begin\":10.0}"
        );
        assert_eq!(serde_json::to_string(&state).unwrap(), expected);
        let wrong = Setting::parse("topology=star").unwrap();
        let error = number(&system_description().unwrap(), &wrong).map(|_| ()).unwrap_err().to_string();
        assert!(error.contains("--set topology") && error.contains("star"), "{error}");
    }
}
