//! The system package: both FMUs, their connections and their parameters in one archive, after SSP 1.0.
//!
//! Its documents are templates (`ssp/`). Ecos reads only documents with these very prefixes of the namespaces.

use std::path::{Path, PathBuf};
use std::{fmt, io};

use askama::Template;
use askama::filters::Escaper;

use fmu_package::Entries;

use super::error::{PackageError, Result};
use crate::scenario::Setting;
use fmu_import::{BaseUnit, Causality, Kind, ModelDescription, Value, Variable};

/// Names of the components.
const HARVESTER: &str = "harvester";
const CIRCUIT: &str = "circuit";

/// The connections: from, to, and the name that the variable has in both.
const CONNECTIONS: [(&str, &str, &str); 4] = [
    (HARVESTER, CIRCUIT, "left.capacitance"),
    (HARVESTER, CIRCUIT, "right.capacitance"),
    (CIRCUIT, HARVESTER, "left.voltage"),
    (CIRCUIT, HARVESTER, "right.voltage"),
];

/// Communication step, s, if the harvester proposes none.
const STEP: f64 = 1e-3;

const VERSION: &str = env!("CARGO_PKG_VERSION");

/// An FMU in the package.
#[derive(Debug, Clone, Copy)]
pub struct Part<'a> {
    /// The archive.
    pub fmu: &'a Path,
    /// Its model description.
    pub description: &'a ModelDescription,
    /// What to set, the last of a name wins. Start values are left out.
    pub settings: &'a [Setting],
    /// Files for its folder `resources`, which settings name without a folder.
    pub resources: &'a [PathBuf],
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

#[derive(Template)]
#[template(path = "ssp/SystemStructure.ssd")]
struct SystemStructure<'a> {
    description: String,
    components: Vec<Component<'a>>,
    units: Vec<Unit<'a>>,
    step: String,
    stop_time: String,
}

struct Component<'a> {
    name: &'static str,
    fmu: String,
    values: String,
    connectors: Vec<Connector<'a>>,
}

/// A Real variable that others may be connected with.
struct Connector<'a> {
    name: &'a str,
    kind: &'static str,
    unit: Option<&'a str>,
}

/// A unit in SI base units.
struct Unit<'a> {
    name: &'a str,
    base: &'a BaseUnit,
    factor: String,
    offset: String,
}

#[derive(Template)]
#[template(path = "ssp/parameters.ssv")]
struct ParameterSet<'a> {
    name: &'a str,
    parameters: &'a [Parameter],
}

struct Parameter {
    name: String,
    value: Value,
}

impl Parameter {
    fn text(&self) -> String {
        if let Value::Real(value) = self.value { number(value) } else { self.value.to_string() }
    }
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
            let fmu = format!("resources/{}.fmu", part.description.co_simulation.model_identifier);
            let values = format!("resources/{name}.ssv");
            entries.add(&fmu, part.archive()?);
            self.add_parameters(&mut entries, &values, &parameters)?;
            components.push(Component { name, fmu, values, connectors: part.connectors() });
            all.extend(parameters.into_iter().map(|it| Parameter { name: format!("{name}.{}", it.name), ..it }));
        }
        // The same once more under full names, for tools that do not follow the bindings of components.
        self.add_parameters(&mut entries, "resources/system.ssv", &all)?;
        let structure = SystemStructure {
            description: format!("Vibro-impact harvester and its circuit. {}", self.description),
            components,
            units: self.units(),
            step: number(self.harvester.description.default_experiment.step_size.unwrap_or(STEP)),
            stop_time: number(self.until),
        };
        add_document(&mut entries, "SystemStructure.ssd", &structure)?;
        entries.write(archive)?;
        Ok(all.into_iter().map(|parameter| parameter.name).collect())
    }

    fn add_parameters(&self, entries: &mut Entries, file: &str, parameters: &[Parameter]) -> Result<()> {
        add_document(entries, file, &ParameterSet { name: self.case, parameters })
    }

    /// The units of both FMUs, each once.
    fn units(&self) -> Vec<Unit<'_>> {
        let mut units: Vec<Unit> = Vec::new();
        for unit in [&self.harvester, &self.circuit].into_iter().flat_map(|part| &part.description.units) {
            if let Some(base) = &unit.base
                && units.iter().all(|known| known.name != unit.name)
            {
                units.push(Unit { name: &unit.name, base, factor: number(base.factor), offset: number(base.offset) });
            }
        }
        units
    }
}

impl Part<'_> {
    /// The bytes of the archive, with the resources.
    fn archive(&self) -> Result<Vec<u8>> {
        let bytes = std::fs::read(self.fmu).map_err(PackageError::io("read", self.fmu))?;
        if self.resources.is_empty() {
            return Ok(bytes);
        }
        let mut entries =
            Entries::read(&bytes).map_err(|cause| PackageError::io("read", self.fmu)(io::Error::other(cause)))?;
        fmu_package::add_resources(self.resources, &mut entries)?;
        Ok(entries.packed(self.fmu)?)
    }

    /// What differs from the start values, in the order of the model description.
    fn parameters(&self) -> Result<Vec<Parameter>> {
        for setting in self.settings {
            self.description.variable(&setting.name)?;
        }
        let mut parameters = Vec::new();
        for variable in &self.description.variables {
            let Some(setting) = self.settings.iter().rfind(|setting| setting.name == variable.name) else { continue };
            let value = Value::parse(self.description, variable, &setting.value).map_err(fmu_import::FmiError::from)?;
            if self.description.start(variable).as_ref() != Some(&value) {
                parameters.push(Parameter { name: variable.name.clone(), value });
            }
        }
        Ok(parameters)
    }

    /// All Real outputs, and the inputs that are connected.
    fn connectors(&self) -> Vec<Connector<'_>> {
        let is_connected = |variable: &Variable| CONNECTIONS.iter().any(|(_, _, name)| *name == variable.name);
        let reals = self.description.variables.iter().filter(|it| matches!(it.kind, Kind::Real { .. }));
        let connectors = reals.filter_map(|variable| {
            let kind = match variable.causality {
                Causality::Output => "output",
                Causality::Input if is_connected(variable) => "input",
                _ => return None,
            };
            Some(Connector { name: &variable.name, kind, unit: variable.unit() })
        });
        connectors.collect()
    }
}

/// Adds a document, which ends with a line feed.
fn add_document(entries: &mut Entries, file: &str, document: &impl Template) -> Result<()> {
    let text = document.render().map_err(PackageError::template(file))?;
    entries.add(file, text + "\n");
    Ok(())
}

/// A number as XML Schema spells it; reading it gives the same bits.
fn number(value: f64) -> String {
    match value {
        f64::INFINITY => "INF".to_owned(),
        f64::NEG_INFINITY => "-INF".to_owned(),
        _ => format!("{value:?}"),
    }
}

/// Escapes the value of an XML attribute.
#[derive(Clone, Copy)]
pub(super) struct Xml;

impl Escaper for Xml {
    fn write_escaped_str<W: fmt::Write>(&self, mut to: W, text: &str) -> fmt::Result {
        text.chars().try_for_each(|character| match character {
            '<' => to.write_str("&lt;"),
            '>' => to.write_str("&gt;"),
            '&' => to.write_str("&amp;"),
            '"' => to.write_str("&quot;"),
            '\t' | '\n' | '\r' => write!(to, "&#{};", u32::from(character)),
            other => to.write_char(other),
        })
    }
}
