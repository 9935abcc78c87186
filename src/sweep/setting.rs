//! Variables that are set to one value, with their types.

use super::{SweepError, Vary, column};
use crate::scenario::Setting;
use fmu_import::{ModelDescription, Value, Variable};

/// Items without those whose name comes again: the last one stands, in the place of the first.
pub(super) fn last_of_each<T: Clone>(items: &[T], name: impl Fn(&T) -> &str) -> Vec<T> {
    let mut kept: Vec<T> = Vec::new();
    for item in items {
        match kept.iter_mut().find(|other| name(other) == name(item)) {
            Some(other) => *other = item.clone(),
            None => kept.push(item.clone()),
        }
    }
    kept
}

/// The settings of variables that are not varied; the last of a name wins.
pub(super) fn not_varied(settings: &[Setting], vary: &[Vary]) -> Vec<Setting> {
    let is_fixed = |setting: &Setting| vary.iter().all(|vary| vary.name != setting.name);
    last_of_each(settings, |setting| &setting.name).into_iter().filter(is_fixed).collect()
}

/// The variable of `setting`, and its value; an error says where it was set.
pub(super) fn typed(description: &ModelDescription, setting: &Setting) -> Result<(Variable, Value), SweepError> {
    let bad = |reason: String| SweepError::option("set", &setting.name, reason);
    let variable = description.variable(&setting.name).map_err(|error| bad(error.to_string()))?;
    if !variable.is_settable() {
        let causality = variable.causality.as_str();
        let article = if causality.starts_with(['i', 'o']) { "an" } else { "a" };
        return Err(bad(format!("it is {article} {causality}, which cannot be set")));
    }
    let value = Value::parse(description, variable, &setting.value).map_err(|error| bad(error.to_string()))?;
    Ok((variable.clone(), value))
}

/// As in the document: one value has one text, however it was written.
pub(super) fn as_setting((variable, value): (&Variable, &Value)) -> Setting {
    let text = if let Value::String(text) = value { text.clone() } else { column::cell(value) };
    Setting::new(&variable.name, text)
}
