//! Reading results: whole lines in the order of the runs, as many as are what they should be.

use std::io::{self, BufRead, Read as _};

use super::column::{self, Column, Type};
use super::order::Order;

/// Longest line with its end, bytes. None is written that is longer.
pub(super) const LONGEST: usize = 1 << 20;

/// The valid part of a file of results.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Extent {
    /// Bytes, heading included.
    pub bytes: u64,
    /// Lines after the heading.
    pub lines: u64,
    /// Those of them that are runs that failed.
    pub failed: u64,
    /// The last of them that is of a run that did not fail, and the number of that run.
    pub last: Option<(u64, Vec<u8>)>,
    /// The rest of the file.
    pub rest: Rest,
}

/// The rest of a file after its valid lines.
#[derive(Debug, Default, PartialEq)]
pub(super) enum Rest {
    /// Nothing.
    #[default]
    Nothing,
    /// The trace of a write that was cut short: part of a line, or zero bytes, which no text of an FMU has.
    Torn,
    /// A whole line, and why it is not the one expected.
    Wrong(String),
}

impl Extent {
    /// That it is all of a file of `length` bytes with results, behind which `order` stands; else what is wrong with them.
    pub fn check_complete(&self, length: u64, order: &Order) -> Result<(), String> {
        let is_short = order.next() < order.range().end;
        match &self.rest {
            _ if self.bytes == 0 => Err(NOT_HEADING.to_owned()),
            Rest::Wrong(reason) if is_short => Err(reason.clone()),
            _ if is_short => Err(not_expected(self.lines + 2, order)),
            _ if self.bytes < length => {
                Err(format!("{} bytes follow line {}, its last", length - self.bytes, self.lines + 1))
            }
            _ => Ok(()),
        }
    }
}

const NOT_HEADING: &str = "its first line is not the heading of this sweep";

fn not_expected(line: u64, order: &Order) -> String {
    let range = order.range();
    format!("line {line} is not run {} of runs {} to {}", order.next(), range.start, range.end - 1)
}

/// Follows results in their `order` from their heading on, and hands each line of a run to `take`. Ends before the first
/// line that is not whole or not that of the run expected.
pub(super) fn follow<E: From<io::Error>>(
    mut from: impl BufRead,
    columns: &[Column],
    order: &mut Order,
    mut take: impl FnMut(&[u8]) -> Result<(), E>,
) -> Result<Extent, E> {
    let heading = column::heading(columns);
    let (mut extent, mut line, mut cells) = (Extent::default(), Vec::new(), Cells::new(columns));
    loop {
        line.clear();
        from.by_ref().take(LONGEST as u64).read_until(b'\n', &mut line)?;
        if line.is_empty() {
            return Ok(extent);
        }
        let is_heading = extent.bytes == 0;
        let checked = match line.last() {
            _ if line.contains(&0) => Err(Rest::Torn),
            Some(b'\n') if is_heading && line == heading => Ok(()),
            Some(b'\n') if is_heading => Err(Rest::Wrong(NOT_HEADING.to_owned())),
            Some(b'\n') => cells.check(&line, &extent, order).map_err(Rest::Wrong),
            _ if line.len() < LONGEST => Err(Rest::Torn),
            _ => Err(Rest::Wrong(format!("line {} has more than {LONGEST} bytes", extent.lines + 2))),
        };
        if let Err(rest) = checked {
            extent.rest = rest;
            return Ok(extent);
        }
        extent.bytes += line.len() as u64;
        if is_heading {
            continue;
        }
        take(&line)?;
        if has_failed(&line) {
            extent.failed += 1;
        } else {
            let (run, last) = extent.last.get_or_insert_default();
            *run = order.next();
            last.clone_from(&line);
        }
        extent.lines += 1;
        order.took(&line);
    }
}

/// The cells of a line, in memory that serves one line after the other.
struct Cells<'a> {
    columns: &'a [Column],
    reader: csv_core::Reader,
    text: Vec<u8>,
    ends: Vec<usize>,
}

