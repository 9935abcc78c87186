//! The system package: both FMUs, their connections and their parameters in one archive, after SSP 1.0.

mod annotation;
mod document;

use std::path::Path;

use serde::Serialize;

use self::document::{
    BaseUnit, Component, Connection, Connector, Parameter, ParameterSet, Real, SystemStructureDescription, Unit,
};
use super::entries::Entries;
use super::error::{PackageError, Result};
use crate::scenario::Setting;
use fmu_import::{Causality, Kind, ModelDescription, Value, Variable};

/// Names of the components.
const HARVESTER: &str = "harvester";
const CIRCUIT: &str = "circuit";

/// The connections: from, to, and the variable that both call the same.
const CONNECTIONS: [(&str, &str, &str); 4] = [
    (HARVESTER, CIRCUIT, "left.capacitance"),
    (HARVESTER, CIRCUIT, "right.capacitance"),
    (CIRCUIT, HARVESTER, "left.voltage"),
    (CIRCUIT, HARVESTER, "right.voltage"),
];

/// Communication step, s, if the harvester proposes none.
const STEP: f64 = 1e-3;

/// An FMU in the package.
#[derive(Debug, Clone, Copy)]
pub struct Part<'a> {
    /// The archive.
    pub fmu: &'a Path,
    /// What is in it.
    pub description: &'a ModelDescription,
    /// What to set, the last of a name wins. Start values are left out.
    pub settings: &'a [Setting],
}

/// What is packaged.
#[derive(Debug, Clone, Copy)]
pub struct SystemPackage<'a> {
    /// Name of the parameter values.
    pub case: &'a str,
    /// One line on what it shows.
    pub description: &'a str,
    /// End of the proposed experiment, s.
    pub until: f64,
    /// The harvester.
    pub harvester: Part<'a>,
    /// The circuit.
    pub circuit: Part<'a>,
}

impl SystemPackage<'_> {
    /// Writes the archive; returns the names of the parameters that it sets, as `component.name`.
    ///
    /// # Errors
    /// A setting that an FMU cannot take, or files that cannot be read or written.
    pub fn write(&self, archive: &Path) -> Result<Vec<String>> {
        let mut entries = Entries::default();
        let mut all = Vec::new();
        let mut components = Vec::new();
        for (name, part) in [(HARVESTER, &self.harvester), (CIRCUIT, &self.circuit)] {
            let parameters = part.parameters()?;
            let qualified = |it: &Parameter| Parameter { name: format!("{name}.{}", it.name), value: it.value.clone() };
            all.extend(parameters.iter().map(qualified));
            let fmu = format!("resources/{}.fmu", part.description.co_simulation.model_identifier);
            let values = format!("resources/{name}.ssv");
            entries.add_bytes(&values, xml("the parameter values", &ParameterSet::new(self.case, parameters))?);
            entries.add_file(&fmu, part.fmu);
            components.push(Component::new(name, fmu, part.connectors(), values));
        }
        let set: Vec<_> = all.iter().map(|parameter| parameter.name.clone()).collect();
        // The same once more under full names, for tools that do not follow the bindings of components.
        entries.add_bytes("resources/system.ssv", xml("the parameter values", &ParameterSet::new(self.case, all))?);
        let description = format!("Vibro-impact harvester and its circuit. {}", self.description);
        let parts = (components, connections());
        let step = self.harvester.description.default_experiment.step_size.unwrap_or(STEP);
        let times = (step, self.until);
        let structure = SystemStructureDescription::new("Harvester", description, parts, self.units(), times);
        entries.add_bytes("SystemStructure.ssd", xml("SystemStructure.ssd", &structure)?);
        entries.write(archive)?;
        Ok(set)
    }

    /// The units of both FMUs, each once.
    fn units(&self) -> Vec<Unit> {
        let mut units: Vec<Unit> = Vec::new();
        for unit in [self.harvester, self.circuit].iter().flat_map(|part| &part.description.units) {
            if let Some(base) = &unit.base
                && units.iter().all(|known| known.name != unit.name)
            {
                units.push(Unit { name: unit.name.clone(), base: BaseUnit::new(base) });
            }
        }
        units
    }
}

impl Part<'_> {
    /// What differs from the start values, in the order of the model description.
    fn parameters(&self) -> Result<Vec<Parameter>> {
        for setting in self.settings {
            self.description.variable(&setting.name)?;
        }
        let mut parameters = Vec::new();
        for variable in &self.description.variables {
            let Some(setting) = self.settings.iter().rfind(|setting| setting.name == variable.name) else { continue };
            let value = Value::parse(self.description, variable, &setting.value).map_err(fmu_import::FmiError::from)?;
            if !is_start(variable, &value) {
                parameters.push(Parameter { name: variable.name.clone(), value: document::Value::new(&value) });
            }
        }
        Ok(parameters)
    }

    /// All Real outputs, and the inputs that are connected.
    fn connectors(&self) -> Vec<Connector> {
        let kind = |variable: &Variable| match (&variable.kind, variable.causality) {
            (Kind::Real { .. }, Causality::Output) => Some("output"),
            (Kind::Real { .. }, Causality::Input) => {
                CONNECTIONS.iter().any(|(_, _, name)| *name == variable.name).then_some("input")
            }
            _ => None,
        };
        let connector = |variable: &Variable| {
            let real = Real { unit: variable.unit().map(str::to_owned) };
            kind(variable).map(|kind| Connector { name: variable.name.clone(), kind, real })
        };
        self.description.variables.iter().filter_map(connector).collect()
    }
}

fn connections() -> Vec<Connection> {
    let connection = |(from, to, name)| Connection {
        start_element: from,
        start_connector: name,
        end_element: to,
        end_connector: name,
    };
    CONNECTIONS.into_iter().map(connection).collect()
}

fn is_start(variable: &Variable, value: &Value) -> bool {
    match (&variable.kind, value) {
        (Kind::Real { start, .. }, Value::Real(value)) => *start == Some(*value),
        (Kind::Integer { start, .. }, Value::Integer(value))
        | (Kind::Enumeration { start }, Value::Enumeration { value, .. }) => *start == Some(*value),
        (Kind::Boolean { start }, Value::Boolean(value)) => *start == Some(*value),
        (Kind::String { start }, Value::String(value)) => start.as_ref() == Some(value),
        _ => false,
    }
}

fn xml(name: &'static str, document: &impl Serialize) -> Result<Vec<u8>> {
    let mut text = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
    let mut serializer = quick_xml::se::Serializer::new(&mut text);
    serializer.indent(' ', 2);
    document.serialize(serializer).map_err(|cause| PackageError::Xml { document: name, cause })?;
    text.push('\n');
    Ok(text.into_bytes())
}
