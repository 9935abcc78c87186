//! The cases of the axis `case`: published ones by name, and case files.

use std::path::{Path, PathBuf};

use crate::scenario::{CaseFile, Origin, Request, ScenarioError, find_file};
use crate::sweep::{CASE_AXIS, Spread, Vary};

/// The cases that `vary` asks for, or else several `files`, each of a case; none if there is no such axis. The axis gets the names of the
/// cases.
pub fn cases(files: &[PathBuf], vary: &mut Vec<Vary>) -> Result<Vec<CaseFile>, ScenarioError> {
    let asked = vary.iter().rfind(|vary| vary.name == CASE_AXIS).cloned();
    let cases = match asked {
        Some(Vary { spread: Spread::List { values }, origin, .. }) if !values.is_empty() => {
            values.iter().map(|value| case(value, &origin)).collect::<Result<Vec<_>, _>>()?
        }
        Some(Vary { origin, .. }) => {
            let reason = "names of cases or case files are expected, with commas between them".to_owned();
            return Err(ScenarioError::BadFile { path: origin.entry("vary", CASE_AXIS), reason });
        }
        None if files.len() > 1 => files.iter().map(|file| CaseFile::read(file)).collect::<Result<_, _>>()?,
        None => return Ok(Vec::new()),
    };
    let values = cases.iter().filter_map(|case| case.name.clone()).collect();
    let axis = Vary { name: CASE_AXIS.to_owned(), spread: Spread::List { values }, origin: Origin::Option };
    match vary.iter_mut().find(|vary| vary.name == CASE_AXIS) {
        Some(there) => *there = axis,
        None => vary.insert(0, axis),
    }
    vary.retain({
        let mut is_first = true;
        move |vary| vary.name != CASE_AXIS || std::mem::take(&mut is_first)
    });
    Ok(cases)
}

/// A published case, or a case file beside the file at `origin` or where the user stands.
fn case(value: &str, origin: &Origin) -> Result<CaseFile, ScenarioError> {
    if Path::new(value).extension().is_some_and(|it| it == "toml") {
        return CaseFile::read(&find_file(value, origin).unwrap_or_else(|| value.into()));
    }
    let name = Some(value.to_owned());
    let known = Request { case: name.clone(), ..Request::default() }.resolve();
    known.map_err(|error| match error {
        ScenarioError::UnknownCase { known, .. } => {
            let given = format!("{}: {value}", origin.entry("vary", CASE_AXIS));
            ScenarioError::UnknownCase { given, known: format!("{known}; or a case file, my.toml") }
        }
        other => other,
    })?;
    Ok(CaseFile { case: name.clone(), name, ..CaseFile::default() })
}

/// `case` with what the sweep file says on top of it.
pub fn under(case: CaseFile, sweep: &CaseFile) -> CaseFile {
    CaseFile {
        until: sweep.until.or(case.until),
        step: sweep.step.or(case.step),
        window: sweep.window.or(case.window),
        settings: [&case.settings[..], &sweep.settings].concat(),
        ..case
    }
}
