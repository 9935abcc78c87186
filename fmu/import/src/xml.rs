//! From the text of `modelDescription.xml` to [`ModelDescription`]: first the elements as a tree (`element`), then the values of
//! those that are used; all others are skipped.

use std::borrow::Cow;
use std::collections::HashMap;

use super::description::{
    BaseUnit, Causality, CoSimulation, DefaultExperiment, EnumerationItem, EnumerationType, Initial, Kind,
    ModelDescription, Unit, Variability, Variable,
};
use super::error::FmiError;
use element::{Element, missing, not_allowed};

mod element;
mod types;
mod variable;

/// The error says what is wrong with the description.
type Result<T> = std::result::Result<T, String>;

impl ModelDescription {
    /// Largest document that [`ModelDescription::parse`] takes, in bytes.
    pub const MAX_BYTES: u64 = 32 << 20;

    /// Reads a document. `origin` names it in errors.
    ///
    /// # Errors
    /// When it is too large, not well-formed, of another FMI version, not for co-simulation, lacks something, or has more than a
    /// million elements, 256 attributes of an element or 64 KiB in an attribute.
    pub fn parse(document: &[u8], origin: &str) -> std::result::Result<Self, FmiError> {
        let (found, allowed) = (document.len() as u64, Self::MAX_BYTES);
        let description = if found > allowed { Err(Self::too_large(found, allowed)) } else { read(document) };
        description.map_err(|cause| FmiError::Description { origin: origin.to_owned(), cause })
    }

    pub(super) fn too_large(found: u64, allowed: u64) -> String {
        format!("the model description has {found} bytes, allowed are {allowed}")
    }
}

fn read(document: &[u8]) -> Result<ModelDescription> {
    let document = document.strip_prefix(b"\xef\xbb\xbf").unwrap_or(document);
    let text = decode(document)?;
    let element = Element::parse(&text)?;
    let root = "fmiModelDescription";
    if element.name() != root {
        return Err(format!("the root element is <{}>, allowed is <{root}>", element.name()));
    }
    let fmi_version = element.required(root, "fmiVersion")?;
    let is_3 = fmi_version.starts_with("3.");
    if fmi_version != "2.0" && !is_3 {
        return Err(format!("fmiVersion is \"{fmi_version}\", allowed is \"2.0\" or \"3.0\""));
    }
    let enumerations = types::enumerations(&element)?;
    let variables = variables(&element)?;
    let co_simulation = element.child("CoSimulation")?;
    let co_simulation = co_simulation.ok_or_else(|| missing(root, "CoSimulation element, so it cannot co-simulate"))?;
    Ok(ModelDescription {
        fmi_version,
        model_name: element.required(root, "modelName")?,
        guid: element.required(root, if is_3 { "instantiationToken" } else { "guid" })?,
        description: element.attribute("description")?,
        generation_tool: element.attribute("generationTool")?,
        co_simulation: capabilities(co_simulation)?,
        units: element.list("UnitDefinitions", "Unit")?.map(unit).collect::<Result<_>>()?,
        enumeration_positions: enumerations.iter().enumerate().rev().map(|(k, it)| (it.name.clone(), k)).collect(),
        enumerations,
        log_categories: log_categories(&element)?,
        default_experiment: experiment(&element)?,
        positions: positions(&variables)?,
        outputs: if is_3 { outputs_3(&element, &variables)? } else { outputs(&element, variables.len())? },
        variables,
    })
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
    Err(format!("the model description is not UTF-8 (first bad byte at {})", error.valid_up_to()))
}

fn variables(root: &Element<'_>) -> Result<Vec<Variable>> {
    let types = types::Types::read(root)?;
    let list = root.child("ModelVariables")?.ok_or_else(|| missing("fmiModelDescription", "ModelVariables"))?;
    let is_variable = |it: &&Element<'_>| it.name() == "ScalarVariable" || variable::TYPES_3.contains(&&*it.name());
    let variables = list.all_children().filter(is_variable).enumerate();
    variables.map(|(position, element)| variable::variable(element, position, &types)).collect()
}

