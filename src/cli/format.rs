//! Numbers and tables as people read them.

use comfy_table::{Cell, CellAlignment, ColumnConstraint, ContentArrangement, LineStyle, Table, TableStyle, Width};
use videg_report::Column;

use super::terminal;

/// A rule above, below the heading and below the table; nothing between rows.
const RULE: LineStyle = LineStyle::none().fill(terminal::RULE).junction(terminal::RULE);
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

    /// The table as text of at most `columns`, whatever the terminal.
    pub fn within(&self, columns: usize) -> String {
        let text = self.laid_out(&self.headings, |column| column == 0 || self.words.contains(&column));
        let columns = terminal::width().map_or(columns, |width| width.min(columns));
        self.narrowed(text, columns)
    }

    /// The table with these headings, whose columns are aligned to the right but for some.
    fn laid_out(&self, headings: &[String], is_left: impl Fn(usize) -> bool) -> Table {
        let row = |cells: &[String]| {
            let aligned = cells.iter().enumerate().map(|(column, text)| {
                let cell = Cell::new(text);
                if is_left(column) { cell } else { cell.set_alignment(CellAlignment::Right) }
            });
            aligned.collect::<Vec<_>>()
        };
        let mut table = Table::new();
        table.load_style(STYLE).set_content_arrangement(ContentArrangement::Disabled);
        table.set_header(row(headings));
        table.add_rows(self.rows.iter().map(|cells| row(cells)));
        table
    }

    fn filled(&self, headings: &[String]) -> String {
        let text = self.laid_out(headings, |column| column == 0);
        let whole = text.to_string();
        match terminal::width() {
            Some(columns) if !fits(&whole, columns) => self.narrowed(text, columns),
            _ => whole,
        }
    }

    /// The table, which does not fit in `columns` as it is: with words on several lines, or without spaces at its edges, too, or else a block
    /// for each row.
    fn narrowed(&self, mut table: Table, columns: usize) -> String {
        let last = self.headings.len().saturating_sub(1);
        let with_edges = self.arranged(&mut table, columns, |_| (1, 1));
        let without = || self.arranged(&mut table, columns, |column| (0, u16::from(column < last)));
        with_edges.or_else(without).unwrap_or_else(|| self.blocks(columns))
    }

    /// The `table` with words on several lines, and spaces to the left and right of the cells of each column, if it fits in `columns` so.
    fn arranged(&self, table: &mut Table, columns: usize, padding: impl Fn(usize) -> (u16, u16)) -> Option<String> {
        let least = |column: usize| {
            let cells = self.rows.iter().filter_map(|row| row.get(column));
            // The first column and those of words break at spaces, as headings do; a number stays whole.
            let is_words = column == 0 || self.words.contains(&column);
            let least = |cell: &String| if is_words { longest_word(cell) } else { terminal::columns_of(cell) };
            let content = cells.map(least).chain([longest_word(&self.headings[column])]).max().unwrap_or_default();
            let (left, right) = padding(column);
            content + usize::from(left + right)
        };
        let least: Vec<_> = (0..self.headings.len()).map(least).collect();
        // Between columns stands one more space.
        if least.iter().sum::<usize>() + least.len() > columns + 1 {
            return None;
        }
        table.set_content_arrangement(ContentArrangement::Dynamic);
        table.set_width(u16::try_from(columns).unwrap_or(u16::MAX));
        for (index, (column, least)) in table.column_iter_mut().zip(least).enumerate() {
            let least = Width::Fixed(u16::try_from(least).unwrap_or(u16::MAX));
            column.set_padding(padding(index)).set_constraint(ColumnConstraint::LowerBoundary(least));
        }
        let shown = table.to_string();
        fits(&shown, columns).then_some(shown)
    }

    /// A block for each row, a line for each cell that is not empty, with its heading.
    fn blocks(&self, columns: usize) -> String {
        let widest = self.headings.iter().map(|heading| terminal::columns_of(heading)).max().unwrap_or_default();
        let indentation = widest.min(columns / 2) + 2;
        let line = |(heading, cell): (&String, &String)| {
            let indented =
                terminal::broken(cell, columns - indentation).replace('\n', &format!("\n{:indentation$}", ""));
            let beside = format!("{heading:<indentation$}{indented}");
            if fits(&beside, columns) { beside } else { terminal::broken(&format!("{heading} {cell}"), columns) }
        };
        let block = |row: &Vec<String>| {
            let cells = self.headings.iter().zip(row).filter(|(_, cell)| !cell.is_empty());
            cells.map(line).collect::<Vec<_>>().join("\n")
        };
        self.rows.iter().map(block).collect::<Vec<_>>().join("\n\n")
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

fn fits(text: &str, columns: usize) -> bool {
    text.lines().all(|line| terminal::columns_of(line) <= columns)
}

fn longest_word(text: &str) -> usize {
    text.split_whitespace().map(terminal::columns_of).max().unwrap_or_default()
}

/// A rate or a count per second: whole and with commas from a thousand on.
pub fn rate(value: f64) -> String {
    const GROUP: usize = 3;
    if value.abs() < 1e3 || !value.is_finite() {
        return significant(value, GROUP);
    }
    let digits = format!("{value:.0}");
    let first = digits.len() % GROUP;
    let comma = |(k, digit): (usize, char)| {
        [(k > 0 && k % GROUP == first).then_some(','), Some(digit)].into_iter().flatten().collect::<String>()
    };
    digits.chars().enumerate().map(comma).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_have_commas_from_a_thousand_on() {
        for (value, shown) in
            [(30.24, "30.2"), (999.0, "999"), (3596.4, "3,596"), (35964.0, "35,964"), (1_234_567.0, "1,234,567")]
        {
            assert_eq!(rate(value), shown);
        }
    }

    #[test]
    fn a_table_is_as_narrow_as_it_has_to_be() {
        let rows = [["energy into the load of both membranes", "mJ", "1.234567"], ["net gain", "mJ", "-0.1"]];
        let rows = rows.map(|row| row.map(str::to_owned).to_vec()).to_vec();
        let sheet = Sheet::new(["quantity", "unit", "found by the solver"], &[0, 1], rows);
        for columns in 20..80 {
            let narrow = sheet.narrowed(sheet.laid_out(&sheet.headings, |column| column == 0), columns);
            assert!(fits(&narrow, columns) && narrow.contains("1.234567"), "{columns}:\n{narrow}");
            // membranes, unit, 1.234567 and two columns between each.
            assert_eq!(narrow.contains(terminal::RULE), columns >= 9 + 2 + 4 + 2 + 8, "{columns}:\n{narrow}");
        }
    }

    #[test]
    fn a_cell_on_several_lines_stays_beside_its_heading() {
        let rows =
            vec![["Table 3, 2 Hz: P by the paper's stepping at 1e-5 s", "0.0612571"].map(str::to_owned).to_vec()];
        let shown = Sheet::new(["where and what", "videg"], &[], rows).blocks(44);
        let lines = [
            "where and what  Table 3, 2 Hz: P by the",
            "                paper's stepping at 1e-5 s",
            "videg           0.0612571",
        ];
        assert_eq!(shown, lines.join("\n"));
    }

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
