//! The elements of `modelDescription.xml` as they stand: every attribute an optional string, unknown ones skipped.
//!
//! What few elements have is boxed: an element of a few letters must not take much more memory than text.

use serde::Deserialize;

#[derive(Debug, Deserialize)]
#[allow(clippy::struct_field_names)] // the names of the attributes
pub(super) struct Description {
    #[serde(rename = "@modelName")]
    pub model_name: Option<String>,
    #[serde(rename = "@guid")]
    pub guid: Option<String>,
    #[serde(rename = "@description")]
    pub description: Option<String>,
    #[serde(rename = "@generationTool")]
    pub generation_tool: Option<String>,
    #[serde(rename = "CoSimulation")]
    pub co_simulation: Option<CoSimulation>,
    #[serde(rename = "UnitDefinitions")]
    pub unit_definitions: Option<UnitDefinitions>,
    #[serde(rename = "TypeDefinitions")]
    pub type_definitions: Option<TypeDefinitions>,
    #[serde(rename = "LogCategories")]
    pub log_categories: Option<LogCategories>,
    #[serde(rename = "DefaultExperiment")]
    pub default_experiment: Option<DefaultExperiment>,
    #[serde(rename = "ModelVariables")]
    pub model_variables: Option<ModelVariables>,
    #[serde(rename = "ModelStructure")]
    pub model_structure: Option<ModelStructure>,
}

#[derive(Debug, Deserialize)]
pub(super) struct CoSimulation {
    #[serde(rename = "@modelIdentifier")]
    pub model_identifier: Option<String>,
    #[serde(rename = "@needsExecutionTool")]
    pub needs_execution_tool: Option<String>,
    #[serde(rename = "@canHandleVariableCommunicationStepSize")]
    pub can_handle_variable_communication_step_size: Option<String>,
    #[serde(rename = "@canInterpolateInputs")]
    pub can_interpolate_inputs: Option<String>,
    #[serde(rename = "@maxOutputDerivativeOrder")]
    pub max_output_derivative_order: Option<String>,
    // The standard spells it so.
    #[serde(rename = "@canRunAsynchronuously")]
    pub can_run_asynchronously: Option<String>,
    #[serde(rename = "@canBeInstantiatedOnlyOncePerProcess")]
    pub can_be_instantiated_only_once_per_process: Option<String>,
    #[serde(rename = "@canNotUseMemoryManagementFunctions")]
    pub can_not_use_memory_management_functions: Option<String>,
    #[serde(rename = "@canGetAndSetFMUstate")]
    pub can_get_and_set_fmu_state: Option<String>,
    #[serde(rename = "@canSerializeFMUstate")]
    pub can_serialize_fmu_state: Option<String>,
    #[serde(rename = "@providesDirectionalDerivative")]
    pub provides_directional_derivative: Option<String>,
}

#[derive(Debug, Default, Deserialize)]
pub(super) struct UnitDefinitions {
    #[serde(rename = "Unit", default)]
    pub units: Vec<Unit>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Unit {
    #[serde(rename = "@name")]
    pub name: Option<String>,
    #[serde(rename = "BaseUnit")]
    pub base: Option<Box<BaseUnit>>,
}

#[derive(Debug, Deserialize)]
pub(super) struct BaseUnit {
    #[serde(rename = "@kg")]
    pub kg: Option<String>,
    #[serde(rename = "@m")]
    pub m: Option<String>,
    #[serde(rename = "@s")]
    pub s: Option<String>,
    #[serde(rename = "@A")]
    pub a: Option<String>,
    #[serde(rename = "@K")]
    pub k: Option<String>,
    #[serde(rename = "@mol")]
    pub mol: Option<String>,
    #[serde(rename = "@cd")]
    pub cd: Option<String>,
    #[serde(rename = "@rad")]
    pub rad: Option<String>,
    #[serde(rename = "@factor")]
    pub factor: Option<String>,
    #[serde(rename = "@offset")]
    pub offset: Option<String>,
}

#[derive(Debug, Default, Deserialize)]
pub(super) struct TypeDefinitions {
    #[serde(rename = "SimpleType", default)]
    pub types: Vec<SimpleType>,
}

#[derive(Debug, Deserialize)]
pub(super) struct SimpleType {
    #[serde(rename = "@name")]
    pub name: Option<String>,
    #[serde(rename = "Real")]
    pub real: Option<Box<Attributes>>,
    #[serde(rename = "Integer")]
    pub integer: Option<Box<Attributes>>,
    #[serde(rename = "Enumeration")]
    pub enumeration: Option<Items>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Items {
    #[serde(rename = "Item", default)]
    pub items: Vec<Item>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Item {
    #[serde(rename = "@name")]
    pub name: Option<String>,
    #[serde(rename = "@value")]
    pub value: Option<String>,
    #[serde(rename = "@description")]
    pub description: Option<String>,
}

#[derive(Debug, Default, Deserialize)]
pub(super) struct LogCategories {
    #[serde(rename = "Category", default)]
    pub categories: Vec<Category>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Category {
    #[serde(rename = "@name")]
    pub name: Option<String>,
}

#[derive(Debug, Default, Deserialize)]
pub(super) struct DefaultExperiment {
    #[serde(rename = "@startTime")]
    pub start_time: Option<String>,
    #[serde(rename = "@stopTime")]
    pub stop_time: Option<String>,
    #[serde(rename = "@tolerance")]
    pub tolerance: Option<String>,
    #[serde(rename = "@stepSize")]
    pub step_size: Option<String>,
}

#[derive(Debug, Deserialize)]
pub(super) struct ModelVariables {
    #[serde(rename = "ScalarVariable", default)]
    pub variables: Vec<ScalarVariable>,
}

#[derive(Debug, Deserialize)]
pub(super) struct ScalarVariable {
    #[serde(rename = "@name")]
    pub name: Option<String>,
    #[serde(rename = "@valueReference")]
    pub value_reference: Option<String>,
    #[serde(rename = "@description")]
    pub description: Option<String>,
    #[serde(rename = "@causality")]
    pub causality: Option<String>,
    #[serde(rename = "@variability")]
    pub variability: Option<String>,
    #[serde(rename = "@initial")]
    pub initial: Option<String>,
    #[serde(rename = "Real")]
    pub real: Option<Box<Attributes>>,
    #[serde(rename = "Integer")]
    pub integer: Option<Box<Attributes>>,
    #[serde(rename = "Boolean")]
    pub boolean: Option<Box<Attributes>>,
    #[serde(rename = "String")]
    pub string: Option<Box<Attributes>>,
    #[serde(rename = "Enumeration")]
    pub enumeration: Option<Box<Attributes>>,
}

/// Attributes of the type elements, of variables and of type definitions alike.
#[derive(Debug, Default, Deserialize)]
pub(super) struct Attributes {
    #[serde(rename = "@declaredType")]
    pub declared_type: Option<String>,
    #[serde(rename = "@unit")]
    pub unit: Option<String>,
    #[serde(rename = "@min")]
    pub min: Option<String>,
    #[serde(rename = "@max")]
    pub max: Option<String>,
    #[serde(rename = "@start")]
    pub start: Option<String>,
}

#[derive(Debug, Default, Deserialize)]
pub(super) struct ModelStructure {
    #[serde(rename = "Outputs")]
    pub outputs: Option<Outputs>,
}

#[derive(Debug, Default, Deserialize)]
pub(super) struct Outputs {
    #[serde(rename = "Unknown", default)]
    pub unknowns: Vec<Unknown>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Unknown {
    #[serde(rename = "@index")]
    pub index: Option<String>,
}
