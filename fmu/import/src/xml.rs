//! From the text of `modelDescription.xml` to [`ModelDescription`].
//!
//! Two passes: the first (`vet`) walks the events and refuses what must never be interpreted; the second reads the
//! elements that are used and skips all others.

use std::borrow::Cow;
use std::collections::HashMap;
use std::str::FromStr;

use super::description::{
    BaseUnit, Causality, CoSimulation, DefaultExperiment, EnumerationItem, EnumerationType, Initial, Kind,
    ModelDescription, Unit, Variability, Variable,
};
use super::error::DescriptionError as Error;

mod raw;
mod types;
mod variable;
mod vet;

type Result<T> = std::result::Result<T, Error>;

pub(super) fn read(document: &[u8]) -> Result<ModelDescription> {
    let document = document.strip_prefix(b"\xef\xbb\xbf").unwrap_or(document);
    let text = decode(document)?;
    vet::vet(&text)?;
    let raw: raw::Description =
        quick_xml::de::from_str(&text).map_err(|error| Error::Content { cause: error.to_string() })?;
    convert(raw)
}

/// The text of a document in UTF-8, or in the ISO-8859-1 that some old exporters write and declare.
fn decode(document: &[u8]) -> Result<Cow<'_, str>> {
    let error = match std::str::from_utf8(document) {
        Ok(text) => return Ok(text.into()),
        Err(error) => error,
    };
    let declaration = document.split(|&byte| byte == b'>').next().unwrap_or_default().to_ascii_lowercase();
    let latin1 = b"iso-8859-1";
    if declaration.starts_with(b"<?xml") && declaration.windows(latin1.len()).any(|window| window == latin1) {
        return Ok(document.iter().map(|&byte| char::from(byte)).collect::<String>().into());
    }
    Err(Error::Encoding { position: error.valid_up_to() })
}

/// Second pass: from strings to values.
fn convert(raw: raw::Description) -> Result<ModelDescription> {
    let root = "fmiModelDescription";
    let types = raw.type_definitions.unwrap_or_default().types;
    let enumerations = types.iter().filter_map(enumeration).collect::<Result<Vec<_>>>()?;
    let variables = raw.model_variables.ok_or_else(|| missing(root, "ModelVariables"))?.variables;
    let types = types::Types::of(types)?;
    let variables = variables
        .into_iter()
        .enumerate()
        .map(|(position, raw)| variable::convert(raw, position, &types))
        .collect::<Result<Vec<_>>>()?;
    let co_simulation =
        raw.co_simulation.ok_or_else(|| missing(root, "CoSimulation element, so it cannot co-simulate"))?;
    Ok(ModelDescription {
        fmi_version: "2.0".to_owned(),
        model_name: raw.model_name.ok_or_else(|| missing(root, "modelName"))?,
        guid: raw.guid.ok_or_else(|| missing(root, "guid"))?,
        description: raw.description,
        generation_tool: raw.generation_tool,
        co_simulation: capabilities(co_simulation)?,
        units: raw.unit_definitions.unwrap_or_default().units.into_iter().map(unit).collect::<Result<_>>()?,
        enumeration_positions: enumerations.iter().enumerate().rev().map(|(k, it)| (it.name.clone(), k)).collect(),
        enumerations,
        log_categories: raw
            .log_categories
            .unwrap_or_default()
            .categories
            .into_iter()
            .filter_map(|it| it.name)
            .collect(),
        default_experiment: experiment(raw.default_experiment.unwrap_or_default())?,
        positions: positions(&variables)?,
        outputs: outputs(raw.model_structure.unwrap_or_default(), variables.len())?,
        variables,
    })
}

fn capabilities(raw: raw::CoSimulation) -> Result<CoSimulation> {
    let place = "CoSimulation";
    let model_identifier = raw.model_identifier.ok_or_else(|| missing(place, "modelIdentifier"))?;
    if !is_identifier(&model_identifier) {
        let allowed = "a C identifier ([A-Za-z_][A-Za-z0-9_]*)".to_owned();
        return Err(attribute(place, "modelIdentifier", &model_identifier, allowed));
    }
    let flag = |name, value: Option<String>| value.map_or(Ok(false), |text| boolean(place, name, &text));
    let order =
        optional(raw.max_output_derivative_order.as_deref(), |text| integer(place, "maxOutputDerivativeOrder", text))?;
    Ok(CoSimulation {
        model_identifier,
        needs_execution_tool: flag("needsExecutionTool", raw.needs_execution_tool)?,
        can_handle_variable_communication_step_size: flag(
            "canHandleVariableCommunicationStepSize",
            raw.can_handle_variable_communication_step_size,
        )?,
        can_interpolate_inputs: flag("canInterpolateInputs", raw.can_interpolate_inputs)?,
        max_output_derivative_order: order.unwrap_or(0),
        can_run_asynchronously: flag("canRunAsynchronuously", raw.can_run_asynchronously)?,
        can_be_instantiated_only_once_per_process: flag(
            "canBeInstantiatedOnlyOncePerProcess",
            raw.can_be_instantiated_only_once_per_process,
        )?,
        can_not_use_memory_management_functions: flag(
            "canNotUseMemoryManagementFunctions",
            raw.can_not_use_memory_management_functions,
        )?,
        can_get_and_set_fmu_state: flag("canGetAndSetFMUstate", raw.can_get_and_set_fmu_state)?,
        can_serialize_fmu_state: flag("canSerializeFMUstate", raw.can_serialize_fmu_state)?,
        provides_directional_derivative: flag("providesDirectionalDerivative", raw.provides_directional_derivative)?,
    })
}

