//! `videg fmu`: build, check and describe FMUs.

use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};
use comfy_table::{ColumnConstraint, ContentArrangement};
use serde::Serialize;

use super::isolation::IsolationOptions;
use super::message::plain;
use super::progress::spinner;
use super::{Verdict, fmu_check, format, output, packaging};
use crate::fmi::{Archive, Kind, ModelDescription, Variable};
use crate::package::{self, AddedBinary, Options};

/// Columns of a terminal within which descriptions of variables are wrapped.
const WIDTH: u16 = 120;

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
        /// Build for these instead of this machine alone, all into the same FMUs: linux64 (runs with glibc 2.17 and
        /// later; needs cargo-zigbuild and zig), win64 (needs mingw-w64), darwin64 (on a Mac), or Rust triples
        #[arg(long = "target", value_name = "PLATFORM", value_delimiter = ',')]
        targets: Vec<String>,
        /// Add a library that was built elsewhere, such as darwin64=libVibroImpactHarvester.dylib; its name tells the
        /// FMU. May be repeated
        #[arg(long = "add-binary", value_name = "PLATFORM=FILE")]
        added: Vec<String>,
        /// Folder for the FMUs [default: target/fmu of the source tree]
        #[arg(long, value_name = "DIR")]
        output: Option<PathBuf>,
        /// Print one JSON object on stdout instead of the list
        #[arg(long)]
        json: bool,
    },
    /// Load an FMU and run it for some steps: does it keep the promises of its model description?
    Check {
        /// The FMU; its code is run
        file: PathBuf,
        /// Print one JSON object on stdout instead of the list
        #[arg(long)]
        json: bool,
        #[command(flatten)]
        isolation: IsolationOptions,
    },
    /// Describe an FMU: platforms, capabilities, variables. Nothing of it is unpacked or run
    Info {
        /// The FMU
        file: PathBuf,
        /// Print one JSON object on stdout instead of the tables
        #[arg(long)]
        json: bool,
    },
}

/// Runs the verb.
pub fn run(arguments: &Arguments) -> anyhow::Result<Verdict> {
    match &arguments.task {
        Task::Build { targets, added, output, json } => build(targets, added, output.clone(), *json)?,
        Task::Check { file, json, isolation } => return fmu_check::run(file, isolation, *json),
        Task::Info { file, json } => info(file, *json)?,
    }
    Ok(Verdict::Passed)
}

fn build(targets: &[String], added: &[String], folder: Option<PathBuf>, json: bool) -> anyhow::Result<()> {
    #[derive(Serialize)]
    struct Built {
        fmus: Vec<PathBuf>,
    }
    let added = added.iter().map(|text| AddedBinary::parse(text)).collect::<Result<_, _>>()?;
    let waiting = spinner("building the FMUs");
    let built = package::build_all(&Options {
        output: folder,
        targets: targets.to_vec(),
        added,
        progress: packaging::follow,
        ..Options::default()
    });
    waiting.finish_and_clear();
    let fmus = built?;
    if json {
        output::print(&serde_json::to_string_pretty(&Built { fmus })?)?;
    } else {
        fmus.iter().try_for_each(|path| output::print(&path.display().to_string()))?;
    }
    Ok(())
}

/// One variable as `--json` shows it.
#[derive(Serialize)]
struct Row {
    name: String,
    value_reference: u32,
    r#type: &'static str,
    causality: String,
    variability: String,
    unit: Option<String>,
    start: Option<String>,
    min: Option<f64>,
    max: Option<f64>,
    description: Option<String>,
}

#[derive(Serialize)]
struct Info<'a> {
    file: &'a Path,
    model_name: &'a str,
    model_identifier: &'a str,
    guid: &'a str,
    fmi_version: &'static str,
    description: Option<&'a str>,
    platforms: Vec<String>,
    variables: Vec<Row>,
}

fn info(file: &Path, json: bool) -> anyhow::Result<()> {
    let mut archive = Archive::open(file)?;
    let description = archive.description()?;
    let variables = description.variables.iter().map(|variable| row(&description, variable)).collect();
    let info = Info {
        file,
        model_name: &description.model_name,
        model_identifier: &description.co_simulation.model_identifier,
        guid: &description.guid,
        fmi_version: "2.0",
        description: description.description.as_deref(),
        platforms: archive.platforms(),
        variables,
    };
    if json {
        output::print(&serde_json::to_string_pretty(&info)?)?;
    } else {
        output::print(&plain(&text(&info)))?;
    }
    Ok(())
}

fn row(description: &ModelDescription, variable: &Variable) -> Row {
    let item = |number: i32| {
        let items = description.enumeration(variable).map(|enumeration| &enumeration.items);
        let found = items.and_then(|items| items.iter().find(|item| item.value == number));
        found.map_or_else(|| number.to_string(), |item| item.name.clone())
    };
    let (kind, start, min, max) = match &variable.kind {
        Kind::Real { start, min, max, .. } => ("Real", start.map(|value| format!("{value:?}")), *min, *max),
        Kind::Integer { start, min, max } => {
            ("Integer", start.map(|value| value.to_string()), min.map(f64::from), max.map(f64::from))
        }
        Kind::Boolean { start } => ("Boolean", start.map(|value| value.to_string()), None, None),
        Kind::String { start } => ("String", start.clone(), None, None),
        Kind::Enumeration { start } => ("Enumeration", start.map(item), None, None),
    };
    Row {
        name: variable.name.clone(),
        value_reference: variable.value_reference,
        r#type: kind,
        causality: variable.causality.as_str().to_owned(),
        variability: variable.variability.as_str().to_owned(),
        unit: variable.unit().map(ToOwned::to_owned),
        start,
        min,
        max,
        description: variable.description.clone(),
    }
}

fn text(info: &Info) -> String {
    let mut table = format::table(&["variable", "start", "unit", "causality", "description"]);
    table.set_content_arrangement(ContentArrangement::Dynamic).set_width(WIDTH);
    let whole = vec![ColumnConstraint::ContentWidth; 4];
    table.set_constraints(whole);
    for variable in &info.variables {
        let start = variable.start.clone().unwrap_or_default();
        let unit = variable.unit.clone().unwrap_or_else(|| variable.r#type.to_lowercase());
        let mut cells = format::row(&[variable.name.clone(), start, unit, variable.causality.clone()]);
        cells.push(variable.description.clone().unwrap_or_default().into());
        table.add_row(cells);
    }
    let platforms = if info.platforms.is_empty() { "none".to_owned() } else { info.platforms.join(", ") };
    format!(
        "{} (model identifier {}, FMI {})\n{}\nGUID {}, platforms: {platforms}\n\n{table}",
        info.model_name,
        info.model_identifier,
        info.fmi_version,
        info.description.unwrap_or_default(),
        info.guid,
    )
}
