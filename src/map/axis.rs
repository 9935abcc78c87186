//! An axis of a map: a variable and its evenly spread values.

use fmu_import::{Kind, ModelDescription};

use super::error::MapError;
use crate::sweep::{Range, Scale, Spread, Vary};

/// An axis of a map.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// Name of the variable.
    pub name: String,
    /// Its unit, empty without one.
    pub unit: String,
    /// Ascending values.
    pub range: Range,
    /// How many values, at least 2.
    pub count: usize,
}

impl Axis {
    /// The axis that `vary` describes, of a variable of `description`.
    pub(super) fn new(description: &ModelDescription, vary: &Vary) -> Result<Self, MapError> {
        let bad = |reason: String| Err(MapError::Axis { axis: vary.name.clone(), reason });
        let variable = match description.variable(&vary.name) {
            Ok(variable) => variable,
            Err(error) => return bad(error.to_string()),
        };
        if !matches!(variable.kind, Kind::Real { .. }) {
            return bad(format!("it is of type {}; an axis of a map is a Real variable", variable.kind.name()));
        }
        let Spread::Range(Range { from, to, count, scale }) = vary.spread else {
            return bad("a list of values makes no axis; name=from:to:count is expected".to_owned());
        };
        let Some(count) = count else { return bad(format!("it needs a count, as in {from}:{to}:100")) };
        if count < 2 {
            return bad(format!("a count of {count} makes no axis; at least 2 are allowed"));
        }
        if from == to {
            return bad(format!("it goes from {from} to {to}; two different ends are allowed"));
        }
        let (low, high) = if from > to { (to, from) } else { (from, to) };
        let range = Range { from: low, to: high, count: Some(count), scale };
        let unit = variable.unit().unwrap_or_default().to_owned();
        Ok(Self { name: vary.name.clone(), unit, range, count: usize::try_from(count).unwrap_or(usize::MAX) })
    }

    /// What the sweep over the grid varies.
    pub(super) fn vary(&self, said: &Vary) -> Vary {
        Vary { spread: Spread::Range(self.range), ..said.clone() }
    }

    /// The value at a place that counts the values of the grid, from 0 on; places in between have values in between.
    pub fn value(&self, place: f64) -> f64 {
        self.range.at(place / self.last())
    }

    /// The last place.
    pub(super) fn last(&self) -> f64 {
        self.count as f64 - 1.0
    }

    /// The values of the grid.
    pub fn values(&self) -> Vec<f64> {
        (0..self.count).map(|index| self.value(index as f64)).collect()
    }

    /// Whether the values have equal ratios.
    pub fn is_log(&self) -> bool {
        self.range.scale == Scale::Log
    }

    /// Name and unit.
    pub fn label(&self) -> String {
        labelled(&self.name, &self.unit)
    }
}

/// `name (unit)`; the unit 1 is none.
pub(super) fn labelled(name: &str, unit: &str) -> String {
    if unit.is_empty() || unit == "1" { name.to_owned() } else { format!("{name} ({unit})") }
}
