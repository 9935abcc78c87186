//! The axis `case`: each of its values is the name of a case and stands for all that this case sets.

use indexmap::IndexMap;
use serde::Serialize;

use super::axis::Axis;
use super::setting::{as_setting, not_varied, typed};
use super::{SweepError, Vary};
use crate::scenario::Setting;
use fmu_import::{Causality, Kind, ModelDescription, Value, Variability, Variable};

/// Name of the axis, and of its column.
pub const AXIS: &str = "case";

/// A case to vary over.
#[derive(Debug, Clone)]
pub struct NamedCase {
    /// Its name.
    pub name: String,
    /// All that it sets; the last of a name wins.
    pub settings: Vec<Setting>,
}

/// What a case sets that others do not, by its name.
#[derive(Default)]
pub(super) struct Cases(IndexMap<String, Vec<(Variable, Value)>>);

/// A case in the document, with what it sets as `variable=value`.
#[derive(Serialize)]
pub(super) struct Documented<'a> {
    name: &'a str,
    values: Vec<String>,
}

impl Cases {
    /// The cases, and what all of them set alike. What is varied besides is left out.
    pub fn new(
        description: &ModelDescription,
        cases: &[NamedCase],
        vary: &[Vary],
    ) -> Result<(Self, Vec<Setting>), SweepError> {
        let all: Vec<_> = cases.iter().map(|case| not_varied(&case.settings, vary)).collect();
        let is_of_all = |setting: &Setting| {
            let same = |other: &Setting| other.name == setting.name && other.value == setting.value;
            all.iter().all(|settings: &Vec<Setting>| settings.iter().any(same))
        };
        let shared = all.iter().take(1).flatten().filter(|setting| is_of_all(setting)).cloned().collect();
        let own = |settings: &[Setting]| {
            let own = settings.iter().filter(|setting| !is_of_all(setting));
            let typed = |setting: &Setting| {
                typed(description, setting).map_err(|error| error.said(|_, _| setting.origin.clone()))
            };
            own.map(typed).collect::<Result<Vec<_>, _>>()
        };
        let mut named = IndexMap::new();
        for (NamedCase { name, .. }, settings) in cases.iter().zip(&all) {
            if named.insert(name.clone(), own(settings)?).is_some() {
                let reason = format!("two cases are called {name}; give one another name by the key name of its file");
                return Err(SweepError::option("vary", AXIS, reason));
            }
        }
        Ok((Self(named), shared))
    }

    /// Whether `vary` is over the cases.
    pub fn is_axis(&self, vary: &Vary) -> bool {
        !self.0.is_empty() && vary.name == AXIS
    }

    /// Whether `axis` is that of the cases.
    pub fn are_of(&self, axis: &Axis) -> bool {
        !self.0.is_empty() && axis.variable.name == AXIS
    }

    /// The axis over the cases.
    pub fn axis(&self, seed: u64) -> Axis {
        let variable = Variable {
            name: AXIS.to_owned(),
            value_reference: u32::MAX,
            description: None,
            causality: Causality::Parameter,
            variability: Variability::Fixed,
            initial: None,
            declared_type: None,
            kind: Kind::String { start: None },
            type_name: "String",
        };
        Axis::of_list(variable, self.0.keys().cloned().map(Value::String).collect(), seed)
    }

    /// What the cases set.
    pub fn values(&self) -> impl Iterator<Item = &(Variable, Value)> {
        self.0.values().flatten()
    }

    /// What the case among the `values` of `axes` sets; nothing without the axis.
    pub fn settings(&self, axes: &[Axis], values: &[Value]) -> &[(Variable, Value)] {
        let case = axes.iter().zip(values).find(|(axis, _)| self.are_of(axis));
        match case {
            Some((_, Value::String(name))) => self.0.get(name).map_or(&[], Vec::as_slice),
            _ => &[],
        }
    }

    /// The cases in the document.
    pub fn documented(&self) -> Vec<Documented<'_>> {
        let text = |(setting, value): &(Variable, Value)| {
            let Setting { name, value, .. } = as_setting((setting, value));
            format!("{name}={value}")
        };
        self.0.iter().map(|(name, own)| Documented { name, values: own.iter().map(text).collect() }).collect()
    }
}
