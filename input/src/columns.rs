//! Columns of numbers below a heading, as comma-separated values.
//!
//! - UTF-8, with or without a byte order mark; lines end with LF or CRLF.
//! - The first line that is no comment is the heading. Lines that begin with `#` are comments.
//! - Blanks and tabs around names and numbers count for nothing. Empty lines are allowed after the last row only.
//! - Numbers are finite and have a decimal point. Each column has its order, such as one that increases.
//!
//! Reading stops at the first fault, so that a file of any size is refused after a bounded part of it.

use std::io::{self, BufRead, BufReader, Read as _};
use std::path::Path;

use crate::open_regular;

/// Longest line, in bytes without its end.
const LONGEST_LINE: usize = 4096;

/// Most bytes of a file: a million rows of more than 200 bytes.
const LARGEST: u64 = 256 << 20;

/// What a table may be.
#[derive(Debug, Clone, Copy)]
pub struct Form<const N: usize> {
    /// Headings to choose from, and the units of their columns.
    pub headings: [Heading; N],
    /// Number of rows: the least and the largest.
    pub rows: [usize; 2],
}

/// The columns of a table.
pub type Heading = &'static [Column];

/// A column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Column {
    /// Its name in the heading.
    pub name: &'static str,
    /// Its unit, for messages.
    pub unit: &'static str,
    /// How its numbers follow each other.
    pub order: Order,
}

/// How the numbers of a column follow each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Order {
    /// In any way.
    Any,
    /// Each is above the one before.
    Rising,
    /// Likewise, from 0.
    RisingFromZero,
    /// None is below the one before.
    NotFalling,
}

/// The content of a file.
#[derive(Debug, Clone, PartialEq)]
pub struct Columns {
    /// Which of the headings it has.
    pub heading: usize,
    /// The columns.
    pub values: Vec<Vec<f64>>,
    /// On which lines its rows are.
    pub lines: Lines,
}

/// On which lines the rows of a table are.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Lines {
    /// Rows before which there are others lines than rows, with their lines.
    jumps: Vec<(usize, u64)>,
}

impl Lines {
    /// The line of a row; rows are counted from 0, lines from 1.
    pub fn of(&self, row: usize) -> u64 {
        let jump = self.jumps[..self.jumps.partition_point(|(first, _)| *first <= row)].last();
        jump.map_or(0, |(first, line)| line + (row - first) as u64)
    }

    fn add(&mut self, row: usize, line: u64) {
        if self.jumps.is_empty() || self.of(row) != line {
            self.jumps.push((row, line));
        }
    }
}

