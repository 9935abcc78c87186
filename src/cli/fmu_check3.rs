//! `videg fmu check` on an FMU of FMI 3.0: whether its parts fit together. Its code is not run.

use std::collections::HashSet;

use fmu_import::{Archive, Causality, FUNCTIONS_3, ModelDescription};
use object::read::{File, Object as _};

/// The folder of libraries for this machine.
fn host_folder() -> String {
    let system = if std::env::consts::OS == "macos" { "darwin" } else { std::env::consts::OS };
    format!("{}-{system}", std::env::consts::ARCH)
}

/// The checks by name: what each left out, or what is wrong.
pub(super) fn checks(
    archive: &mut Archive,
    description: &ModelDescription,
) -> Vec<(&'static str, Result<String, String>)> {
    let done = |found: Result<(), String>| found.map(|()| String::new());
    vec![
        ("value references are unique", done(unique(description))),
        ("there is one independent variable", done(independent(description))),
        ("every output is in the model structure", done(outputs(description))),
        ("the library for this machine has all functions", done(functions(archive, description))),
        ("runs", Ok("left out, FMUs of FMI 3.0 are not run here".to_owned())),
    ]
}

fn unique(description: &ModelDescription) -> Result<(), String> {
    let mut seen = HashSet::new();
    match description.variables.iter().find(|variable| !seen.insert(variable.value_reference)) {
        None => Ok(()),
        Some(variable) => Err(format!("{} has that of another, {}", variable.name, variable.value_reference)),
    }
}

fn independent(description: &ModelDescription) -> Result<(), String> {
    let found = description.variables.iter().filter(|variable| variable.causality == Causality::Independent).count();
    if found == 1 { Ok(()) } else { Err(format!("there are {found}")) }
}

fn outputs(description: &ModelDescription) -> Result<(), String> {
    let listed: HashSet<_> = description.output_variables().map(|variable| variable.value_reference).collect();
    let is_missing = |reference: u32| !listed.contains(&reference);
    let outputs = description.variables.iter().filter(|variable| variable.causality == Causality::Output);
    let mut missing = outputs.filter(|variable| is_missing(variable.value_reference));
    missing.next().map_or(Ok(()), |variable| Err(format!("{} is not", variable.name)))
}

fn functions(archive: &mut Archive, description: &ModelDescription) -> Result<(), String> {
    let stem = format!("binaries/{}/{}.", host_folder(), description.co_simulation.model_identifier);
    let Some(entry) = archive.entries().iter().find(|entry| entry.starts_with(&stem)).cloned() else {
        return Err(format!("there is no {stem}*; there are libraries for {}", archive.platforms().join(", ")));
    };
    let folder = archive.unpack().map_err(|error| error.to_string())?;
    let bytes = std::fs::read(folder.path().join(&entry)).map_err(|error| format!("{entry}: {error}"))?;
    let exported = exported(&bytes).map_err(|error| format!("{entry} is no library: {error}"))?;
    match FUNCTIONS_3.iter().find(|name| !exported.contains(**name)) {
        None => Ok(()),
        Some(name) => Err(format!("{entry} does not export {name}")),
    }
}

/// Names of the functions that a library exports; C names begin with an underscore on macOS.
fn exported(library: &[u8]) -> object::read::Result<HashSet<String>> {
    let file = File::parse(library)?;
    let mut names = HashSet::new();
    for export in file.exports()? {
        if let object::read::NameOrOrdinal::Name(name) = export?.name() {
            let name = String::from_utf8_lossy(name);
            names.insert(name.strip_prefix('_').unwrap_or(&name).to_owned());
        }
    }
    Ok(names)
}
