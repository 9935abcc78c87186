//! Columns of the results.

use serde::{Deserialize, Serialize};

use fmu_import::{Kind, Value, Variable};

/// A column.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Column {
    /// Its heading.
    pub name: String,
    /// Type of its cells.
    #[serde(rename = "type")]
    pub kind: Type,
    /// Whether it is empty in the row of a run that failed, or of one that did not.
    pub optional: bool,
}

/// Type of the cells of a column.
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
        Self { name: one_line(name), kind, optional: false }
    }

    /// A column that may be empty.
    pub(super) fn optional(name: &str, kind: Type) -> Self {
        Self { name: one_line(name), kind, optional: true }
    }
}

impl Type {
    /// Type of the values of `variable`.
    pub(super) fn of(variable: &Variable) -> Self {
        match variable.kind {
            Kind::Real { .. } => Self::Real,
            Kind::Integer { .. } => Self::Integer,
            Kind::Boolean { .. } => Self::Boolean,
            Kind::String { .. } | Kind::Enumeration { .. } | Kind::Other => Self::Text,
        }
    }
}

/// The cell of `value`; a number keeps its bits when it is read again.
pub(super) fn cell(value: &Value) -> String {
    match value {
        Value::Real(value) => real(*value),
        other => one_line(&other.to_string()),
    }
}

/// The shortest text that reads as `value`.
pub(super) fn real(value: f64) -> String {
    format!("{value:?}")
}

/// `text` in one line, so that a line is a row, and without zero bytes, which a torn write leaves. All texts of an FMU pass
/// here: names of columns and of items of enumerations, values, and reasons of failures.
pub(super) fn one_line(text: &str) -> String {
    text.split(['\r', '\n', '\0']).filter(|line| !line.is_empty()).collect::<Vec<_>>().join(" ")
}

/// Most that [`reason`] takes of a line, bytes.
pub(super) const MOST_REASON: usize = 1 << 16;

/// Reason of a failure for one cell, cut if it is too long.
pub(super) fn reason(text: &str) -> String {
    let text = one_line(text);
    // A quote takes two bytes, and the cell has one at each end.
    let most = MOST_REASON / 2 - 8;
    if text.len() <= most {
        return text;
    }
    let end = text.char_indices().map(|(at, _)| at).take_while(|at| *at <= most).last().unwrap_or(0);
    format!("{}...", &text[..end])
}

/// The first line of the results.
pub(super) fn heading(columns: &[Column]) -> Vec<u8> {
    line(columns.iter().map(|column| column.name.as_str()))
}

/// A row as a line of CSV.
pub(super) fn line<'a>(cells: impl IntoIterator<Item = &'a str>) -> Vec<u8> {
    let mut writer = csv::WriterBuilder::new().buffer_capacity(512).from_writer(Vec::new());
    // A vector takes everything, and there is but one row: no length can differ.
    let written = writer.write_record(cells);
    debug_assert!(written.is_ok());
    writer.into_inner().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whatever_an_fmu_has_a_say_in_is_one_line_without_zero_bytes() {
        let evil = "two\r\nlines\0and \"quotes\"";
        let said = "two lines and \"quotes\"";
        assert_eq!(Column::always(evil, Type::Real).name, said);
        assert_eq!(Column::optional(evil, Type::Real).name, said);
        assert_eq!(cell(&Value::String(evil.to_owned())), said);
        assert_eq!(cell(&Value::Enumeration { value: 1, name: evil.to_owned() }), said);
        assert_eq!(reason(evil), said);
    }

    #[test]
    fn a_reason_that_is_too_long_is_cut_between_letters() {
        let cut = line([reason(&"\"".repeat(MOST_REASON)).as_str()]);
        assert!(cut.ends_with(b"...\"\n") && cut.len() <= MOST_REASON, "{} bytes", cut.len());
        assert!(reason(&"\u{fc}".repeat(MOST_REASON)).ends_with("\u{fc}..."));
    }
}
