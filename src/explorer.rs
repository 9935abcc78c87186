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

use std::path::Path;

use fmu_import::{Causality, EnumerationItem, FmiError, Kind, ModelDescription, Value, Variable};
use serde_json::{Map, Value as Json, json};
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
}

/// The page, which begins with `scenario`.
///
/// # Errors
/// A setting that neither harvester nor circuit takes; a file that cannot be read; a page that cannot be built.
pub fn page(scenario: &Scenario, options: &package::Options) -> Result<String, ExplorerError> {
    let description = system_description()?;
    let cases = Case::ALL.iter().map(|case| published(&description, case)).collect::<Result<Vec<_>, _>>()?;
    let known = json!({
        "version": env!("CARGO_PKG_VERSION"), "variables": parameters(&description)?, "cases": cases,
        "state": state(&description, scenario)?,
    });
    with_description(&package::explorer(options)?, &videg_report::inert(&known.to_string()))
        .ok_or(ExplorerError::NoPlace)
}

/// The `page` with another description: it has one element for that, which may be empty or of another machine.
fn with_description(page: &str, json: &str) -> Option<String> {
    const BEGIN: &str = "<script type=\"application/json\" id=\"description\">";
    let (head, rest) = page.split_once(BEGIN)?;
    let tail = &rest[rest.find("</script>")?..];
    Some(format!("{head}{BEGIN}{json}{tail}"))
}

/// Parameters of the harvester, then those of the circuit that can be set without an FMU.
fn parameters(description: &ModelDescription) -> Result<Vec<Json>, ExplorerError> {
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

/// A parameter, as the reference lists it; `part` is harvester or circuit.
fn parameter(description: &ModelDescription, variable: &Variable, part: &str) -> Json {
    let items = description.enumeration(variable).map_or(&[][..], |enumeration| &enumeration.items);
    let start = description.start(variable).filter(|start| !matches!(start, Value::String(_)));
    let item = |it: &EnumerationItem| json!({ "name": it.name, "value": it.value, "description": it.description });
    let [min, max] = variable.kind.bounds();
    json!({
        "name": variable.name, "part": part, "kind": variable.kind.name().to_lowercase(),
        "unit": variable.unit().filter(|unit| *unit != "1"), "start": start.map(as_json), "min": min, "max": max,
        "items": items.iter().map(item).collect::<Vec<_>>(),
        "description": variable.description.as_deref().unwrap_or_default(),
    })
}

fn published(description: &ModelDescription, case: &Case) -> Result<Json, ExplorerError> {
    let scenario = Request { case: Some(case.name.to_owned()), ..Request::default() }.resolve()?;
    let settings = scenario.settings.iter().map(|setting| Ok((setting.name.clone(), number(description, setting)?)));
    let settings = settings.collect::<Result<Map<_, _>, ExplorerError>>()?;
    Ok(json!({ "name": case.name, "description": case.description, "source": case.source, "settings": settings }))
}

/// What the page begins with.
fn state(description: &ModelDescription, scenario: &Scenario) -> Result<Json, ExplorerError> {
    let (mut set, mut files) = (Map::new(), Map::new());
    for setting in scenario.changes() {
        let is_file = description.variable(&setting.name).is_ok_and(|it| matches!(it.kind, Kind::String { .. }));
        if !is_file {
            set.insert(setting.name.clone(), number(description, setting)?);
        } else if !setting.value.is_empty() {
            files.insert(setting.name.clone(), file(setting)?);
        }
    }
    let [from, until] = [scenario.window[0], scenario.until];
    Ok(json!({ "case": scenario.case, "set": set, "files": files, "until": until, "from": from, "begin": from }))
}

/// The value of a setting, of the type of its variable.
fn number(description: &ModelDescription, setting: &Setting) -> Result<Json, ExplorerError> {
    let failed = |reason: String| ExplorerError::Setting { place: setting.place(), reason };
    let variable = description.variable(&setting.name).map_err(|error| failed(error.to_string()))?;
    Value::parse(description, variable, &setting.value).map(as_json).map_err(|error| failed(error.to_string()))
}

fn as_json(value: Value) -> Json {
    match value {
        // JSON has no infinity.
        Value::Real(f64::INFINITY) => "Infinity".into(),
        Value::Real(value) => value.into(),
        Value::Integer(value) => value.into(),
        Value::Boolean(on) => on.into(),
        Value::Enumeration { name: text, .. } | Value::String(text) => text.into(),
    }
}

fn file(setting: &Setting) -> Result<Json, ExplorerError> {
    let path = setting.value_for_fmu();
    let failed = |cause| ExplorerError::File { place: setting.place(), path: setting.value.clone(), cause };
    let size = std::fs::metadata(&*path).map_err(failed)?.len();
    if size > LARGEST_FILE {
        return Err(ExplorerError::TooLarge { place: setting.place(), path: setting.value.clone(), size });
    }
    let text = videg_input::read_text(Path::new(&*path)).map_err(failed)?;
    let name =
        Path::new(&setting.value).file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    Ok(json!({ "name": name, "text": text }))
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
        let names: Vec<_> = parameters.iter().map(|it| &it["name"]).collect();
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
        let set = json!({
            "contact.reaction": true, "excitation.seed": 7, "load.resistance": "Infinity", "topology": "isolated",
        });
        let expected = json!({ "case": "fig15", "set": set, "files": {}, "until": 20.0, "from": 10.0, "begin": 10.0 });
        assert_eq!(state, expected);
        let wrong = Setting::parse("topology=star").unwrap();
        let error = number(&system_description().unwrap(), &wrong).map(|_| ()).unwrap_err().to_string();
        assert!(error.contains("--set topology") && error.contains("star"), "{error}");
    }
}
