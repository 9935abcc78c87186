//! `videg fmu`: build, check and describe FMUs.

use std::borrow::Cow;
use std::collections::HashMap;
use std::path::{Path, PathBuf};

use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Args, Subcommand};
use serde::Serialize;

use super::format::Sheet;
use super::isolation::IsolationOptions;
use super::progress::Spinner;
use super::{Exit, fmu_check, output};
use crate::package::{self, AddedBinary, FmiVersion, Options};
use fmu_import::{Archive, EnumerationItem, Kind, ModelDescription, Variable};

/// Columns of a terminal within which descriptions of variables are wrapped.
const WIDTH: usize = 120;

/// Arguments of the verb.
#[derive(Args)]
pub struct Arguments {
    #[command(subcommand)]
    task: Task,
}

#[derive(Subcommand)]
enum Task {
    /// Build the FMUs of this project into target/fmu
    Build {
        /// Version of FMI: 2, which most tools import, or 3, with event mode, early return and a clock of the impacts; in
        /// target/fmu/fmi3
        #[arg(long, value_parser = version(), default_value = "2")]
        fmi: FmiVersion,
        /// Build for these platforms, all into the same FMUs, instead of this machine: linux64 (runs with glibc 2.17 and
        /// later; needs cargo-zigbuild and zig), win64 (needs mingw-w64), darwin64 (on a Mac), or Rust triples
        #[arg(long = "target", value_name = "PLATFORM", value_delimiter = ',')]
        targets: Vec<String>,
        /// Add a library built elsewhere, e.g. darwin64=libVibroImpactHarvester.dylib; its name tells the FMU. May be
        /// repeated
        #[arg(long = "add-binary", value_name = "PLATFORM=FILE")]
        added: Vec<String>,
        /// Add a file to the resources of the harvester, e.g. a recording that excitation.file then names without a folder. May
        /// be repeated
        #[arg(long = "resource", value_name = "FILE")]
        resources: Vec<PathBuf>,
        /// Folder for the FMUs [default: target/fmu of the source tree]
        #[arg(long, value_name = "DIR")]
        output: Option<PathBuf>,
        /// Print one JSON object on stdout instead of the list
        #[arg(long)]
        json: bool,
    },
    /// Load an FMU, run some steps, and check it against its model description; one of FMI 3.0 is looked at, not run
    Check {
        /// The FMU; its code is run, unless it is of FMI 3.0
        file: PathBuf,
        /// Print one JSON object on stdout instead of the list
        #[arg(long)]
        json: bool,
        #[command(flatten)]
        isolation: IsolationOptions,
    },
    /// Describe an FMU: platforms, capabilities, variables; unpacks and runs nothing
    Info {
        /// The FMU
        file: PathBuf,
        /// Print one JSON object on stdout instead of the tables
        #[arg(long)]
        json: bool,
    },
}

/// A version of FMI.
fn version() -> impl TypedValueParser<Value = FmiVersion> {
    PossibleValuesParser::new(["2", "3"]).map(|text| if text == "3" { FmiVersion::Fmi3 } else { FmiVersion::Fmi2 })
}

/// Runs the verb.
pub fn run(arguments: &Arguments) -> anyhow::Result<Exit> {
    match &arguments.task {
        Task::Build { fmi, targets, added, resources, output, json } => {
            let options =
                Options { fmi: *fmi, output: output.clone(), resources: resources.clone(), ..Options::default() };
            build(targets, added, options, *json)?;
        }
        Task::Check { file, json, isolation } => return fmu_check::run(file, isolation, *json),
        Task::Info { file, json } => info(file, *json)?,
    }
    Ok(Exit::Passed)
}

fn build(targets: &[String], added: &[String], options: Options, json: bool) -> anyhow::Result<()> {
    #[derive(Serialize)]
    struct Built {
        fmus: Vec<PathBuf>,
    }
    let added = added.iter().map(|text| AddedBinary::parse(text)).collect::<Result<_, _>>()?;
    let waiting = Spinner::new("building the FMUs");
    let (targets, progress) = (targets.to_vec(), Spinner::tell as fn(&str));
    let options = Options { targets, added, progress, ..options };
    let built = Built { fmus: package::build_all(&options)? };
    drop(waiting);
    let paths = || built.fmus.iter().map(|path| path.display().to_string()).collect::<Vec<_>>();
    output::show(json, &built, || paths().join("\n"))
}

/// One variable as `--json` shows it.
#[derive(Serialize)]
struct Row<'a> {
    name: &'a str,
    value_reference: u32,
    r#type: &'static str,
    causality: &'static str,
    variability: &'static str,
    unit: Option<&'a str>,
    start: Option<Cow<'a, str>>,
    min: Option<f64>,
    max: Option<f64>,
    description: Option<&'a str>,
}

