//! Columns of the results.

use serde::{Deserialize, Serialize};

use crate::fmi::{Kind, Value, Variable};

/// A column.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Column {
    /// Its heading.
    pub name: String,
    /// What stands in it.
    #[serde(rename = "type")]
    pub kind: Type,
    /// Whether it is empty in the row of a run that failed, or of one that did not.
    pub optional: bool,
}

/// What stands in a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Type {
    /// A whole number of 64 bits.
    Integer,
    /// A floating-point number of 64 bits.
    Real,
    /// `true` or `false`.
    Boolean,
    /// Words.
    Text,
}

impl Column {
    /// A column that is never empty.
    pub(super) fn always(name: &str, kind: Type) -> Self {
        Self { name: name.to_owned(), kind, optional: false }
    }

    /// A column that may be empty.
    pub(super) fn optional(name: &str, kind: Type) -> Self {
        Self { name: name.to_owned(), kind, optional: true }
    }
}

impl Type {
    /// What the values of `variable` are.
    pub(super) fn of(variable: &Variable) -> Self {
        match variable.kind {
            Kind::Real { .. } => Self::Real,
            Kind::Integer { .. } => Self::Integer,
            Kind::Boolean { .. } => Self::Boolean,
            Kind::String { .. } | Kind::Enumeration { .. } => Self::Text,
        }
    }
}

/// `value` as it stands in a row: reading a number gives the same bits.
pub(super) fn cell(value: &Value) -> String {
    match value {
        Value::Real(value) => real(*value),
        Value::String(text) => one_line(text),
        other => other.to_string(),
    }
}

/// The shortest text that reads as `value`.
pub(super) fn real(value: f64) -> String {
    format!("{value:?}")
}

/// `text` in one line, so that a line is a row.
pub(super) fn one_line(text: &str) -> String {
    text.split(['\r', '\n']).filter(|line| !line.is_empty()).collect::<Vec<_>>().join(" ")
}

/// A row as a line of CSV.
pub(super) fn line<'a>(cells: impl IntoIterator<Item = &'a str>) -> Vec<u8> {
    let mut writer = csv::WriterBuilder::new().buffer_capacity(512).from_writer(Vec::new());
    // A vector takes everything, and there is but one row: no length can differ.
    let written = writer.write_record(cells);
    debug_assert!(written.is_ok());
    writer.into_inner().unwrap_or_default()
}