impl<'a> Cells<'a> {
    fn new(columns: &'a [Column]) -> Self {
        // One end more than there may be: a cell too many is seen.
        let ends = vec![0; columns.len() + 1];
        Self { columns, reader: csv_core::Reader::new(), text: Vec::new(), ends }
    }

    /// That `line` is that of the run that follows in `order`, behind `extent`, and a row of its own, with cells of the types
    /// of the columns; else why not.
    fn check(&mut self, line: &[u8], extent: &Extent, order: &Order) -> Result<(), String> {
        let (number, expected, range) = (extent.lines + 2, order.next(), order.range());
        if range.is_empty() {
            return Err(format!("line {number} is one too many: a share without runs has none"));
        }
        if expected >= range.end {
            return Err(format!("line {number} follows that of the last run, {}", range.end - 1));
        }
        if line.strip_prefix(expected.to_string().as_bytes()).is_none_or(|rest| rest.first() != Some(&b',')) {
            return Err(not_expected(number, order));
        }
        self.check_cells(line).map_err(|reason| format!("line {number}, of run {expected}, {reason}"))
    }

    fn check_cells(&mut self, line: &[u8]) -> Result<(), String> {
        self.text.resize(line.len().max(self.text.len()), 0);
        self.reader.reset();
        let (read, taken, _, count) = self.reader.read_record(line, &mut self.text, &mut self.ends);
        // A quote that is not closed would make further lines part of a cell.
        let is_row = read == csv_core::ReadRecordResult::Record && taken == line.len();
        if !is_row || count != self.columns.len() {
            return Err(format!("is no row of {} cells", self.columns.len()));
        }
        let mut start = 0;
        for (column, end) in self.columns.iter().zip(&self.ends) {
            let cell = &self.text[start..*end];
            if !is_of(column, cell) {
                let cell: String = String::from_utf8_lossy(cell).chars().take(40).collect();
                return Err(format!("has {} = {cell:?}, which is not of its type", column.name));
            }
            start = *end;
        }
        Ok(())
    }
}

fn is_of(column: &Column, cell: &[u8]) -> bool {
    let Ok(cell) = std::str::from_utf8(cell) else { return false };
    match column.kind {
        _ if column.optional && cell.is_empty() => true,
        Type::Integer => cell.parse::<i64>().is_ok(),
        Type::Real => cell.parse::<f64>().is_ok(),
        Type::Boolean => cell.parse::<bool>().is_ok(),
        Type::Text => true,
    }
}

/// Whether the line is that of a run that failed: its last cell, the error, is not empty. A text that ends in a comma
/// would stand in quotes.
pub(super) fn has_failed(line: &[u8]) -> bool {
    !line.ends_with(b",\n")
}

#[cfg(test)]
mod tests {
    use std::ops::Range;

    use super::*;

    fn columns() -> [Column; 2] {
        [Column::always("run", Type::Integer), Column::optional("error", Type::Text)]
    }

    fn extent(text: &str, range: &Range<u64>) -> Extent {
        let columns = columns();
        follow(text.as_bytes(), &columns, &mut Order::of(range.clone(), None), |_| Ok::<_, io::Error>(())).unwrap()
    }

