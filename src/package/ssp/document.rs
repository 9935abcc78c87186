//! The documents of SSP 1.0, as far as they are needed here. The names of the structures are those of its schemas; Ecos reads
//! only documents with these very prefixes.

use serde::Serialize;

use super::annotation::Annotations;

const COMMON: &str = "http://ssp-standard.org/SSP1/SystemStructureCommon";
const STRUCTURE: &str = "http://ssp-standard.org/SSP1/SystemStructureDescription";
const VALUES: &str = "http://ssp-standard.org/SSP1/SystemStructureParameterValues";

#[derive(Serialize)]
#[serde(rename = "ssd:SystemStructureDescription")]
pub(super) struct SystemStructureDescription {
    #[serde(rename = "@xmlns:ssc")]
    common: &'static str,
    #[serde(rename = "@xmlns:ssd")]
    structure: &'static str,
    #[serde(rename = "@version")]
    version: &'static str,
    #[serde(rename = "@name")]
    name: &'static str,
    #[serde(rename = "@description")]
    description: String,
    #[serde(rename = "@license")]
    license: &'static str,
    #[serde(rename = "@generationTool")]
    generation_tool: &'static str,
    #[serde(rename = "ssd:System")]
    system: System,
    #[serde(rename = "ssd:Units")]
    units: Units,
    #[serde(rename = "ssd:DefaultExperiment")]
    default_experiment: DefaultExperiment,
}

impl SystemStructureDescription {
    pub(super) fn new(
        name: &'static str,
        description: String,
        (components, connections): (Vec<Component>, Vec<Connection>),
        units: Vec<Unit>,
        (step, stop_time): (f64, f64),
    ) -> Self {
        let system = System {
            name,
            elements: Elements { components },
            connections: Connections { connections },
            annotations: Annotations::new(step),
        };
        Self {
            common: COMMON,
            structure: STRUCTURE,
            version: "1.0",
            name,
            description,
            license: "MIT OR Apache-2.0",
            generation_tool: concat!("videg ", env!("CARGO_PKG_VERSION")),
            system,
            units: Units { units },
            default_experiment: DefaultExperiment { start_time: number(0.0), stop_time: number(stop_time) },
        }
    }
}

#[derive(Serialize)]
struct System {
    #[serde(rename = "@name")]
    name: &'static str,
    #[serde(rename = "ssd:Elements")]
    elements: Elements,
    #[serde(rename = "ssd:Connections")]
    connections: Connections,
    #[serde(rename = "ssd:Annotations")]
    annotations: Annotations,
}

#[derive(Serialize)]
struct Elements {
    #[serde(rename = "ssd:Component")]
    components: Vec<Component>,
}

#[derive(Serialize)]
struct Connections {
    #[serde(rename = "ssd:Connection")]
    connections: Vec<Connection>,
}

/// An FMU and where its parameters stand.
#[derive(Serialize)]
pub(super) struct Component {
    #[serde(rename = "@name")]
    pub name: &'static str,
    #[serde(rename = "@type")]
    kind: &'static str,
    #[serde(rename = "@source")]
    source: String,
    #[serde(rename = "@implementation")]
    implementation: &'static str,
    #[serde(rename = "ssd:Connectors")]
    connectors: Connectors,
    #[serde(rename = "ssd:ParameterBindings")]
    bindings: ParameterBindings,
}

impl Component {
    pub(super) fn new(name: &'static str, source: String, connectors: Vec<Connector>, parameters: String) -> Self {
        Self {
            name,
            kind: "application/x-fmu-sharedlibrary",
            source,
            implementation: "CoSimulation",
            connectors: Connectors { connectors },
            bindings: ParameterBindings { binding: ParameterBinding { source: parameters } },
        }
    }
}

#[derive(Serialize)]
struct Connectors {
    #[serde(rename = "ssd:Connector")]
    connectors: Vec<Connector>,
}

/// A Real variable that others may be connected with.
#[derive(Serialize)]
pub(super) struct Connector {
    #[serde(rename = "@name")]
    pub name: String,
    #[serde(rename = "@kind")]
    pub kind: &'static str,
    #[serde(rename = "ssc:Real")]
    pub real: Real,
}

#[derive(Serialize)]
pub(super) struct Real {
    #[serde(rename = "@unit", skip_serializing_if = "Option::is_none")]
    pub unit: Option<String>,
}

#[derive(Serialize)]
struct ParameterBindings {
    #[serde(rename = "ssd:ParameterBinding")]
    binding: ParameterBinding,
}

#[derive(Serialize)]
struct ParameterBinding {
    #[serde(rename = "@source")]
    source: String,
}

