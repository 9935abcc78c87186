//! The type definitions, read once: however many variables are of a type, its attributes are read once and its texts shared.

use std::collections::HashMap;
use std::sync::Arc;

use super::{Result, attribute, integer, optional, raw, real};

/// What a variable takes over from its type.
#[derive(Default)]
pub(super) struct SimpleType {
    pub unit: Option<Arc<str>>,
    /// Bounds of a Real.
    pub real: [Option<f64>; 2],
    /// Bounds of an Integer.
    pub integer: [Option<i32>; 2],
    pub is_enumeration: bool,
}

/// A text of a type, which is shown with each of its variables.
///
/// # Errors
/// If it is too long for that.
pub(super) fn shared(place: &str, name: &'static str, text: String) -> Result<String> {
    const LONGEST: usize = 1024;
    let is_short = text.len() <= LONGEST;
    if is_short { Ok(text) } else { Err(attribute(place, name, &text, format!("at most {LONGEST} bytes"))) }
}

/// Type definitions by name; of those that share one, the first.
pub(super) struct Types(HashMap<String, SimpleType>);

impl Types {
    pub fn of(types: Vec<raw::SimpleType>) -> Result<Self> {
        let mut all = HashMap::with_capacity(types.len());
        for raw in types {
            let Some(name) = raw.name else { continue };
            if all.contains_key(&name) {
                continue;
            }
            let place = format!("type \"{name}\"");
            let mut read = SimpleType { is_enumeration: raw.enumeration.is_some(), ..SimpleType::default() };
            if let Some(it) = raw.real {
                let number = |name, text: Option<String>| optional(text.as_deref(), |text| real(&place, name, text));
                read.real = [number("min", it.min)?, number("max", it.max)?];
                read.unit = it.unit.map(|unit| shared(&place, "unit", unit).map(Arc::from)).transpose()?;
            }
            if let Some(it) = raw.integer {
                let number = |name, text: Option<String>| optional(text.as_deref(), |text| integer(&place, name, text));
                read.integer = [number("min", it.min)?, number("max", it.max)?];
            }
            all.insert(name, read);
        }
        Ok(Self(all))
    }

    pub fn get(&self, name: Option<&str>) -> Option<&SimpleType> {
        self.0.get(name?)
    }

    /// Names of the enumerations, sorted.
    pub fn enumerations(&self) -> Vec<&str> {
        let enumerations = self.0.iter().filter(|(_, simple)| simple.is_enumeration);
        let mut names: Vec<_> = enumerations.map(|(name, _)| name.as_str()).collect();
        names.sort_unstable();
        names
    }
}