    #[test]
    fn results_end_before_the_first_line_that_is_torn_or_wrong() {
        let wrong = |reason: &str| Rest::Wrong(reason.to_owned());
        let (not_6, no_row) = ("line 3 is not run 6 of runs 5 to 7", "line 3, of run 6, is no row of 2 cells");
        let long = format!("5,{}\n", "x".repeat(LONGEST));
        for (text, expected) in [
            ("", ((0, 0, 0), Rest::Nothing)),
            ("run,err", ((0, 0, 0), Rest::Torn)),
            ("\0\0\0", ((0, 0, 0), Rest::Torn)),
            ("run,other\n0,\n", ((0, 0, 0), wrong(NOT_HEADING))),
        ] {
            let Extent { bytes, lines, failed, rest, .. } = extent(text, &(5..8));
            assert_eq!(((bytes, lines, failed), rest), expected, "{text:?}");
        }
        for (text, expected) in [
            ("", ((10, 0, 0), Rest::Nothing)),
            ("5,\n", ((13, 1, 0), Rest::Nothing)),
            ("5,\n6,bad\n7,\n", ((22, 3, 1), Rest::Nothing)),
            ("5,\"a, \"\"b\"\"\"\n6,\n7,\n", ((29, 3, 1), Rest::Nothing)),
            ("5,\n6,", ((13, 1, 0), Rest::Torn)),
            ("5,\n\0\0\0\0\n6,\n", ((13, 1, 0), Rest::Torn)),
            ("5,\n6,\0\0,\n7,\n", ((13, 1, 0), Rest::Torn)),
            ("5,\n6,\n7,\n8,", ((19, 3, 0), Rest::Torn)),
            ("5,\n7,\n", ((13, 1, 0), wrong(not_6))),
            ("5,\n60,\n", ((13, 1, 0), wrong(not_6))),
            ("5,\n6\n", ((13, 1, 0), wrong(not_6))),
            ("5,\n6,a,b\n", ((13, 1, 0), wrong(no_row))),
            ("5,\n6,\"\n7,\n", ((13, 1, 0), wrong(no_row))),
            ("5,\n6,\r7,\n", ((13, 1, 0), wrong(no_row))),
            ("5,\n6,\n7,\n8,\n", ((19, 3, 0), wrong("line 5 follows that of the last run, 7"))),
            (&long, ((10, 0, 0), wrong("line 2 has more than 1048576 bytes"))),
        ] {
            let Extent { bytes, lines, failed, rest, .. } = extent(&format!("run,error\n{text}"), &(5..8));
            assert_eq!(((bytes, lines, failed), rest), expected, "{text:.40?}");
        }
    }

    #[test]
    fn the_last_run_that_did_not_fail_is_known() {
        for (text, expected) in [
            ("run,error\n", None),
            ("run,error\n5,bad\n", None),
            ("run,error\n5,\n6,\n", Some((6, "6,\n"))),
            ("run,error\n5,\n6,bad\n7,bad\n", Some((5, "5,\n"))),
        ] {
            let expected = expected.map(|(run, line): (u64, &str)| (run, line.into()));
            assert_eq!(extent(text, &(5..8)).last, expected, "{text:?}");
        }
    }

    #[test]
    fn a_cell_that_is_not_of_the_type_of_its_column_is_named() {
        for (kind, cell, is_one) in [
            (Type::Integer, "7", true),
            (Type::Integer, "7.5", false),
            (Type::Real, "-inf", true),
            (Type::Real, "abc", false),
            (Type::Boolean, "1", false),
            (Type::Text, "", true),
            (Type::Real, "", false),
        ] {
            let columns = [Column::always("run", Type::Integer), Column::always("x", kind)];
            let text = format!("run,x\n0,{cell}\n");
            let extent =
                follow(text.as_bytes(), &columns, &mut Order::of(0..1, None), |_| Ok::<_, io::Error>(())).unwrap();
            let wrong = Rest::Wrong(format!("line 2, of run 0, has x = {cell:?}, which is not of its type"));
            assert_eq!(extent.rest, if is_one { Rest::Nothing } else { wrong });
        }
    }

    #[test]
    fn results_that_are_not_whole_are_told_by_what_is_wrong() {
        let of_none = extent("run,error\n0,\n", &(0..0)).rest;
        assert_eq!(of_none, Rest::Wrong("line 2 is one too many: a share without runs has none".to_owned()));
        for (text, expected) in [
            ("run,error\n5,\n6,\n", None),
            ("run,other\n5,\n6,\n", Some("its first line is not the heading of this sweep")),
            ("run,error\n5,\n7,\n", Some("line 3 is not run 6 of runs 5 to 6")),
            ("run,error\n5,\n6,\n7,\n", Some("3 bytes follow line 3, its last")),
        ] {
            let (columns, mut order) = (columns(), Order::of(5..7, None));
            let extent = follow(text.as_bytes(), &columns, &mut order, |_| Ok::<_, io::Error>(())).unwrap();
            let checked = extent.check_complete(text.len() as u64, &order);
            assert_eq!(checked.err().as_deref(), expected, "{text:?}");
        }
    }
}