/// Why a file is no such table. The line is counted from 1.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the message of each variant names its fields")]
pub enum ColumnsError {
    /// The file cannot be opened or read.
    #[error("{0}")]
    Unreadable(#[from] io::Error),
    /// A line is not what it should be.
    #[error("line {line}: {reason}")]
    Line { line: u64, reason: String },
    /// Too few rows.
    #[error("{found} below the heading; at least {least} are needed", found = samples(*rows))]
    TooFew { rows: usize, least: usize },
    /// There is no heading.
    #[error("no heading; allowed is {allowed}")]
    NoHeading { allowed: String },
}

fn samples(rows: usize) -> String {
    if rows == 1 { "1 row".to_owned() } else { format!("{rows} rows") }
}

/// Reads the regular file at `path`.
///
/// # Errors
/// A file that cannot be opened or is not regular; as [`parse`].
pub fn read<const N: usize>(path: &Path, form: &Form<N>) -> Result<Columns, ColumnsError> {
    parse(BufReader::new(open_regular(path)?), form)
}

/// Reads a table.
///
/// # Errors
/// A line that is not UTF-8, too long, no row of finite numbers in their order; another heading; too few or too many rows; too
/// many bytes.
pub fn parse<const N: usize>(text: impl BufRead, form: &Form<N>) -> Result<Columns, ColumnsError> {
    let mut text = Text { bytes: text.take(LARGEST), number: 0, line: Vec::new() };
    let heading = loop {
        let Some(line) = text.next()? else { return Err(ColumnsError::NoHeading { allowed: form.allowed() }) };
        if !line.starts_with('#') {
            break form.heading(line).map_err(|reason| text.refuse(reason))?;
        }
    };
    let columns = form.headings[heading];
    let mut values = vec![Vec::new(); columns.len()];
    let (mut lines, mut empty) = (Lines::default(), None);
    while let Some(line) = text.next()? {
        if line.starts_with('#') {
            continue;
        }
        if line.is_empty() {
            empty.get_or_insert(text.number);
            continue;
        }
        if let Some(number) = empty {
            return Err(ColumnsError::Line { line: number, reason: "an empty line before the last row".to_owned() });
        }
        add_row(columns, line, &mut values).map_err(|reason| text.refuse(reason))?;
        lines.add(values[0].len() - 1, text.number);
        if values[0].len() > form.rows[1] {
            return Err(text.refuse(format!("more than {} rows", form.rows[1])));
        }
    }
    let [rows, least] = [values[0].len(), form.rows[0]];
    if rows < least { Err(ColumnsError::TooFew { rows, least }) } else { Ok(Columns { heading, values, lines }) }
}

/// A text, of which one line is read at a time.
struct Text<R> {
    bytes: io::Take<R>,
    number: u64,
    line: Vec<u8>,
}

impl<R: BufRead> Text<R> {
    /// The next line without its end, and without blanks around it.
    fn next(&mut self) -> Result<Option<&str>, ColumnsError> {
        self.line.clear();
        self.number += 1;
        // The end of the line may have two bytes.
        let read = (&mut self.bytes).take(LONGEST_LINE as u64 + 2).read_until(b'\n', &mut self.line)?;
        if self.bytes.limit() == 0 {
            return Err(self.refuse(format!("more than {LARGEST} bytes up to here")));
        }
        if read == 0 {
            return Ok(None);
        }
        let line = self.line.strip_suffix(b"\n").unwrap_or(&self.line);
        let line = line.strip_suffix(b"\r").unwrap_or(line);
        if line.len() > LONGEST_LINE {
            return Err(self.refuse(format!("it has more than {LONGEST_LINE} bytes")));
        }
        let line = if self.number == 1 { line.strip_prefix(b"\xef\xbb\xbf").unwrap_or(line) } else { line };
        let text = str::from_utf8(line).map_err(|error| {
            let reason =
                format!("not UTF-8: byte {:#04x} at column {}", line[error.valid_up_to()], error.valid_up_to() + 1);
            ColumnsError::Line { line: self.number, reason }
        })?;
        Ok(Some(text.trim_matches(BLANKS)))
    }

    fn refuse(&self, reason: String) -> ColumnsError {
        ColumnsError::Line { line: self.number, reason }
    }
}

/// What may stand around names and numbers.
const BLANKS: [char; 2] = [' ', '\t'];

/// Names and numbers of a line.
fn cells(line: &str) -> impl Iterator<Item = &str> {
    line.split(',').map(|cell| cell.trim_matches(BLANKS))
}

/// A text for messages, which nobody wants to read to its end.
fn shown(text: &str) -> String {
    const SHOWN: usize = 60;
    text.char_indices().nth(SHOWN).map_or_else(|| format!("{text:?}"), |(end, _)| format!("{:?}...", &text[..end]))
}

impl<const N: usize> Form<N> {
    fn heading(&self, line: &str) -> Result<usize, String> {
        let found = self.headings.iter().position(|heading| cells(line).eq(heading.iter().map(|it| it.name)));
        found.ok_or_else(|| format!("the heading is {}; allowed is {}", shown(line), self.allowed()))
    }

