//! Reading results: whole lines in the order of the runs, as many as are what they should be.

use std::io::{self, BufRead, Read as _};
use std::ops::Range;

/// Longest line that can be one, bytes.
const LONGEST: u64 = 1 << 20;

/// How far results are what they should be.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Extent {
    /// Bytes, heading included.
    pub bytes: u64,
    /// Lines after the heading.
    pub lines: u64,
    /// Those of them that are runs that failed.
    pub failed: u64,
    /// The last of them.
    pub last: Vec<u8>,
}

impl Extent {
    /// That it is all of a file of `length` bytes with the results of the runs `range`; else what is wrong with them.
    pub fn check_whole(&self, length: u64, range: &Range<u64>) -> Result<(), String> {
        let due = range.start + self.lines;
        if self.bytes == 0 {
            Err("its first line is not the heading of this sweep".to_owned())
        } else if due < range.end {
            Err(format!("line {} is not run {due} of runs {} to {}", self.lines + 2, range.start, range.end - 1))
        } else if self.bytes < length {
            Err(format!("{} bytes follow line {}, its last", length - self.bytes, self.lines + 1))
        } else {
            Ok(())
        }
    }
}

/// Follows results from their heading on, and hands each line of runs `first` and following, of which there are at most
/// `most`, to `take`. Ends before the first line that is not whole or not that of the run which is due.
pub(super) fn follow<E: From<io::Error>>(
    from: impl BufRead,
    heading: &[u8],
    first: u64,
    most: u64,
    mut take: impl FnMut(&[u8]) -> Result<(), E>,
) -> Result<Extent, E> {
    let (mut from, mut extent, mut line) = (from, Extent::default(), Vec::new());
    if !next(&mut from, &mut line)? || line != heading {
        return Ok(extent);
    }
    extent.bytes = line.len() as u64;
    while extent.lines < most && next(&mut from, &mut line)? && is_run(&line, first + extent.lines) {
        take(&line)?;
        extent.bytes += line.len() as u64;
        extent.lines += 1;
        extent.failed += u64::from(has_failed(&line));
        extent.last.clone_from(&line);
    }
    Ok(extent)
}

/// Reads a line with its end; false if there is no whole one.
fn next(from: &mut impl BufRead, line: &mut Vec<u8>) -> io::Result<bool> {
    line.clear();
    from.take(LONGEST).read_until(b'\n', line)?;
    Ok(line.last() == Some(&b'\n'))
}

/// Whether a line is that of run `number`. A zero byte is what a power cut leaves, and in no text of an FMU. A quote that is
/// not closed would make further lines part of a cell.
fn is_run(line: &[u8], number: u64) -> bool {
    !line.contains(&0)
        && !line.split(|byte| *byte == b'"').count().is_multiple_of(2)
        && line.strip_prefix(number.to_string().as_bytes()).is_some_and(|rest| rest.first() == Some(&b','))
}

/// Whether the line is that of a run that failed: its last cell, the error, is not empty. A text that ends in a comma
/// would stand in quotes.
pub(super) fn has_failed(line: &[u8]) -> bool {
    !line.ends_with(b",\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn extent(text: &str, first: u64, most: u64) -> (u64, u64, u64) {
        let extent = follow(text.as_bytes(), b"run,error\n", first, most, |_| Ok::<_, io::Error>(())).unwrap();
        (extent.bytes, extent.lines, extent.failed)
    }

    #[test]
    fn results_end_before_the_first_line_that_is_not_what_it_should_be() {
        for (text, expected) in [
            ("", (0, 0, 0)),
            ("run,err", (0, 0, 0)),
            ("run,other\n0,\n", (0, 0, 0)),
            ("run,error\n", (10, 0, 0)),
            ("run,error\n5,\n6,bad\n7,\n", (22, 3, 1)),
            ("run,error\n5,\n6,", (13, 1, 0)),
            ("run,error\n5,\n7,\n", (13, 1, 0)),
            ("run,error\n5,\n\0\0\0\0\n6,\n", (13, 1, 0)),
            ("run,error\n5,\n60,\n", (13, 1, 0)),
            ("run,error\n5,\n6,\0\0,\n7,\n", (13, 1, 0)),
            ("run,error\n5,\"a, \"\"b\"\"\"\n6,\n7,\n", (29, 3, 1)),
            ("run,error\n5,\n6,\"\n7,\n", (13, 1, 0)),
            ("run,error\n5,\n6,\n7,\n8,\n", (19, 3, 0)),
        ] {
            assert_eq!(extent(text, 5, 3), expected, "{text:?}");
        }
    }
    #[test]
    fn results_that_are_not_whole_are_told_by_what_is_wrong() {
        for (text, expected) in [
            ("run,error\n5,\n6,\n", None),
            ("run,other\n5,\n6,\n", Some("its first line is not the heading of this sweep")),
            ("run,error\n5,\n7,\n", Some("line 3 is not run 6 of runs 5 to 6")),
            ("run,error\n5,\n6,\n7,\n", Some("3 bytes follow line 3, its last")),
        ] {
            let extent = follow(text.as_bytes(), b"run,error\n", 5, 2, |_| Ok::<_, io::Error>(())).unwrap();
            assert_eq!(extent.check_whole(text.len() as u64, &(5..7)).err().as_deref(), expected, "{text:?}");
        }
    }
}
