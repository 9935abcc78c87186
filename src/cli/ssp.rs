//! `videg ssp`: both FMUs, connected, as a system package.

use std::path::{Path, PathBuf};

use anyhow::Context as _;
use clap::Args;
use serde::Serialize;

use super::options::TimedCaseOptions;
use super::{Exit, output, packaging};
use crate::cosim::{CapacitanceRatios, CircuitRequest, EmbeddedCircuit, FmuCircuit, HarvesterFmu};
use crate::package::{Part, SystemPackage};
use crate::scenario::{Scenario, Setting, find_file, is_file};
use fmu_import::{Fmu, Kind};

/// Name of the package.
const FILE: &str = "Harvester.ssp";

/// Arguments of the verb.
#[derive(Args)]
pub struct Arguments {
    #[command(flatten)]
    case: TimedCaseOptions,
    /// Folder for Harvester.ssp [default: where the FMUs are, target/fmu of the source tree]
    #[arg(long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Print one JSON object on stdout instead of the file's name
    #[arg(long)]
    json: bool,
}

#[derive(Serialize)]
struct Packaged<'a> {
    case: &'a str,
    ssp: &'a Path,
    parameters: &'a [String],
    warnings: &'a [String],
}

/// Runs the verb.
pub fn run(arguments: &Arguments) -> anyhow::Result<Exit> {
    let scenario = arguments.case.scenario()?;
    let archives = packaging::build()?;
    let [harvester, circuit] = archives.as_slice() else { anyhow::bail!("not two FMUs but {}", archives.len()) };
    let beside = || harvester.parent().unwrap_or(Path::new("."));
    let ssp = arguments.output.as_deref().unwrap_or_else(beside).join(FILE);
    let (harvester_fmu, circuit_fmu) = (Fmu::open(harvester)?, Fmu::open(circuit)?);
    let (mechanical, of_circuit) = settings_of_both(&harvester_fmu, &scenario)?;
    let (mechanical, resources) = with_resources(mechanical);
    let (harvester_part, circuit_part) = (
        Part { fmu: harvester, description: harvester_fmu.description(), settings: &mechanical, resources: &resources },
        Part { fmu: circuit, description: circuit_fmu.description(), settings: &of_circuit, resources: &[] },
    );
    let package = SystemPackage {
        case: &scenario.name,
        description: &scenario.description,
        until: scenario.until,
        harvester: harvester_part,
        circuit: circuit_part,
    };
    let parameters = package.write(&ssp).with_context(|| format!("cannot package {FILE}"))?;
    let warnings: Vec<_> = unread(&parameters, [&harvester_fmu, &circuit_fmu]).collect();
    let packaged = Packaged { case: &scenario.name, ssp: &ssp, parameters: &parameters, warnings: &warnings };
    output::show(arguments.json, &packaged, || ssp.display().to_string())?;
    output::warn(&warnings);
    Ok(Exit::Passed)
}

/// What to set in harvester and circuit. They are tried, so that what is packaged can run. The circuit starts with the
/// capacitances that the harvester starts with.
fn settings_of_both(fmu: &Fmu, scenario: &Scenario) -> anyhow::Result<(Vec<Setting>, Vec<Setting>)> {
    let (mechanical, request) = CircuitRequest::split(fmu.description(), &scenario.settings)?;
    let harvester = HarvesterFmu::new(fmu, scenario, &mechanical)?;
    let ratio = CapacitanceRatios::of(fmu, scenario, &mechanical)?.best;
    let resolved = request.resolve(harvester.bias_voltage(), ratio);
    let capacitance = harvester.sample()?.capacitance();
    EmbeddedCircuit::new("circuit", &resolved, capacitance).map_err(|error| request.located(error, &resolved))?;
    let mut of_circuit = FmuCircuit::settings(&resolved);
    for (name, value) in ["left.capacitance", "right.capacitance"].into_iter().zip(capacitance) {
        of_circuit.push(Setting::new(name, format!("{value:?}")));
    }
    Ok((mechanical, of_circuit))
}

/// The settings with the names of files as they are in the FMU, and these files: the package runs where the user's are not.
fn with_resources(mut settings: Vec<Setting>) -> (Vec<Setting>, Vec<PathBuf>) {
    let mut resources = Vec::new();
    for index in 0..settings.len() {
        let (before, later) = settings.split_at_mut(index + 1);
        let setting = &mut before[index];
        let is_last = later.iter().all(|other| other.name != setting.name);
        let path = if is_file(&setting.name) { find_file(&setting.value, &setting.origin) } else { None };
        if let Some(path) = path.filter(|_| is_last) {
            if let Some(name) = path.file_name().and_then(|name| name.to_str()) {
                name.clone_into(&mut setting.value);
            }
            resources.push(path);
        }
    }
    (settings, resources)
}

/// Warnings about parameters that not every tool reads.
fn unread<'a>(parameters: &'a [String], fmus: [&'a Fmu; 2]) -> impl Iterator<Item = String> + 'a {
    parameters.iter().filter_map(move |name| {
        let (_, variable) = name.split_once('.')?;
        match fmus.iter().find_map(|fmu| fmu.description().variable(variable).ok())?.kind {
            Kind::Enumeration { .. } => Some(format!(
                "{name} is an enumeration: FMPy 0.3 and Ecos 0.7 do not read such parameters from a system package"
            )),
            Kind::String { .. } => {
                Some(format!("{name} is a text: FMPy 0.3 does not run a system package with such parameters"))
            }
            _ => None,
        }
    })
}