    fn allowed(&self) -> String {
        let texts = self.headings.map(|heading| {
            let names: Vec<_> = heading.iter().map(|column| column.name).collect();
            let units: Vec<_> = heading.iter().map(|column| column.unit).collect();
            let (last, first) = units.split_last().unwrap_or((&"", &[]));
            format!("{} (in {} and {last})", names.join(","), first.join(", "))
        });
        texts.join(" or ")
    }
}

/// Adds the numbers of a line to the columns.
fn add_row(heading: Heading, line: &str, values: &mut [Vec<f64>]) -> Result<(), String> {
    let (mut cells, count) = (cells(line), heading.len());
    for (Column { name, unit, .. }, values) in heading.iter().zip(&mut *values) {
        let cell = cells.next().ok_or_else(|| format!("no {name} in {}: a row has {count} numbers", shown(line)))?;
        let value: f64 = cell.parse().map_err(|_| format!("{name} = {}: no number", shown(cell)))?;
        if !value.is_finite() {
            return Err(format!("{name} = {}: it must be a finite number in {unit}", shown(cell)));
        }
        values.push(value);
    }
    if cells.next().is_some() {
        return Err(format!("more than {count} numbers in {}", shown(line)));
    }
    heading.iter().zip(values).try_for_each(|(column, values)| column.check(values))
}

impl Column {
    /// That the last of the `values` may follow the one before.
    fn check(&self, values: &[f64]) -> Result<(), String> {
        let Self { name, unit, order } = self;
        let Some((&value, earlier)) = values.split_last() else { return Ok(()) };
        let before = earlier.last();
        match (order, before) {
            (Order::Rising | Order::RisingFromZero, Some(before)) if value <= *before => {
                Err(format!("{name} = {value} {unit} is not above that of the row before, {before} {unit}"))
            }
            (Order::NotFalling, Some(before)) if value < *before => {
                Err(format!("{name} = {value} {unit} is below that of the row before, {before} {unit}"))
            }
            (Order::RisingFromZero, None) if value != 0.0 => {
                Err(format!("{name} = {value} {unit}: the first row must be that of 0 {unit}"))
            }
            _ => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const TIME: Column = Column { name: "time", unit: "s", order: Order::Rising };
    const FORM: Form<2> = Form {
        headings: [
            &[TIME, Column { name: "acceleration", unit: "m/s2", order: Order::Any }],
            &[TIME, Column { name: "force", unit: "N", order: Order::Any }],
        ],
        rows: [2, 4],
    };

    fn parsed(text: &[u8]) -> Result<Columns, String> {
        parse(text, &FORM).map_err(|error| error.to_string())
    }

    #[test]
    fn spellings_of_other_programs_are_read() {
        let plain = parsed(b"time,force\n0,1\n0.5,-2e-3\n").unwrap();
        assert_eq!((plain.heading, &*plain.values), (1, &[vec![0.0, 0.5], vec![1.0, -2e-3]][..]));
        assert_eq!([0, 1].map(|row| plain.lines.of(row)), [2, 3]);
        for text in [
            "\u{feff}time,force\r\n0,1\r\n0.5,-2e-3\r\n",
            "# of a lorry\ntime , force\n\t0, 1\n# here it brakes\n+0.5,-0.002",
            "time,force\n0,1\n0.5,-2e-3\n\n \t\n# end\n\n",
        ] {
            let found = parsed(text.as_bytes()).unwrap();
            assert_eq!((found.heading, &found.values), (1, &plain.values), "{text:?}");
            for row in 0..2 {
                let of_row = text.lines().nth(usize::try_from(found.lines.of(row)).unwrap() - 1).unwrap();
                assert!(of_row.contains(["0", "0.5"][row]) && of_row.contains(','), "{of_row}");
            }
        }
    }

    #[test]
    fn a_fault_is_named_with_its_line_its_value_and_what_is_allowed() {
        let allowed = "allowed is time,acceleration (in s and m/s2) or time,force (in s and N)";
        let long = "x".repeat(5000);
        for (text, said) in [
            ("", format!("no heading; {allowed}")),
            ("# nothing\n", format!("no heading; {allowed}")),
            ("\ntime,force\n", format!("line 1: the heading is \"\"; {allowed}")),
            ("time [ms],acc\n0,1\n", format!("line 1: the heading is \"time [ms],acc\"; {allowed}")),
            ("Time,Force\n", format!("line 1: the heading is \"Time,Force\"; {allowed}")),
            ("0,1\n1,2\n", format!("line 1: the heading is \"0,1\"; {allowed}")),
            ("time,force\n", "0 rows below the heading; at least 2 are needed".into()),
            ("time,force\n0,1\n", "1 row below the heading; at least 2 are needed".into()),
            ("time,force\n0,1\n1\n", "line 3: no force in \"1\": a row has 2 numbers".into()),
            ("time,force\n0,1\n1,\n", "line 3: force = \"\": no number".into()),
            ("time,force\n0,1\n1,2,3\n", "line 3: more than 2 numbers in \"1,2,3\"".into()),
            ("time,force\n0,1\n0,5;1\n", "line 3: force = \"5;1\": no number".into()),
            ("time,force\n0,1\n1,much\n", "line 3: force = \"much\": no number".into()),
            ("time,force\n0,1\n1,NaN\n", "line 3: force = \"NaN\": it must be a finite number in N".into()),
            ("time,force\n-inf,1\n", "line 2: time = \"-inf\": it must be a finite number in s".into()),
            ("time,force\n0,1e999\n", "line 2: force = \"1e999\": it must be a finite number in N".into()),
            ("time,force\n1,1\n0.5,1\n", "line 3: time = 0.5 s is not above that of the row before, 1 s".into()),
            ("time,force\n1,1\n# again\n1,1\n", "line 4: time = 1 s is not above that of the row before, 1 s".into()),
            ("time,force\n0,1\n\n1,1\n", "line 3: an empty line before the last row".into()),
            ("time,force\n0,0\n1,0\n2,0\n3,0\n4,0\n", "line 6: more than 4 rows".into()),
            (&long, "line 1: it has more than 4096 bytes".into()),
        ] {
            assert_eq!(parsed(text.as_bytes()), Err(said), "{:?}", &text[..text.len().min(60)]);
        }
        let said = "line 2: not UTF-8: byte 0xff at column 3";
        assert_eq!(parsed(b"time,force\n0,\xff\n"), Err(said.to_owned()));
    }

    #[test]
    fn a_text_without_end_is_refused_after_a_bounded_part() {
        for (unit, said) in
            [(&b"\0"[..], "line 1: it has more than 4096 bytes"), (b"# more\n", "more than 268435456 bytes")]
        {
            let endless = BufReader::new(Endless(unit, 0));
            let error = parse(endless, &FORM).unwrap_err().to_string();
            assert!(error.contains(said), "{error}");
        }
    }

    /// The same text again and again.
    struct Endless(&'static [u8], usize);

    impl io::Read for Endless {
        fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
            for byte in &mut *buffer {
                *byte = self.0[self.1];
                self.1 = (self.1 + 1) % self.0.len();
            }
            Ok(buffer.len())
        }
    }

    proptest! {
        #[test]
        fn numbers_are_read_back_to_the_same_bits(
            steps in proptest::collection::vec((1e-6_f64..1e3, proptest::num::f64::NORMAL), 2..5)
        ) {
            let mut time = 0.0;
            let rows: Vec<_> = steps.iter().map(|(step, value)| { time += step; (time, *value) }).collect();
            let lines: Vec<_> = rows.iter().map(|(time, value)| format!("{time:?}, {value:e}\r\n")).collect();
            let text = lines.concat();
            let found = parsed(format!("time,acceleration\r\n{text}").as_bytes()).unwrap();
            prop_assert_eq!(found.heading, 0);
            prop_assert_eq!(&found.values[0], &rows.iter().map(|row| row.0).collect::<Vec<_>>());
            prop_assert_eq!(&found.values[1], &rows.iter().map(|row| row.1).collect::<Vec<_>>());
        }

        #[test]
        fn any_text_is_read_or_refused_in_one_line(text in "(time,force\n)?([0-9a-z#,. -]{0,6}\r?\n){0,6}") {
            if let Err(reason) = parsed(text.as_bytes()) {
                prop_assert_eq!(reason.lines().count(), 1);
            }
        }
    }
}
