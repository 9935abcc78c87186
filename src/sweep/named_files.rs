//! Files that a sweep sets or varies. Its document and its results have their names as the user gave them, so that a sweep is the same
//! wherever it goes on; an FMU gets absolute names.

use std::borrow::Cow;
use std::collections::HashMap;

use super::SweepError;
use super::vary::{Spread, Vary};
use crate::scenario::{Setting, absolute_file, is_file};
use fmu_import::Value;

/// Absolute names of files by the names that the user gave.
pub(super) struct NamedFiles(HashMap<String, String>);

impl NamedFiles {
    /// Those of a sweep. A name that means two files, as seen from two case files, is refused.
    pub fn of<'a>(settings: impl Iterator<Item = &'a Setting>, vary: &[Vary]) -> Result<Self, SweepError> {
        let set = settings.map(|setting| (&setting.name, &setting.value, &setting.origin));
        let varied = vary.iter().flat_map(|Vary { name, spread, origin }| {
            let values = if let Spread::List { values } = spread { &values[..] } else { &[] };
            values.iter().map(move |value| (name, value, origin))
        });
        let files = set.chain(varied).filter(|(name, ..)| is_file(name));
        let mut named = HashMap::new();
        for (name, value, origin) in files {
            let path = absolute_file(name, value, origin).into_owned();
            match named.insert(value.clone(), path.clone()) {
                Some(other) if other != path => {
                    let reason = format!("{value} is {other} in one place and {path} in another: give them two names");
                    return Err(SweepError::option("set", name, reason));
                }
                _ => {}
            }
        }
        Ok(Self(named))
    }

    /// The value of a variable as an FMU gets it.
    pub fn for_fmu<'a>(&self, value: &'a Value) -> Cow<'a, Value> {
        let file = if let Value::String(text) = value { self.0.get(text) } else { None };
        file.map_or(Cow::Borrowed(value), |path| Cow::Owned(Value::String(path.clone())))
    }
}
