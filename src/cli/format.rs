//! Numbers and tables as people read them.

use comfy_table::{Cell, CellAlignment, ContentArrangement, LineStyle, Table, TableStyle};
use videg_report::Column;

/// A rule above, below the heading and below the table; nothing between rows.
const RULE: LineStyle = LineStyle::none().fill('\u{2500}').junction('\u{2500}');
const STYLE: TableStyle = TableStyle::new().top_border(RULE).header_separator(RULE).bottom_border(RULE);

/// `value` with `digits` significant digits, without an exponent where that stays readable.
pub fn significant(value: f64, digits: usize) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    let exponential = format!("{:.*e}", digits.saturating_sub(1), value);
    let exponent: i32 = exponential.split('e').nth(1).and_then(|text| text.parse().ok()).unwrap_or(0);
    let wanted = i32::try_from(digits).unwrap_or(i32::MAX);
    if !(-4..=8).contains(&exponent) {
        return exponential;
    }
    let decimals = usize::try_from(wanted - 1 - exponent).unwrap_or(0);
    format!("{value:.decimals$}")
}

/// Deviation of `found` from `expected` in per cent.
pub fn deviation(found: f64, expected: f64) -> String {
    format!("{:+.3} %", (found / expected - 1.0) * 100.0)
}

/// An empty table with a heading; columns but the first are aligned to the right.
pub fn table<S: AsRef<str>>(heading: &[S]) -> Table {
    let mut table = Table::new();
    table.load_style(STYLE).set_content_arrangement(ContentArrangement::Disabled);
    table.set_header(row(heading));
    table
}

/// A row of such a table.
pub fn row<S: AsRef<str>>(cells: &[S]) -> Vec<Cell> {
    let aligned = cells.iter().enumerate().map(|(column, text)| {
        let cell = Cell::new(text.as_ref());
        if column == 0 { cell } else { cell.set_alignment(CellAlignment::Right) }
    });
    aligned.collect()
}

/// A table for terminals and for HTML reports.
pub struct Sheet {
    headings: Vec<String>,
    words: &'static [usize],
    rows: Vec<Vec<String>>,
}

impl Sheet {
    /// A table of `rows` whose columns with the indices `words` hold words; the others hold numbers.
    pub fn new(
        headings: impl IntoIterator<Item = impl Into<String>>,
        words: &'static [usize],
        rows: Vec<Vec<String>>,
    ) -> Self {
        Self { headings: headings.into_iter().map(Into::into).collect(), words, rows }
    }

    /// The table as text.
    pub fn text(&self) -> String {
        self.filled(&self.headings)
    }

    /// The table as text, with headings that break at each `separator`.
    pub fn narrow(&self, separator: &str) -> String {
        let headings: Vec<_> = self.headings.iter().map(|heading| heading.replace(separator, "\n")).collect();
        self.filled(&headings)
    }

    fn filled(&self, headings: &[String]) -> String {
        let mut text = table(headings);
        for cells in &self.rows {
            text.add_row(row(cells));
        }
        text.to_string()
    }

    /// The table in a report.
    pub fn html(self) -> videg_report::Table {
        let column = |(index, heading)| {
            if self.words.contains(&index) { Column::words(heading) } else { Column::numbers(heading) }
        };
        let columns = videg_report::Table::new(self.headings.into_iter().enumerate().map(column));
        self.rows.into_iter().fold(columns, videg_report::Table::row)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn significant_digits_are_kept_and_exponents_only_where_they_help() {
        assert_eq!(significant(8_078.869_512, 6), "8078.87");
        assert_eq!(significant(0.000_121_3, 4), "0.0001213");
        assert_eq!(significant(1.213e-7, 4), "1.213e-7");
        assert_eq!(significant(0.0, 4), "0");
        assert_eq!(significant(-0.061_249, 3), "-0.0612");
        assert_eq!(significant(2_191_352.9, 5), "2191353");
        assert_eq!(significant(f64::NAN, 3), "NaN");
    }
}
