//! Files that a sweep sets or varies. Its document and its results have their names as the user gave them, so that a sweep is the same
//! wherever it goes on; an FMU gets absolute names.

use std::borrow::Cow;
use std::collections::HashMap;

use super::vary::{Spread, Vary};
use crate::scenario::{Setting, absolute_file, is_file};
use fmu_import::Value;

/// Absolute names of files by the names that the user gave.
pub(super) struct NamedFiles(HashMap<String, String>);

impl NamedFiles {
    /// Those of a sweep.
    pub fn of(settings: &[Setting], vary: &[Vary]) -> Self {
        let set = settings.iter().map(|setting| (&setting.name, &setting.value, &setting.origin));
        let varied = vary.iter().flat_map(|Vary { name, spread, origin }| {
            let values = if let Spread::List { values } = spread { &values[..] } else { &[] };
            values.iter().map(move |value| (name, value, origin))
        });
        let files = set.chain(varied).filter(|(name, ..)| is_file(name));
        let named = files.map(|(name, value, origin)| (value.clone(), absolute_file(name, value, origin).into_owned()));
        Self(named.collect())
    }

    /// The value of a variable as an FMU gets it.
    pub fn for_fmu<'a>(&self, value: &'a Value) -> Cow<'a, Value> {
        let file = if let Value::String(text) = value { self.0.get(text) } else { None };
        file.map_or(Cow::Borrowed(value), |path| Cow::Owned(Value::String(path.clone())))
    }
}