/// Whether a name is safe as a part of a file name and of C symbols.
fn is_identifier(name: &str) -> bool {
    name.starts_with(|first: char| first.is_ascii_alphabetic() || first == '_')
        && name.chars().all(|char| char.is_ascii_alphanumeric() || char == '_')
}

fn unit(raw: raw::Unit) -> Result<Unit> {
    let name = raw.name.ok_or_else(|| missing("Unit", "name"))?;
    let Some(base) = raw.base else { return Ok(Unit { name, base: None }) };
    let place = format!("unit \"{name}\"");
    let mut exponents = [0; 8];
    let fields = [
        ("kg", base.kg),
        ("m", base.m),
        ("s", base.s),
        ("A", base.a),
        ("K", base.k),
        ("mol", base.mol),
        ("cd", base.cd),
        ("rad", base.rad),
    ];
    for (exponent, (attribute, text)) in exponents.iter_mut().zip(fields) {
        *exponent = optional(text.as_deref(), |text| integer(&place, attribute, text))?.unwrap_or(0);
    }
    let factor = optional(base.factor.as_deref(), |text| real(&place, "factor", text))?.unwrap_or(1.0);
    let offset = optional(base.offset.as_deref(), |text| real(&place, "offset", text))?.unwrap_or(0.0);
    Ok(Unit { name, base: Some(BaseUnit { exponents, factor, offset }) })
}

/// The enumeration type behind a type definition, if it is one.
fn enumeration(raw: &raw::SimpleType) -> Option<Result<EnumerationType>> {
    let items = &raw.enumeration.as_ref()?.items;
    let read = || {
        let name = raw.name.clone().ok_or_else(|| missing("SimpleType", "name"))?;
        let place = format!("enumeration \"{name}\"");
        let items = items.iter().map(|item| enumeration_item(item, &place)).collect::<Result<Vec<_>>>()?;
        Ok(EnumerationType { name, items })
    };
    Some(read())
}

fn enumeration_item(raw: &raw::Item, place: &str) -> Result<EnumerationItem> {
    let value = raw.value.as_deref().ok_or_else(|| missing(place, "value in an Item"))?;
    Ok(EnumerationItem {
        name: types::shared(place, "name", raw.name.clone().ok_or_else(|| missing(place, "name in an Item"))?)?,
        value: integer(place, "value", value)?,
        description: raw.description.clone(),
    })
}

fn experiment(raw: raw::DefaultExperiment) -> Result<DefaultExperiment> {
    let read = |name, value: Option<String>| optional(value.as_deref(), |text| real("DefaultExperiment", name, text));
    Ok(DefaultExperiment {
        start_time: read("startTime", raw.start_time)?,
        stop_time: read("stopTime", raw.stop_time)?,
        tolerance: read("tolerance", raw.tolerance)?,
        step_size: read("stepSize", raw.step_size)?,
    })
}

fn positions(variables: &[Variable]) -> Result<HashMap<String, usize>> {
    let mut positions = HashMap::with_capacity(variables.len());
    for (position, variable) in variables.iter().enumerate() {
        if positions.insert(variable.name.clone(), position).is_some() {
            return Err(Error::Duplicate { name: variable.name.clone() });
        }
    }
    Ok(positions)
}

/// `index` counts from 1.
fn outputs(raw: raw::ModelStructure, count: usize) -> Result<Vec<usize>> {
    let place = "ModelStructure/Outputs/Unknown";
    let position = |unknown: raw::Unknown| {
        let text = unknown.index.ok_or_else(|| missing(place, "index"))?;
        let index: usize = integer(place, "index", &text)?;
        let position = index.checked_sub(1).filter(|position| *position < count);
        position.ok_or_else(|| attribute(place, "index", &text, format!("1 .. {count}")))
    };
    raw.outputs.unwrap_or_default().unknowns.into_iter().map(position).collect()
}

fn optional<T>(text: Option<&str>, read: impl FnOnce(&str) -> Result<T>) -> Result<Option<T>> {
    text.map(read).transpose()
}

fn missing(place: &str, what: &'static str) -> Error {
    Error::Missing { place: place.to_owned(), what }
}

fn attribute(place: &str, attribute: &'static str, found: &str, allowed: String) -> Error {
    Error::Attribute { place: place.to_owned(), attribute, found: found.to_owned(), allowed }
}

fn real(place: &str, name: &'static str, text: &str) -> Result<f64> {
    text.trim().parse().map_err(|_| attribute(place, name, text, "a number".to_owned()))
}

fn integer<T: FromStr>(place: &str, name: &'static str, text: &str) -> Result<T> {
    text.trim().parse().map_err(|_| attribute(place, name, text, "an integer of the attribute's range".to_owned()))
}

fn boolean(place: &str, name: &'static str, text: &str) -> Result<bool> {
    match text.trim() {
        "true" | "1" => Ok(true),
        "false" | "0" => Ok(false),
        _ => Err(attribute(place, name, text, "true or false".to_owned())),
    }
}
