//! Binary raw files of ngspice: a header in ASCII, then the points, one after the other, as little-endian doubles.
//!
//! Nothing in the header is trusted: no memory is taken by a count that stands there, and every number is checked.

use std::io::{BufRead, Read};

use thiserror::Error;

/// Why a raw file cannot be read.
#[derive(Debug, Error)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the message of each variant names its fields")]
pub enum RawError {
    /// The header is not one.
    #[error("header of the raw file: {0}")]
    Header(String),
    /// The file ends within its points.
    #[error("the raw file ends at point {point} of {points}")]
    Truncated { point: u64, points: u64 },
    /// A number is NaN or infinite.
    #[error("{variable} = {value} at point {point} of the raw file")]
    NotFinite { variable: String, value: f64, point: u64 },
    /// A variable that should be there is not.
    #[error("the raw file has no variable {0}")]
    NoVariable(&'static str),
    /// The file cannot be read.
    #[error("cannot read the raw file: {0}")]
    Io(#[from] std::io::Error),
}

/// Bounds on what a header may say.
const MAX_LINE: u64 = 4096;
const MAX_LINES: usize = 64;
const MAX_VARIABLES: usize = 1024;
const MAX_POINTS: u64 = 1 << 40;

/// A raw file, read point by point.
#[derive(Debug)]
pub struct RawReader<R> {
    input: R,
    names: Vec<String>,
    points: u64,
    next: u64,
    bytes: Vec<u8>,
}

impl<R: BufRead> RawReader<R> {
    /// Reads the header.
    ///
    /// # Errors
    /// No header, ASCII or complex data, counts that are absurd or do not fit what follows.
    pub fn new(mut input: R) -> Result<Self, RawError> {
        let (mut variables, mut points, mut real) = (None, None, false);
        for _ in 0..MAX_LINES {
            let line = header_line(&mut input)?;
            let (key, value) = line.split_once(':').unwrap_or((&line, ""));
            let value = value.trim();
            match key {
                "Flags" => real = value.split_whitespace().any(|flag| flag == "real"),
                "No. Variables" => variables = Some(count("No. Variables", value, MAX_VARIABLES as u64)?),
                "No. Points" => points = Some(count("No. Points", value, MAX_POINTS)?),
                "Variables" => {
                    let (Some(variables), Some(points)) = (variables, points) else {
                        return fail("no number of variables or points before the list of variables");
                    };
                    if !real {
                        return fail("the data are not flagged as real numbers");
                    }
                    let names = (0..variables).map(|index| variable(&mut input, index)).collect::<Result<_, _>>()?;
                    return Self::at_points(input, names, points);
                }
                _ => {}
            }
        }
        fail("no list of variables")
    }

    fn at_points(mut input: R, names: Vec<String>, points: u64) -> Result<Self, RawError> {
        match header_line(&mut input)?.as_str() {
            "Binary:" => {
                let bytes = vec![0; names.len() * size_of::<f64>()];
                Ok(Self { input, names, points, next: 0, bytes })
            }
            "Values:" => fail("the data are in ASCII: only binary files are read (set filetype=binary)"),
            _ => fail("no line \"Binary:\" after the list of variables"),
        }
    }

    /// Names of the variables; the first is the time.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Number of points, as announced.
    pub fn points(&self) -> u64 {
        self.points
    }

    /// Positions of variables in a point.
    ///
    /// # Errors
    /// The first that is not there.
    pub fn indices(&self, names: &[&'static str]) -> Result<Vec<usize>, RawError> {
        let index = |name| self.names.iter().position(|known| known.eq_ignore_ascii_case(name));
        names.iter().map(|&name| index(name).ok_or(RawError::NoVariable(name))).collect()
    }

    /// Reads the next point into `values`; false after the last.
    ///
    /// # Errors
    /// A file that ends too early; a number that is not finite.
    pub fn next_point(&mut self, values: &mut Vec<f64>) -> Result<bool, RawError> {
        let point = self.next;
        if point == self.points {
            return Ok(false);
        }
        self.input.read_exact(&mut self.bytes).map_err(|error| match error.kind() {
            std::io::ErrorKind::UnexpectedEof => RawError::Truncated { point, points: self.points },
            _ => RawError::Io(error),
        })?;
        values.clear();
        values.extend(self.bytes.chunks_exact(size_of::<f64>()).map(|chunk| {
            let mut bytes = [0; size_of::<f64>()];
            bytes.copy_from_slice(chunk);
            f64::from_le_bytes(bytes)
        }));
        if let Some(index) = values.iter().position(|value| !value.is_finite()) {
            return Err(RawError::NotFinite { variable: self.names[index].clone(), value: values[index], point });
        }
        self.next += 1;
        Ok(true)
    }
}

fn fail<T>(reason: impl Into<String>) -> Result<T, RawError> {
    Err(RawError::Header(reason.into()))
}

/// A line without its end.
fn header_line(input: &mut impl BufRead) -> Result<String, RawError> {
    let mut line = Vec::new();
    input.by_ref().take(MAX_LINE).read_until(b'\n', &mut line)?;
    if line.pop() != Some(b'\n') {
        return fail("it ends within a line, or a line is too long");
    }
    String::from_utf8(line)
        .map_err(|_| RawError::Header("it is not text".to_owned()))
        .map(|line| line.trim_end().to_owned())
}

fn count(name: &str, value: &str, most: u64) -> Result<u64, RawError> {
    match value.parse() {
        Ok(count) if (1..=most).contains(&count) => Ok(count),
        _ => fail(format!("{name} = {value:.40}: must lie from 1 to {most}")),
    }
}

/// A line of the list of variables: index, name, type.
fn variable(input: &mut impl BufRead, index: u64) -> Result<String, RawError> {
    let line = header_line(input)?;
    let mut words = line.split_whitespace();
    match (words.next(), words.next()) {
        (Some(number), Some(name)) if number.parse() == Ok(index) => Ok(name.to_owned()),
        _ => fail(format!("variable {index} is not on its line")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEADER: &str = "Title: a title\nDate: now\nPlotname: Transient Analysis\nFlags: real\nNo. Variables: 2\n\
                          No. Points: 2       \nVariables:\n\t0\ttime\ttime\n\t1\tv(de)\tvoltage\nBinary:\n";

    fn file(header: &str, numbers: &[f64]) -> Vec<u8> {
        header.bytes().chain(numbers.iter().flat_map(|number| number.to_le_bytes())).collect()
    }

    fn read(bytes: &[u8]) -> Result<Vec<Vec<f64>>, RawError> {
        let mut reader = RawReader::new(bytes)?;
        let (mut point, mut points) = (Vec::new(), Vec::new());
        while reader.next_point(&mut point)? {
            points.push(point.clone());
        }
        Ok(points)
    }

    #[test]
    fn points_are_read_to_the_last_bit() {
        let bytes = file(HEADER, &[0.0, 2000.0, 1e-6, 1.0 / 3.0]);
        assert_eq!(read(&bytes).unwrap(), [[0.0, 2000.0], [1e-6, 1.0 / 3.0]]);
        let reader = RawReader::new(bytes.as_slice()).unwrap();
        assert_eq!((reader.indices(&["V(de)", "time"]).unwrap(), reader.points()), (vec![1, 0], 2));
        let error = reader.indices(&["time", "v(out)"]).unwrap_err().to_string();
        assert_eq!(error, "the raw file has no variable v(out)");
    }

    #[test]
    fn what_is_wrong_with_a_file_is_named() {
        let numbers = [0.0, 2000.0, 1e-6, 2001.0];
        for (from, to, expected) in [
            ("Flags: real", "Flags: complex", "not flagged as real"),
            ("Flags: real\n", "", "not flagged as real"),
            ("No. Points: 2 ", "No. Points: 0 ", "No. Points = 0: must lie from 1"),
            ("No. Points: 2 ", "No. Points: 99999999999999999999 ", "No. Points = 99999999999999999999"),
            ("No. Points: 2 ", "No. Points: -2 ", "No. Points = -2"),
            ("No. Points: 2 ", "No. Points: 3 ", "ends at point 2 of 3"),
            ("No. Points: 2 ", "No. Points: 1000000000000 ", "ends at point 2 of 1000000000000"),
            ("No. Variables: 2", "No. Variables: 1025", "No. Variables = 1025: must lie from 1 to 1024"),
            ("No. Variables: 2", "No. Variables: 3", "variable 2 is not on its line"),
            ("No. Variables: 2\n", "", "no number of variables"),
            ("\t1\tv(de)", "\t7\tv(de)", "variable 1 is not on its line"),
            ("Binary:", "Values:", "ASCII"),
            ("Binary:", "Text:", "no line \"Binary:\""),
        ] {
            let error = read(&file(&HEADER.replace(from, to), &numbers)).unwrap_err().to_string();
            assert!(error.contains(expected), "{to}: {error}");
        }
        let error = read(&file(HEADER, &[0.0, f64::NAN, 1e-6, 2.0])).unwrap_err().to_string();
        assert_eq!(error, "v(de) = NaN at point 0 of the raw file");
        assert!(read(&file(HEADER, &[0.0, 1.0, 2.0])[..]).unwrap_err().to_string().contains("ends at point 1 of 2"));
        let long = "x".repeat(5000);
        assert!(read(long.as_bytes()).unwrap_err().to_string().contains("a line is too long"));
        assert!(read("Title: x\n".repeat(100).as_bytes()).unwrap_err().to_string().contains("no list of variables"));
    }
}