#[derive(Serialize)]
struct Info<'a> {
    file: &'a Path,
    model_name: &'a str,
    model_identifier: &'a str,
    guid: &'a str,
    fmi_version: &'a str,
    description: Option<&'a str>,
    platforms: Vec<String>,
    variables: Vec<Row<'a>>,
}

fn info(file: &Path, json: bool) -> anyhow::Result<()> {
    let mut archive = Archive::open(file)?;
    let description = archive.description()?;
    let items = Items::of(&description);
    let variables = description.variables.iter().map(|variable| row(&items, variable)).collect();
    let info = Info {
        file,
        model_name: &description.model_name,
        model_identifier: &description.co_simulation.model_identifier,
        guid: &description.guid,
        fmi_version: &description.fmi_version,
        description: description.description.as_deref(),
        platforms: archive.platforms(),
        variables,
    };
    output::show(json, &info, || text(&info))
}

/// Names of the items of each enumeration by their values: there may be many items, and many variables of their type.
struct Items<'a>(HashMap<&'a str, HashMap<i32, &'a str>>);

impl<'a> Items<'a> {
    /// Of types and items that share a name or value, the first counts.
    fn of(description: &'a ModelDescription) -> Self {
        let types = description.enumerations.iter().rev();
        let items = |items: &'a [EnumerationItem]| items.iter().rev().map(|item| (item.value, item.name.as_str()));
        Self(types.map(|it| (it.name.as_str(), items(&it.items).collect())).collect())
    }

    fn name(&self, variable: &Variable, value: i32) -> Cow<'a, str> {
        let items = variable.declared_type.as_deref().and_then(|name| self.0.get(name));
        items.and_then(|items| items.get(&value)).map_or_else(|| value.to_string().into(), |name| (*name).into())
    }
}

fn row<'a>(items: &Items<'a>, variable: &'a Variable) -> Row<'a> {
    let start = match &variable.kind {
        Kind::Real { start, .. } => start.map(|value| format!("{value:?}").into()),
        Kind::Integer { start, .. } => start.map(|value| value.to_string().into()),
        Kind::Boolean { start } => start.map(|value| value.to_string().into()),
        Kind::String { start } => start.as_deref().map(Cow::from),
        Kind::Enumeration { start } => start.map(|value| items.name(variable, value)),
        Kind::Other => None,
    };
    let [min, max] = variable.kind.bounds();
    Row {
        name: &variable.name,
        value_reference: variable.value_reference,
        r#type: variable.type_name,
        causality: variable.causality.as_str(),
        variability: variable.variability.as_str(),
        unit: variable.unit(),
        start,
        min,
        max,
        description: variable.description.as_deref(),
    }
}

fn text(info: &Info) -> String {
    let row = |variable: &Row<'_>| {
        let unit = variable.unit.map_or_else(|| variable.r#type.to_lowercase(), ToOwned::to_owned);
        let start = variable.start.as_deref().unwrap_or_default().to_owned();
        let description = variable.description.unwrap_or_default().to_owned();
        vec![variable.name.to_owned(), start, unit, variable.causality.to_owned(), description]
    };
    let headings = ["variable", "start", "unit", "causality", "description"];
    let table = Sheet::new(headings, &[4], info.variables.iter().map(row).collect()).within(WIDTH);
    let platforms = if info.platforms.is_empty() { "none".to_owned() } else { info.platforms.join(", ") };
    format!(
        "{} (model identifier {}, FMI {})\n{}\n{} {}, platforms: {platforms}\n\n{table}",
        info.model_name,
        info.model_identifier,
        info.fmi_version,
        info.description.unwrap_or_default(),
        if info.fmi_version == "2.0" { "GUID" } else { "instantiation token" },
        info.guid,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn start_values_of_enumerations_are_shown_by_names_that_are_not_copied() {
        let document = include_bytes!("../../fmu/import/src/testdata/good.xml");
        let description = ModelDescription::parse(document, "test").unwrap();
        let items = Items::of(&description);
        let shown = row(&items, description.variable("law").unwrap());
        let name = &description.enumerations[0].items[0].name;
        assert!(matches!(shown.start, Some(Cow::Borrowed(start)) if std::ptr::eq(start, name.as_str())));
        let mut law = description.variable("law").unwrap().clone();
        law.kind = Kind::Enumeration { start: Some(77) };
        assert_eq!(row(&items, &law).start.as_deref(), Some("77"), "there is no such item");
    }
}