#[derive(Serialize)]
pub(super) struct Connection {
    #[serde(rename = "@startElement")]
    pub start_element: &'static str,
    #[serde(rename = "@startConnector")]
    pub start_connector: &'static str,
    #[serde(rename = "@endElement")]
    pub end_element: &'static str,
    #[serde(rename = "@endConnector")]
    pub end_connector: &'static str,
}

#[derive(Serialize)]
struct DefaultExperiment {
    #[serde(rename = "@startTime")]
    start_time: String,
    #[serde(rename = "@stopTime")]
    stop_time: String,
}

#[derive(Serialize)]
struct Units {
    #[serde(rename = "ssc:Unit")]
    units: Vec<Unit>,
}

/// A unit in SI base units.
#[derive(Serialize, Clone, PartialEq)]
pub(super) struct Unit {
    #[serde(rename = "@name")]
    pub name: String,
    #[serde(rename = "ssc:BaseUnit")]
    pub base: BaseUnit,
}

#[derive(Serialize, Clone, PartialEq)]
pub(super) struct BaseUnit {
    #[serde(rename = "@kg")]
    kg: i32,
    #[serde(rename = "@m")]
    m: i32,
    #[serde(rename = "@s")]
    s: i32,
    #[serde(rename = "@A")]
    ampere: i32,
    #[serde(rename = "@K")]
    kelvin: i32,
    #[serde(rename = "@mol")]
    mol: i32,
    #[serde(rename = "@cd")]
    cd: i32,
    #[serde(rename = "@rad")]
    rad: i32,
    #[serde(rename = "@factor")]
    factor: String,
    #[serde(rename = "@offset")]
    offset: String,
}

impl BaseUnit {
    pub(super) fn new(unit: &fmu_import::BaseUnit) -> Self {
        let [kg, m, s, ampere, kelvin, mol, cd, rad] = unit.exponents;
        let (factor, offset) = (number(unit.factor), number(unit.offset));
        Self { kg, m, s, ampere, kelvin, mol, cd, rad, factor, offset }
    }
}

/// A file of parameter values.
#[derive(Serialize)]
#[serde(rename = "ssv:ParameterSet")]
pub(super) struct ParameterSet {
    #[serde(rename = "@xmlns:ssc")]
    common: &'static str,
    #[serde(rename = "@xmlns:ssv")]
    values: &'static str,
    #[serde(rename = "@version")]
    version: &'static str,
    #[serde(rename = "@name")]
    name: String,
    #[serde(rename = "ssv:Parameters")]
    parameters: Parameters,
}

impl ParameterSet {
    pub(super) fn new(name: &str, parameters: Vec<Parameter>) -> Self {
        let parameters = Parameters { parameters };
        Self { common: COMMON, values: VALUES, version: "1.0", name: name.to_owned(), parameters }
    }
}

#[derive(Serialize)]
struct Parameters {
    #[serde(rename = "ssv:Parameter")]
    parameters: Vec<Parameter>,
}

#[derive(Serialize, Clone)]
pub(super) struct Parameter {
    #[serde(rename = "@name")]
    pub name: String,
    #[serde(rename = "$value")]
    pub value: Value,
}

#[derive(Serialize, Clone)]
pub(super) enum Value {
    #[serde(rename = "ssv:Real")]
    Real(Text),
    #[serde(rename = "ssv:Integer")]
    Integer(Text),
    #[serde(rename = "ssv:Boolean")]
    Boolean(Text),
    #[serde(rename = "ssv:String")]
    String(Text),
    #[serde(rename = "ssv:Enumeration")]
    Enumeration(Text),
}

#[derive(Serialize, Clone)]
pub(super) struct Text {
    #[serde(rename = "@value")]
    value: String,
}

impl Value {
    pub(super) fn new(value: &fmu_import::Value) -> Self {
        use fmu_import::Value as Fmi;
        let text = |value: String| Text { value };
        match value {
            Fmi::Real(value) => Self::Real(text(number(*value))),
            Fmi::Integer(value) => Self::Integer(text(value.to_string())),
            Fmi::Boolean(value) => Self::Boolean(text(value.to_string())),
            Fmi::String(value) => Self::String(text(value.clone())),
            Fmi::Enumeration { name, .. } => Self::Enumeration(text(name.clone())),
        }
    }
}

/// A number as XML Schema spells it; reading it gives the same bits.
pub(super) fn number(value: f64) -> String {
    match value {
        f64::INFINITY => "INF".to_owned(),
        f64::NEG_INFINITY => "-INF".to_owned(),
        _ => format!("{value:?}"),
    }
}