fn capabilities(element: &Element<'_>) -> Result<CoSimulation> {
    let place = "CoSimulation";
    let model_identifier = element.required(place, "modelIdentifier")?;
    if !is_identifier(&model_identifier) {
        let allowed = "a C identifier ([A-Za-z_][A-Za-z0-9_]*)";
        return Err(not_allowed(place, "modelIdentifier", &model_identifier, allowed));
    }
    let flag = |name| element.boolean(place, name).map(Option::unwrap_or_default);
    // FMI 3.0 spells three of them in another way.
    let either = |name, name_3| Ok::<_, String>(flag(name)? || flag(name_3)?);
    Ok(CoSimulation {
        model_identifier,
        needs_execution_tool: flag("needsExecutionTool")?,
        can_handle_variable_communication_step_size: flag("canHandleVariableCommunicationStepSize")?,
        can_interpolate_inputs: flag("canInterpolateInputs")?,
        max_output_derivative_order: element.integer(place, "maxOutputDerivativeOrder")?.unwrap_or(0),
        // The standard spells it so.
        can_run_asynchronously: flag("canRunAsynchronuously")?,
        can_be_instantiated_only_once_per_process: flag("canBeInstantiatedOnlyOncePerProcess")?,
        can_not_use_memory_management_functions: flag("canNotUseMemoryManagementFunctions")?,
        can_get_and_set_fmu_state: either("canGetAndSetFMUstate", "canGetAndSetFMUState")?,
        can_serialize_fmu_state: either("canSerializeFMUstate", "canSerializeFMUState")?,
        provides_directional_derivative: either("providesDirectionalDerivative", "providesDirectionalDerivatives")?,
    })
}

/// Whether a name is safe as a part of a file name and of C symbols.
fn is_identifier(name: &str) -> bool {
    name.starts_with(|first: char| first.is_ascii_alphabetic() || first == '_')
        && name.chars().all(|char| char.is_ascii_alphanumeric() || char == '_')
}

fn unit(element: &Element<'_>) -> Result<Unit> {
    let name = element.required("Unit", "name")?;
    let Some(base) = element.child("BaseUnit")? else { return Ok(Unit { name, base: None }) };
    let place = format!("unit \"{name}\"");
    let mut exponents = [0; 8];
    for (exponent, symbol) in exponents.iter_mut().zip(["kg", "m", "s", "A", "K", "mol", "cd", "rad"]) {
        *exponent = base.integer(&place, symbol)?.unwrap_or(0);
    }
    let factor = base.real(&place, "factor")?.unwrap_or(1.0);
    let offset = base.real(&place, "offset")?.unwrap_or(0.0);
    Ok(Unit { name, base: Some(BaseUnit { exponents, factor, offset }) })
}

fn log_categories(root: &Element<'_>) -> Result<Vec<String>> {
    root.list("LogCategories", "Category")?.filter_map(|category| category.attribute("name").transpose()).collect()
}

fn experiment(root: &Element<'_>) -> Result<DefaultExperiment> {
    let Some(element) = root.child("DefaultExperiment")? else { return Ok(DefaultExperiment::default()) };
    let read = |name| element.real("DefaultExperiment", name);
    Ok(DefaultExperiment {
        start_time: read("startTime")?,
        stop_time: read("stopTime")?,
        tolerance: read("tolerance")?,
        step_size: read("stepSize")?,
    })
}

fn positions(variables: &[Variable]) -> Result<HashMap<String, usize>> {
    let mut positions = HashMap::with_capacity(variables.len());
    for (position, variable) in variables.iter().enumerate() {
        if positions.insert(variable.name.clone(), position).is_some() {
            return Err(format!("two variables are named \"{}\"", variable.name));
        }
    }
    Ok(positions)
}

/// Positions of the outputs; `index` counts from 1.
fn outputs(root: &Element<'_>, count: usize) -> Result<Vec<usize>> {
    let place = "ModelStructure/Outputs/Unknown";
    let Some(structure) = root.child("ModelStructure")? else { return Ok(Vec::new()) };
    let position = |unknown: &Element<'_>| {
        let index: usize = unknown.integer(place, "index")?.ok_or_else(|| missing(place, "index"))?;
        let position = index.checked_sub(1).filter(|position| *position < count);
        position.ok_or_else(|| not_allowed(place, "index", &index.to_string(), &format!("1 .. {count}")))
    };
    structure.list("Outputs", "Unknown")?.map(position).collect()
}

/// The same of FMI 3.0, whose structure names value references.
fn outputs_3(root: &Element<'_>, variables: &[Variable]) -> Result<Vec<usize>> {
    let place = "ModelStructure/Output";
    let positions: HashMap<u32, usize> = variables.iter().enumerate().map(|(k, it)| (it.value_reference, k)).collect();
    let position = |output: &Element<'_>| {
        let reference: u32 =
            output.integer(place, "valueReference")?.ok_or_else(|| missing(place, "valueReference"))?;
        let allowed = || not_allowed(place, "valueReference", &reference.to_string(), "that of a variable");
        positions.get(&reference).copied().ok_or_else(allowed)
    };
    root.list("ModelStructure", "Output")?.map(position).collect()
}
